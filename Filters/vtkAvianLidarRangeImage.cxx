// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarRangeImage.h"

#include "AvailableMemory.h"
#include "ScanGrid.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarGather.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarImageArrays.h"
#include "vtkAvianLidarImageBeams.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStructuredData.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
namespace ImageArrays = vtkAvianLidarImageArrays;
namespace ImageBeams = vtkAvianLidarImageBeams;

using Pipeline = vtkStreamingDemandDrivenPipeline;

/// Memory of a cell of the image, bytes: beam, echo and arrays.
constexpr double BytesPerCell = 40.0;

// Index of the strongest echo of each beam, -1 without an echo.
std::vector<vtkIdType> StrongestEchoes(vtkPolyData* echoes, const ImageBeams::Beams& beams)
{
  std::vector<vtkIdType> strongest(beams.IndexOfId.size(), -1);
  if (echoes->GetNumberOfPoints() == 0)
  {
    return strongest;
  }
  const std::string port = "input port 0 (echoes)";
  const auto find = [&](const Arrays::Name& name)
  { return ImageArrays::Find(echoes, name, port.c_str()); };
  vtkDataArray* ids = find(Arrays::BeamId);
  vtkDataArray* received = find(Arrays::EnergyReceived);
  vtkDataArray* distance = find(Arrays::Distance);
  vtkDataArray* energy = find(Arrays::Energy);
  for (vtkIdType i = 0; i < echoes->GetNumberOfPoints(); ++i)
  {
    for (vtkDataArray* array : { received, distance, energy })
    {
      if (!std::isfinite(array->GetComponent(i, 0)))
      {
        vtkAvianLidarRequire(std::string("point array '") + array->GetName() + "' of " + port +
          " is not finite, at point " + std::to_string(i));
      }
    }
    const auto id = ImageArrays::RequireInteger<vtkIdType>(
      ids->GetComponent(i, 0), Arrays::BeamId, port.c_str(), i);
    const auto found = beams.IndexOfId.find(id);
    if (found == beams.IndexOfId.end())
    {
      vtkAvianLidarRequire("echo " + std::to_string(i) + " of " + port + " has the 'beam_id' " +
        std::to_string(id) + ", which no beam of input port 1 has");
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

// Index of the beam that each cell shows: the beam with the strongest echo, else the first beam.
// The index is -1 without a beam.
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

// Indices for an image of given size without beams: -1 in every cell.
std::vector<vtkIdType> NoBeams(vtkIdType cells)
{
  const double count = static_cast<double>(cells);
  avianlidar::requireMemory(count, "cells of the image", BytesPerCell * count);
  return std::vector<vtkIdType>(static_cast<std::size_t>(cells), -1);
}

// Sets extent, origin and spacing of the image. An axis with unequal spacing counts from 0.
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

// Reduces the whole image to the requested extent.
void CutOut(vtkInformation* info, vtkImageData* output)
{
  int asked[6];
  info->Get(Pipeline::UPDATE_EXTENT(), asked);
  if (asked[0] > asked[1] || asked[2] > asked[3] || asked[4] > asked[5])
  {
    output->Initialize();
    return;
  }
  output->Crop(asked);
}

std::string SizeOf(int columns, int rows)
{
  return std::to_string(columns) + " columns and " + std::to_string(rows) + " rows";
}
}

vtkStandardNewMacro(vtkAvianLidarRangeImage);
vtkAvianLidarCxxControllerMacro(vtkAvianLidarRangeImage);

//------------------------------------------------------------------------------
vtkAvianLidarRangeImage::vtkAvianLidarRangeImage()
{
  this->SetController(vtkMultiProcessController::GetGlobalController());
  this->SetNumberOfInputPorts(2);
}

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
  const std::string problem = vtkAvianLidarGuard::ProblemOf(
    [&]()
    {
      vtkInformation* beamsInfo = inputVector[1]->GetInformationObject(0);
      vtkInformation* info = outputVector->GetInformationObject(0);
      // VTK's imaging filters read origin and spacing here, even if not set.
      int extent[6] = { 0, this->Columns - 1, 0, this->Rows - 1, 0, 0 };
      double origin[3] = { 0.0, 0.0, 0.0 };
      double spacing[3] = { 1.0, 1.0, 1.0 };
      if (!this->SizeIsGiven())
      {
        SetGeometry(vtkAvianLidarScanShape::Read(beamsInfo).Grid, extent, origin, spacing);
      }
      info->Set(Pipeline::WHOLE_EXTENT(), extent, 6);
      info->Set(vtkDataObject::ORIGIN(), origin, 3);
      info->Set(vtkDataObject::SPACING(), spacing, 3);
      if (!info->Has(Pipeline::TIME_RANGE()))
      {
        info->CopyEntry(beamsInfo, Pipeline::TIME_STEPS());
        info->CopyEntry(beamsInfo, Pipeline::TIME_RANGE());
      }
      info->Set(CAN_PRODUCE_SUB_EXTENT(), 1);
      vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_DOUBLE, 1);
    });
  if (!problem.empty())
  {
    vtkErrorMacro("" << problem << ".");
  }
  return problem.empty();
}

