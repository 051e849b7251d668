// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Vector.h
 * @brief The vector type of the kernel: doubles in right-handed frames, metres unless stated
 * otherwise.
 *
 * Source: GLM.
 * Differs: safeLength() and unitVector() neither overflow nor underflow, unlike GLM's functions.
 * Valid: stated at each function.
 * Test: TestTriangleTest.cxx (unit vectors of any length).
 */
#ifndef avianlidar_Vector_h
#define avianlidar_Vector_h

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <limits>

namespace avianlidar
{
using Vec3 = glm::dvec3;

constexpr double Pi = 3.14159265358979323846;
constexpr double RadiansPerDegree = Pi / 180.0;
constexpr double DegreesPerRadian = 180.0 / Pi;
constexpr double Root2 = 1.4142135623730951;
constexpr double Infinity = std::numeric_limits<double>::infinity();
constexpr float FloatInfinity = std::numeric_limits<float>::infinity();

/// Length without overflow or underflow for any finite vector.
inline double safeLength(const Vec3& v)
{
  return std::hypot(v.x, v.y, v.z);
}

/// Unit vector along any finite vector that is not zero, however long or short.
inline Vec3 unitVector(const Vec3& v)
{
  const double largest = std::fmax(std::fabs(v.x), std::fmax(std::fabs(v.y), std::fabs(v.z)));
  const Vec3 scaled =
    v / largest; // components of at most 1: no overflow, no underflow that matters
  return scaled / safeLength(scaled);
}

inline bool isFinite(const Vec3& v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
}

#endif
