// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarScanCache.h"

#include "AvailableMemory.h"
#include "vtkAvianLidarArrays.h"

#include <cmath>
#include <numeric>

namespace
{
namespace Arrays = vtkAvianLidarArrays;

using Key = vtkAvianLidarScanCache::Key;
using Scan = vtkAvianLidarScanCache::Scan;

Key KeyOf(const avianlidar::ScanPattern& p, const avianlidar::ScanPart& part)
{
  Key key{ p.yaw, p.pitch, p.roll, static_cast<double>(p.channels), p.minimumElevation,
    p.elevationStep, p.azimuthStart, p.azimuthEnd, p.azimuthStep, p.rotationRate, p.firingInterval,
    static_cast<double>(part.piece), static_cast<double>(part.pieces) };
  // All beams are the same beams, in however many steps they came.
  const bool whole = part.step + 1 == part.steps;
  key.push_back(whole ? 0.0 : static_cast<double>(part.step));
  key.push_back(whole ? 1.0 : static_cast<double>(part.steps));
  key.insert(key.end(), p.elevations.begin(), p.elevations.end());
  return key;
}

// Both outputs, and what is kept for the next execution.
constexpr double BytesPerBeam = 200.0;

Scan MakeScan(const avianlidar::ScanPattern& pattern, const avianlidar::ScanPart& part)
{
  const double columns = static_cast<double>(avianlidar::numberOfColumns(pattern));
  const double count = avianlidar::numberOfChannels(pattern) * std::ceil(columns / part.pieces) *
    (part.step + 1.0) / part.steps;
  avianlidar::requireMemory(count, "beams", BytesPerBeam * count);
  const std::vector<std::int64_t> beams = avianlidar::beamsOf(pattern, part);
  const vtkIdType size = static_cast<vtkIdType>(beams.size());
  Scan scan;
  scan.MadeFrom = KeyOf(pattern, part);
  scan.BeamIds = Arrays::Make<vtkIdTypeArray>(Arrays::BeamId, size);
  scan.Directions = Arrays::Make<vtkDoubleArray>(Arrays::Direction, size, 3);
  scan.LaserIds = Arrays::Make<vtkIntArray>(Arrays::LaserId, size);
  scan.Azimuths = Arrays::Make<vtkDoubleArray>(Arrays::Azimuth, size);
  scan.VerticalAngles = Arrays::Make<vtkDoubleArray>(Arrays::VerticalAngle, size);
  scan.Times.resize(beams.size());

  const avianlidar::ScanGenerator generator(pattern);
  for (vtkIdType i = 0; i < size; ++i)
  {
    const avianlidar::ScanBeam beam = generator.beam(beams[i]);
    // 359.99999999999997 deg may round up to a full circle in hundredths.
    const double azimuth = 100.0 * beam.azimuth;
    scan.BeamIds->SetValue(i, static_cast<vtkIdType>(beams[i]));
    scan.Directions->SetTypedTuple(i, beam.direction.data());
    scan.LaserIds->SetValue(i, beam.channel);
    scan.Azimuths->SetValue(i, azimuth < 36000.0 ? azimuth : 0.0);
    scan.VerticalAngles->SetValue(i, beam.elevation);
    scan.Times[i] = beam.time;
  }
  return scan;
}

/// @param times s since the start of the revolution, `start`, s
vtkSmartPointer<vtkDoubleArray> MakeTimestamps(const std::vector<double>& times, double start)
{
  auto timestamps =
    Arrays::Make<vtkDoubleArray>(Arrays::Timestamp, static_cast<vtkIdType>(times.size()));
  for (std::size_t i = 0; i < times.size(); ++i)
  {
    timestamps->SetValue(static_cast<vtkIdType>(i), 1e6 * (start + times[i]));
  }
  return timestamps;
}

// `cells` cells of `corners` points each, all different.
vtkSmartPointer<vtkCellArray> MakeCells(vtkIdType cells, vtkIdType corners)
{
  vtkNew<vtkIdTypeArray> offsets;
  Arrays::SetTuples(offsets.Get(), cells + 1);
  for (vtkIdType cell = 0; cell <= cells; ++cell)
  {
    offsets->SetValue(cell, cell * corners);
  }
  vtkNew<vtkIdTypeArray> connectivity;
  Arrays::SetTuples(connectivity.Get(), cells * corners);
  vtkIdType* points = connectivity->GetPointer(0);
  std::iota(points, points + cells * corners, vtkIdType{ 0 });
  auto array = vtkSmartPointer<vtkCellArray>::New();
  array->SetData(offsets, connectivity);
  return array;
}
}

//------------------------------------------------------------------------------
const vtkAvianLidarScanCache::Scan& vtkAvianLidarScanCache::GetScan(
  const avianlidar::ScanPattern& pattern, const avianlidar::ScanPart& part, int revolution)
{
  Scan& scan = this->Kept;
  if (scan.MadeFrom != KeyOf(pattern, part))
  {
    scan = MakeScan(pattern, part);
  }
  if (!scan.Timestamps || scan.Revolution != revolution)
  {
    scan.Timestamps = MakeTimestamps(scan.Times, revolution / pattern.rotationRate);
    scan.Revolution = revolution;
  }
  return scan;
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanCache::GetVertices(
  vtkIdType size, const double position[3], vtkPolyData* output)
{
  const Key key{ static_cast<double>(size), position[0], position[1], position[2] };
  if (this->VerticesMadeFrom != key)
  {
    this->VerticesMadeFrom.clear(); // what follows may fail halfway
    this->VertexPoints = Arrays::MakePoints(size);
    for (vtkIdType i = 0; i < size; ++i)
    {
      this->VertexPoints->SetPoint(i, position);
    }
    if (!this->Vertices || this->Vertices->GetNumberOfCells() != size)
    {
      this->Vertices = MakeCells(size, 1);
    }
    this->VerticesMadeFrom = key;
  }
  output->SetPoints(this->VertexPoints);
  output->SetVerts(this->Vertices);
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanCache::GetRays(
  const Scan& scan, const double position[3], double length, vtkPolyData* output)
{
  Key key{ position[0], position[1], position[2], length };
  key.insert(key.end(), scan.MadeFrom.begin(), scan.MadeFrom.end());
  if (this->RaysMadeFrom != key)
  {
    this->RaysMadeFrom.clear();
    const vtkIdType size = scan.Size();
    this->RayPoints = Arrays::MakePoints(2 * size);
    for (vtkIdType i = 0; i < size; ++i)
    {
      double d[3];
      scan.Directions->GetTypedTuple(i, d);
      this->RayPoints->SetPoint(2 * i, position);
      this->RayPoints->SetPoint(2 * i + 1, position[0] + length * d[0], position[1] + length * d[1],
        position[2] + length * d[2]);
    }
    if (!this->Rays || this->Rays->GetNumberOfCells() != size)
    {
      this->Rays = MakeCells(size, 2);
    }
    this->RaysMadeFrom = key;
  }
  output->SetPoints(this->RayPoints);
  output->SetLines(this->Rays);
}
