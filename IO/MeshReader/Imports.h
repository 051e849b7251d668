// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Imports.h
 * @brief Reads mesh files with Assimp or VTK.
 */
#ifndef AvianLidarImports_h
#define AvianLidarImports_h

#include "SceneTypes.h"

#include <cmath>

namespace avianlidar::scene
{
/// Returns the mesh of a file, before points are merged. Throws Error or std::bad_alloc.
Mesh ReadAssimpMesh(const std::string& file);
Mesh ReadVtkMesh(const std::string& file);

/// Returns the distance between a number in single precision and the next greater one.
inline double SpacingAt(double number)
{
  const auto single = static_cast<float>(std::abs(number));
  return std::nextafter(single, HUGE_VALF) - single;
}
}

#endif
