// SPDX-License-Identifier: BSD-3-Clause
// The rays of a beam: distribution, place in the cone, cells, and estimates without bias.
#include "BeamSampler.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

using namespace avianlidar;

namespace
{
constexpr double halfBeamwidths[] = { 1e-9, 1e-6, 5.6e-3, 0.3, 1.0, MaximumHalfBeamwidth };

/// Offset angle and azimuth of a ray, from its place in the plane alone.
struct Polar
{
  double theta;
  double phi;
};

Polar polar(const BeamRays& rays, std::size_t n, double t)
{
  double phi = std::atan2(rays.y[n], rays.x[n]);
  phi += phi < 0.0 ? 2.0 * Pi : 0.0;
  return { std::atan(std::hypot(rays.x[n], rays.y[n]) * std::tan(t)), phi };
}

/// Cumulative share of the energy inside theta.
double cumulativeShare(double theta, double t, BeamProfile profile)
{
  const double s = std::sin(0.5 * theta) / std::sin(0.5 * t);
  const double u = s * s;
  return profile == BeamProfile::Uniform ? u : std::expm1(-2.0 * u) / std::expm1(-2.0);
}

double chiSquare(double t, BeamProfile profile, Sampling sampling, std::size_t count)
{
  constexpr int radial = 20;
  constexpr int sectors = 12;
  constexpr std::size_t total = 240000;
  const StrataPartition strata(count);
  std::vector<int> counts(radial * sectors, 0);
  BeamRays rays;
  for (std::uint64_t beam = 0; beam < total / count; ++beam)
  {
    sampleBeam(11, beam, count, { t, profile }, sampling, &strata, rays);
    for (std::size_t n = 0; n < count; ++n)
    {
      const Polar p = polar(rays, n, t);
      const int r =
        std::min(radial - 1, static_cast<int>(radial * cumulativeShare(p.theta, t, profile)));
      const int s = std::min(sectors - 1, static_cast<int>(sectors * p.phi / (2.0 * Pi)));
      ++counts[r * sectors + s];
    }
  }
  const double mean = static_cast<double>(total) / (radial * sectors);
  double sum = 0.0;
  for (const int c : counts)
  {
    sum += (c - mean) * (c - mean) / mean;
  }
  return sum;
}
}

TEST(BeamRays, EvenInSolidAngleAndAzimuth)
{
  // 239 degrees of freedom: 0.01 % and 99.99 % quantiles.
  for (const double t : { 1e-9, 5.6e-3, 1.0 })
  {
    for (const BeamProfile profile : { BeamProfile::Uniform, BeamProfile::Gaussian })
    {
      const double independent = chiSquare(t, profile, Sampling::MonteCarlo, 100);
      EXPECT_GT(independent, 164.0) << t;
      EXPECT_LT(independent, 327.0) << t;
      const double oneCell = chiSquare(t, profile, Sampling::Stratified, 2);
      EXPECT_GT(oneCell, 164.0) << t;
      EXPECT_LT(oneCell, 327.0) << t;
      // Cells spread the rays more evenly than chance.
      EXPECT_LT(chiSquare(t, profile, Sampling::Stratified, 100), independent) << t;
    }
  }
}

TEST(BeamRays, EveryRayLiesInTheCone)
{
  BeamRays rays;
  for (const double t : halfBeamwidths)
  {
    for (const BeamProfile profile : { BeamProfile::Uniform, BeamProfile::Gaussian })
    {
      for (const std::size_t count : { 1, 2, 3, 100, 20001 })
      {
        const StrataPartition strata(count);
        for (const Sampling sampling : { Sampling::MonteCarlo, Sampling::Stratified })
        {
          sampleBeam(0, 5, count, { t, profile }, sampling, &strata, rays);
          ASSERT_EQ(rays.size(), count);
          for (std::size_t n = 0; n < count; ++n)
          {
            ASSERT_LE(rays.x[n] * rays.x[n] + rays.y[n] * rays.y[n], 1.0) << t;
          }
        }
      }
    }
  }
}

