// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBirds.h
 * @brief Makes birds as surfaces with materials and names, and reads tables of species. Not
 * installed.
 */
#ifndef vtkAvianLidarBirds_h
#define vtkAvianLidarBirds_h

#include "Bird.h"

#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <string>
#include <vector>

/// All functions throw std::runtime_error, which names the property.
namespace vtkAvianLidarBirds
{
std::vector<avianlidar::BirdSpecies> BuiltInSpecies();

/// The species of the user's table; none without a file.
std::vector<avianlidar::BirdSpecies> OwnSpecies(const std::string& file);

/// The species of the user's table, then the built-in species.
std::vector<avianlidar::BirdSpecies> KnownSpecies(const std::string& file);

/// Names of the built-in species, then of the species of the user's table, one in each line.
/// A table that cannot be read adds no names, because the execution reports the error.
std::string NamesOfSpecies(const std::string& file);

/// Index of the species that the property Species names.
std::size_t FindSpecies(const std::vector<avianlidar::BirdSpecies>& known, const std::string& name);

void CheckReflectance(double reflectance);

/// Body, left and right wing in the bird's frame (Bird.h), with the cell arrays `part`,
/// `material_id` and the coefficients, and field data `material_names`.
/// @param angle angle of the wings, rad
vtkSmartPointer<vtkPolyData> Surface(
  const avianlidar::BirdShape& shape, double angle, double reflectance);

/// Set the cell array `object_id` and field data `object_names`.
void SetObject(vtkPolyData* bird, int id, const std::string& name);
}

#endif
