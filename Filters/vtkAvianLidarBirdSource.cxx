// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBirdSource.h"

#include "Bird.h"
#include "ScanBeams.h"
#include "ScanPattern.h"
#include "ValueError.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBuiltInTexts.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarMaterials.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using avianlidar::Vec3;

std::string TextOf(const std::string& file)
{
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream)
  {
    throw std::runtime_error("SpeciesFileName " + file + " cannot be read");
  }
  return text.str();
}

/// The species of a name: of the user's file, else of the table that is built in.
avianlidar::BirdSpecies FindSpecies(const std::string& name, const std::string& file)
{
  std::vector<avianlidar::BirdSpecies> all;
  if (!file.empty())
  {
    all = avianlidar::readSpecies(TextOf(file), file);
  }
  const auto builtIn =
    avianlidar::readSpecies(vtkAvianLidarBuiltInText("species.csv"), "species.csv");
  all.insert(all.end(), builtIn.begin(), builtIn.end());
  std::string known;
  for (const avianlidar::BirdSpecies& species : all)
  {
    if (species.name == name)
    {
      return species;
    }
    known += (known.empty() ? "" : ", ") + species.name;
  }
  throw std::runtime_error("Species is '" + name + "', expected one of " + known);
}

void RequireFinite(const char* name, double value)
{
  if (!std::isfinite(value))
  {
    throw std::runtime_error(avianlidar::valueError(name, value, "a finite number"));
  }
}

/// Turns from the bird's frame into the scene's: bank to the right, then heading.
class Turn
{
public:
  Turn(double heading, double bank)
  {
    avianlidar::sinCosDegrees(heading, this->SinHeading, this->CosHeading);
    avianlidar::sinCosDegrees(bank, this->SinBank, this->CosBank);
  }
  Vec3 operator()(const Vec3& p) const
  {
    const double x = this->CosBank * p.x + this->SinBank * p.z;
    const double z = this->CosBank * p.z - this->SinBank * p.x;
    return { this->CosHeading * x + this->SinHeading * p.y,
      this->CosHeading * p.y - this->SinHeading * x, z };
  }

private:
  double SinHeading, CosHeading, SinBank, CosBank;
};

vtkSmartPointer<vtkIntArray> Constant(const Arrays::Name& name, vtkIdType count, int value)
{
  auto array = Arrays::Make<vtkIntArray>(name, count);
  array->FillValue(value);
  return array;
}
}

vtkStandardNewMacro(vtkAvianLidarBirdSource);

//------------------------------------------------------------------------------
vtkAvianLidarBirdSource::vtkAvianLidarBirdSource()
{
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkAvianLidarBirdSource::~vtkAvianLidarBirdSource() = default;

//------------------------------------------------------------------------------
int vtkAvianLidarBirdSource::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]() -> std::string
    {
      const avianlidar::BirdShape shape(FindSpecies(this->Species, this->SpeciesFileName));
      RequireFinite("WingPhase", this->WingPhase);
      RequireFinite("Heading", this->Heading);
      RequireFinite("Bank", this->Bank);
      const Vec3 position(this->Position[0], this->Position[1], this->Position[2]);
      const std::string misplaced = avianlidar::checkPosition(position);
      if (!misplaced.empty())
      {
        return "Bird source: P" + misplaced.substr(1);
      }
      if (!(this->Reflectance >= 0.0) || !(this->Reflectance <= 1.0))
      {
        return avianlidar::valueError("Reflectance", this->Reflectance, "0 to 1");
      }
      if (this->ObjectId < -1)
      {
        return avianlidar::valueError("ObjectId", this->ObjectId, "at least -1");
      }
      const avianlidar::Material plumage{ this->Reflectance, 0.0, 1.0 };
      const double angle = avianlidar::wingAngle(this->WingPhase, this->Gliding);
      const Turn turn(this->Heading, this->Bank);
      auto points = Arrays::MakePoints(0);
      vtkNew<vtkCellArray> cells;
      auto parts = Arrays::Make<vtkIntArray>(Arrays::Part, 0);
      for (const auto part : { avianlidar::BirdPart::Body, avianlidar::BirdPart::LeftWing,
             avianlidar::BirdPart::RightWing })
      {
        const avianlidar::TriangleMesh mesh = avianlidar::birdPart(shape, part, angle);
        const vtkIdType first = points->GetNumberOfPoints();
        for (const Vec3& own : mesh.points)
        {
          const Vec3 p = position + turn(own);
          points->InsertNextPoint(p.x, p.y, p.z);
        }
        for (const auto& t : mesh.triangles)
        {
          cells->InsertNextCell({ first + t[0], first + t[1], first + t[2] });
          parts->InsertNextValue(static_cast<int>(part));
        }
      }
      auto* output = vtkPolyData::GetData(outputVector);
      output->SetPoints(points);
      output->SetPolys(cells);
      const vtkIdType count = cells->GetNumberOfCells();
      output->GetCellData()->AddArray(parts);
      output->GetCellData()->AddArray(Constant(Arrays::ObjectId, count, this->ObjectId));
      output->GetCellData()->AddArray(Constant(Arrays::MaterialId, count, 4));
      vtkAvianLidarMaterials::AddCoefficients(output->GetCellData(), count,
        [&](vtkIdType) -> const avianlidar::Material& { return plumage; });
      vtkFieldData* fields = output->GetFieldData();
      Arrays::SetFieldStrings(
        fields, Arrays::MaterialNames, { "Wall", "Glass", "Metal", "Wood", "Plumage" });
      Arrays::SetFieldStrings(fields, Arrays::ObjectNames, { this->Species });
      Arrays::SetFieldStrings(fields, Arrays::ObjectClasses, { "bird" });
      return {};
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarBirdSource::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Species: " << this->Species << "\n";
  os << indent << "SpeciesFileName: " << this->SpeciesFileName << "\n";
  os << indent << "WingPhase: " << this->WingPhase << "\n";
  os << indent << "Gliding: " << this->Gliding << "\n";
  os << indent << "Position: " << this->Position[0] << " " << this->Position[1] << " "
     << this->Position[2] << "\n";
  os << indent << "Heading: " << this->Heading << "\n";
  os << indent << "Bank: " << this->Bank << "\n";
  os << indent << "Reflectance: " << this->Reflectance << "\n";
  os << indent << "ObjectId: " << this->ObjectId << "\n";
  os << indent << "ErrorsAsData: " << this->ErrorsAsData << "\n";
}
