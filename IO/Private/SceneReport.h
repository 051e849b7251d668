// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneReport.h
 * @brief Reports extents, faults and the place of the lidar before a scene is scanned.
 */
#ifndef AvianLidarSceneReport_h
#define AvianLidarSceneReport_h

#include "SceneBuilder.h"

namespace avianlidar::scene
{
/**
 * A line for every part: triangles, extents, degenerate triangles (two vertices at one place or all
 * three on a line, within rounding: no ray meets them). Warns of parts all of whose triangles are
 * degenerate, and of parts beyond 100 km: a wrong scale, unit, position or reference system.
 */
void ReportExtents(BuiltScene& built);

/**
 * Where the lidar stands: surfaces straight above and below, and whether it is inside a part (an
 * odd number of surfaces in all six directions). Warns where it is inside one, unless the scene
 * says `inside`, or where everything is above it.
 */
void ReportLidar(BuiltScene& built);
}

#endif
