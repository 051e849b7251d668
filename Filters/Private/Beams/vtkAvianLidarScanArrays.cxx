// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarScanArrays.h"

#include "AvailableMemory.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <cmath>
#include <initializer_list>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;

// Memory of a beam in both outputs, bytes.
constexpr double BytesPerBeam = 200.0;
constexpr double BytesPerReport = 24.0; // memory of a reported direction, bytes

// Returns the nominal directions, which the sensor reports. Changes `directions` to the actual
// directions of the beams.
vtkSmartPointer<vtkDoubleArray> Misdirect(const avianlidar::PointingErrors& errors,
  const avianlidar::ScanGenerator& generator, const std::vector<std::int64_t>& beams,
  int revolution, double start, vtkDoubleArray* directions)
{
  const avianlidar::Pointing pointing(errors, generator.rotor());
  auto reported = Arrays::Make<vtkDoubleArray>(
    Arrays::ReportedDirection, static_cast<vtkIdType>(beams.size()), 3);
  for (vtkIdType i = 0; i < directions->GetNumberOfTuples(); ++i)
  {
    const avianlidar::ScanBeam beam = generator.beam(beams[i]);
    const avianlidar::Vec3 actual =
      pointing.direction(beam.direction, generator.column(beams[i]), revolution, start + beam.time);
    reported->SetTypedTuple(i, &beam.direction.x);
    directions->SetTypedTuple(i, &actual.x);
  }
  return reported;
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanArrays::FillBeams(const avianlidar::ScanPattern& pattern,
  const avianlidar::PointingErrors& errors, const avianlidar::ScanPart& part, int revolution,
  const double position[3], vtkPolyData* output)
{
  const double columns = static_cast<double>(avianlidar::numberOfColumns(pattern));
  const double count = avianlidar::numberOfChannels(pattern) * std::ceil(columns / part.pieces) *
    (part.step + 1.0) / part.steps;
  const double bytes = BytesPerBeam + (errors.none() ? 0.0 : BytesPerReport);
  avianlidar::requireMemory(count, "beams", bytes * count);
  const std::vector<std::int64_t> beams = avianlidar::beamsOf(pattern, part);
  const vtkIdType size = static_cast<vtkIdType>(beams.size());
  auto points = Arrays::MakePoints(size);
  auto ids = Arrays::Make<vtkIdTypeArray>(Arrays::BeamId, size);
  auto directions = Arrays::Make<vtkDoubleArray>(Arrays::Direction, size, 3);
  auto channels = Arrays::Make<vtkIntArray>(Arrays::LaserId, size);
  auto azimuths = Arrays::Make<vtkDoubleArray>(Arrays::Azimuth, size);
  auto elevations = Arrays::Make<vtkDoubleArray>(Arrays::VerticalAngle, size);
  auto timestamps = Arrays::Make<vtkDoubleArray>(Arrays::Timestamp, size);
  const double start = revolution / pattern.rotationRate; // start of the revolution, s
  const avianlidar::ScanGenerator generator(pattern, revolution);
  for (vtkIdType i = 0; i < size; ++i)
  {
    const avianlidar::ScanBeam beam = generator.beam(beams[i]);
    // In hundredths of a degree, 359.99999999999997 deg may be rounded up to a full circle.
    const double azimuth = 100.0 * beam.azimuth;
    points->SetPoint(
      i, position[0] + beam.origin[0], position[1] + beam.origin[1], position[2] + beam.origin[2]);
    ids->SetValue(i, static_cast<vtkIdType>(beams[i]));
    directions->SetTypedTuple(i, &beam.direction.x);
    channels->SetValue(i, beam.channel);
    azimuths->SetValue(i, azimuth < 36000.0 ? azimuth : 0.0);
    elevations->SetValue(i, beam.elevation);
    timestamps->SetValue(i, 1e6 * (start + beam.time));
  }
  output->SetPoints(points);
  output->SetVerts(vtkAvianLidarMakeCells(size, 1));
  for (vtkDataArray* array : std::initializer_list<vtkDataArray*>{
         ids, directions, channels, azimuths, elevations, timestamps })
  {
    output->GetPointData()->AddArray(array);
  }
  if (!errors.none())
  {
    output->GetPointData()->AddArray(
      Misdirect(errors, generator, beams, revolution, start, directions));
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanArrays::FillRays(vtkPolyData* beams, double length, vtkPolyData* output)
{
  const vtkIdType size = beams->GetNumberOfPoints();
  vtkDataArray* directions = beams->GetPointData()->GetArray(Arrays::Direction.name);
  auto points = Arrays::MakePoints(2 * size);
  for (vtkIdType i = 0; i < size; ++i)
  {
    double p[3], d[3];
    beams->GetPoint(i, p);
    directions->GetTuple(i, d);
    points->SetPoint(2 * i, p);
    points->SetPoint(2 * i + 1, p[0] + length * d[0], p[1] + length * d[1], p[2] + length * d[2]);
  }
  output->SetPoints(points);
  output->SetLines(vtkAvianLidarMakeCells(size, 2));
  for (const Arrays::Name& name : { Arrays::BeamId, Arrays::LaserId, Arrays::Timestamp })
  {
    output->GetCellData()->AddArray(beams->GetPointData()->GetArray(name.name));
  }
}
