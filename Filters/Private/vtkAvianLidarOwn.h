// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarOwn.h
 * @brief Arrays that are kept from one execution to the next and written to again. Not installed.
 */
#ifndef vtkAvianLidarOwn_h
#define vtkAvianLidarOwn_h

#include "vtkSmartPointer.h"

/// Make sure that nobody else holds the array: then it may be written to.
template <class ArrayT>
void vtkAvianLidarOwn(vtkSmartPointer<ArrayT>& array)
{
  if (array && array->GetReferenceCount() > 1)
  {
    auto copy = vtkSmartPointer<ArrayT>::New();
    copy->DeepCopy(array);
    array = copy;
  }
}

#endif
