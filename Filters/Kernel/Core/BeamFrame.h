// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamFrame.h
 * @brief A beam: apex, axis, half-beamwidth, and the orthonormal frame about its axis.
 *
 * A ray of the beam is a point (x, y) of the beam's own plane at unit distance, in units of
 * tan(theta0.5). Its direction is axis + tan(theta0.5) (x e1 + y e2), not normalised, and x^2 +
 * y^2 <= 1.
 *
 * Source: frame of Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
 * Differs: the axis is normalised twice, so that it is a unit vector to the last bits.
 * Valid: finite directions other than zero, half-beamwidth in (0, pi/3]. The frame is continuous
 * on either side of z = 0 and jumps where the axis crosses it.
 * Test: TestBeamVolumeTest.cxx, TestTriangleTest.cxx, InstructionSets.cxx (bits).
 */
#ifndef avianlidar_BeamFrame_h
#define avianlidar_BeamFrame_h

#include "Vector.h"

namespace avianlidar
{
struct BeamFrame
{
  Vec3 origin{ 0.0 }; ///< apex, scene coordinates, m
  Vec3 axis{ 0.0, 0.0, 1.0 };
  Vec3 e1{ 1.0, 0.0, 0.0 };
  Vec3 e2{ 0.0, 1.0, 0.0 };
  double halfBeamwidth = 0.0; ///< rad
  double tanHalf = 0.0;
  double sinHalf = 0.0;
  double cosHalf = 1.0;

  /// Components of a vector along e1, e2 (divided by tan(theta0.5)) and the axis.
  Vec3 toPlane(const Vec3& v) const
  {
    return { glm::dot(v, this->e1) / this->tanHalf, glm::dot(v, this->e2) / this->tanHalf,
      glm::dot(v, this->axis) };
  }

  /// Direction of the ray (x, y), not normalised: its component along the axis is 1.
  Vec3 direction(double x, double y) const
  {
    return this->axis + this->tanHalf * (x * this->e1 + y * this->e2);
  }

  /// True if the point at `v` from the apex lies in the closed cone.
  bool contains(const Vec3& v) const
  {
    const Vec3 p = this->toPlane(v);
    return p.z > 0.0 && p.x * p.x + p.y * p.y <= p.z * p.z;
  }
};

/// Half-beamwidth of many beams, with its sine, cosine and tangent.
struct BeamWidth
{
  double half, tangent, sine, cosine;
  explicit BeamWidth(double halfBeamwidth)
    : half(halfBeamwidth)
    , tangent(std::tan(halfBeamwidth))
    , sine(std::sin(halfBeamwidth))
    , cosine(std::cos(halfBeamwidth))
  {
  }
};

/// Frame of a beam; `direction` need not be normalised but must be finite and not zero (checked by
/// the caller).
inline BeamFrame makeBeamFrame(const Vec3& origin, const Vec3& direction, const BeamWidth& width)
{
  BeamFrame frame;
  frame.origin = origin;
  // The second step removes the rounding of the first.
  frame.axis = unitVector(unitVector(direction));
  const Vec3& n = frame.axis;
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  const double b = n.x * n.y * a;
  frame.e1 = { 1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x };
  frame.e2 = { b, sign + n.y * n.y * a, -n.y };
  frame.halfBeamwidth = width.half;
  frame.tanHalf = width.tangent;
  frame.sinHalf = width.sine;
  frame.cosHalf = width.cosine;
  return frame;
}

inline BeamFrame makeBeamFrame(const Vec3& origin, const Vec3& direction, double halfBeamwidth)
{
  return makeBeamFrame(origin, direction, BeamWidth(halfBeamwidth));
}
}

#endif
