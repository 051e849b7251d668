// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ObjectDescription.h
 * @brief The part of a scene file that describes one object.
 */
#ifndef AvianLidarObjectDescription_h
#define AvianLidarObjectDescription_h

#include "JsonNode.h"
#include "SceneTypes.h"

namespace avianlidar::scene
{
/// One value of "objects"; the scene's origin, materials and file name are known by then.
Object ParseObject(const JsonNode& node, Scene& scene);

/// The id of a material, case aside; -1 if there is none of that name.
int FindMaterial(const Scene& scene, const std::string& name);
/// The id of the material that a string names; a shipped one joins the scene when it is first
/// named, an unknown one is an Error.
int ParseMaterialName(const JsonNode& node, Scene& scene);
/// The "material_map" of the scene or of an object; none if it has none.
std::vector<MaterialRule> ParseRules(const JsonNode& owner, Scene& scene);
Geodetic ParseGeodetic(const JsonNode& node);

/**
 * The rotation whose second axis (the model's north, +y) points along a direction, with the model's
 * up as near to up as that allows; the direction must not be vertical.
 */
Mat3 RotationToDirection(const Vec3& direction);
}

#endif
