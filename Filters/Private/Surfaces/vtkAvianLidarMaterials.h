// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarMaterials.h
 * @brief The named materials, and materials as cell arrays. Not installed.
 */
#ifndef vtkAvianLidarMaterials_h
#define vtkAvianLidarMaterials_h

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarNamedMaterials.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"

namespace vtkAvianLidarMaterials
{
/// Add the cell arrays of all coefficients. @param materialOf the material of a cell, by its index
template <class F>
void AddCoefficients(vtkCellData* cells, vtkIdType count, const F& materialOf)
{
  for (const avianlidar::MaterialCoefficient& coefficient : avianlidar::MaterialCoefficients)
  {
    auto array =
      vtkAvianLidarArrays::Make<vtkDoubleArray>({ coefficient.name, coefficient.unit }, count);
    for (vtkIdType i = 0; i < count; ++i)
    {
      const avianlidar::Material& material = materialOf(i);
      array->SetValue(i, material.*coefficient.member);
    }
    cells->AddArray(array);
  }
}
}

#endif
