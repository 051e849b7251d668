// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CoordinateSystem.h
 * @brief Coordinate reference systems as text (WKT 1, as LAS 1.4 wants it), through GDAL.
 */
#ifndef AvianLidarCoordinateSystem_h
#define AvianLidarCoordinateSystem_h

#include <string>
#include <vector>

namespace avianlidar::formats
{
/// UTM on WGS84 with heights above the ellipsoid: EPSG 326zz or 327zz and the ellipsoid as vertical
/// system. The zone is 1 to 60, negative in the south.
std::string utmWkt(int zone);

/// Geocentric WGS84, EPSG:4978.
std::string geocentricWkt();

/// The system that keys of GeoTIFF describe (tags 34735, 34736 and 34737); empty if GDAL knows
/// none.
std::string wktOfGeoKeys(const std::vector<unsigned char>& keys,
  const std::vector<unsigned char>& doubles, const std::vector<unsigned char>& texts);

/// The unit of the coordinates where it is not the metre: "degree", "US survey foot"; with both,
/// "metre and foot" for plan and heights. Empty: metres, or not known.
std::string foreignUnitOf(const std::string& wkt);

/// The zone of a text that is UTM on WGS84, negative in the south; 0 if it is something else.
int utmZoneOf(const std::string& wkt);
}

#endif
