// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarRangeImage.h"

#include "ScanGrid.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarImageArrays.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
namespace ImageArrays = vtkAvianLidarImageArrays;

constexpr double DegreesPerRadian = 180.0 / 3.14159265358979323846;

// The beams as an image wants them. `Problem` is set when the input was bad.
struct Beams
{
  avianlidar::ScanGrid Grid;
  std::unordered_map<vtkIdType, vtkIdType> IndexOfId;
  std::string Problem;
};

// Azimuth and elevation of each beam in degrees, from their arrays or from the direction.
bool ReadAngles(vtkPolyData* input, std::vector<double>& azimuths, std::vector<double>& elevations,
  std::string& problem)
{
  const char* port = "input port 1 (beams)";
  vtkPointData* data = input->GetPointData();
  const bool angles =
    data->GetArray(Arrays::Azimuth.name) || data->GetArray(Arrays::VerticalAngle.name);
  vtkDataArray* first = angles ? ImageArrays::Find(input, Arrays::Azimuth, port, problem)
                               : ImageArrays::Find(input, Arrays::Direction, port, problem, 3);
  vtkDataArray* second =
    angles && first ? ImageArrays::Find(input, Arrays::VerticalAngle, port, problem) : first;
  if (!first || !second)
  {
    return false;
  }
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
      azimuth = DegreesPerRadian * std::atan2(x, y);
      elevation = length > 0.0 ? DegreesPerRadian * std::atan2(z, std::hypot(x, y)) : std::nan("");
    }
    if (!std::isfinite(azimuth) || !std::isfinite(elevation))
    {
      problem = std::string("beam ") + std::to_string(i) + " of " + port +
        " has no finite direction (array '" +
        (angles ? "azimuth' or 'vertical_angle" : "direction") + "')";
      return false;
    }
    azimuths.push_back(azimuth);
    elevations.push_back(elevation);
  }
  return true;
}

Beams ReadBeams(vtkPolyData* input)
{
  Beams beams;
  if (input->GetNumberOfPoints() == 0)
  {
    return beams;
  }
  std::vector<double> azimuths, elevations;
  if (!ReadAngles(input, azimuths, elevations, beams.Problem))
  {
    return beams;
  }
  std::vector<int> channels;
  if (vtkDataArray* lasers = input->GetPointData()->GetArray(Arrays::LaserId.name))
  {
    for (vtkIdType i = 0; i < lasers->GetNumberOfTuples(); ++i)
    {
      channels.push_back(static_cast<int>(lasers->GetComponent(i, 0)));
    }
  }
  vtkDataArray* ids = input->GetPointData()->GetArray(Arrays::BeamId.name);
  for (vtkIdType i = 0; i < input->GetNumberOfPoints(); ++i)
  {
    const vtkIdType id = ids ? static_cast<vtkIdType>(ids->GetComponent(i, 0)) : i;
    if (!beams.IndexOfId.emplace(id, i).second)
    {
      beams.Problem = "input port 1 (beams) has two beams with the 'beam_id' " +
        std::to_string(id) + ", expected one sensor with unique ids";
      return beams;
    }
  }
  beams.Grid = avianlidar::makeScanGrid(azimuths, elevations, channels);
  if (beams.Grid.empty())
  {
    beams.Problem = "the beams of input port 1 form no grid of azimuths and elevations, and "
                    "'laser_id' does not give "
                    "every channel as many beams";
  }
  return beams;
}

// The strongest echo of each beam, -1 where there is none.
std::vector<vtkIdType> StrongestEchoes(
  vtkPolyData* echoes, const Beams& beams, std::string& problem)
{
  std::vector<vtkIdType> strongest(beams.IndexOfId.size(), -1);
  if (echoes->GetNumberOfPoints() == 0)
  {
    return strongest;
  }
  const char* port = "input port 0 (echoes)";
  vtkDataArray* ids = ImageArrays::Find(echoes, Arrays::BeamId, port, problem);
  vtkDataArray* received =
    ids ? ImageArrays::Find(echoes, Arrays::EnergyReceived, port, problem) : nullptr;
  vtkDataArray* distance =
    received ? ImageArrays::Find(echoes, Arrays::Distance, port, problem) : nullptr;
  for (vtkIdType i = 0; distance && i < echoes->GetNumberOfPoints(); ++i)
  {
    const auto found = beams.IndexOfId.find(static_cast<vtkIdType>(ids->GetComponent(i, 0)));
    if (found == beams.IndexOfId.end())
    {
      problem = std::string("echo ") + std::to_string(i) + " of " + port + " has the 'beam_id' " +
        std::to_string(static_cast<vtkIdType>(ids->GetComponent(i, 0))) +
        ", which no beam of input port 1 has";
      return strongest;
    }
    vtkIdType& best = strongest[found->second];
    if (best < 0 || received->GetComponent(i, 0) > received->GetComponent(best, 0) ||
      (received->GetComponent(i, 0) == received->GetComponent(best, 0) &&
        distance->GetComponent(i, 0) < distance->GetComponent(best, 0)))
    {
      best = i;
    }
  }
  return strongest;
}

