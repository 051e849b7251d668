// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarMaterials.h
 * @brief Includes the named materials, and writes materials as cell arrays. Not installed.
 */
#ifndef vtkAvianLidarMaterials_h
#define vtkAvianLidarMaterials_h

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarNamedMaterials.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"

namespace vtkAvianLidarMaterials
{
/// The cell arrays of all coefficients.
class Coefficients
{
public:
  /// Add the arrays without setting their values.
  Coefficients(vtkCellData* cells, vtkIdType count)
  {
    for (std::size_t k = 0; k < std::size(avianlidar::MaterialCoefficients); ++k)
    {
      const avianlidar::MaterialCoefficient& coefficient = avianlidar::MaterialCoefficients[k];
      auto array =
        vtkAvianLidarArrays::Make<vtkDoubleArray>({ coefficient.name, coefficient.unit }, count);
      cells->AddArray(array);
      this->Values[k] = array->GetPointer(0);
    }
  }
  void Set(vtkIdType cell, const avianlidar::Material& material)
  {
    for (std::size_t k = 0; k < std::size(this->Values); ++k)
    {
      this->Values[k][cell] = material.*avianlidar::MaterialCoefficients[k].member;
    }
  }

private:
  double* Values[std::size(avianlidar::MaterialCoefficients)];
};

/// Add the cell arrays of all coefficients. @param materialOf function from the index of a cell to
/// the cell's material
template <class F>
void AddCoefficients(vtkCellData* cells, vtkIdType count, const F& materialOf)
{
  Coefficients coefficients(cells, count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    coefficients.Set(i, materialOf(i));
  }
}
}

#endif
