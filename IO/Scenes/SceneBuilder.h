// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneBuilder.h
 * @brief Builds placed triangles with materials from a scene file.
 */
#ifndef AvianLidarSceneBuilder_h
#define AvianLidarSceneBuilder_h

#include "SceneTypes.h"

#include <functional>

namespace avianlidar::scene
{
struct BuiltScene
{
  Scene description;
  /// Parts in the order of the file, in metres east, north and up. Triangles have material ids.
  std::vector<Part> parts;
  /// Lines of the report on the parts and the lidar.
  std::vector<std::string> report;
  /// Warnings: sentences on valid input that is probably a mistake.
  std::vector<std::string> warnings;
};

/**
 * Finds the parts of a scene without their triangles, for pieces of the output that are empty.
 * Reads only footprints that become several parts, and the objects on which these footprints stand.
 * The report and the warnings are empty. Arguments and errors are the same as for BuildScene().
 */
BuiltScene OutlineScene(const std::string& file, const std::function<bool(double)>& progress,
  const std::string& text = {});

/**
 * Reads a whole scene. Each mesh file is read once. `text`, unless empty, replaces the contents of
 * the scene file. The argument of the function `progress` is the share of the work done, 0 to 1.
 * The function returns false to stop the work. Throws Error (file, key and reason) or WorkStopped.
 */
BuiltScene BuildScene(const std::string& file, const std::function<bool(double)>& progress,
  const std::string& text = {});
}

#endif
