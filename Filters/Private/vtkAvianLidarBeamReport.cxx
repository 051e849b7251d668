// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBeamReport.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarEchoOutput.h"
#include "vtkAvianLidarOwn.h"

#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace
{
namespace names = vtkAvianLidarArrays;
using avianlidar::BeamReport;
using avianlidar::Vec3;

Vec3 PlaceOf(const vtkAvianLidarBeams& beams, std::size_t beam, const BeamReport& report)
{
  const double range = std::isnan(report.range) ? beams.displayLength : report.range;
  return beams.beams.origins[beam] + range * beams.beams.directions[beam];
}

template <class ArrayT, class F>
void Write(vtkSmartPointer<ArrayT>& array, const names::Name& name,
  const avianlidar::ScanResult& result, F valueOf)
{
  array = names::Make<ArrayT>(name, static_cast<vtkIdType>(result.reports.size()));
  auto* values = array->GetPointer(0);
  for (std::size_t i = 0; i < result.reports.size(); ++i)
  {
    values[i] = valueOf(i);
  }
}

/// Have the given values in an array, a new one if they are not there already.
template <class ArrayT, class T>
void Keep(vtkSmartPointer<ArrayT>& array, const names::Name& name, const std::vector<T>& given)
{
  const auto size = static_cast<vtkIdType>(given.size());
  if (!array || array->GetNumberOfTuples() != size ||
    !std::equal(given.begin(), given.end(), array->GetPointer(0)))
  {
    array = names::Make<ArrayT>(name, size);
    std::copy(given.begin(), given.end(), array->GetPointer(0));
  }
}

/// Write value(beam) to the places of the beams that changed, unless all are there already.
template <class ArrayT, class F>
void Rewrite(vtkSmartPointer<ArrayT>& array, const avianlidar::ScanResult& result, F valueOf)
{
  bool own = false;
  auto* values = array->GetPointer(0);
  for (const std::uint32_t beam : result.changed)
  {
    const auto value = valueOf(beam);
    if (values[beam] == value)
    {
      continue;
    }
    if (!own)
    {
      vtkAvianLidarOwn(array);
      values = array->GetPointer(0);
      own = true;
    }
    values[beam] = value;
  }
  if (own)
  {
    array->Modified();
  }
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamReport::Fill(const avianlidar::ScanResult& result,
  const vtkAvianLidarBeams& beams, const avianlidar::NoisePlan& noise, vtkPolyData* report)
{
  const double noiseSkipped = noise.active ? 0.0 : noise.bound;
  const bool same = this->Checksum == beams.beams.checksum &&
    this->DisplayLength == beams.displayLength && this->NoiseSkipped == noiseSkipped;
  this->NoiseSkipped = noiseSkipped;
  if (this->Run != 0 && this->Run == result.before && same)
  {
    this->Change(result, beams);
  }
  else
  {
    this->Make(result, beams);
  }
  this->MakeAngles(beams);
  this->Run = result.run;
  this->Checksum = beams.beams.checksum;
  this->DisplayLength = beams.displayLength;
  vtkNew<vtkPoints> points;
  points->SetData(this->Coordinates);
  report->SetPoints(points);
  report->SetVerts(this->Vertices);
  vtkPointData* data = report->GetPointData();
  data->AddArray(this->BeamIds);
  data->AddArray(this->LaserIds);
  data->AddArray(this->Azimuths);
  data->AddArray(this->VerticalAngles);
  data->AddArray(this->Status);
  data->AddArray(this->Candidates);
  data->AddArray(this->NodesVisited);
  data->AddArray(this->RaysTraced);
  data->AddArray(this->Skipped);
  data->AddArray(this->SkippedBound);
  data->AddArray(this->LeftOut);
  data->SetActiveScalars(names::Status.name);
}

//------------------------------------------------------------------------------
std::size_t vtkAvianLidarBeamReport::Bytes() const
{
  std::size_t kibibytes = this->Vertices ? this->Vertices->GetActualMemorySize() : 0;
  const std::initializer_list<vtkDataArray*> arrays = { this->Coordinates, this->BeamIds,
    this->LaserIds, this->Azimuths, this->VerticalAngles, this->Status, this->Candidates,
    this->NodesVisited, this->RaysTraced, this->Skipped, this->SkippedBound, this->LeftOut };
  for (vtkDataArray* array : arrays)
  {
    kibibytes += array ? array->GetActualMemorySize() : 0;
  }
  return kibibytes << 10;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamReport::MakeAngles(const vtkAvianLidarBeams& beams)
{
  // Not covered by the checksum of the beams: they are labels.
  Keep(this->LaserIds, names::LaserId, beams.laserIds);
  Keep(this->Azimuths, names::Azimuth, beams.azimuths);
  Keep(this->VerticalAngles, names::VerticalAngle, beams.verticalAngles);
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamReport::Make(
  const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams)
{
  const auto& all = result.reports;
  const vtkIdType count = static_cast<vtkIdType>(all.size());
  this->Coordinates = vtkSmartPointer<vtkDoubleArray>::New();
  this->Coordinates->SetNumberOfComponents(3);
  names::SetTuples(this->Coordinates.Get(), count);
  double* place = this->Coordinates->GetPointer(0);
  for (std::size_t i = 0; i < all.size(); ++i, place += 3)
  {
    const Vec3 p = PlaceOf(beams, i, all[i]);
    place[0] = p.x;
    place[1] = p.y;
    place[2] = p.z;
  }
  this->Vertices = vtkAvianLidarEchoOutput::MakeVertices(count);
  Write(this->BeamIds, names::BeamId, result,
    [&](std::size_t i) { return static_cast<vtkIdType>(beams.beams.ids[i]); });
  Write(this->Status, names::Status, result,
    [&](std::size_t i) { return static_cast<int>(all[i].status); });
  Write(this->Candidates, names::Candidates, result,
    [&](std::size_t i) { return static_cast<vtkIdType>(all[i].counters.candidates); });
  Write(this->NodesVisited, names::NodesVisited, result,
    [&](std::size_t i) { return static_cast<vtkIdType>(all[i].counters.nodesVisited); });
  Write(this->RaysTraced, names::RaysTraced, result,
    [&](std::size_t i) { return static_cast<vtkIdType>(all[i].counters.raysTraced); });
  Write(
    this->Skipped, names::Skipped, result, [&](std::size_t i) { return this->SkippedOf(all[i]); });
  Write(this->SkippedBound, names::SkippedBound, result,
    [&](std::size_t i) { return all[i].lost + this->NoiseSkipped; });
  Write(this->LeftOut, names::SmallTargetsLeftOut, result,
    [&](std::size_t i) { return static_cast<int>(all[i].targetsLeftOut); });
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamReport::SkippedOf(const avianlidar::BeamReport& report) const
{
  const unsigned noise = this->NoiseSkipped > 0.0 ? avianlidar::SkippedNoise : 0u;
  return static_cast<int>(report.skipped | noise);
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamReport::Change(
  const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams)
{
  const auto& all = result.reports;
  bool own = false;
  double* places = this->Coordinates->GetPointer(0);
  for (const std::uint32_t beam : result.changed)
  {
    const Vec3 p = PlaceOf(beams, beam, all[beam]);
    const double* old = places + 3 * static_cast<std::size_t>(beam);
    if (old[0] == p.x && old[1] == p.y && old[2] == p.z)
    {
      continue;
    }
    if (!own)
    {
      vtkAvianLidarOwn(this->Coordinates);
      places = this->Coordinates->GetPointer(0);
      own = true;
    }
    double* place = places + 3 * static_cast<std::size_t>(beam);
    place[0] = p.x;
    place[1] = p.y;
    place[2] = p.z;
  }
  if (own)
  {
    this->Coordinates->Modified();
  }
  Rewrite(this->Status, result, [&](std::size_t i) { return static_cast<int>(all[i].status); });
  Rewrite(this->Candidates, result,
    [&](std::size_t i) { return static_cast<vtkIdType>(all[i].counters.candidates); });
  Rewrite(this->NodesVisited, result,
    [&](std::size_t i) { return static_cast<vtkIdType>(all[i].counters.nodesVisited); });
  Rewrite(this->RaysTraced, result,
    [&](std::size_t i) { return static_cast<vtkIdType>(all[i].counters.raysTraced); });
  Rewrite(this->Skipped, result, [&](std::size_t i) { return this->SkippedOf(all[i]); });
  Rewrite(
    this->SkippedBound, result, [&](std::size_t i) { return all[i].lost + this->NoiseSkipped; });
  Rewrite(
    this->LeftOut, result, [&](std::size_t i) { return static_cast<int>(all[i].targetsLeftOut); });
}