TEST(BeamRays, RadiusIsExactAtEveryBeamwidth)
{
  BeamRays rays;
  for (const double t : halfBeamwidths)
  {
    sampleBeam(4, 9, 1000, { t, BeamProfile::Uniform }, Sampling::MonteCarlo, nullptr, rays);
    for (std::size_t n = 0; n < rays.size(); ++n)
    {
      const long double v = uniformPair(4, 9, n, RandomPurpose::Rays)[0];
      const long double quarter = std::sin(0.5L * t);
      const long double theta = 2.0L * std::asin(std::sqrt(v) * quarter);
      const double expected =
        static_cast<double>(std::tan(theta) / std::tan(static_cast<long double>(t)));
      ASSERT_NEAR(std::hypot(rays.x[n], rays.y[n]) / expected, 1.0, 4e-15) << t;
    }
  }
}

TEST(BeamRays, EstimateAtAnEdgeHasNoBiasForAnyNumberOfRays)
{
  // The mean over beams of the share beyond the edge, each ray weighing 1/N: even and odd N, cells
  // cut anyhow.
  const double t = 5.6e-3;
  const double edge = std::tan(2e-3) / std::tan(t);
  const double share = 0.2775666733;
  for (const std::size_t count : { 1, 2, 3, 4, 5, 7, 11, 12, 13, 100, 101 })
  {
    const std::uint64_t beams = 200000 / count;
    const StrataPartition strata(count);
    BeamRays rays;
    double mean = 0.0;
    for (std::uint64_t beam = 0; beam < beams; ++beam)
    {
      sampleBeam(3, beam, count, { t, BeamProfile::Uniform }, Sampling::Stratified, &strata, rays);
      mean += static_cast<double>(
        std::count_if(rays.y.begin(), rays.y.end(), [edge](double y) { return y > edge; }));
    }
    mean /= static_cast<double>(beams * count);
    const double bound = std::sqrt(share * (1.0 - share) / static_cast<double>(beams * count));
    EXPECT_NEAR(mean, share, 4.5 * bound) << count;
  }
}

TEST(BeamRays, StratifiedBeatsMonteCarloSixfoldAtAnEdge)
{
  // Root mean square error of the covered share at an edge of random place, N = 100: 0.015 against
  // 0.038.
  const StrataPartition strata(100);
  const auto rms = [&strata](Sampling sampling)
  {
    BeamRays rays;
    double squares = 0.0;
    constexpr int beams = 4000;
    for (int beam = 0; beam < beams; ++beam)
    {
      const auto place = uniformPair(1, beam, 0, RandomPurpose::Connections);
      const double edge = 2.0 * place[0] - 1.0;
      const double turn = 2.0 * Pi * place[1];
      const double share = statistics::shareBeyond(edge);
      sampleBeam(1, beam, 100, { 1e-3, BeamProfile::Uniform }, sampling, &strata, rays);
      int beyond = 0;
      for (std::size_t n = 0; n < 100; ++n)
      {
        beyond += rays.x[n] * std::cos(turn) + rays.y[n] * std::sin(turn) > edge;
      }
      squares += (0.01 * beyond - share) * (0.01 * beyond - share);
    }
    return std::sqrt(squares / beams);
  };
  EXPECT_NEAR(rms(Sampling::MonteCarlo), 0.038, 0.002);
  EXPECT_NEAR(rms(Sampling::Stratified), 0.015, 0.001);
}

TEST(BeamRays, StrataThatDoNotFitAreRefused)
{
  BeamRays rays;
  const StrataPartition strata(10);
  EXPECT_THROW(
    sampleBeam(0, 0, 11, { 0.01, BeamProfile::Uniform }, Sampling::Stratified, &strata, rays),
    std::invalid_argument);
  EXPECT_THROW(
    sampleBeam(0, 0, 11, { 0.01, BeamProfile::Uniform }, Sampling::Stratified, nullptr, rays),
    std::invalid_argument);
  EXPECT_THROW(StrataPartition(0), std::invalid_argument);
}

