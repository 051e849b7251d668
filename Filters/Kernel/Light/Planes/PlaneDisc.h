// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PlaneDisc.h
 * @brief A beam in the coordinates of a plane that it meets: a direction is given by its angle of
 * incidence b and its turn phi about the plane's normal.
 *
 * With N the direction to the foot of the perpendicular, axis = cos a N + sin a U and V = N x U, a
 * direction is cos b N + sin b (cos phi U + sin phi V). In the beam's own plane (BeamFrame.h) the
 * axes -sin a N + cos a U and V replace e1 and e2; the coordinates x, y here are along them, in
 * half-beamwidths t. The directions of incidence b inside the cone are an arc -phi_m ... phi_m,
 *
 *   tan^2(phi_m/2) = sin((t+b-a)/2) sin((t-b+a)/2) / (sin((b+a-t)/2) sin((b+a+t)/2)),
 *
 * or, where the normal lies in the cone and b < t - a, a whole circle.
 *
 * Source: none; derived in Documentation/plane-integration.md.
 * Valid: half-beamwidths from 1e-9 rad on. Angles of incidence are given as b - a, so that no
 * difference of nearly equal angles is taken.
 * Test: TestPlaneIntegration.cxx, TestPlaneQuadrature.cxx, TestPlaneSurfaces.cxx.
 */
#ifndef avianlidar_PlaneDisc_h
#define avianlidar_PlaneDisc_h

#include "BeamFrame.h"
#include "LaneMath.h"
#include "Sensor.h"

namespace avianlidar
{
/// A plane that a beam meets.
struct PatchPlane
{
  Vec3 normal{ 0.0 };  ///< unit, towards the apex
  double height = 0.0; ///< distance from the apex, m
  double size = 0.0;   ///< largest distance of a corner from the apex along a coordinate, m
};

/// A beam relative to such a plane.
struct PlaneDisc
{
  double height;   ///< h, m
  double tilt;     ///< a, rad
  double half;     ///< t, rad
  double sineTilt; ///< sin a
  double cosTilt;
  double tanHalf;
  double sine2;      ///< sin^2(t/2)
  double least;      ///< least b of the disc, rad
  double most;       ///< largest b of the disc, rad
  double cosLeast;   ///< cosines of these
  double cosMost;    ///< not positive: the disc extends beyond the horizon
  double turn[2][2]; ///< components of the axes along e1 and e2 of the frame
  double nearest() const { return this->height / this->cosLeast; }
  double farthest() const { return this->height / this->cosMost; }

  /// b - a where the arcs begin, at b = |a - t|.
  double aheadOfArcs() const
  {
    return this->tilt < this->half ? this->half - 2.0 * this->tilt : -this->half;
  }
  /// b - a of the point (x, y).
  double aheadOf(double x, double y) const;
};

PlaneDisc planeDisc(const BeamFrame& frame, const PatchPlane& plane);

/// A circle of incidence b in the disc.
struct IncidenceCircle
{
  double sine;     ///< sin b
  double sinAhead; ///< sin(b - a)
  double cosAhead;
  double reach; ///< phi_m; pi: a whole circle
};

namespace lanes
{
constexpr double TurnsPerRadian = 1.0 / (2.0 * Pi);

/// Sine of an angle in [-2 pi, 4 pi].
AVIANLIDAR_ALWAYS_INLINE double sineOf(double angle)
{
  double cosine = 0.0;
  double sine = 0.0;
  cosSinOfTurns(angle * TurnsPerRadian, cosine, sine);
  return sine;
}

/// Angle in [0, pi/2] of a positive multiple of (cosine, sine), both at least 0.
AVIANLIDAR_ALWAYS_INLINE double angleOf(double cosine, double sine)
{
  const double inverse = 1.0 / std::sqrt(cosine * cosine + sine * sine);
  const bool small = sine < cosine;
  const double x = inverse * (small ? sine : cosine);
  const double angle = asin(x);
  return small ? angle : 1.57079632679489661923 - angle;
}
}
}

#endif
