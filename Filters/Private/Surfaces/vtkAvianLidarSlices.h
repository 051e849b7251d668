// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSlices.h
 * @brief Arrays that are slices of one piece of memory, so that the surfaces of a scene as one
 * block share their values with the surfaces as many blocks. Not installed.
 */
#ifndef vtkAvianLidarSlices_h
#define vtkAvianLidarSlices_h

#include "vtkInformation.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace vtkAvianLidarSlices
{
/// An array of VTK that keeps the memory of its values alive. Copies in depth are usual arrays.
template <class ArrayT>
class Slice : public ArrayT
{
public:
  using Value = typename ArrayT::ValueType;
  std::shared_ptr<Value> Memory; ///< first value of the memory of which the array is a slice

  /// A slice with name, unit and components of another array. @param values first value
  static vtkSmartPointer<ArrayT> Make(
    ArrayT* like, const std::shared_ptr<Value>& memory, Value* values, vtkIdType count)
  {
    auto slice = vtkSmartPointer<Slice>::Take(new Slice);
    slice->InitializeObjectBase();
    slice->Memory = memory;
    slice->SetName(like->GetName());
    slice->CopyInformation(like->GetInformation());
    slice->SetNumberOfComponents(like->GetNumberOfComponents());
    constexpr int isKept = 1; // VTK neither frees nor resizes the memory
    slice->SetArray(values, count, isKept);
    return slice;
  }
};

/// Copies of arrays, one after the other in one piece of memory.
template <class ArrayT>
std::vector<vtkSmartPointer<ArrayT>> Divide(const std::vector<ArrayT*>& arrays)
{
  using Value = typename ArrayT::ValueType;
  vtkIdType total = 0;
  for (ArrayT* array : arrays)
  {
    total += array->GetNumberOfValues();
  }
  const std::shared_ptr<Value> memory(
    new Value[static_cast<std::size_t>(total)], std::default_delete<Value[]>());
  std::vector<vtkSmartPointer<ArrayT>> slices;
  Value* values = memory.get();
  for (ArrayT* array : arrays)
  {
    const vtkIdType count = array->GetNumberOfValues();
    std::copy_n(array->GetPointer(0), count, values);
    slices.push_back(Slice<ArrayT>::Make(array, memory, values, count));
    values += count;
  }
  return slices;
}

/// The slice that consists of the given slices, or null unless they follow one another in memory.
template <class ArrayT, class Array>
vtkSmartPointer<ArrayT> Join(const std::vector<Array*>& arrays)
{
  std::vector<Slice<ArrayT>*> slices;
  vtkIdType total = 0;
  for (Array* array : arrays)
  {
    auto* slice = dynamic_cast<Slice<ArrayT>*>(array);
    if (!slice || slice->Memory != (slices.empty() ? slice : slices[0])->Memory ||
      slice->GetPointer(0) != (slices.empty() ? slice : slices[0])->GetPointer(0) + total)
    {
      return nullptr;
    }
    slices.push_back(slice);
    total += slice->GetNumberOfValues();
  }
  return slices.empty()
    ? nullptr
    : Slice<ArrayT>::Make(slices[0], slices[0]->Memory, slices[0]->GetPointer(0), total);
}
}

#endif
