// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBirdSource.h"

#include "Bird.h"
#include "ScanBeams.h"
#include "ScanPattern.h"
#include "ValueError.h"
#include "vtkAvianLidarBirds.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"

#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <array>

namespace
{
using avianlidar::Vec3;

void RequireFinite(const char* name, double value)
{
  using avianlidar::LargestFinite;
  vtkAvianLidarRequire(
    avianlidar::rangeError(name, value, -LargestFinite, LargestFinite, "a finite number"));
}

/// Rotation from the frame of the bird to the frame of the scene: bank to the right, then heading.
class Turn
{
public:
  Turn(double heading, double bank)
    : Heading(avianlidar::sinCosDegrees(heading))
    , Bank(avianlidar::sinCosDegrees(bank))
  {
  }
  Vec3 operator()(const Vec3& p) const
  {
    const auto [sine, cosine] = this->Bank;
    const Vec3 level(cosine * p.x + sine * p.z, p.y, cosine * p.z - sine * p.x);
    const auto [east, north] = this->Heading;
    return { north * level.x + east * level.y, north * level.y - east * level.x, level.z };
  }

private:
  std::array<double, 2> Heading, Bank; ///< sine and cosine of the angle
};
}

vtkStandardNewMacro(vtkAvianLidarBirdSource);

//------------------------------------------------------------------------------
vtkAvianLidarBirdSource::vtkAvianLidarBirdSource()
{
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
int vtkAvianLidarBirdSource::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      const auto known = vtkAvianLidarBirds::KnownSpecies(this->SpeciesFileName);
      const avianlidar::BirdShape shape(
        known[vtkAvianLidarBirds::FindSpecies(known, this->Species)]);
      RequireFinite("WingPhase", this->WingPhase);
      RequireFinite("Heading", this->Heading);
      RequireFinite("Bank", this->Bank);
      const Vec3 position(this->Position[0], this->Position[1], this->Position[2]);
      const std::string misplaced = avianlidar::checkPosition(position);
      vtkAvianLidarRequire(misplaced.empty() ? "" : "Bird source: P" + misplaced.substr(1));
      vtkAvianLidarBirds::CheckReflectance(this->Reflectance);
      vtkAvianLidarRequire(
        avianlidar::rangeError("ObjectId", this->ObjectId, -1, VTK_INT_MAX, "at least -1"));
      auto surface = vtkAvianLidarBirds::Surface(
        shape, avianlidar::wingAngle(this->WingPhase, this->Gliding), this->Reflectance);
      const Turn turn(this->Heading, this->Bank);
      vtkPoints* points = surface->GetPoints();
      for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
      {
        double own[3];
        points->GetPoint(i, own);
        const Vec3 p = position + turn({ own[0], own[1], own[2] });
        points->SetPoint(i, p.x, p.y, p.z);
      }
      vtkAvianLidarBirds::SetObject(surface, this->ObjectId, this->Species);
      vtkPolyData::GetData(outputVector)->ShallowCopy(surface);
    });
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBirdSource::GetKnownSpecies()
{
  return vtkAvianLidarBirds::NamesOfSpecies(this->SpeciesFileName);
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarBirdSource, Species, SpeciesFileName, WingPhase, Gliding,
  Position, Heading, Bank, Reflectance, ObjectId, ErrorsAsData);
