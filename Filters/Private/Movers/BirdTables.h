// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BirdTables.h
 * @brief Reads tables of species and of tracks of birds.
 */
#ifndef avianlidar_BirdTables_h
#define avianlidar_BirdTables_h

#include "Bird.h"
#include "Flight.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
/// Reads a table of species with the header of Filters/Birds/species.csv. Lines that begin with #
/// are comments. Throws std::runtime_error naming file, line and column.
/// @param file name of the file, for messages
std::vector<BirdSpecies> readSpecies(const std::string& text, const std::string& file);

/// Reads a table of tracks: a header "id,species,time,x,y,z" or
/// "id,species,time,longitude,latitude,height". Lines that begin with # are comments. Rows of
/// several tracks may alternate. Throws std::runtime_error naming file, line and column.
/// @param file name of the file, for messages @param known all species
/// @param origin origin of the scene: latitude, longitude in degrees, height above the ellipsoid in
/// m (checked by the caller with GeodeticFrame::checkOrigin())
std::vector<Flight> readFlights(const std::string& text, const std::string& file,
  const std::vector<BirdSpecies>& known, const std::array<double, 3>& origin, std::int32_t seed);
}

#endif
