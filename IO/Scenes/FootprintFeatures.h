// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file FootprintFeatures.h
 * @brief Reads the features of a vector file by GDAL, as plans in local metres.
 */
#ifndef AvianLidarFootprintFeatures_h
#define AvianLidarFootprintFeatures_h

#include "OsmXml.h"
#include "Polygons.h"
#include "SceneTypes.h"
#include "ShownNames.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace avianlidar::scene
{
/// A feature that may become a part of the scene.
struct FootprintFeature
{
  std::string name; ///< number of the feature if it does not have a name
  std::string heightText;
  bool isNested = false;           ///< whether places inside an even number of rings are outside
  std::optional<double> height;    ///< m
  std::optional<double> minHeight; ///< m
  std::optional<double> width;     ///< width of lines, m
  std::vector<Polygon> polygons;
  std::vector<Ring> lines;
  Ring points;

  bool HasPlan() const
  {
    return !this->polygons.empty() || !this->lines.empty() || !this->points.empty();
  }
};

/// What was left out, repaired or assumed.
struct FootprintCounts
{
  int filtered = 0;
  OsmNotes map;
  Names placeless;
  Names surfaces;
  int points = 0;
  int thinLines = 0;
  Names repaired;
  Names strayHoles;
  Names empty;
  Names assumedHeights;
  Names minHeights;
  Names lowest; ///< features with a least height that is not a length
  int beyond = 0;
  Names failed;
  std::string failure; ///< error of the first feature that failed

  void AddFailure(const std::string& name, const std::string& error)
  {
    this->failure = this->failed.GetCount() == 0 ? error : this->failure;
    this->failed.Add(name);
  }
};

/// Returns what was left out of a map, for an error.
std::string FaultsOf(const FootprintCounts& counts);

/// Reads the features of a `footprints` object that fit its filters. A feature outside the
/// reference system has no plan. Throws Error if the file cannot be read or has no such feature.
/// Throws WorkStopped if keepGoing returns false.
std::vector<FootprintFeature> ReadFootprintFeatures(const Object& object, const Scene& scene,
  FootprintCounts& counts, std::vector<std::string>& notes, const std::function<bool()>& keepGoing);
}

#endif