TEST(BeamRaysStrata, SharesFollowTheRays)
{
  for (std::size_t count = 1; count <= 300; ++count)
  {
    const StrataPartition strata(count);
    const auto& cells = strata.cells();
    ASSERT_EQ(cells.size(), std::max<std::size_t>(1, count / 2));
    std::size_t rays = 0;
    double sum = 0.0;
    for (std::size_t c = 0; c < cells.size(); ++c)
    {
      const double share =
        (cells[c].v1 - cells[c].v0) * (cells[c].phi1 - cells[c].phi0) / (2.0 * Pi);
      const std::size_t held = strata.raysInCell(c);
      ASSERT_NEAR(share, static_cast<double>(held) / static_cast<double>(count), 1e-13) << count;
      for (std::size_t n = rays; n < rays + held; ++n)
      {
        ASSERT_EQ(strata.cellOfRay(n), c) << count;
      }
      rays += held;
      sum += share;
    }
    ASSERT_EQ(rays, count);
    ASSERT_NEAR(sum, 1.0, 1e-12);
  }
}

TEST(BeamRays, PatternsTogetherFillEveryCellEvenly)
{
  constexpr std::size_t count = 101;
  constexpr double half = 0.3;
  const StrataPartition strata(count);
  std::vector<std::vector<int>> places(count, std::vector<int>(PatternsOfRays, 0));
  for (std::size_t p = 0; p < PatternsOfRays; ++p)
  {
    BeamRays pattern;
    samplePattern(5, p, PatternsOfRays, { half, BeamProfile::Uniform }, strata, pattern);
    ASSERT_EQ(pattern.size(), count);
    for (std::size_t n = 0; n < count; ++n)
    {
      // Back from the place to the share of the cone's solid angle that lies inside.
      const Polar ray = polar(pattern, n, half);
      const double share = cumulativeShare(ray.theta, half, BeamProfile::Uniform);
      const StrataPartition::Cell& cell = strata.cells()[strata.cellOfRay(n)];
      const double place = (share - cell.v0) / (cell.v1 - cell.v0);
      ASSERT_GT(place, -1e-9);
      ASSERT_LT(place, 1.0 + 1e-9);
      ++places[n][std::min<std::size_t>(
        PatternsOfRays - 1, static_cast<std::size_t>(std::max(0.0, place) * PatternsOfRays))];
      ASSERT_GE(ray.phi, cell.phi0 - 1e-9);
      ASSERT_LE(ray.phi, cell.phi1 + 1e-9);
    }
  }
  for (const std::vector<int>& ofRay : places)
  {
    EXPECT_EQ(std::count(ofRay.begin(), ofRay.end(), 1), std::ptrdiff_t(PatternsOfRays));
  }
}

TEST(BeamRays, TurnedRaysStayInTheBeam)
{
  BeamRays pattern;
  BeamRays turned;
  const StrataPartition strata(500);
  samplePattern(0, 3, PatternsOfRays, { 0.01, BeamProfile::Gaussian }, strata, pattern);
  for (std::size_t k = 0; k < 1000; ++k)
  {
    const double turns = uniformPair(1, 0, k, RandomPurpose::Turns)[0];
    turnRays(pattern, turns, turned);
    for (std::size_t n = 0; n < pattern.size(); ++n)
    {
      ASSERT_LE(turned.x[n] * turned.x[n] + turned.y[n] * turned.y[n], 1.0);
      ASSERT_NEAR(
        std::hypot(turned.x[n], turned.y[n]), std::hypot(pattern.x[n], pattern.y[n]), 1e-15);
    }
  }
}
