// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarNamedMaterials.h
 * @brief Lists the named materials. Not installed.
 *
 * The materials of the paper's Table 1 have their index as `material_id`. A material outside Table
 * 1 has the next free id from its first use on. This file includes no VTK header: headers of newer
 * VTK rename the namespace of the JSON library that the scene reader includes beside this file.
 */
#ifndef vtkAvianLidarNamedMaterials_h
#define vtkAvianLidarNamedMaterials_h

#include "Reflectance.h"

namespace vtkAvianLidarMaterials
{
struct NamedMaterial
{
  const char* name;
  avianlidar::Material material;
  double colour[3]; ///< display colour: red, green, blue, 0 to 1
  const char* source;
};

constexpr int NumberOfStandardMaterials = 4;

inline constexpr char Paper[] = "Photonics 2024, 11(2), 153, Table 1";

inline constexpr NamedMaterial NamedMaterials[] = {
  { "Wall", { 0.146, 0.054, 112.0 }, { 0.80, 0.76, 0.68 }, Paper },
  { "Glass", { 0.020, 0.852, 8046.0 }, { 0.55, 0.75, 0.85 }, Paper },
  { "Metal", { 0.075, 0.634, 6803.0 }, { 0.60, 0.63, 0.68 }, Paper },
  { "Wood", { 0.107, 0.100, 82.0 }, { 0.62, 0.44, 0.27 }, Paper },
  // Kokaly et al. 2017, doi:10.3133/ds1035. Spectra do not give a specular lobe: the reflectance is
  // taken as diffuse. No roughness of such ground was found.
  { "Concrete", { 0.3104, 0.0, 1.0, 0.35 }, { 0.66, 0.66, 0.64 },
    "USGS Spectral Library 7, 905 nm: Concrete GDS375 light grey road; roughness assumed" },
  { "Asphalt", { 0.1298, 0.0, 1.0, 0.52 }, { 0.25, 0.25, 0.27 },
    "USGS Spectral Library 7, 905 nm: Asphalt GDS376 black road, old; roughness assumed" },
  { "Grass", { 0.2204, 0.0, 1.0, 0.7 }, { 0.36, 0.55, 0.25 },
    "USGS Spectral Library 7, 905 nm: Cheatgrass ANPC1 field; roughness assumed" },
  // No reflectance of plumage at 905 nm was found.
  { "Plumage", { 0.3, 0.0, 1.0 }, { 0.45, 0.38, 0.33 }, "assumed" },
};
}

#endif