// The beam that each cell shows: of those with an echo the one with the strongest, else the first;
// -1 where there is none.
std::vector<vtkIdType> BeamsOfCells(
  vtkPolyData* echoes, const avianlidar::ScanGrid& grid, const std::vector<vtkIdType>& strongest)
{
  const std::size_t columns = grid.azimuths.size();
  std::vector<vtkIdType> beams(columns * grid.elevations.size(), -1);
  std::vector<double> best(beams.size(), -1.0);
  vtkDataArray* received = echoes->GetPointData()->GetArray(Arrays::EnergyReceived.name);
  for (std::size_t beam = 0; beam < strongest.size(); ++beam)
  {
    const std::size_t cell = grid.row[beam] * columns + grid.column[beam];
    const vtkIdType echo = strongest[beam];
    const double energy = echo >= 0 ? received->GetComponent(echo, 0) : -1.0;
    if (beams[cell] < 0 || energy > best[cell])
    {
      beams[cell] = static_cast<vtkIdType>(beam);
      best[cell] = energy;
    }
  }
  return beams;
}

// Extent, origin and spacing of the image; an axis that is not equally spaced counts from 0.
void SetGeometry(
  const avianlidar::ScanGrid& grid, int extent[6], double origin[3], double spacing[3])
{
  const std::vector<double>* axes[2] = { &grid.azimuths, &grid.elevations };
  for (int axis = 0; axis < 2; ++axis)
  {
    extent[2 * axis] = 0;
    extent[2 * axis + 1] = static_cast<int>(axes[axis]->size()) - 1;
    if (grid.byChannel || !avianlidar::equallySpaced(*axes[axis], origin[axis], spacing[axis]))
    {
      origin[axis] = 0.0;
      spacing[axis] = 1.0;
    }
  }
  extent[4] = 0;
  extent[5] = grid.empty() ? -1 : 0;
  origin[2] = 0.0;
  spacing[2] = 1.0;
}
}

vtkStandardNewMacro(vtkAvianLidarRangeImage);

//------------------------------------------------------------------------------
vtkAvianLidarRangeImage::vtkAvianLidarRangeImage()
{
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
vtkAvianLidarRangeImage::~vtkAvianLidarRangeImage() = default;

//------------------------------------------------------------------------------
int vtkAvianLidarRangeImage::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarRangeImage::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  // The extent follows from the beams: bring them, and nothing else, up to date.
  vtkInformation* beamsInfo = inputVector[1]->GetInformationObject(0);
  beamsInfo->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), 0);
  beamsInfo->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  beamsInfo->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  int port = 0;
  vtkAlgorithm* producer = this->GetInputAlgorithm(1, 0, port);
  if (producer)
  {
    producer->Update(port);
  }
  vtkPolyData* beams = vtkPolyData::GetData(beamsInfo);
  int extent[6];
  double origin[3], spacing[3];
  SetGeometry(beams ? ReadBeams(beams).Grid : avianlidar::ScanGrid(), extent, origin, spacing);
  vtkInformation* info = outputVector->GetInformationObject(0);
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::ORIGIN(), origin, 3);
  info->Set(vtkDataObject::SPACING(), spacing, 3);
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_DOUBLE, 1);
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarRangeImage::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  for (int port = 0; port < this->GetNumberOfInputPorts(); ++port)
  {
    vtkInformation* info = inputVector[port]->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), 0);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), 1);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarRangeImage::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]() -> int
    {
      vtkPolyData* echoes = vtkPolyData::GetData(inputVector[0]);
      const Beams beams = ReadBeams(vtkPolyData::GetData(inputVector[1]));
      std::string problem = beams.Problem;
      std::vector<vtkIdType> strongest;
      if (problem.empty())
      {
        strongest = StrongestEchoes(echoes, beams, problem);
      }
      int extent[6];
      double origin[3], spacing[3];
      SetGeometry(beams.Grid, extent, origin, spacing);
      vtkNew<vtkImageData> image;
      image->SetExtent(extent);
      image->SetOrigin(origin);
      image->SetSpacing(spacing);
      if (problem.empty() && !beams.Grid.empty())
      {
        const auto beamOfCell = BeamsOfCells(echoes, beams.Grid, strongest);
        ImageArrays::AddEchoes(echoes, beamOfCell, strongest, image, problem);
        ImageArrays::AddReport(vtkPolyData::GetData(inputVector[1]), beamOfCell, image, problem);
        ImageArrays::AddAngles(image->GetFieldData(), Arrays::ColumnAzimuths, beams.Grid.azimuths);
        ImageArrays::AddAngles(image->GetFieldData(), Arrays::RowElevations, beams.Grid.elevations);
      }
      if (!problem.empty())
      {
        vtkErrorMacro("Range image: " << problem << ".");
        return 0;
      }
      vtkInformation* info = outputVector->GetInformationObject(0);
      vtkImageData* output = vtkImageData::GetData(info);
      output->ShallowCopy(image);
      if (info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT()) && !beams.Grid.empty())
      {
        output->Crop(info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT()));
      }
      return 1;
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarRangeImage::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
