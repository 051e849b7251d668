// SPDX-License-Identifier: BSD-3-Clause
// Tracks from clusters: closed forms of confirmation and of false tracks, crossings, a hundred
// birds, bounded memory.
#include "Statistics.h"
#include "Tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

using namespace avianlidar;

namespace
{
using Random = std::mt19937_64;

/// Positions are exact to a few centimetres; two of two confirm.
TrackerSettings settings()
{
  TrackerSettings s;
  s.targetExtent = 0.05;
  s.gate = normalDistanceSquare(0.99);
  s.motion = { 0.5, 0.0, 25.0 / std::sqrt(s.gate), 5.0 / std::sqrt(s.gate), 0.0 };
  s.confirmHits = 2;
  s.confirmScans = 2;
  s.maximumMisses = 1;
  s.historyLength = 100;
  return s;
}

/// Clusters of one point each, in the order that is expected of them.
std::vector<Cluster> clustersOf(const std::vector<Vec3>& places, double time)
{
  std::vector<CloudPoint> points;
  for (const Vec3& place : places)
  {
    points.push_back({ place, time, 0.05 });
  }
  return findClusters(points, Vec3(0.0), 0.0, 0.0).all;
}

/// The number of the track nearest to a place.
int trackAt(const Tracker& tracker, const Vec3& place)
{
  double least = Infinity;
  int nearest = -1;
  for (const Track& track : tracker.tracks())
  {
    const double apart = safeLength(track.positions.back().position - place);
    if (apart < least)
    {
      least = apart;
      nearest = track.id;
    }
  }
  return nearest;
}

/// Scans until a bird that is detected with the probability p is confirmed.
statistics::Moments scansToConfirm(const TrackerSettings& s, double p, int runs)
{
  Random random(11);
  std::bernoulli_distribution detected(p);
  statistics::Moments scans;
  for (int run = 0; run < runs; ++run)
  {
    Tracker tracker;
    int scan = 0;
    for (bool confirmed = false; !confirmed;)
    {
      ++scan;
      const Vec3 place(100.0, 10.0 * scan, 50.0);
      tracker.update(
        clustersOf(detected(random) ? std::vector<Vec3>{ place } : std::vector<Vec3>{}, scan),
        Vec3(0.0), scan, s);
      for (const Track& track : tracker.tracks())
      {
        confirmed = confirmed || track.confirmed;
      }
    }
    scans.add(scan);
  }
  return scans;
}

/// The same by a Markov chain, whose states are what the last m - 1 scans were.
double expectedScans(int k, int m, double p)
{
  const std::size_t states = std::size_t{ 1 } << (m - 1);
  std::vector<double> from(states, 0.0);
  for (int round = 0; round < 20000; ++round)
  {
    std::vector<double> next(states, 1.0);
    for (std::size_t state = 0; state < states; ++state)
    {
      int hits = 1;
      for (int bit = 0; bit < m - 1; ++bit)
      {
        hits += static_cast<int>(state >> bit & 1u);
      }
      next[state] += (1.0 - p) * from[state << 1 & (states - 1)] +
        (hits >= k ? 0.0 : p * from[(state << 1 | 1u) & (states - 1)]);
    }
    from = next;
  }
  return from[0];
}
}

TEST(Tracker, ConfirmsKOfMAsAMarkovChain)
{
  for (const auto& [k, m] :
    { std::pair(2, 2), std::pair(2, 3), std::pair(3, 4), std::pair(3, 5), std::pair(1, 1) })
  {
    TrackerSettings s = settings();
    s.confirmHits = k;
    s.confirmScans = m;
    for (const double p : { 0.4, 0.7 })
    {
      const statistics::Moments scans = scansToConfirm(s, p, 4000);
      EXPECT_NEAR(scans.mean(), expectedScans(k, m, p), 3.0 * scans.error())
        << k << " of " << m << " at " << p;
    }
  }
}

TEST(Tracker, ConfirmsFalseAlarmsAsTheClosedForm)
{
  TrackerSettings s = settings();
  s.motion.accelerationDensity = 0.0;
  constexpr std::size_t alarms = 300;
  constexpr int scans = 1500;
  const Vec3 box(4000.0, 4000.0, 400.0);
  const double variance = 2.0 * 0.05 * 0.05; // of two positions, along each axis: extent alone
  const auto halfAxis = [&](double speed)
  { return std::sqrt(s.gate * (variance + variance + speed * speed)); };
  const double gate = 4.0 / 3.0 * Pi * halfAxis(s.motion.speedError) *
    halfAxis(s.motion.speedError) * halfAxis(s.motion.climbError);
  Random random(5);
  std::uniform_real_distribution<double> side(0.0, 1.0);
  Tracker tracker;
  std::set<int> confirmed;
  for (int scan = 0; scan < scans; ++scan)
  {
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < alarms; ++i)
    {
      places.push_back(box * Vec3(side(random), side(random), side(random)));
    }
    tracker.update(clustersOf(places, scan), Vec3(0.0), scan, s);
    for (const Track& track : tracker.tracks())
    {
      if (track.confirmed)
      {
        confirmed.insert(track.id);
      }
    }
  }
  const double expected = scans * double(alarms * alarms) * gate / (box.x * box.y * box.z);
  EXPECT_GT(expected, 200.0);
  EXPECT_NEAR(static_cast<double>(confirmed.size()), expected, 3.0 * std::sqrt(expected));
}

