// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CoordinateSystem.h
 * @brief Coordinate reference systems as WKT, by GDAL. LAS 1.4 requires WKT 1.
 */
#ifndef AvianLidarCoordinateSystem_h
#define AvianLidarCoordinateSystem_h

#include <string>
#include <vector>

namespace avianlidar::formats
{
/// Returns UTM on WGS84 with heights above the ellipsoid: EPSG 326zz or 327zz (zz is the zone) and
/// the ellipsoid as vertical system. The zone is 1 to 60 in the north, and -1 to -60 in the south.
std::string utmWkt(int zone);

/// Returns geocentric WGS84, EPSG:4978.
std::string geocentricWkt();

/// Returns the system that keys of GeoTIFF (tags 34735, 34736 and 34737) describe, as WKT 1 or, if
/// WKT 1 cannot express the system, WKT 2. Returns an empty text if GDAL does not find the system.
std::string wktOfGeoKeys(const std::vector<unsigned char>& keys,
  const std::vector<unsigned char>& doubles, const std::vector<unsigned char>& texts);

/// Returns the unit of the coordinates, such as "degree" or "US survey foot", or "metre and foot"
/// if plan and heights have different units. Returns an empty text for metres or an unknown unit.
std::string foreignUnitOf(const std::string& wkt);

/// Returns whether the coordinates are longitude and latitude.
bool hasDegrees(const std::string& wkt);

/// Returns the zone of a WKT of UTM on WGS84, negative in the south, or 0 for any other text.
int utmZoneOf(const std::string& wkt);
}

#endif
