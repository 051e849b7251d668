// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarImageArrays.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarGuard.h"

#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStructuredData.h"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace
{
namespace Arrays = vtkAvianLidarArrays;

const char* const EchoPort = "input port 0 (echoes)";
const char* const BeamPort = "input port 1 (beams)";

// A point array of the image: of each cell the value of its item, the given one where that is -1.
template <class ArrayT, class T>
void AddCells(vtkImageData* image, const Arrays::Name& name, vtkDataArray* values,
  const std::vector<vtkIdType>& items, T empty, const char* port, std::string& problem)
{
  auto array = Arrays::Make<ArrayT>(name, static_cast<vtkIdType>(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    const double value = items[i] < 0 ? 0.0 : values->GetComponent(items[i], 0);
    if (std::is_integral_v<T> && !vtkAvianLidarImageArrays::Fits<T>(value))
    {
      problem = vtkAvianLidarImageArrays::NoInteger(name, port, items[i]);
      return;
    }
    array->SetValue(static_cast<vtkIdType>(i), items[i] < 0 ? empty : static_cast<T>(value));
  }
  image->GetPointData()->AddArray(array);
}

// Of each cell what its beam says, if the beams have that array.
template <class ArrayT, class T>
void AddBeams(vtkImageData* image, const Arrays::Name& name, vtkPolyData* beams,
  const std::vector<vtkIdType>& beamOfCell, T empty, std::string& problem)
{
  if (beams->GetPointData()->GetAbstractArray(name.name))
  {
    if (vtkDataArray* values = vtkAvianLidarImageArrays::Find(beams, name, BeamPort, problem))
    {
      AddCells<ArrayT>(image, name, values, beamOfCell, empty, BeamPort, problem);
    }
  }
}
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarImageArrays::CheckLengths(vtkPolyData* input, const char* port)
{
  for (int i = 0; i < input->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = input->GetPointData()->GetAbstractArray(i);
    if (array->GetNumberOfTuples() != input->GetNumberOfPoints())
    {
      return std::string("point array '") + (array->GetName() ? array->GetName() : "") + "' of " +
        port + " has " + std::to_string(array->GetNumberOfTuples()) + " values, expected " +
        std::to_string(input->GetNumberOfPoints());
    }
  }
  return {};
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarImageArrays::NoInteger(
  const Arrays::Name& name, const char* port, vtkIdType point)
{
  return std::string("point array '") + name.name + "' of " + port +
    " has a value that is not an integer, at point " + std::to_string(point);
}

//------------------------------------------------------------------------------
vtkDataArray* vtkAvianLidarImageArrays::Find(vtkPolyData* input, const Arrays::Name& name,
  const char* port, std::string& problem, int components)
{
  vtkDataArray* array = input->GetPointData()->GetArray(name.name);
  if (!array)
  {
    problem = std::string(port) + " has no numeric point array '" + name.name + "'";
  }
  else if (array->GetNumberOfComponents() != components)
  {
    problem = std::string("point array '") + name.name + "' of " + port + " has " +
      std::to_string(array->GetNumberOfComponents()) + " components, expected " +
      std::to_string(components);
    array = nullptr;
  }
  return array;
}

//------------------------------------------------------------------------------
void vtkAvianLidarImageArrays::AddEchoes(vtkPolyData* echoes,
  const std::vector<vtkIdType>& beamOfCell, const std::vector<vtkIdType>& strongest,
  vtkImageData* image, std::string& problem)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<vtkIdType> items(beamOfCell.size(), -1);
  std::transform(beamOfCell.begin(), beamOfCell.end(), items.begin(),
    [&](vtkIdType beam) { return beam < 0 ? beam : strongest[beam]; });
  vtkDataArray *distance = nullptr, *energy = nullptr, *object = nullptr;
  if (echoes->GetNumberOfPoints() > 0)
  {
    distance = Find(echoes, Arrays::Distance, EchoPort, problem);
    energy = distance ? Find(echoes, Arrays::Energy, EchoPort, problem) : nullptr;
    object = energy ? Find(echoes, Arrays::ObjectId, EchoPort, problem) : nullptr;
  }
  if (problem.empty())
  {
    AddCells<vtkDoubleArray>(image, Arrays::Distance, distance, items, nan, EchoPort, problem);
    AddCells<vtkDoubleArray>(image, Arrays::Energy, energy, items, nan, EchoPort, problem);
    AddCells<vtkIntArray>(image, Arrays::ObjectId, object, items, -1, EchoPort, problem);
    image->GetPointData()->SetActiveScalars(Arrays::Distance.name);
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarImageArrays::AddReport(vtkPolyData* beams,
  const std::vector<vtkIdType>& beamOfCell, vtkImageData* image, std::string& problem)
{
  for (const Arrays::Name& name : { Arrays::Status, Arrays::Skipped })
  {
    AddBeams<vtkIntArray>(image, name, beams, beamOfCell, -1, problem);
  }
  for (const Arrays::Name& name : { Arrays::Candidates, Arrays::NodesVisited, Arrays::RaysTraced })
  {
    AddBeams<vtkIdTypeArray>(image, name, beams, beamOfCell, vtkIdType{ -1 }, problem);
  }
  AddBeams<vtkDoubleArray>(image, Arrays::SkippedBound, beams, beamOfCell,
    std::numeric_limits<double>::quiet_NaN(), problem);
}

//------------------------------------------------------------------------------
bool vtkAvianLidarImageArrays::FillIfFailed(vtkAlgorithm* self, vtkInformationVector* outputs)
{
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkImageData* image = vtkImageData::GetData(info);
  if (!image || !image->GetFieldData()->HasArray(Arrays::Error.name) ||
    !info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT()))
  {
    return true;
  }
  const std::string problem = vtkAvianLidarGuard::ProblemOf(
    [&]()
    {
      int extent[6];
      info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent);
      // Not by AllocateScalars(), which ends the process where there is no memory.
      vtkNew<vtkDoubleArray> nothing;
      nothing->SetName("ImageScalars");
      Arrays::SetTuples(nothing.Get(), vtkStructuredData::GetNumberOfPoints(extent));
      nothing->Fill(std::numeric_limits<double>::quiet_NaN());
      image->SetExtent(extent);
      image->GetPointData()->SetScalars(nothing);
      return std::string();
    });
  if (!problem.empty())
  {
    vtkErrorWithObjectMacro(self, << problem);
  }
  return problem.empty();
}
