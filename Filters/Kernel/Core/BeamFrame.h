// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamFrame.h
 * @brief A beam: apex, axis, half-beamwidth, and the orthogonal frame about its axis.
 *
 * A ray of the beam is a point (x, y), x^2 + y^2 <= 1, of the plane across the axis at unit
 * distance. Its coordinates are in units of tan(theta0.5). The direction of this ray is axis +
 * tan(theta0.5) (x e1 + y e2), not normalised. In a round beam e2 is a unit vector. In other beams
 * the length of e2 is the ratio of the tangents of the two beamwidths. So an elliptic beam, too, is
 * the unit disc. A rectangular beam is the square in this disc. The cone of the half-beamwidth
 * contains round, elliptic and rectangular beams.
 *
 * Source: frame of Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
 * Differs: the axis is normalised twice, so that it is a unit vector to the last bits.
 * Valid: finite directions other than zero, half-beamwidth in (0, pi/3]. The frame is continuous on
 * either side of z = 0 and jumps where the axis crosses this plane.
 * Test: TestBeamVolumeTest.cxx, TestTriangleTest.cxx, InstructionSets.cxx (bits).
 */
#ifndef avianlidar_BeamFrame_h
#define avianlidar_BeamFrame_h

#include "Vector.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
struct BeamFrame
{
  Vec3 origin{ 0.0 }; ///< apex, scene coordinates, m
  Vec3 axis{ 0.0, 0.0, 1.0 };
  Vec3 e1{ 1.0, 0.0, 0.0 };
  Vec3 e2{ 0.0, 1.0, 0.0 };
  double halfBeamwidth = 0.0; ///< half-beamwidth, rad
  double tanHalf = 0.0;       ///< tangent of the half-beamwidth
  double sinHalf = 0.0;       ///< sine of the half-beamwidth
  double cosHalf = 1.0;       ///< cosine of the half-beamwidth
  double flatness2 = 1.0;     ///< squared length of e2
  bool isRectangle = false;

  /// Returns (x z, y z, z) of a vector, with z its component along the axis and (x, y) its ray.
  Vec3 toPlane(const Vec3& v) const
  {
    return { glm::dot(v, this->e1) / this->tanHalf,
      glm::dot(v, this->e2) / (this->tanHalf * this->flatness2), glm::dot(v, this->axis) };
  }

  /// Squared tangent of the angle between ray and axis, divided by tanHalf^2.
  double radius2(double x, double y) const { return x * x + this->flatness2 * (y * y); }

  /// Direction of the ray (x, y), not normalised: its component along the axis is 1.
  Vec3 direction(double x, double y) const
  {
    return this->axis + this->tanHalf * (x * this->e1 + y * this->e2);
  }

  /// True if the point `v`, relative to the apex, lies in the beam or on its outline.
  bool contains(const Vec3& v) const
  {
    const Vec3 p = this->toPlane(v);
    const double square =
      this->isRectangle ? 2.0 * std::max(p.x * p.x, p.y * p.y) : p.x * p.x + p.y * p.y;
    return p.z > 0.0 && square <= p.z * p.z;
  }
};

/// Half-beamwidth and outline that many beams share.
struct BeamWidth
{
  double half, tangent, sine, cosine; ///< half-beamwidth, rad, and its tangent, sine and cosine
  bool isRound = true;
  // For beams that are not round:
  bool isRectangle = false;
  double flatness = 1.0;    ///< ratio of tangents along e2 to tangents along e1, at most 1
  double turn = 0.0;        ///< angle of e1 from the horizontal towards `up`, rad
  Vec3 up{ 0.0, 0.0, 1.0 }; ///< unit vector at right angles to the horizontal
  explicit BeamWidth(double halfBeamwidth)
    : half(halfBeamwidth)
    , tangent(std::tan(halfBeamwidth))
    , sine(std::sin(halfBeamwidth))
    , cosine(std::cos(halfBeamwidth))
  {
  }
};

/// Turn e1 and e2 of a frame to the axes of a beam that is not round. If the beam points along or
/// against `up`, e1 itself is turned instead of the horizontal direction.
inline void setAxes(const BeamWidth& width, BeamFrame& frame)
{
  const Vec3 across = glm::cross(frame.axis, width.up);
  const Vec3 right = glm::dot(across, across) > 1e-24 ? unitVector(across) : frame.e1;
  const Vec3 up = glm::cross(right, frame.axis);
  const double cosine = std::cos(width.turn);
  const double sine = std::sin(width.turn);
  frame.e1 = cosine * right + sine * up;
  frame.e2 = width.flatness * (cosine * up - sine * right);
  frame.flatness2 = width.flatness * width.flatness;
  frame.isRectangle = width.isRectangle;
}

/// Frame of a beam. @param direction direction of any length, finite and not zero (checked by the
/// caller)
inline BeamFrame makeBeamFrame(const Vec3& origin, const Vec3& direction, const BeamWidth& width)
{
  BeamFrame frame;
  frame.origin = origin;
  // The second normalisation removes the rounding error of the first normalisation.
  frame.axis = unitVector(unitVector(direction));
  const Vec3& n = frame.axis;
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  const double b = n.x * n.y * a;
  frame.e1 = { 1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x };
  frame.e2 = { b, sign + n.y * n.y * a, -n.y };
  if (!width.isRound)
  {
    setAxes(width, frame);
  }
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
