// SPDX-License-Identifier: BSD-3-Clause
#include "BeamShape.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Half-beamwidth at which a profile uniform in solid angle is uniform over the plane, to rounding.
constexpr double Flat = 1e-9; // half-beamwidth, rad

/// Diagonal of the unit square.
constexpr double Diagonal = 1.4142135623730951;

/// Solves erf(root2 k x) = share erf(root2 k) for x in [0, 1] by Newton's method. As erf is
/// concave, the steps rise to the solution.
double placeOfShare(double share, double k)
{
  const double all = std::erf(Diagonal * k);
  const double slope = 2.0 / std::sqrt(Pi) * Diagonal * k;
  double x = 0.0;
  for (int step = 0; step < 60; ++step)
  {
    const double off = share * all - std::erf(Diagonal * k * x);
    const double next = x + off / (slope * std::exp(-2.0 * k * k * x * x));
    if (!(next > x))
    {
      break;
    }
    x = std::min(1.0, next);
  }
  return x;
}
}

BeamShape::BeamShape(const Sensor& sensor)
  : Width(sensor.halfBeamwidth)
  , Profile{ sensor.halfBeamwidth, sensor.beamProfile, sensor.gaussianTruncation }
  , MostDensity(rayDensity(this->Profile, 0.0))
{
  if (sensor.hasRoundBeam())
  {
    this->ShareOfArea = this->Width.tangent * this->Width.tangent / sensor.solidAngle();
    return;
  }
  const double one = std::tan(sensor.halfBeamwidth);
  const double two = sensor.halfBeamwidthAcross > 0.0 ? std::tan(sensor.halfBeamwidthAcross) : one;
  const bool isRectangle = sensor.beamOutline == BeamOutline::Rectangle;
  this->Width = BeamWidth(std::atan((isRectangle ? Diagonal : 1.0) * std::max(one, two)));
  this->Width.isRound = false;
  this->Width.isRectangle = isRectangle;
  this->Width.flatness = std::min(one, two) / std::max(one, two);
  this->Width.turn = Pi / 180.0 * sensor.beamRotation + (two > one ? 0.5 * Pi : 0.0);
  this->Width.up = sensor.up;
  this->Profile.halfBeamwidth = Flat;
  this->ShareOfArea = 1.0 / this->area();
  const double k = sensor.gaussianTruncation;
  if (!isRectangle && sensor.beamProfile == BeamProfile::Gaussian)
  {
    this->Fall = 2.0 * k * k;
    this->PerMean = this->MostDensity = this->Fall / -std::expm1(-this->Fall);
  }
  if (isRectangle && sensor.beamProfile == BeamProfile::Gaussian)
  {
    const double perMean = 2.0 * Diagonal * k / (std::sqrt(Pi) * std::erf(Diagonal * k));
    this->Profile.profile = BeamProfile::Uniform; // profile of the rays before fit()
    this->Truncation = k;
    this->Fall = 4.0 * k * k;
    this->PerMean = perMean * perMean;
    this->MostDensity = this->PerMean;
  }
}

/// The disc is mapped to the square so that areas keep their ratio: Shirley and Chiu, "A Low
/// Distortion Map Between Disk and Square", Journal of Graphics Tools 2(3), 1997. Each coordinate
/// then moves to the place with the same share of the Gaussian.
void BeamShape::fit(BeamRays& rays) const
{
  for (std::size_t n = 0; this->Width.isRectangle && n < rays.size(); ++n)
  {
    const double x = rays.x[n];
    const double y = rays.y[n];
    const double radius = std::sqrt(x * x + y * y);
    const bool isAlongX = std::fabs(x) >= std::fabs(y);
    const double longer = std::copysign(radius, isAlongX ? x : y);
    const double ratio = radius > 0.0 ? (isAlongX ? y / x : x / y) : 0.0;
    const double shorter = longer * std::atan(ratio) * 4.0 / Pi;
    const auto placed = [&](double share)
    {
      const double place = this->Truncation > 0.0
        ? std::copysign(placeOfShare(std::fabs(share), this->Truncation), share)
        : share;
      return HalfSide * place;
    };
    rays.x[n] = placed(isAlongX ? longer : shorter);
    rays.y[n] = placed(isAlongX ? shorter : longer);
  }
}
}
