// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Footprints.h
 * @brief Reads plans of buildings and pavements from any vector format of GDAL, and raises plans to
 * triangles.
 */
#ifndef AvianLidarFootprints_h
#define AvianLidarFootprints_h

#include "SceneTypes.h"
#include "Terrain.h"

#include <functional>

namespace avianlidar::scene
{
/**
 * Reads the features of a `footprints` object. Raises each feature to a part, or all features to
 * one part, in metres east, north and up of the origin. Positions in plan are exact on the
 * ellipsoid. Heights count from the tangent plane of the origin, so that level ground is level (at
 * 3 km the tangent plane lies 0.7 m above the ellipsoid). Triangles have material ids of the scene.
 *
 * On a terrain, a solid stands on the lowest point of the terrain below the solid. Flat areas,
 * lines and media follow the terrain. Areas beyond the terrain are left out.
 *
 * A feature that cannot be made is left out. Sentences that count and name repaired features,
 * features that were left out and assumed heights are added to `notes`. Throws Error if the file
 * cannot be read or no feature is left. Throws WorkStopped if keepGoing returns false.
 */
std::vector<Part> ReadFootprints(const Object& object, const Scene& scene, const Terrain* terrain,
  std::vector<std::string>& notes, const std::function<bool()>& keepGoing);
}

#endif
