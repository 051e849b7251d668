// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneDescription.h
 * @brief Parses and checks a scene file. Documentation/reference/scene-files.md describes the keys.
 */
#ifndef AvianLidarSceneDescription_h
#define AvianLidarSceneDescription_h

#include "SceneTypes.h"

namespace avianlidar::scene
{
/**
 * Parses a scene file. `text`, unless empty, replaces the contents of the file. Throws Error, which
 * names the file and the key, for an unknown or missing key, a wrong type, a number out of range,
 * an unknown material or a missing file. The four materials of the paper's Table 1 have the ids 0
 * to 3. Other materials follow in the order in which the scene file names them. File names are
 * relative to the folder of the scene file and are returned as absolute names.
 */
Scene ReadDescription(const std::string& file, const std::string& text = {});
}

#endif
