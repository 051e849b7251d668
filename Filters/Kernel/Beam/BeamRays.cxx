// SPDX-License-Identifier: BSD-3-Clause
#include "BeamRays.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace avianlidar
{
namespace
{
/// Number of cells inside the next smaller circle if `cells` cells lie inside this circle and all
/// cells are about as wide as high (Beckers and Beckers, "A general rule for disk and hemisphere
/// partition into equal-area cells", Computational Geometry 45(7), 2012, Eq. 5).
std::size_t cellsInsideRing(std::size_t cells)
{
  const double root = std::sqrt(static_cast<double>(cells)) - std::sqrt(Pi);
  if (root <= 0.0)
  {
    return 0;
  }
  return std::min(cells - 1, static_cast<std::size_t>(std::llround(root * root)));
}

/// Radius in the beam's plane of the circle that contains a share of the energy.
class PlaneRadius
{
public:
  explicit PlaneRadius(const RadialProfile& profile)
    : SinQuarter(std::sin(0.5 * profile.halfBeamwidth))
    , InverseTangent(1.0 / std::tan(profile.halfBeamwidth))
    , PerFall(0.5 / (profile.truncation * profile.truncation))
    , Within(-std::expm1(-1.0 / PerFall))
  {
  }

  /// Returns tan theta / tan theta0.5, where sin^2(theta/2) = u sin^2(theta0.5/2). For a uniform
  /// profile u = (1 - cos theta)/(1 - cos theta0.5) is the share v itself. For a Gaussian profile u
  /// is -ln(1 - v (1 - e^(-2 k^2)))/(2 k^2).
  template <BeamProfile Profile>
  AVIANLIDAR_ALWAYS_INLINE double of(double v) const
  {
    double u = v;
    if constexpr (Profile == BeamProfile::Gaussian)
    {
      const double q = -this->PerFall * lanes::logOneMinus(v * this->Within);
      u = q < 1.0 ? q : 1.0;
    }
    const double s = std::sqrt(u) * this->SinQuarter;
    const double tangent = 2.0 * s * std::sqrt((1.0 - s) * (1.0 + s)) / (1.0 - 2.0 * s * s);
    const double radius = tangent * this->InverseTangent;
    // The limit lies some units of round-off inside, so that x^2 + y^2 <= 1 after rounding.
    constexpr double rim = 1.0 - 0x1p-50;
    return radius < rim ? radius : rim;
  }

private:
  double SinQuarter;
  double InverseTangent;
  double PerFall; ///< 1/(2 k^2)
  double Within;
};

/// Values that all rays of a beam share. `cells` is null for Monte Carlo rays.
struct Draw
{
  std::int32_t seed;
  std::uint64_t beam;
  RandomPurpose purpose;
  PlaneRadius radius;
  const StrataPartition::RayCells* cells;
};

template <BeamProfile Profile, bool Stratified>
AVIANLIDAR_ALWAYS_INLINE void drawLanes(const Draw& draw, double* x, double* y, std::size_t count)
{
  const PlaneRadius radius = draw.radius;
  const std::int32_t seed = draw.seed;
  const std::uint64_t beam = draw.beam;
  const RandomPurpose purpose = draw.purpose;
  const double* v0 = Stratified ? draw.cells->v0.data() : nullptr;
  const double* dv = Stratified ? draw.cells->dv.data() : nullptr;
  const double* turn0 = Stratified ? draw.cells->turn0.data() : nullptr;
  const double* dturns = Stratified ? draw.cells->dturns.data() : nullptr;
#pragma omp simd
  for (std::size_t n = 0; n < count; ++n)
  {
    double v;
    double turns;
    lanes::uniformPair(seed, beam, n, purpose, v, turns);
    if constexpr (Stratified)
    {
      v = v0[n] + dv[n] * v;
      turns = turn0[n] + dturns[n] * turns;
    }
    const double rho = radius.of<Profile>(v);
    double cosine;
    double sine;
    lanes::cosSinOfTurns(turns, cosine, sine);
    x[n] = rho * cosine;
    y[n] = rho * sine;
  }
}

AVIANLIDAR_MULTIVERSION void drawCoordinates(
  const Draw& draw, BeamProfile profile, double* x, double* y, std::size_t count)
{
  if (profile == BeamProfile::Uniform)
  {
    draw.cells ? drawLanes<BeamProfile::Uniform, true>(draw, x, y, count)
               : drawLanes<BeamProfile::Uniform, false>(draw, x, y, count);
  }
  else
  {
    draw.cells ? drawLanes<BeamProfile::Gaussian, true>(draw, x, y, count)
               : drawLanes<BeamProfile::Gaussian, false>(draw, x, y, count);
  }
}

void drawAll(const Draw& draw, BeamProfile profile, std::size_t count, BeamRays& rays)
{
  rays.resize(count);
  drawCoordinates(draw, profile, rays.x.data(), rays.y.data(), count);
}

AVIANLIDAR_MULTIVERSION void turnAll(const double* fromX, const double* fromY, double cosine,
  double sine, double* x, double* y, std::size_t count)
{
#pragma omp simd
  for (std::size_t n = 0; n < count; ++n)
  {
    x[n] = cosine * fromX[n] - sine * fromY[n];
    y[n] = sine * fromX[n] + cosine * fromY[n];
  }
}
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
  for (std::size_t n = 0; n < numberOfRays; ++n)
  {
    const Cell& cell = this->Cells[this->cellOfRay(n)];
    this->Lanes.v0.push_back(cell.v0);
    this->Lanes.dv.push_back(cell.v1 - cell.v0);
    this->Lanes.turn0.push_back(cell.phi0 / (2.0 * Pi));
    this->Lanes.dturns.push_back((cell.phi1 - cell.phi0) / (2.0 * Pi));
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

double rayDensity(const RadialProfile& profile, double radius2)
{
  if (profile.profile == BeamProfile::Uniform)
  {
    return 1.0;
  }
  const double half = std::sin(0.5 * profile.halfBeamwidth);
  const double tangent = std::tan(profile.halfBeamwidth);
  const double fall = 2.0 * profile.truncation * profile.truncation;
  const double tan2 = tangent * tangent * radius2;
  const double length = std::sqrt(1.0 + tan2);
  const double u = tan2 / (length * (1.0 + length)) / (2.0 * half * half);
  return fall * std::exp(-fall * std::min(1.0, u)) / -std::expm1(-fall);
}

void sampleBeam(std::int32_t seed, std::uint64_t beam, std::size_t numberOfRays,
  const RadialProfile& profile, Sampling sampling, const StrataPartition* strata, BeamRays& rays)
{
  const bool stratified = sampling == Sampling::Stratified;
  if (stratified && (!strata || strata->numberOfRays() != numberOfRays))
  {
    throw std::invalid_argument("strata do not fit the number of rays");
  }
  drawAll({ seed, beam, RandomPurpose::Rays, PlaneRadius(profile),
            stratified ? &strata->rayCells() : nullptr },
    profile.profile, numberOfRays, rays);
}

void samplePattern(std::int32_t seed, std::size_t pattern, std::size_t patterns,
  const RadialProfile& profile, const StrataPartition& strata, BeamRays& rays)
{
  StrataPartition::RayCells cells = strata.rayCells();
  for (std::size_t n = 0; n < cells.v0.size(); ++n)
  {
    // (odd * pattern + first) % patterns is a permutation of the patterns for each ray.
    const auto u = uniformPair(seed, patterns, n, RandomPurpose::Patterns);
    const auto odd = 2 * static_cast<std::size_t>(u[0] * static_cast<double>(patterns)) + 1;
    const auto first = static_cast<std::size_t>(u[1] * static_cast<double>(patterns));
    cells.dv[n] /= static_cast<double>(patterns);
    cells.v0[n] += cells.dv[n] * static_cast<double>((odd * pattern + first) % patterns);
  }
  drawAll({ seed, pattern, RandomPurpose::Patterns, PlaneRadius(profile), &cells }, profile.profile,
    strata.numberOfRays(), rays);
}

void turnRays(const BeamRays& pattern, double turns, BeamRays& rays)
{
  double cosine;
  double sine;
  lanes::cosSinOfTurns(turns, cosine, sine);
  rays.resize(pattern.size());
  turnAll(
    pattern.x.data(), pattern.y.data(), cosine, sine, rays.x.data(), rays.y.data(), pattern.size());
}
}
