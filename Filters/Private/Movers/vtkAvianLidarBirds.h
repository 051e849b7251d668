// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBirds.h
 * @brief Birds as surfaces with materials and names, and the species that are known. Not installed.
 */
#ifndef vtkAvianLidarBirds_h
#define vtkAvianLidarBirds_h

#include "Bird.h"

#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <string>
#include <vector>

/// All throw std::runtime_error, which names the property.
namespace vtkAvianLidarBirds
{
/// The text of a file. @param property the name of the property that holds the file's
std::string TextOf(const char* property, const std::string& file);

/// The species of a table of the user's, if there is a file, then those that are built in.
std::vector<avianlidar::BirdSpecies> KnownSpecies(const std::string& file);

/// Index of the species that the property Species names.
std::size_t FindSpecies(const std::vector<avianlidar::BirdSpecies>& known, const std::string& name);

void CheckReflectance(double reflectance);

/// Body, left and right wing in the bird's frame (Bird.h), with the cell arrays `part`,
/// `material_id` and the coefficients, and field data `material_names`.
/// @param angle of the wings, rad
vtkSmartPointer<vtkPolyData> Surface(
  const avianlidar::BirdShape& shape, double angle, double reflectance);

/// Set the cell array `object_id` and field data `object_names`.
void SetObject(vtkPolyData* bird, int id, const std::string& name);
}

#endif
