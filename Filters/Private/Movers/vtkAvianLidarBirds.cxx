// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBirds.h"

#include "BirdTables.h"
#include "Table.h"
#include "ValueError.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBuiltInTexts.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarRequire.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"

#include <stdexcept>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
}

//------------------------------------------------------------------------------
std::vector<avianlidar::BirdSpecies> vtkAvianLidarBirds::BuiltInSpecies()
{
  return avianlidar::readSpecies(vtkAvianLidarBuiltInText("species.csv"), "species.csv");
}

//------------------------------------------------------------------------------
std::vector<avianlidar::BirdSpecies> vtkAvianLidarBirds::OwnSpecies(const std::string& file)
{
  if (file.empty())
  {
    return {};
  }
  return avianlidar::readSpecies(avianlidar::textOfFile("SpeciesFileName", file), file);
}

//------------------------------------------------------------------------------
std::vector<avianlidar::BirdSpecies> vtkAvianLidarBirds::KnownSpecies(const std::string& file)
{
  std::vector<avianlidar::BirdSpecies> all = OwnSpecies(file);
  const auto builtIn = BuiltInSpecies();
  all.insert(all.end(), builtIn.begin(), builtIn.end());
  return all;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBirds::NamesOfSpecies(const std::string& file)
{
  std::vector<avianlidar::BirdSpecies> all = BuiltInSpecies();
  try
  {
    const auto own = OwnSpecies(file);
    all.insert(all.end(), own.begin(), own.end());
  }
  catch (const std::runtime_error&)
  {
    // reported by the execution
  }
  std::string names;
  for (const avianlidar::BirdSpecies& species : all)
  {
    names += species.name + "\n";
  }
  return names;
}

//------------------------------------------------------------------------------
std::size_t vtkAvianLidarBirds::FindSpecies(
  const std::vector<avianlidar::BirdSpecies>& known, const std::string& name)
try
{
  return avianlidar::findSpecies(known, name);
}
catch (const std::runtime_error& error)
{
  throw std::runtime_error(std::string("Species ") + error.what());
}

//------------------------------------------------------------------------------
void vtkAvianLidarBirds::CheckReflectance(double reflectance)
{
  vtkAvianLidarRequire(avianlidar::rangeError("Reflectance", reflectance, 0.0, 1.0, "0 to 1"));
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarBirds::Surface(
  const avianlidar::BirdShape& shape, double angle, double reflectance)
{
  const avianlidar::Material plumage{ reflectance, 0.0, 1.0 };
  auto points = Arrays::MakePoints(0);
  vtkNew<vtkCellArray> cells;
  auto parts = Arrays::Make<vtkIntArray>(Arrays::Part, 0);
  for (const auto part :
    { avianlidar::BirdPart::Body, avianlidar::BirdPart::LeftWing, avianlidar::BirdPart::RightWing })
  {
    const avianlidar::TriangleMesh mesh = avianlidar::birdPart(shape, part, angle);
    const vtkIdType first = points->GetNumberOfPoints();
    for (const avianlidar::Vec3& p : mesh.points)
    {
      points->InsertNextPoint(p.x, p.y, p.z);
    }
    for (const auto& t : mesh.triangles)
    {
      cells->InsertNextCell({ first + t[0], first + t[1], first + t[2] });
      parts->InsertNextValue(static_cast<int>(part));
    }
  }
  auto bird = vtkSmartPointer<vtkPolyData>::New();
  bird->SetPoints(points);
  bird->SetPolys(cells);
  const vtkIdType count = cells->GetNumberOfCells();
  bird->GetCellData()->AddArray(parts);
  bird->GetCellData()->AddArray(Arrays::Constant(Arrays::MaterialId, count, 4));
  vtkAvianLidarMaterials::AddCoefficients(
    bird->GetCellData(), count, [&](vtkIdType) -> const avianlidar::Material& { return plumage; });
  Arrays::SetFieldStrings(
    bird->GetFieldData(), Arrays::MaterialNames, { "Wall", "Glass", "Metal", "Wood", "Plumage" });
  return bird;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBirds::SetObject(vtkPolyData* bird, int id, const std::string& name)
{
  bird->GetCellData()->AddArray(Arrays::Constant(Arrays::ObjectId, bird->GetNumberOfCells(), id));
  Arrays::SetFieldStrings(bird->GetFieldData(), Arrays::ObjectNames, { name });
  Arrays::SetFieldStrings(bird->GetFieldData(), Arrays::ObjectClasses, { "bird" });
}
