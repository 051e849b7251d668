// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarEchoOutput.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarModelNotes.h"
#include "vtkAvianLidarVersion.h"

#include "vtkCellArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeUInt64Array.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace
{
namespace names = vtkAvianLidarArrays;
using avianlidar::Echo;
using avianlidar::Vec3;

constexpr double DegreesPerRadian = 180.0 / avianlidar::Pi;

/// Point i at position(i), and a vertex on it.
template <class F>
void SetVertices(vtkPolyData* poly, vtkIdType count, F position)
{
  auto points = names::MakePoints(count);
  double* place = vtkDoubleArray::SafeDownCast(points->GetData())->GetPointer(0);
  for (vtkIdType i = 0; i < count; ++i, place += 3)
  {
    const Vec3 p = position(static_cast<std::size_t>(i));
    place[0] = p.x;
    place[1] = p.y;
    place[2] = p.z;
  }
  poly->SetPoints(points);
  poly->SetVerts(vtkAvianLidarEchoOutput::MakeVertices(count));
}

/// Adds a point array whose value i is function(i).
template <class ArrayT, class F>
void Add(vtkPolyData* poly, const names::Name& name, F function)
{
  const vtkIdType count = poly->GetNumberOfPoints();
  auto array = names::Make<ArrayT>(name, count);
  auto* values = array->GetPointer(0);
  for (vtkIdType i = 0; i < count; ++i)
  {
    values[i] = function(static_cast<std::size_t>(i));
  }
  poly->GetPointData()->AddArray(array);
}

Vec3 PointOnBeam(const avianlidar::ScanBeams& beams, std::size_t beam, double range)
{
  return beams.origins[beam] + range * beams.directions[beam];
}

double IntensityOf(double energy, const avianlidar::Sensor& sensor)
{
  const double width = sensor.upperEnergyLimit - sensor.lowerEnergyLimit;
  return width > 0.0
    ? 255.0 * std::min(1.0, std::max(0.0, (energy - sensor.lowerEnergyLimit) / width))
    : 255.0;
}

void AddBeamArrays(
  const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams, vtkPolyData* echoes)
{
  const auto& beamOf = result.beamOfEcho;
  Add<vtkIdTypeArray>(echoes, names::BeamId,
    [&](std::size_t i) { return static_cast<vtkIdType>(beams.beams.ids[beamOf[i]]); });
  Add<vtkIntArray>(
    echoes, names::LaserId, [&](std::size_t i) { return beams.laserIds[beamOf[i]]; });
  Add<vtkDoubleArray>(
    echoes, names::Azimuth, [&](std::size_t i) { return beams.azimuths[beamOf[i]]; });
  Add<vtkDoubleArray>(
    echoes, names::VerticalAngle, [&](std::size_t i) { return beams.verticalAngles[beamOf[i]]; });
  Add<vtkDoubleArray>(
    echoes, names::Timestamp, [&](std::size_t i) { return beams.timestamps[beamOf[i]]; });
}

void SetText(vtkFieldData* fields, const char* name, const std::string& text)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  array->InsertNextValue(text);
  fields->AddArray(array);
}

void SetChecksum(vtkFieldData* fields, const char* name, std::uint64_t value)
{
  vtkNew<vtkTypeUInt64Array> array;
  array->SetName(name);
  array->InsertNextValue(value);
  fields->AddArray(array);
}

void SetInteger(vtkFieldData* fields, const names::Name& name, int value)
{
  auto array = names::Make<vtkIntArray>(name, 1);
  array->SetValue(0, value);
  fields->AddArray(array);
}

/// What was modelled, and what is left out at most.
void SetNeeds(const avianlidar::ScanSetup& setup, vtkFieldData* fields)
{
  const avianlidar::ModelNeeds& needs = setup.needs;
  SetInteger(fields, { "noise_modelled", "1" }, setup.noise.active);
  names::SetFieldValue(fields, { "noise_bound", "J" }, setup.noise.bound);
  names::SetFieldValue(fields, { "light_energy_constraint_bound", "J" },
    avianlidar::dropsFaintPaths(setup.settings)
      ? avianlidar::LightEnergyTolerance * setup.sensor.lowerEnergyLimit
      : 0.0);
  SetInteger(fields, { "secondary_reflections_modelled", "1" }, needs.secondaryReflections);
  names::SetFieldValue(fields, { "perceivable_range", "m" }, needs.perceivableRange);
  names::SetFieldValue(fields, { "skipped_energy_bound", "J" }, needs.skippedEnergyBound);
  names::SetFieldValue(fields, { "missed_detail_energy", "J" }, needs.missedDetailEnergy);
}

