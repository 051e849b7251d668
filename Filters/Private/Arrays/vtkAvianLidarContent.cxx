// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarContent.h"

#include "Hash.h"

#include "vtkCellArray.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkInformation.h"
#include "vtkInformationStringKey.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>

namespace vtkAvianLidarContent
{
//------------------------------------------------------------------------------
vtkMTimeType TimeOf(vtkPolyData* poly)
{
  vtkMTimeType time = poly->GetMTime(); // includes all arrays except arrays of point ids
  const auto look = [&time](vtkObject* object)
  { time = object ? std::max(time, object->GetMTime()) : time; };
  look(poly->GetPoints() ? poly->GetPoints()->GetData() : nullptr);
  for (vtkCellArray* cells :
    { poly->GetVerts(), poly->GetLines(), poly->GetPolys(), poly->GetStrips() })
  {
    look(cells);
    look(cells->GetOffsetsArray());
    look(cells->GetConnectivityArray());
  }
  return time;
}

//------------------------------------------------------------------------------
State StateOf(vtkDataObject* data)
{
  State state;
  const auto add = [&state](vtkDataObject* object)
  {
    auto* poly = vtkPolyData::SafeDownCast(object);
    state.emplace_back(object, poly ? TimeOf(poly) : object->GetMTime());
  };
  add(data);
  auto* composite = vtkCompositeDataSet::SafeDownCast(data);
  if (!composite)
  {
    return state;
  }
  auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(composite->NewIterator());
  if (auto* nodes = vtkDataObjectTreeIterator::SafeDownCast(iterator))
  {
    nodes->VisitOnlyLeavesOff();
  }
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    add(iterator->GetCurrentDataObject());
    vtkInformation* about =
      iterator->HasCurrentMetaData() ? iterator->GetCurrentMetaData() : nullptr;
    if (about && about->Has(vtkCompositeDataSet::NAME()))
    {
      // A new name of a block does not change the data of the block.
      state.emplace_back(about, std::hash<std::string>()(about->Get(vtkCompositeDataSet::NAME())));
    }
  }
  return state;
}

//------------------------------------------------------------------------------
std::uint64_t HashOf(vtkDataArray* array, std::uint64_t seed)
{
  const std::int64_t shape[] = { array ? array->GetDataType() : -1,
    array ? array->GetNumberOfComponents() : 0, array ? array->GetNumberOfTuples() : 0 };
  seed = avianlidar::hashOf(shape, sizeof(shape), seed);
  const auto size = static_cast<std::size_t>(array ? array->GetDataTypeSize() : 0);
  if (size > 0 && array->HasStandardMemoryLayout())
  {
    const auto values = static_cast<std::size_t>(shape[1] * shape[2]);
    return values > 0 ? avianlidar::hashOf(array->GetVoidPointer(0), values * size, seed) : seed;
  }
  // Some other arrays compute a tuple in a shared buffer, so only one thread may read.
  static std::mutex one;
  const std::lock_guard<std::mutex> alone(one);
  std::vector<double> tuple(static_cast<std::size_t>(shape[1]));
  for (vtkIdType i = 0; i < shape[2]; ++i)
  {
    array->GetTuple(i, tuple.data());
    seed = avianlidar::hashOf(tuple.data(), tuple.size() * sizeof(double), seed);
  }
  return seed;
}

//------------------------------------------------------------------------------
std::uint64_t HashOfGeometry(vtkPolyData* poly, std::uint64_t seed)
{
  seed = HashOf(poly->GetPoints() ? poly->GetPoints()->GetData() : nullptr, seed);
  std::uint64_t kind = 0;
  for (vtkCellArray* cells :
    { poly->GetVerts(), poly->GetLines(), poly->GetPolys(), poly->GetStrips() })
  {
    ++kind;
    if (cells->GetNumberOfCells() != 0) // the number is -1 if offsets are missing
    {
      seed = HashOf(cells->GetOffsetsArray(), avianlidar::hashOf(&kind, sizeof(kind), seed));
      seed = HashOf(cells->GetConnectivityArray(), seed);
    }
  }
  return seed;
}
}
