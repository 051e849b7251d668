// SPDX-License-Identifier: BSD-3-Clause
#include "BenchmarkScene.h"

#include "vtkAvianLidarCollisionTree.h"
#include "vtkAvianLidarSceneReader.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkPolyData.h"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace benchmarks
{
namespace
{
/// The surfaces as the filters see them: merged, triangles only, with a material and an object
/// each.
void takeSurfaces(vtkPolyData* surfaces, Scene& scene)
{
  TriangleMesh& mesh = *scene.mesh;
  mesh.points.resize(surfaces->GetNumberOfPoints());
  for (vtkIdType p = 0; p < surfaces->GetNumberOfPoints(); ++p)
  {
    surfaces->GetPoint(p, &mesh.points[p].x);
  }
  vtkCellArray* cells = surfaces->GetPolys();
  vtkNew<vtkIdList> corners;
  vtkDataArray* kd = surfaces->GetCellData()->GetArray("kd");
  vtkDataArray* ks = surfaces->GetCellData()->GetArray("ks");
  vtkDataArray* kp = surfaces->GetCellData()->GetArray("kp");
  vtkDataArray* object = surfaces->GetCellData()->GetArray("object_id");
  if (!object)
  {
    throw std::runtime_error("surfaces without object_id");
  }
  for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c)
  {
    cells->GetCellAtId(c, corners);
    mesh.triangles.push_back({ static_cast<std::uint32_t>(corners->GetId(0)),
      static_cast<std::uint32_t>(corners->GetId(1)),
      static_cast<std::uint32_t>(corners->GetId(2)) });
    scene.materials.push_back({ kd->GetTuple1(c), ks->GetTuple1(c), kp->GetTuple1(c) });
    scene.objectIds.push_back(static_cast<int>(object->GetTuple1(c)));
  }
}
}

Scene readScene(const std::string& name, const std::string& file)
{
  Scene scene;
  scene.name = name;
  scene.mesh = std::make_shared<TriangleMesh>();
  scene.pattern = airportPattern(16);
  scene.airport = true;
  const char* data = std::getenv("AVIANLIDAR_DATA_DIR");
  const bool shipped = file.rfind(AVIANLIDAR_SOURCE_DIR, 0) == 0;
  if (!std::ifstream(file) || (!shipped && (!data || !*data)))
  {
    return scene;
  }
  vtkNew<vtkAvianLidarSceneReader> reader;
  reader->SetFileName(file.c_str());
  vtkNew<vtkAvianLidarCollisionTree> tree;
  tree->SetInputConnection(reader->GetOutputPort());
  tree->Update();
  takeSurfaces(tree->GetOutput(), scene);
  vtkDataArray* position =
    reader->GetOutputDataObject(0)->GetFieldData()->GetArray("lidar_position");
  if (!position || scene.mesh->size() == 0)
  {
    throw std::runtime_error(file + " gave no surfaces, or no position of the lidar");
  }
  position->GetTuple(0, &scene.apex.x);
  return scene;
}

std::vector<SceneEntry> airports()
{
  const auto entry = [](const std::string& name, const std::string& file,
                       const char* repaint = "Terminal*") {
    return SceneEntry{ name, [=]() { return readScene(name, file); }, file, repaint };
  };
  const std::string scenes = AVIANLIDAR_SCENES_DIR;
  return {
    entry("Hongqiao",
      std::string(AVIANLIDAR_SOURCE_DIR) + "/Examples/airport/scene/hongqiao.lidarscene.json"),
    entry("Hongqiao, structures", scenes + "/zsss_structures.lidarscene.json"),
    entry("Hongqiao, everything", scenes + "/zsss_all.lidarscene.json"),
    entry("Honolulu", scenes + "/phnl.lidarscene.json", "Structures*"),
  };
}

std::vector<SceneEntry> generatedScenes()
{
  const auto entry = [](const std::string& name, std::function<Scene()> make) {
    return SceneEntry{ name, std::move(make), "", "" };
  };
  return {
    entry("boxes 500", []() { return makeBoxes(500); }),
    entry("boxes 50000", []() { return makeBoxes(50000); }),
    entry("corridor", makeCorridor),
    entry("terrain", makeTerrain),
    entry("sphere 1e2", []() { return makeSphere(100); }),
    entry("sphere 1e4", []() { return makeSphere(10000); }),
    entry("sphere 1e6", []() { return makeSphere(1000000); }),
    entry("sphere 5e6", []() { return makeSphere(5000000); }),
  };
}
}
