// SPDX-License-Identifier: BSD-3-Clause
// Standard errors: by hand, and how often +-1.96 of them hold the true value.
#include "EchoTestScene.h"

#include "Random.h"
#include "StandardError.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

using namespace avianlidar;
using namespace echotest;

namespace
{
/// Energy that a beam receives of a point of the unit disc, and in all.
struct LitDisc
{
  std::function<double(std::uint64_t beam, double x, double y)> energyOf;
  std::function<double(std::uint64_t beam)> truth;
  bool filling = false; ///< fills the beam: what rays see bounds what they do not see
};

/// Share of beams whose true energy lies within 1.96 standard errors of the estimate. @param
/// ofSeenAlone true: only beams with a ray that meets the target count
double coverage(
  Sampling sampling, std::size_t rays, int beams, const LitDisc& target, bool ofSeenAlone = false)
{
  const StrataPartition strata(rays);
  StandardErrorEstimator estimator(sampling, rays, &strata);
  const auto count = static_cast<double>(rays);
  BeamRays sample;
  int held = 0;
  int all = 0;
  for (std::uint64_t beam = 0; beam < static_cast<std::uint64_t>(beams); ++beam)
  {
    sampleBeam(2, beam, rays, { 1e-3, BeamProfile::Uniform }, sampling, &strata, sample);
    estimator.begin();
    double sum = 0.0;
    for (std::size_t n = 0; n < rays; ++n)
    {
      const double energy = target.energyOf(beam, sample.x[n], sample.y[n]) / count;
      estimator.add(n, energy);
      sum += energy;
    }
    const bool counts = !ofSeenAlone || sum > 0.0;
    const UnseenEnergy unseen = target.filling
      ? UnseenEnergy{ estimator.smallest(), estimator.largest() }
      : UnseenEnergy{ 0.0, 1.0 / count };
    all += counts;
    held += counts && std::abs(sum - target.truth(beam)) <= 1.96 * estimator.estimate(unseen);
  }
  return static_cast<double>(held) / all;
}

/// An edge of random place and direction: how far a point is beyond it.
double edgeOf(std::uint64_t beam)
{
  return 2.0 * uniformPair(9, beam, 0, RandomPurpose::Connections)[0] - 1.0;
}

double beyondEdge(std::uint64_t beam, double x, double y)
{
  const double turn = 2.0 * Pi * uniformPair(9, beam, 0, RandomPurpose::Connections)[1];
  return x * std::cos(turn) + y * std::sin(turn) - edgeOf(beam);
}

const LitDisc BeyondEdge{ [](std::uint64_t beam, double x, double y)
  { return beyondEdge(beam, x, y) > 0.0 ? 1.0 : 0.0; },
  [](std::uint64_t beam) { return statistics::shareBeyond(edgeOf(beam)); } };

/// A strip half as wide as the disc's radius, at a random place.
const LitDisc OnStrip{ [](std::uint64_t beam, double x, double y)
  { return std::fabs(beyondEdge(beam, x, y)) < 0.25 ? 1.0 : 0.0; },
  [](std::uint64_t beam)
  {
    return statistics::shareBeyond(edgeOf(beam) - 0.25) -
      statistics::shareBeyond(edgeOf(beam) + 0.25);
  } };

/// A disc about the axis that has a share of the beam.
LitDisc discOf(double share)
{
  return { [=](std::uint64_t, double x, double y) { return x * x + y * y < share ? 1.0 : 0.0; },
    [=](std::uint64_t) { return share; } };
}

/// A plane askew that fills the beam.
const LitDisc OnPlane{ [](std::uint64_t, double x, double) { return 1.0 + 0.3 * x; },
  [](std::uint64_t) { return 1.0; }, true };
}

TEST(StandardError, MonteCarloByHand)
{
  StandardErrorEstimator estimator(Sampling::MonteCarlo, 16, nullptr);
  estimator.add(0, 1.0);
  estimator.add(2, 2.0);
  estimator.add(2, 1.0); // 1, 3 and 14 zeros
  // With 0, 0, 5, 5: mean 0.7, squares 60 - 20 0.49, s^2 over 19; 16 rays.
  EXPECT_NEAR(estimator.estimate({ 0.0, 5.0 }), std::sqrt(16.0 * (60.0 - 9.8) / 19.0), 1e-14);
  // With 1, 1, 1, 1: mean 0.4, squares 14 - 20 0.16.
  EXPECT_NEAR(estimator.estimate({ 1.0, 1.0 }), std::sqrt(16.0 * 10.8 / 19.0), 1e-14);
  estimator.begin();
  EXPECT_EQ(estimator.estimate({}), 0.0);
  EXPECT_GT(estimator.estimate({ 0.0, 5.0 }), 0.0);
}

