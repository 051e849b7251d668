// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarMaterials.h
 * @brief The named materials of the paper's Table 1; their index is their `material_id`. Not
 * installed.
 */
#ifndef vtkAvianLidarMaterials_h
#define vtkAvianLidarMaterials_h

#include "Reflectance.h"

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
}

#endif
