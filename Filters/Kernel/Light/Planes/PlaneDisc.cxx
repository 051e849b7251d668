// SPDX-License-Identifier: BSD-3-Clause
#include "PlaneDisc.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// The axes of a disc: V, and V x axis. Where the axis is the normal any will do.
void setAxes(const BeamFrame& frame, const Vec3& across, double sine, PlaneDisc& disc)
{
  constexpr double nothing = 1e-15;
  disc.turn[0][0] = disc.turn[1][1] = 1.0;
  disc.turn[0][1] = disc.turn[1][0] = 0.0;
  if (sine > nothing)
  {
    const double x = glm::dot(across, frame.e1);
    const double y = glm::dot(across, frame.e2);
    const double length = std::sqrt(x * x + y * y);
    if (length > 0.0)
    {
      // e1 x axis = -e2, e2 x axis = e1.
      disc.turn[1][0] = x / length;
      disc.turn[1][1] = y / length;
      disc.turn[0][0] = disc.turn[1][1];
      disc.turn[0][1] = -disc.turn[1][0];
    }
  }
}
}

PlaneDisc planeDisc(const BeamFrame& frame, const PatchPlane& plane)
{
  PlaneDisc disc;
  const Vec3 across = glm::cross(-plane.normal, frame.axis);
  const double sine = std::sqrt(glm::dot(across, across));
  disc.height = plane.height;
  disc.tilt = lanes::angleOf(std::max(0.0, -glm::dot(plane.normal, frame.axis)), sine);
  disc.half = frame.halfBeamwidth;
  disc.tanHalf = frame.tanHalf;
  lanes::cosSinOfTurns(disc.tilt * lanes::TurnsPerRadian, disc.cosTilt, disc.sineTilt);
  const double half = lanes::sineOf(0.5 * disc.half);
  disc.sine2 = half * half;
  disc.least = std::max(0.0, disc.tilt - disc.half);
  disc.most = disc.tilt + disc.half;
  double none = 0.0;
  lanes::cosSinOfTurns(disc.least * lanes::TurnsPerRadian, disc.cosLeast, none);
  lanes::cosSinOfTurns(disc.most * lanes::TurnsPerRadian, disc.cosMost, none);
  setAxes(frame, across, sine, disc);
  return disc;
}

double PlaneDisc::aheadOf(double x, double y) const
{
  const double along = this->tanHalf * x;
  const double v = this->tanHalf * y;
  const double u = this->sineTilt + along * this->cosTilt;
  const double n = this->cosTilt - along * this->sineTilt;
  const double across = std::sqrt(u * u + v * v);
  const double length = std::sqrt(1.0 + along * along + v * v);
  // |(u, v)| - u, without cancellation.
  const double more = u > 0.0 ? v * v / (across + u) : across - u;
  const double sine = (along + more * this->cosTilt) / length;
  const double cosine = (n * this->cosTilt + across * this->sineTilt) / length;
  const double angle = lanes::angleOf(std::fabs(cosine), std::fabs(sine));
  return std::copysign(cosine < 0.0 ? Pi - angle : angle, sine);
}
}