TEST(StandardError, StratifiedByHand)
{
  const StrataPartition strata(17); // the last cell has 3
  StandardErrorEstimator estimator(Sampling::Stratified, 17, &strata);
  estimator.add(0, 3.0);
  estimator.add(1, 1.0);
  estimator.add(14, 1.0);
  estimator.add(15, 2.0);
  estimator.add(16, 6.0); // mean 3, squared deviations 4 + 1 + 9 = 14, s^2 = 7
  EXPECT_NEAR(estimator.estimate({ 7.0, 7.0 }), std::sqrt(4.0 + 3.0 * 7.0), 1e-14);
  EXPECT_NEAR(estimator.estimate({ 1.0, 7.0 }), std::sqrt(4.0 + 3.0 * 7.0 + 36.0), 1e-14);
  EXPECT_EQ(estimator.smallest(), 0.0);
  EXPECT_EQ(estimator.largest(), 6.0);
}

TEST(StandardError, FewRaysHaveNone)
{
  for (std::size_t rays = 1; rays < 20; ++rays)
  {
    const StrataPartition strata(rays);
    for (const Sampling sampling : { Sampling::Stratified, Sampling::MonteCarlo })
    {
      StandardErrorEstimator estimator(sampling, rays, &strata);
      EXPECT_EQ(std::isnan(estimator.estimate({ 0.0, 1.0 })), rays < 8) << rays;
    }
  }
}

TEST(StandardError, SmallSamplesHoldTheTruth)
{
  // Of a plane that fills the window, what few rays see says least of what they do not see. Of an
  // edge, the beams count of which a ray sees anything.
  for (std::size_t rays = 8; rays <= 16; ++rays)
  {
    for (const Sampling sampling : { Sampling::MonteCarlo, Sampling::Stratified })
    {
      EXPECT_GT(coverage(sampling, rays, 10000, OnPlane), 0.955) << rays;
      EXPECT_GT(coverage(sampling, rays, 10000, BeyondEdge, true), 0.955) << rays;
    }
  }
}

TEST(StandardError, StrataMustFit)
{
  const StrataPartition strata(6);
  EXPECT_THROW(StandardErrorEstimator(Sampling::Stratified, 5, &strata), std::invalid_argument);
  EXPECT_THROW(StandardErrorEstimator(Sampling::Stratified, 5, nullptr), std::invalid_argument);
}

TEST(StandardError, IsTheSameInAnyOrderOfRays)
{
  for (const std::size_t count : { 8, 9, 101 })
  {
    const StrataPartition strata(count);
    for (const Sampling sampling : { Sampling::MonteCarlo, Sampling::Stratified })
    {
      StandardErrorEstimator forward(sampling, count, &strata);
      StandardErrorEstimator backward(sampling, count, &strata);
      for (std::size_t unit = 0; unit < 3; ++unit)
      {
        const auto add = [&](StandardErrorEstimator& error, std::size_t n)
        { error.add(n, n % 3 == 1 ? 0.0 : 1.0 + 0.1 * static_cast<double>(n + unit)); };
        forward.begin();
        backward.begin();
        for (std::size_t n = unit; n < count; ++n)
        {
          add(forward, n);
          add(backward, count - 1 - n + unit);
        }
        EXPECT_EQ(forward.largest(), backward.largest());
        EXPECT_EQ(forward.smallest(), backward.smallest());
        const UnseenEnergy unseen{ forward.smallest(), forward.largest() };
        EXPECT_EQ(forward.estimate(unseen), backward.estimate(unseen)); // to the last bit
      }
    }
  }
}

TEST(StandardError, HundredRaysHoldTheTruth)
{
  // Offsets of the edge even over the beam's width: below 0.92 without the pseudo-rays.
  EXPECT_NEAR(coverage(Sampling::MonteCarlo, 100, 4000, BeyondEdge), 0.951, 0.015);
  // A share of 0.995: 0.39 without.
  EXPECT_GT(coverage(Sampling::MonteCarlo, 100, 4000, discOf(0.995)), 0.93);
  EXPECT_NEAR(coverage(Sampling::Stratified, 100, 4000, BeyondEdge), 0.963, 0.02);
  EXPECT_NEAR(coverage(Sampling::Stratified, 100, 4000, OnStrip), 0.953, 0.02);
  EXPECT_GT(coverage(Sampling::Stratified, 100, 4000, discOf(0.16)), 0.93);
}
