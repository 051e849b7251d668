// SPDX-License-Identifier: BSD-3-Clause
#include "Scenes.h"

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
/// A scene file seen by the airport scan of 16 channels: the surfaces as the filters see them,
/// merged, triangles only, with a material and an object each.
Scene readScene(const std::string& name, const std::string& file)
{
  Scene scene;
  scene.name = name;
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
  vtkPolyData* surfaces = tree->GetOutput();
  scene.mesh->points.resize(surfaces->GetNumberOfPoints());
  for (vtkIdType p = 0; p < surfaces->GetNumberOfPoints(); ++p)
  {
    surfaces->GetPoint(p, &scene.mesh->points[p].x);
  }
  vtkNew<vtkIdList> corners;
  const auto value = [surfaces](const char* array, vtkIdType cell)
  { return surfaces->GetCellData()->GetArray(array)->GetTuple1(cell); };
  for (vtkIdType c = 0; c < surfaces->GetNumberOfPolys(); ++c)
  {
    surfaces->GetPolys()->GetCellAtId(c, corners);
    const auto corner = [&](int k) { return static_cast<std::uint32_t>(corners->GetId(k)); };
    scene.mesh->triangles.push_back({ corner(0), corner(1), corner(2) });
    scene.materials.push_back({ value("kd", c), value("ks", c), value("kp", c) });
    scene.objectIds.push_back(static_cast<int>(value("object_id", c)));
  }
  vtkDataArray* position =
    reader->GetOutputDataObject(0)->GetFieldData()->GetArray("lidar_position");
  if (!position || scene.mesh->size() == 0)
  {
    throw std::runtime_error(file + " gave no surfaces, or no position of the lidar");
  }
  position->GetTuple(0, &scene.apex.x);
  return scene;
}
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
    return SceneEntry{ name, std::move(make) };
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
