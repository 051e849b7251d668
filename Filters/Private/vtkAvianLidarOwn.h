// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarOwn.h
 * @brief Arrays that are kept from one execution to the next and written to again. Not installed.
 *
 * Others may hold such an array, or another one that shares its values: a ShallowCopy() of an array
 * holds the values, not the array. What they hold must stay as it was.
 */
#ifndef vtkAvianLidarOwn_h
#define vtkAvianLidarOwn_h

#include "vtkAOSDataArrayTemplate.h"
#include "vtkAvianLidarArrays.h"
#include "vtkBuffer.h"
#include "vtkSmartPointer.h"

/// Looks at the values, which arrays keep to themselves.
template <class ValueT>
struct vtkAvianLidarValues : public vtkAOSDataArrayTemplate<ValueT>
{
  /// True if another array shares them.
  static bool AreShared(vtkAOSDataArrayTemplate<ValueT>& array)
  {
    return (array.*(&vtkAvianLidarValues::Buffer))->GetReferenceCount() > 1;
  }
};

/// Make sure that nobody else holds the array or its values: then it may be written to. Costs a
/// copy if somebody does.
template <class ArrayT>
void vtkAvianLidarOwn(vtkSmartPointer<ArrayT>& array)
{
  if (array &&
    (array->GetReferenceCount() > 1 ||
      vtkAvianLidarValues<typename ArrayT::ValueType>::AreShared(*array)))
  {
    auto copy = vtkSmartPointer<ArrayT>::New();
    copy->SetNumberOfComponents(array->GetNumberOfComponents());
    vtkAvianLidarArrays::SetTuples(copy.Get(), array->GetNumberOfTuples());
    copy->DeepCopy(array);
    array = copy;
  }
}

#endif