TEST(Tracker, KeepsBirdsApartThatCross)
{
  const auto crossing = [](const Vec3& first, const Vec3& second, double aside)
  {
    Tracker tracker;
    int ids[2] = { -1, -1 };
    for (int scan = -6; scan <= 6; ++scan)
    {
      const Vec3 places[2] = { Vec3(500.0, 0.0, 50.0) + first * (2.0 * scan),
        Vec3(500.0, aside, 50.0) + second * (2.0 * scan) };
      tracker.update(clustersOf({ places[0], places[1] }, 2.0 * scan), Vec3(0.0), scan, settings());
      if (scan == -2)
      {
        ids[0] = trackAt(tracker, places[0]);
        ids[1] = trackAt(tracker, places[1]);
      }
    }
    EXPECT_NE(ids[0], ids[1]);
    EXPECT_EQ(tracker.tracks().size(), 2u);
    EXPECT_EQ(trackAt(tracker, Vec3(500.0, 0.0, 50.0) + first * 12.0), ids[0]);
    EXPECT_EQ(trackAt(tracker, Vec3(500.0, aside, 50.0) + second * 12.0), ids[1]);
  };
  crossing({ 13.0, 0.0, 0.0 }, { 0.0, 13.0, 0.0 }, 1.0);
  crossing({ 13.0, 0.0, 0.0 }, { -13.0, 0.0, 0.0 }, 1.0);
  crossing({ 13.0, 0.0, 0.0 }, { 12.0, 3.0, 0.0 }, 2.0);
}

TEST(Tracker, LosesNoneOfAHundredBirds)
{
  Random random(9);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  std::vector<Vec3> starts;
  std::vector<Vec3> velocities;
  for (int bird = 0; bird < 100; ++bird)
  {
    starts.push_back(Vec3(500.0, 500.0, 100.0) * Vec3(side(random), side(random), side(random)));
    const double heading = Pi * side(random);
    velocities.push_back({ 13.0 * std::cos(heading), 13.0 * std::sin(heading), side(random) });
  }
  Tracker tracker;
  for (int scan = 0; scan < 60; ++scan)
  {
    std::vector<Vec3> places;
    for (std::size_t bird = 0; bird < starts.size(); ++bird)
    {
      places.push_back(starts[bird] + velocities[bird] * (2.0 * scan));
    }
    tracker.update(clustersOf(places, 2.0 * scan), Vec3(0.0), 2.0 * scan, settings());
  }
  std::set<int> found;
  for (std::size_t bird = 0; bird < starts.size(); ++bird)
  {
    found.insert(trackAt(tracker, starts[bird] + velocities[bird] * 118.0));
  }
  EXPECT_EQ(found.size(), 100u);
  ASSERT_EQ(tracker.tracks().size(), 100u);
  for (const Track& track : tracker.tracks())
  {
    EXPECT_TRUE(track.confirmed && !track.ended);
    EXPECT_GE(track.hits, 58); // the first scans may have been another's
  }
}

TEST(Tracker, EndsAndForgetsTracks)
{
  TrackerSettings s = settings();
  s.confirmScans = 3;
  s.maximumMisses = 3;
  s.historyLength = 4;
  s.keepTime = 2.0;
  Tracker tracker;
  int time = 0;
  const auto scan = [&](bool hit)
  {
    ++time;
    const std::vector<Vec3> places(hit ? 1 : 0, Vec3(10.0 * time, 100.0, 20.0));
    return tracker.update(clustersOf(places, time), Vec3(0.0), time, s);
  };
  EXPECT_EQ(scan(true), std::vector<int>{ 0 });
  scan(false);
  EXPECT_EQ(tracker.tracks().size(), 1u);
  scan(false); // two of three are out of reach
  EXPECT_TRUE(tracker.tracks().empty());
  for (int i = 0; i < 10; ++i)
  {
    EXPECT_EQ(scan(true), std::vector<int>{ 1 });
  }
  EXPECT_EQ(tracker.tracks()[0].positions.size(), 4u);
  EXPECT_EQ(tracker.tracks()[0].hits, 10);
  EXPECT_NEAR(tracker.tracks()[0].positions.back().velocity.x, 10.0, 0.01);
  scan(false);
  scan(false);
  EXPECT_FALSE(tracker.tracks()[0].ended);
  scan(false);
  EXPECT_TRUE(tracker.tracks()[0].ended && tracker.tracks()[0].confirmed);
  scan(true); // near, but it has ended
  EXPECT_EQ(tracker.tracks().size(), 2u);
  EXPECT_EQ(tracker.tracks()[1].id, 2);
  scan(true);
  scan(true);
  EXPECT_EQ(tracker.tracks().size(), 1u);
}

TEST(Tracker, StopsWhereNobodyWaits)
{
  Tracker tracker;
  const auto scan = [&](double time, const KeepGoing& goOn)
  { tracker.update(clustersOf({ Vec3(100.0) }, time), Vec3(0.0), time, settings(), goOn); };
  scan(0.0, {});
  EXPECT_THROW(scan(1.0, [](double) { return false; }), WorkStopped);
  scan(1.0, [](double) { return true; });
  EXPECT_EQ(tracker.tracks().size(), 1u);
}

TEST(Tracker, ErrorsFollowTheBeam)
{
  const Cluster one{ { 0.0, 300.0, 400.0 }, 0.0, 0.09, 1 };
  const glm::dmat3 error = positionError(one, Vec3(0.0), 0.01, 0.2);
  const Vec3 along(0.0, 0.6, 0.8);
  EXPECT_NEAR(glm::dot(along, error * along), 0.09 + 0.04, 1e-12);
  EXPECT_NEAR(error[0][0], 25.0 / 4.0 + 0.04, 1e-12); // a radius of 5 m
  Cluster four = one;
  four.points = 4;
  EXPECT_NEAR(positionError(four, Vec3(0.0), 0.01, 0.2)[0][0], error[0][0] / 4.0, 1e-12);
}
