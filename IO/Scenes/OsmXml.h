// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file OsmXml.h
 * @brief Puts OpenStreetMap's XML into the form that GDAL reads, and counts the faults on which
 * GDAL says nothing or stops.
 */
#ifndef AvianLidarOsmXml_h
#define AvianLidarOsmXml_h

#include "SceneTypes.h"
#include "ShownNames.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace avianlidar::scene
{
/// Returns whether a file that begins with this text is XML of OpenStreetMap.
bool IsOsmXml(std::string_view start);

/// What an object wants from a map.
struct OsmWanted
{
  std::string layer; ///< layer of GDAL's OSM driver
  std::vector<AttributeFilter> filters;
};

/// Names of objects of a map by what became of them, such as "relations with missing ways were left
/// out".
using OsmNotes = std::vector<std::pair<std::string, Names>>;

/**
 * Returns the map with nodes, then ways, then relations, each object once, without deleted objects
 * and without nodes that are not on the Earth. GDAL stops at repeated nodes, reads "abc" as the
 * latitude 0, and leaves out without a word: what comes after its users, relations with a missing
 * way, and areas that are not closed. Such objects are noted if they fit the filter. A relation
 * that only misses the way of a courtyard is kept without this courtyard. Returns no text if the
 * XML is damaged, which GDAL reports with its place. Throws WorkStopped.
 * https://wiki.openstreetmap.org/wiki/OSM_XML
 *
 * @param read appends a piece of the file to a text, and returns false at the end of the file
 * @param notes gets the names
 * @param keepGoing is asked regularly
 */
std::optional<std::string> InOrder(const std::function<bool(std::string&)>& read,
  const OsmWanted& wanted, OsmNotes& notes, const std::function<bool()>& keepGoing);
}

#endif
