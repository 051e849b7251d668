// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Vector.h
 * @brief The vector type of the kernel: double precision, right-handed, metres unless said
 * otherwise.
 */
#ifndef avianlidar_Vector_h
#define avianlidar_Vector_h

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>

namespace avianlidar
{
using Vec3 = glm::dvec3;

/// Length without overflow or underflow for any finite vector.
inline double safeLength(const Vec3& v)
{
  return std::hypot(v.x, v.y, v.z);
}

inline bool isFinite(const Vec3& v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
}

#endif
