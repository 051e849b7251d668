// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarMaterials.h
 * @brief The named materials of the paper's Table 1, whose index is their `material_id`, and
 * materials as cell arrays. Not installed.
 */
#ifndef vtkAvianLidarMaterials_h
#define vtkAvianLidarMaterials_h

#include "Reflectance.h"
#include "vtkAvianLidarArrays.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"

namespace vtkAvianLidarMaterials
{
struct NamedMaterial
{
  const char* name;
  avianlidar::Material material;
};

constexpr int NumberOfStandardMaterials = 4;

inline constexpr NamedMaterial StandardMaterials[NumberOfStandardMaterials] = {
  { "Wall", { 0.146, 0.054, 112.0 } },
  { "Glass", { 0.020, 0.852, 8046.0 } },
  { "Metal", { 0.075, 0.634, 6803.0 } },
  { "Wood", { 0.107, 0.100, 82.0 } },
};

/// Add the cell arrays of all coefficients. @param materialOf the material of a cell, by its index
template <class F>
void AddCoefficients(vtkCellData* cells, vtkIdType count, const F& materialOf)
{
  for (const avianlidar::MaterialCoefficient& coefficient : avianlidar::MaterialCoefficients)
  {
    auto array = vtkAvianLidarArrays::Make<vtkDoubleArray>({ coefficient.name, "1" }, count);
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
