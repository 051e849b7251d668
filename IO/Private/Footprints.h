// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Footprints.h
 * @brief Plans of buildings and pavements, from any vector format of GDAL, raised to triangles.
 */
#ifndef AvianLidarFootprints_h
#define AvianLidarFootprints_h

#include "SceneTypes.h"
#include "Terrain.h"

#include <functional>

namespace avianlidar::scene
{
/**
 * Read the features of a `footprints` object and raise them: one part each, or one for all, in
 * metres east, north and up of the origin. Plan positions are exact on the ellipsoid; heights count
 * from the origin's tangent plane, so that a level ground stays level (at 3 km it lies 0.7 m above
 * the ellipsoid's curve). Triangles carry scene material ids.
 *
 * On a terrain, solids stand on the lowest point below them; flat areas, lines and media follow it.
 * What lies beyond it is left out.
 *
 * Notes on what was repaired, skipped or assumed are added to `notes`. Throws Error where the file
 * cannot be read, no feature is left, or one has no height; WorkStopped where keepGoing returns
 * false.
 */
std::vector<Part> ReadFootprints(const Object& object, const Scene& scene, const Terrain* terrain,
  std::vector<std::string>& notes, const std::function<bool()>& keepGoing);
}

#endif
