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

// Adds a point array to the image. A cell has the value of its item, or `empty` if the item is -1.
template <class ArrayT, class T>
void AddCells(vtkImageData* image, const Arrays::Name& name, vtkDataArray* values,
  const std::vector<vtkIdType>& items, T empty, const char* port)
{
  auto array = Arrays::Make<ArrayT>(name, static_cast<vtkIdType>(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    const double value = items[i] < 0 ? 0.0 : values->GetComponent(items[i], 0);
    if (std::is_integral_v<T>)
    {
      vtkAvianLidarImageArrays::RequireInteger<T>(value, name, port, items[i]);
    }
    array->SetValue(static_cast<vtkIdType>(i), items[i] < 0 ? empty : static_cast<T>(value));
  }
  image->GetPointData()->AddArray(array);
}

// Adds the values of each cell's beam as a point array, if the beams have the array.
template <class ArrayT, class T>
void AddBeams(vtkImageData* image, const Arrays::Name& name, vtkPolyData* beams,
  const std::vector<vtkIdType>& beamOfCell, T empty)
{
  if (beams->GetPointData()->GetAbstractArray(name.name))
  {
    AddCells<ArrayT>(image, name, vtkAvianLidarImageArrays::Find(beams, name, BeamPort), beamOfCell,
      empty, BeamPort);
  }
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarImageArrays::RequireLengths(vtkPolyData* input, const char* port)
{
  for (int i = 0; i < input->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = input->GetPointData()->GetAbstractArray(i);
    if (array->GetNumberOfTuples() != input->GetNumberOfPoints())
    {
      vtkAvianLidarRequire(std::string("point array '") +
        (array->GetName() ? array->GetName() : "") + "' of " + port + " has " +
        std::to_string(array->GetNumberOfTuples()) + " values, expected " +
        std::to_string(input->GetNumberOfPoints()));
    }
  }
}

//------------------------------------------------------------------------------
vtkDataArray* vtkAvianLidarImageArrays::Find(
  vtkPolyData* input, const Arrays::Name& name, const char* port, int components)
{
  vtkDataArray* array = input->GetPointData()->GetArray(name.name);
  if (!array)
  {
    vtkAvianLidarRequire(std::string(port) + " has no numeric point array '" + name.name + "'");
  }
  else if (array->GetNumberOfComponents() != components)
  {
    vtkAvianLidarRequire(std::string("point array '") + name.name + "' of " + port + " has " +
      std::to_string(array->GetNumberOfComponents()) + " components, expected " +
      std::to_string(components));
  }
  return array;
}

//------------------------------------------------------------------------------
void vtkAvianLidarImageArrays::AddEchoes(vtkPolyData* echoes,
  const std::vector<vtkIdType>& beamOfCell, const std::vector<vtkIdType>& strongest,
  vtkImageData* image)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<vtkIdType> items(beamOfCell.size(), -1);
  std::transform(beamOfCell.begin(), beamOfCell.end(), items.begin(),
    [&](vtkIdType beam) { return beam < 0 ? beam : strongest[beam]; });
  const auto find = [echoes](const Arrays::Name& name)
  { return echoes->GetNumberOfPoints() > 0 ? Find(echoes, name, EchoPort) : nullptr; };
  vtkDataArray* distance = find(Arrays::Distance);
  vtkDataArray* energy = find(Arrays::Energy);
  vtkDataArray* object = find(Arrays::ObjectId);
  AddCells<vtkDoubleArray>(image, Arrays::Distance, distance, items, nan, EchoPort);
  AddCells<vtkDoubleArray>(image, Arrays::Energy, energy, items, nan, EchoPort);
  AddCells<vtkIntArray>(image, Arrays::ObjectId, object, items, -1, EchoPort);
  image->GetPointData()->SetActiveScalars(Arrays::Distance.name);
}

//------------------------------------------------------------------------------
void vtkAvianLidarImageArrays::AddReport(
  vtkPolyData* beams, const std::vector<vtkIdType>& beamOfCell, vtkImageData* image)
{
  for (const Arrays::Name& name : { Arrays::Status, Arrays::Skipped })
  {
    AddBeams<vtkIntArray>(image, name, beams, beamOfCell, -1);
  }
  for (const Arrays::Name& name : { Arrays::Candidates, Arrays::NodesVisited, Arrays::RaysTraced })
  {
    AddBeams<vtkIdTypeArray>(image, name, beams, beamOfCell, vtkIdType{ -1 });
  }
  AddBeams<vtkDoubleArray>(
    image, Arrays::SkippedBound, beams, beamOfCell, std::numeric_limits<double>::quiet_NaN());
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
      // AllocateScalars() is not used, because without memory it ends the process.
      vtkNew<vtkDoubleArray> nothing;
      nothing->SetName("ImageScalars");
      Arrays::SetTuples(nothing.Get(), vtkStructuredData::GetNumberOfPoints(extent));
      nothing->Fill(std::numeric_limits<double>::quiet_NaN());
      image->SetExtent(extent);
      image->GetPointData()->SetScalars(nothing);
    });
  if (!problem.empty())
  {
    vtkErrorWithObjectMacro(self, << problem);
  }
  return problem.empty();
}