void SetSettings(const avianlidar::EchoSettings& s, vtkFieldData* fields)
{
  SetInteger(fields, { "rays_per_beam", "1" }, s.raysPerBeam);
  SetInteger(fields, { "sampling", "1" }, static_cast<int>(s.sampling));
  names::SetFieldValue(fields, { "target_relative_error", "1" }, s.targetRelativeError);
  SetInteger(fields, { "seed", "" }, s.seed);
  names::SetFieldValue(fields, { "attenuation_coefficient", "1/m" }, s.attenuationCoefficient);
  SetInteger(fields, { "reflectance_model", "1" }, static_cast<int>(s.reflectanceModel));
  SetInteger(fields, { "number_of_reflections", "1" }, s.numberOfReflections);
  SetInteger(fields, { "beam_constraint", "1" }, s.beamConstraint);
  SetInteger(fields, { "light_energy_constraint", "1" }, s.lightEnergyConstraint);
  SetInteger(fields, { "batch_collision_detection", "1" }, s.batchCollisionDetection);
  SetInteger(fields, { "plane_integration", "1" }, s.planeIntegration);
  SetInteger(fields, { "refine_near_limit", "1" }, s.refineNearLimit);
  SetInteger(fields, { "noise", "1" }, s.noise);
  SetInteger(fields, { "small_targets", "1" }, s.smallTargets);
  SetInteger(fields, { "full_model", "1" }, s.fullModel);
  SetInteger(fields, { "return_mode", "1" }, static_cast<int>(s.returnMode));
  SetInteger(fields, { "number_of_connections", "1" }, s.numberOfConnections);
  SetInteger(fields, { "precision", "1" }, static_cast<int>(s.precision));
}
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkCellArray> vtkAvianLidarEchoOutput::MakeVertices(vtkIdType count)
{
  vtkNew<vtkIdTypeArray> offsets;
  names::SetTuples(offsets.Get(), count + 1);
  vtkNew<vtkIdTypeArray> connectivity;
  names::SetTuples(connectivity.Get(), count);
  std::iota(connectivity->GetPointer(0), connectivity->GetPointer(0) + count, vtkIdType{ 0 });
  std::iota(offsets->GetPointer(0), offsets->GetPointer(0) + count + 1, vtkIdType{ 0 });
  auto vertices = vtkSmartPointer<vtkCellArray>::New();
  vertices->SetData(offsets, connectivity);
  return vertices;
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoOutput::FillEchoes(
  const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams, vtkPolyData* echoes)
{
  const std::vector<Echo>& all = result.echoes;
  SetVertices(echoes, static_cast<vtkIdType>(all.size()),
    [&](std::size_t i) { return PointOnBeam(beams.beams, result.beamOfEcho[i], all[i].range); });
  Add<vtkDoubleArray>(echoes, names::Energy, [&](std::size_t i) { return all[i].energy; });
  Add<vtkDoubleArray>(
    echoes, names::EnergyReceived, [&](std::size_t i) { return all[i].energyReceived; });
  Add<vtkDoubleArray>(
    echoes, names::ReturnEnergy, [&](std::size_t i) { return all[i].returnEnergy; });
  Add<vtkDoubleArray>(
    echoes, names::EnergyStdError, [&](std::size_t i) { return all[i].energyStdError; });
  Add<vtkDoubleArray>(echoes, names::Intensity,
    [&](std::size_t i) { return IntensityOf(all[i].energy, beams.sensor); });
  Add<vtkDoubleArray>(echoes, names::Distance, [&](std::size_t i) { return all[i].range; });
  AddBeamArrays(result, beams, echoes);
  Add<vtkIntArray>(echoes, names::ReturnNumber, [&](std::size_t i) { return all[i].returnNumber; });
  Add<vtkIntArray>(
    echoes, names::NumberOfReturns, [&](std::size_t i) { return all[i].numberOfReturns; });
  Add<vtkIntArray>(echoes, names::ObjectId, [&](std::size_t i) { return all[i].objectId; });
  Add<vtkIntArray>(echoes, names::MaterialId, [&](std::size_t i) { return all[i].materialId; });
  Add<vtkDoubleArray>(echoes, names::LabelShare, [&](std::size_t i) { return all[i].labelShare; });
  Add<vtkDoubleArray>(echoes, names::IncidenceAngle,
    [&](std::size_t i) { return all[i].incidenceAngle * DegreesPerRadian; });
  Add<vtkDoubleArray>(
    echoes, names::SecondaryShare, [&](std::size_t i) { return all[i].secondaryShare; });
  echoes->GetPointData()->SetActiveScalars(names::Energy.name);
}

//------------------------------------------------------------------------------
int vtkAvianLidarEchoOutput::CrowdedBeams(const avianlidar::ScanResult& result)
{
  return static_cast<int>(std::count_if(result.reports.begin(), result.reports.end(),
    [](const avianlidar::BeamReport& report) { return report.targetsLeftOut > 0; }));
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoOutput::FillFields(const avianlidar::ScanSetup& setup, int preset,
  int crowdedBeams, vtkFieldData* beamFields, const vtkAvianLidarSurfaces& surfaces,
  vtkFieldData* surfaceFields, std::uint64_t sceneChecksum, vtkFieldData* fields)
{
  fields->PassData(beamFields);
  SetInteger(fields, { "preset", "1" }, preset);
  SetSettings(setup.settings, fields);
  SetText(fields, "avian_lidar_version", vtkAvianLidarVersion());
  SetChecksum(fields, "scene_checksum", sceneChecksum);
  SetNeeds(setup, fields);
  SetInteger(fields, { "crowded_beams", "1" }, crowdedBeams);
  for (const vtkAvianLidarModelNote& note : vtkAvianLidarModelNotes(setup, crowdedBeams))
  {
    SetText(fields, note.name, note.text);
  }
  names::SetFieldStrings(fields, names::ObjectNames, surfaces.objectNames);
  names::SetFieldStrings(fields, names::MaterialNames, surfaces.materialNames);
  for (const names::Name& name : { names::GeodeticOrigin, names::ObjectClasses })
  {
    if (vtkAbstractArray* array =
          surfaceFields ? surfaceFields->GetAbstractArray(name.name) : nullptr)
    {
      fields->AddArray(array);
    }
  }
}
