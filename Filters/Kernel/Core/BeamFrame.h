// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamFrame.h
 * @brief A beam: apex, axis, half-beamwidth, and the orthogonal frame about its axis.
 *
 * A ray of the beam is a point (x, y) of the beam's own plane at unit distance, in units of
 * tan(theta0.5). Its direction is axis + tan(theta0.5) (x e1 + y e2), not normalised, and x^2 +
 * y^2 <= 1. In a round beam e2 is a unit vector. In others it is as much shorter as the beam is
 * narrower there: an ellipse is the unit disc, too, and a rectangle the square in it. The cone of
 * the half-beamwidth holds them all.
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
  double halfBeamwidth = 0.0; ///< rad
  double tanHalf = 0.0;
  double sinHalf = 0.0;
  double cosHalf = 1.0;
  double flatness2 = 1.0; ///< squared length of e2
  bool isRectangle = false;

  /// x and y of a vector's direction, both times its component along the axis, and that.
  Vec3 toPlane(const Vec3& v) const
  {
    return { glm::dot(v, this->e1) / this->tanHalf,
      glm::dot(v, this->e2) / (this->tanHalf * this->flatness2), glm::dot(v, this->axis) };
  }

  /// Squared tangent of the angle of a ray from the axis, over that of the half-beamwidth.
  double radius2(double x, double y) const { return x * x + this->flatness2 * (y * y); }

  /// Direction of the ray (x, y), not normalised: its component along the axis is 1.
  Vec3 direction(double x, double y) const
  {
    return this->axis + this->tanHalf * (x * this->e1 + y * this->e2);
  }

  /// True if the point at `v` from the apex lies in the beam, its outline included.
  bool contains(const Vec3& v) const
  {
    const Vec3 p = this->toPlane(v);
    const double square =
      this->isRectangle ? 2.0 * std::max(p.x * p.x, p.y * p.y) : p.x * p.x + p.y * p.y;
    return p.z > 0.0 && square <= p.z * p.z;
  }
};

/// Half-beamwidth of many beams, with its sine, cosine and tangent.
struct BeamWidth
{
  double half, tangent, sine, cosine;
  bool isRound = true;
  // Of beams that are not:
  bool isRectangle = false;
  double flatness = 1.0;    ///< tangents along e2 over those along e1, at most 1
  double turn = 0.0;        ///< rad, of e1 from the horizontal towards `up`
  Vec3 up{ 0.0, 0.0, 1.0 }; ///< unit vector, at right angles to the horizontal
  explicit BeamWidth(double halfBeamwidth)
    : half(halfBeamwidth)
    , tangent(std::tan(halfBeamwidth))
    , sine(std::sin(halfBeamwidth))
    , cosine(std::cos(halfBeamwidth))
  {
  }
};

/// Turn e1 and e2 of a frame to the axes of a beam that is not round. Looking along a beam that
/// points up or down, e1 stays as it is before it is turned.
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
