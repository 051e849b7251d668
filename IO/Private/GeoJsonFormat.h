// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file GeoJsonFormat.h
 * @brief Points on the Earth as GeoJSON (RFC 7946): a collection of features, one a line.
 */
#ifndef AvianLidarGeoJsonFormat_h
#define AvianLidarGeoJsonFormat_h

#include "CloudData.h"
#include "OutputFile.h"

namespace avianlidar::formats
{
/// A text for each point.
struct TextField
{
  std::string name;
  std::function<std::string(std::int64_t)> value;
};

/// What is written.
struct GeoJsonOutput
{
  std::int64_t size = 0;
  std::function<bool(std::int64_t)> wanted;
  std::function<Point(std::int64_t)> place; ///< longitude deg, latitude deg, height m (WGS84)
  std::vector<Field> fields;
  std::vector<TextField> texts;
  std::string description;
};

/// Longitude and latitude to 9 decimals, height to 4: at most 0.06 mm off. Other numbers have the
/// digits that give the same double back; what is not finite is null. Units of all properties stand
/// in the member `units`. Returns the number of features.
std::int64_t writeGeoJson(
  OutputFile& file, const GeoJsonOutput& output, const KeepGoing& keepGoing);
}

#endif
