// SPDX-License-Identifier: BSD-3-Clause
// Standard errors: by hand, and how often +-1.96 of them hold the true value.
#include "EchoTestScene.h"

#include "Random.h"
#include "StandardError.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

using namespace avianlidar;
using namespace echotest;

namespace
{
constexpr std::size_t RayCount = 100;

/// Share of 4,000 beams of 100 rays whose estimate +-1.96 standard errors holds the truth.
/// `covered` says whether a point of the unit disc is covered in a beam; `truth` is its share.
double coverage(Sampling sampling,
  const std::function<bool(std::uint64_t beam, double x, double y)>& covered,
  const std::function<double(std::uint64_t beam)>& truth)
{
  const StrataPartition strata(RayCount);
  StandardErrorEstimator estimator(sampling, RayCount, &strata);
  BeamRays rays;
  int held = 0;
  constexpr int beams = 4000;
  for (std::uint64_t beam = 0; beam < beams; ++beam)
  {
    sampleBeam(2, beam, RayCount, { 1e-3, BeamProfile::Uniform }, sampling, &strata, rays);
    estimator.begin();
    double sum = 0.0;
    for (std::size_t n = 0; n < RayCount; ++n)
    {
      const double energy = covered(beam, rays.x[n], rays.y[n]) ? 1.0 / RayCount : 0.0;
      estimator.add(n, energy);
      sum += energy;
    }
    const double error = estimator.estimate({ 0.0, 1.0 / RayCount });
    held += std::abs(sum - truth(beam)) <= 1.96 * error;
  }
  return static_cast<double>(held) / beams;
}

/// An edge of random place and direction.
double edgeOf(std::uint64_t beam)
{
  return 2.0 * uniformPair(9, beam, 0, RandomPurpose::Connections)[0] - 1.0;
}

bool beyondEdge(std::uint64_t beam, double x, double y)
{
  const double turn = 2.0 * Pi * uniformPair(9, beam, 0, RandomPurpose::Connections)[1];
  return x * std::cos(turn) + y * std::sin(turn) > edgeOf(beam);
}

double segment(double edge)
{
  const double e = std::min(1.0, std::max(-1.0, edge));
  return (std::acos(e) - e * std::sqrt(1.0 - e * e)) / Pi;
}

double edgeShare(std::uint64_t beam)
{
  return segment(edgeOf(beam));
}

/// A strip half as wide as the disc's radius, at a random place.
bool inStrip(std::uint64_t beam, double x, double y)
{
  const double turn = 2.0 * Pi * uniformPair(9, beam, 0, RandomPurpose::Connections)[1];
  const double place = x * std::cos(turn) + y * std::sin(turn) - edgeOf(beam);
  return place > -0.25 && place < 0.25;
}

double stripShare(std::uint64_t beam)
{
  return segment(edgeOf(beam) - 0.25) - segment(edgeOf(beam) + 0.25);
}

bool inAxisDisc(std::uint64_t, double x, double y)
{
  return x * x + y * y < 0.16;
}

double axisDiscShare(std::uint64_t)
{
  return 0.16;
}
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
  // A plane askew that fills the window: what few rays see of it says least of what they do not
  // see. An edge: of the beams of which a ray sees anything.
  for (std::size_t rays = 8; rays <= 16; ++rays)
  {
    const StrataPartition strata(rays);
    for (const Sampling sampling : { Sampling::MonteCarlo, Sampling::Stratified })
    {
      StandardErrorEstimator estimator(sampling, rays, &strata);
      BeamRays sample;
      int ofPlane = 0;
      int ofEdge = 0;
      int seen = 0;
      constexpr int beams = 10000;
      for (std::uint64_t beam = 0; beam < beams; ++beam)
      {
        sampleBeam(5, beam, rays, { 1e-3, BeamProfile::Uniform }, sampling, &strata, sample);
        const auto holds = [&](const auto& energyOf, bool plane, double truth)
        {
          estimator.begin();
          double sum = 0.0;
          for (std::size_t n = 0; n < rays; ++n)
          {
            const double energy = energyOf(sample.x[n], sample.y[n]) / static_cast<double>(rays);
            estimator.add(n, energy);
            sum += energy;
          }
          seen += !plane && sum > 0.0;
          const double least = plane ? estimator.smallest() : 0.0;
          const double error = estimator.estimate({ least, estimator.largest() });
          return sum > 0.0 && std::abs(sum - truth) <= 1.96 * error;
        };
        ofPlane += holds([](double x, double) { return 1.0 + 0.3 * x; }, true, 1.0);
        ofEdge += holds([&](double x, double y) { return beyondEdge(beam, x, y) ? 1.0 : 0.0; },
          false, edgeShare(beam));
      }
      EXPECT_GT(static_cast<double>(ofPlane) / beams, 0.955) << rays;
      EXPECT_GT(static_cast<double>(ofEdge) / seen, 0.955) << rays;
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

TEST(StandardErrorCoverage, MonteCarlo)
{
  // Offsets of the edge even over the beam's width: below 0.92 without the pseudo-rays.
  EXPECT_NEAR(coverage(Sampling::MonteCarlo, beyondEdge, edgeShare), 0.951, 0.015);
  // A share of 0.995: 0.39 without.
  const auto almostAll = [](std::uint64_t, double x, double y) { return x * x + y * y < 0.995; };
  const auto share = [](std::uint64_t) { return 0.995; };
  EXPECT_GT(coverage(Sampling::MonteCarlo, almostAll, share), 0.93);
}

TEST(StandardErrorCoverage, Stratified)
{
  EXPECT_NEAR(coverage(Sampling::Stratified, beyondEdge, edgeShare), 0.963, 0.02);
  EXPECT_NEAR(coverage(Sampling::Stratified, inStrip, stripShare), 0.953, 0.02);
  EXPECT_GT(coverage(Sampling::Stratified, inAxisDisc, axisDiscShare), 0.93);
}