//------------------------------------------------------------------------------
int vtkAvianLidarRangeImage::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  const vtkAvianLidarRanks ranks(this->Controller, request, outputVector);
  for (int port = 0; port < this->GetNumberOfInputPorts(); ++port)
  {
    ranks.RequestPiece(inputVector[port]);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarRangeImage::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  const int done = vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks)
    {
      vtkAvianLidarRanks::Settings settings;
      settings.Add("Columns", this->Columns);
      settings.Add("Rows", this->Rows);
      ranks.AgreeOn(settings);
      vtkSmartPointer<vtkPolyData> echoes = vtkPolyData::GetData(inputVector[0]);
      vtkSmartPointer<vtkPolyData> beams = vtkPolyData::GetData(inputVector[1]);
      vtkAvianLidarWithin("Range image: ",
        [&]()
        {
          ImageArrays::RequireLengths(echoes, "input port 0 (echoes)");
          ImageArrays::RequireLengths(beams, "input port 1 (beams)");
          echoes = vtkAvianLidarGather::Points(ranks, echoes);
          beams = vtkAvianLidarGather::Points(ranks, beams);
          this->MakeImage(echoes, ranks.Alone() ? beams : ImageBeams::InOrder(beams),
            inputVector[1]->GetInformationObject(0), outputVector->GetInformationObject(0));
        });
    });
  return done && ImageArrays::FillIfFailed(this, outputVector);
}

//------------------------------------------------------------------------------
void vtkAvianLidarRangeImage::MakeImage(
  vtkPolyData* echoes, vtkPolyData* input, vtkInformation* beamsInfo, vtkInformation* info)
{
  vtkAvianLidarScanShape::WholeScan whole;
  if (!this->SizeIsGiven())
  {
    whole = vtkAvianLidarScanShape::Read(beamsInfo);
  }
  const ImageBeams::Beams beams = ImageBeams::Read(input, whole);
  const std::vector<vtkIdType> strongest = StrongestEchoes(echoes, beams);
  int extent[6], announced[6];
  double origin[3], spacing[3];
  SetGeometry(beams.Grid, extent, origin, spacing);
  info->Get(Pipeline::WHOLE_EXTENT(), announced);
  if (beams.Grid.empty())
  {
    std::copy(announced, announced + 6, extent);
  }
  else if (!std::equal(extent, extent + 6, announced))
  {
    vtkAvianLidarRequire("the beams of input port 1 form " + SizeOf(extent[1] + 1, extent[3] + 1) +
      ", but the size announced is " + SizeOf(announced[1] + 1, announced[3] + 1) +
      ": set Columns and Rows to the numbers of the beams' grid");
  }
  vtkNew<vtkImageData> image;
  image->SetExtent(extent);
  image->SetOrigin(origin);
  image->SetSpacing(spacing);
  const vtkIdType cells = vtkStructuredData::GetNumberOfPoints(extent);
  if (cells > 0)
  {
    const auto beamOfCell =
      beams.Grid.empty() ? NoBeams(cells) : BeamsOfCells(echoes, beams.Grid, strongest);
    ImageArrays::AddEchoes(echoes, beamOfCell, strongest, image);
    ImageArrays::AddReport(input, beamOfCell, image);
  }
  if (!beams.Grid.empty())
  {
    image->GetFieldData()->AddArray(
      Arrays::MakeOf<vtkDoubleArray>(Arrays::ColumnAzimuths, beams.Grid.azimuths));
    image->GetFieldData()->AddArray(
      Arrays::MakeOf<vtkDoubleArray>(Arrays::RowElevations, beams.Grid.elevations));
  }
  for (const Arrays::Name& name : { Arrays::LowerEnergyLimit, Arrays::UpperEnergyLimit })
  {
    if (vtkDataArray* limit = input->GetFieldData()->GetArray(name.name))
    {
      image->GetFieldData()->AddArray(limit); // for colours of energies
    }
  }
  vtkImageData* output = vtkImageData::GetData(info);
  output->ShallowCopy(image);
  if (cells > 0 && info->Has(Pipeline::UPDATE_EXTENT()))
  {
    CutOut(info, output);
  }
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarRangeImage, Controller, ErrorsAsData, Columns, Rows);
