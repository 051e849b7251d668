// SPDX-License-Identifier: BSD-3-Clause
#include "BeamRays.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace avianlidar
{
namespace
{
/// Cells inside the next smaller circle when `cells` lie inside this one and all are about as wide
/// as high (Beckers and Beckers, "A general rule for disk and hemisphere partition into equal-area
/// cells", Computational Geometry 45(7), 2012, Eq. 5).
std::size_t cellsInsideRing(std::size_t cells)
{
  const double root = std::sqrt(static_cast<double>(cells)) - std::sqrt(Pi);
  if (root <= 0.0)
  {
    return 0;
  }
  return std::min(cells - 1, static_cast<std::size_t>(std::llround(root * root)));
}

/// u = (1 - cos theta)/(1 - cos theta0.5) at which the share v of the energy lies inside.
double radialQuantile(double v, BeamProfile profile)
{
  if (profile == BeamProfile::Uniform)
  {
    return v;
  }
  // -1/2 ln(1 - v (1 - e^-2)), without cancellation at the axis.
  return std::min(1.0, -0.5 * std::log1p(v * std::expm1(-2.0)));
}

/// tan theta / tan theta0.5 at sin^2(theta/2) = u sin^2(theta0.5/2).
class PlaneRadius
{
public:
  explicit PlaneRadius(double halfBeamwidth)
    : SinQuarter(std::sin(0.5 * halfBeamwidth))
    , TanHalf(std::tan(halfBeamwidth))
  {
  }
  double operator()(double u) const
  {
    const double s = std::sqrt(u) * this->SinQuarter;
    const double tangent = 2.0 * s * std::sqrt((1.0 - s) * (1.0 + s)) / (1.0 - 2.0 * s * s);
    // A few units of round-off inside, so that x^2 + y^2 <= 1 after rounding.
    return std::min(tangent / this->TanHalf, 1.0 - 0x1p-50);
  }

private:
  double SinQuarter;
  double TanHalf;
};
}

StrataPartition::StrataPartition(std::size_t numberOfRays)
  : NumberOfRays(numberOfRays)
{
  if (numberOfRays < 1)
  {
    throw std::invalid_argument("number of rays is 0, expected at least 1");
  }
  // Circles from the rim inwards, then cells from the axis outwards.
  std::vector<std::size_t> circles;
  for (std::size_t k = std::max<std::size_t>(1, numberOfRays / 2); k > 0; k = cellsInsideRing(k))
  {
    circles.push_back(k);
  }
  this->Cells.reserve(circles.front());
  const double all = static_cast<double>(numberOfRays);
  std::size_t inner = 0;
  std::size_t raysInside = 0;
  for (auto circle = circles.rbegin(); circle != circles.rend(); ++circle)
  {
    const bool rim = *circle == circles.front();
    const std::size_t raysWithin = rim ? numberOfRays : 2 * *circle;
    const double v0 = static_cast<double>(raysInside) / all;
    const double v1 = static_cast<double>(raysWithin) / all;
    const double raysOfRing = static_cast<double>(raysWithin - raysInside);
    for (std::size_t cell = inner; cell < *circle; ++cell)
    {
      const double before = static_cast<double>(2 * (cell - inner));
      const bool last = cell + 1 == *circle;
      const double after = last ? raysOfRing : before + 2.0;
      this->Cells.push_back(
        { v0, v1, 2.0 * Pi * before / raysOfRing, 2.0 * Pi * after / raysOfRing });
    }
    inner = *circle;
    raysInside = raysWithin;
  }
}

std::size_t StrataPartition::cellOfRay(std::size_t n) const
{
  return std::min(n / 2, this->Cells.size() - 1);
}

std::size_t StrataPartition::raysInCell(std::size_t cell) const
{
  const std::size_t last = this->Cells.size() - 1;
  return cell < last ? 2 : this->NumberOfRays - 2 * last;
}

void sampleBeam(std::int32_t seed, std::uint64_t beam, std::size_t numberOfRays,
  double halfBeamwidth, BeamProfile profile, Sampling sampling, const StrataPartition* strata,
  RandomPurpose purpose, BeamRays& rays)
{
  const bool stratified = sampling == Sampling::Stratified;
  if (stratified && (!strata || strata->numberOfRays() != numberOfRays))
  {
    throw std::invalid_argument("strata do not fit the number of rays");
  }
  rays.resize(numberOfRays);
  const PlaneRadius radius(halfBeamwidth);
  for (std::size_t n = 0; n < numberOfRays; ++n)
  {
    const auto random = uniformPair(seed, beam, n, purpose);
    double v = random[0];
    double phi = 2.0 * Pi * random[1];
    if (stratified)
    {
      const StrataPartition::Cell& cell = strata->cells()[strata->cellOfRay(n)];
      v = cell.v0 + (cell.v1 - cell.v0) * random[0];
      phi = cell.phi0 + (cell.phi1 - cell.phi0) * random[1];
    }
    const double rho = radius(radialQuantile(v, profile));
    rays.x[n] = rho * std::cos(phi);
    rays.y[n] = rho * std::sin(phi);
  }
}
}
