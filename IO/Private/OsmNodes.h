// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file OsmNodes.h
 * @brief Takes nodes without a place out of OpenStreetMap's XML, because GDAL reads their
 * coordinates as others, such as 0, or stops.
 */
#ifndef AvianLidarOsmNodes_h
#define AvianLidarOsmNodes_h

#include <string>
#include <vector>

namespace avianlidar::scene
{
/// Renames the nodes whose `lat` or `lon` is not a number of degrees, so that GDAL leaves them out
/// of ways. The text keeps its length. Returns the ids of these nodes.
/// https://wiki.openstreetmap.org/wiki/OSM_XML
std::vector<std::string> LeaveOutNodes(std::string& text);
}

#endif
