// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneReport.h
 * @brief Reports extents, faults and the position of the lidar before a scene is scanned.
 */
#ifndef AvianLidarSceneReport_h
#define AvianLidarSceneReport_h

#include "SceneBuilder.h"

namespace avianlidar::scene
{
/**
 * Adds a line for every part: numbers of triangles and of degenerate triangles, and extents, m. A
 * triangle is degenerate if its vertices lie on a line or at a point within rounding. Rays do not
 * meet a degenerate triangle. Warns of parts that have only degenerate triangles, and of parts more
 * than 100 km away, whose scale, unit, position or reference system may be wrong.
 */
void ReportExtents(BuiltScene& built);

/**
 * Adds a line with the numbers of surfaces above and below the lidar, and the part that contains
 * the lidar (an odd number of surfaces in all six directions). Warns if a part contains the lidar,
 * unless the scene says `inside`. Warns if surfaces lie above the lidar but not below the lidar.
 */
void ReportLidar(BuiltScene& built);
}

#endif
