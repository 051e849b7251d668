// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarImageBeams.h"

#include "Vector.h"
#include "vtkAvianLidarImageArrays.h"
#include "vtkAvianLidarNames.h"

#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
namespace ImageArrays = vtkAvianLidarImageArrays;

const char* const Port = "input port 1 (beams)";

// Azimuth and elevation of each beam, deg, from the arrays of angles, or else from the reported
// direction.
void ReadAngles(vtkPolyData* input, std::vector<double>& azimuths, std::vector<double>& elevations)
{
  vtkPointData* data = input->GetPointData();
  const bool angles =
    data->HasArray(Arrays::Azimuth.name) || data->HasArray(Arrays::VerticalAngle.name);
  const Arrays::Name& direction =
    data->HasArray(Arrays::ReportedDirection.name) ? Arrays::ReportedDirection : Arrays::Direction;
  vtkDataArray* first = angles ? ImageArrays::Find(input, Arrays::Azimuth, Port)
                               : ImageArrays::Find(input, direction, Port, 3);
  vtkDataArray* second = angles ? ImageArrays::Find(input, Arrays::VerticalAngle, Port) : first;
  for (vtkIdType i = 0; i < input->GetNumberOfPoints(); ++i)
  {
    double azimuth = first->GetComponent(i, 0);
    double elevation = second->GetComponent(i, 0);
    if (angles)
    {
      azimuth /= 100.0;
    }
    else
    {
      const double x = first->GetComponent(i, 0), y = first->GetComponent(i, 1),
                   z = first->GetComponent(i, 2);
      const double length = std::hypot(x, y, z);
      azimuth = avianlidar::DegreesPerRadian * std::atan2(x, y);
      elevation = length > 0.0 ? avianlidar::DegreesPerRadian * std::atan2(z, std::hypot(x, y))
                               : std::nan("");
    }
    if (!std::isfinite(azimuth) || !std::isfinite(elevation))
    {
      vtkAvianLidarRequire(std::string("beam ") + std::to_string(i) + " of " + Port +
        " has no finite direction (array '" +
        (angles ? "azimuth' or 'vertical_angle" : direction.name) + "')");
    }
    azimuths.push_back(azimuth);
    elevations.push_back(elevation);
  }
}

// The integers of an optional array. Without the array, the index of each beam if `numbered`, else
// an empty vector.
template <class T>
std::vector<T> ReadIntegers(vtkPolyData* input, const Arrays::Name& name, bool numbered)
{
  std::vector<T> values;
  vtkDataArray* array =
    input->GetPointData()->HasArray(name.name) ? ImageArrays::Find(input, name, Port) : nullptr;
  for (vtkIdType i = 0; (array || numbered) && i < input->GetNumberOfPoints(); ++i)
  {
    const double value = array ? array->GetComponent(i, 0) : static_cast<double>(i);
    values.push_back(ImageArrays::RequireInteger<T>(value, name, Port, i));
  }
  return values;
}

// True if every beam has the direction of the sensor's beam with the same id. A filter downstream
// of the sensor may have turned or replaced beams.
bool IsPartOf(const vtkAvianLidarScanShape::WholeScan& whole, const std::vector<vtkIdType>& ids,
  const std::vector<double>& azimuths, const std::vector<double>& elevations)
{
  const auto beams = static_cast<vtkIdType>(whole.Azimuths.size());
  for (std::size_t i = 0; i < ids.size(); ++i)
  {
    if (ids[i] < 0 || ids[i] >= beams)
    {
      return false;
    }
    const auto id = static_cast<std::size_t>(ids[i]);
    // The azimuth of a vertical beam is arbitrary, so differences of azimuths are scaled by the
    // cosine of the elevation.
    const double aside = std::remainder(azimuths[i] - whole.Azimuths[id], 360.0) *
      std::cos(elevations[i] / avianlidar::DegreesPerRadian);
    if (!(std::abs(aside) <= avianlidar::GridTolerance &&
          std::abs(elevations[i] - whole.Elevations[id]) <= avianlidar::GridTolerance))
    {
      return false;
    }
  }
  return !whole.Grid.empty();
}
}

//------------------------------------------------------------------------------
vtkAvianLidarImageBeams::Beams vtkAvianLidarImageBeams::Read(
  vtkPolyData* input, const vtkAvianLidarScanShape::WholeScan& whole)
{
  Beams beams;
  std::vector<double> azimuths, elevations;
  if (input->GetNumberOfPoints() > 0)
  {
    ReadAngles(input, azimuths, elevations);
  }
  const auto ids = ReadIntegers<vtkIdType>(input, Arrays::BeamId, true);
  const auto channels = ReadIntegers<int>(input, Arrays::LaserId, false);
  for (std::size_t i = 0; i < ids.size(); ++i)
  {
    if (!beams.IndexOfId.emplace(ids[i], static_cast<vtkIdType>(i)).second)
    {
      vtkAvianLidarRequire("input port 1 (beams) has two beams with the 'beam_id' " +
        std::to_string(ids[i]) + ", expected one sensor with unique ids");
    }
  }
  if (!IsPartOf(whole, ids, azimuths, elevations))
  {
    if (ids.empty())
    {
      return beams;
    }
    beams.Grid = avianlidar::makeScanGrid(azimuths, elevations, channels);
    vtkAvianLidarRequire(beams.Grid.empty()
        ? "the beams of input port 1 form no grid of azimuths and elevations, and 'laser_id' does "
          "not give every channel as many beams"
        : "");
    return beams;
  }
  beams.Grid = whole.Grid;
  beams.Grid.column.clear();
  beams.Grid.row.clear();
  for (const vtkIdType id : ids)
  {
    beams.Grid.column.push_back(whole.Grid.column[static_cast<std::size_t>(id)]);
    beams.Grid.row.push_back(whole.Grid.row[static_cast<std::size_t>(id)]);
  }
  return beams;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarImageBeams::InOrder(vtkPolyData* input)
{
  vtkDataArray* ids = input->GetPointData()->GetArray(Arrays::BeamId.name);
  if (!ids)
  {
    return input;
  }
  std::vector<vtkIdType> order(static_cast<std::size_t>(input->GetNumberOfPoints()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
    [ids](vtkIdType a, vtkIdType b) { return ids->GetComponent(a, 0) < ids->GetComponent(b, 0); });
  auto sorted = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  sorted->GetPointData()->CopyAllOn();
  sorted->GetPointData()->CopyAllocate(input->GetPointData(), input->GetNumberOfPoints());
  for (const vtkIdType from : order)
  {
    const vtkIdType to = points->InsertNextPoint(input->GetPoint(from));
    sorted->GetPointData()->CopyData(input->GetPointData(), from, to);
  }
  sorted->SetPoints(points);
  return sorted;
}
