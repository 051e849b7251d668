// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneDescription.h
 * @brief A scene file, parsed and checked; Documentation/reference/scene-files.md describes its
 * keys.
 */
#ifndef AvianLidarSceneDescription_h
#define AvianLidarSceneDescription_h

#include "SceneTypes.h"

namespace avianlidar::scene
{
/**
 * Parse a scene file, or a text in its place if that is not empty. Every fault (an unknown or
 * missing key, a wrong type, a number out of its range, an unknown material, a file that is not
 * there) is an Error that names the file and the key. The four materials of the paper's Table 1
 * have the ids 0 to 3, others follow in the order in which they are written. File names are taken
 * relative to the folder of the scene file and returned absolute.
 */
Scene ReadDescription(const std::string& file, const std::string& text = {});

/// Whether a name fits a pattern in which `*` is any run of characters and `?` any one of them.
bool MatchesPattern(const std::string& pattern, const std::string& name);
}

#endif
