// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneBuilder.h
 * @brief From a scene file to placed triangles with materials.
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
  /// In the order of the file, in metres east, north and up; triangles carry material ids.
  std::vector<Part> parts;
  /// What was read, a line each.
  std::vector<std::string> report;
  /// What is legal but looks like a mistake.
  std::vector<std::string> warnings;
};

/**
 * The parts of a scene by name, without triangles: for pieces of it that are empty. Of the files
 * that it names only footprints that become several parts are read, and what they stand on. No
 * report, no warnings; else as BuildScene().
 */
BuiltScene OutlineScene(const std::string& file, const std::function<bool(double)>& progress,
  const std::string& text = {});

/**
 * Read all of a scene, each mesh file once; `text`, if not empty, stands for the contents of the
 * file. `progress` gets the share that is done, and returns
 * whether to go on. Throws Error (file, key and reason) or WorkStopped.
 */
BuiltScene BuildScene(const std::string& file, const std::function<bool(double)>& progress,
  const std::string& text = {});
}

#endif
