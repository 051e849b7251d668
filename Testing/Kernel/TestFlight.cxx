// SPDX-License-Identifier: BSD-3-Clause
// Flights: courses, circles and their poses, flocks against what was measured, tracks of files.
#include "BirdTestScene.h"
#include "Flight.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

using namespace birdtest;

namespace
{
constexpr double OneDegree = Pi / 180.0;

const BirdSpecies& species(const std::string& name)
{
  static const auto all = shippedSpecies();
  return all[findSpecies(all, name)];
}

FlightSettings settingsOf(FlightPattern pattern, int birds)
{
  FlightSettings settings;
  settings.pattern = pattern;
  settings.numberOfBirds = birds;
  settings.seed = 7;
  settings.center = Vec3(100.0, -200.0, 5.0);
  settings.timeRange = { -10.0, 40.0 };
  return settings;
}

std::vector<Flight> gulls(const FlightSettings& settings)
{
  return makeFlights(settings, species("herring gull"), 4);
}

/// What the contract of movers says: linear and slerp.
Pose poseAt(const Flight& flight, double time)
{
  std::size_t next = 1;
  while (flight.poses[next].time < time)
  {
    ++next;
  }
  const Pose& a = flight.poses[next - 1];
  const Pose& b = flight.poses[next];
  const double share = (time - a.time) / (b.time - a.time);
  return { time, glm::mix(a.position, b.position, share),
    glm::slerp(a.orientation, b.orientation, share) };
}

const Vec3 RightWing(1.0, 0.0, 0.0);
const Vec3 Forward(0.0, 1.0, 0.0);
const Vec3 Upward(0.0, 0.0, 1.0);

void expectNear(const Vec3& a, const Vec3& b, double error)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    EXPECT_NEAR(a[axis], b[axis], error);
  }
}

/// Speeds over the airspeed.
statistics::Moments speedsOf(const std::vector<Flight>& flights, double airspeed)
{
  statistics::Moments speeds;
  for (const Flight& flight : flights)
  {
    const Pose& a = flight.poses[0];
    const Pose& b = flight.poses[1];
    const double speed = glm::length(b.position - a.position) / (b.time - a.time) / airspeed;
    EXPECT_GT(speed, 0.7 - 1e-9);
    EXPECT_LT(speed, 1.3 + 1e-9);
    speeds.add(speed);
  }
  return speeds;
}

std::vector<double> nearestDistances(const std::vector<Vec3>& places)
{
  std::vector<double> nearest(places.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    for (std::size_t k = 0; k < i; ++k)
    {
      const double distance = glm::length(places[i] - places[k]);
      nearest[i] = std::min(nearest[i], distance);
      nearest[k] = std::min(nearest[k], distance);
    }
  }
  return nearest;
}

std::string errorOf(const std::string& text)
{
  return statistics::errorOf([&]() { readFlights(text, "own.csv", shippedSpecies(), {}, 0); });
}

const std::string Header = "id,species,time,x,y,z\n";
}

TEST(Flight, CrossingsAreLevelAndPassTheCenterInTheTimeRange)
{
  const FlightSettings settings = settingsOf(FlightPattern::Crossings, 2000);
  const auto flights = gulls(settings);
  ASSERT_EQ(flights.size(), 2000u);
  double offsets = 0.0;
  double times = 0.0;
  double heights = 0.0;
  Vec3 directions(0.0);
  for (const Flight& flight : flights)
  {
    ASSERT_EQ(flight.poses.size(), 2u);
    EXPECT_EQ(flight.poses[0].time, -10.0);
    EXPECT_EQ(flight.poses[1].time, 40.0);
    EXPECT_FALSE(flight.gliding);
    EXPECT_GT(flight.wingPhase, 0.0);
    EXPECT_LT(flight.wingPhase, 1.0);
    EXPECT_EQ(flight.species, 4u);
    const Vec3 v = (flight.poses[1].position - flight.poses[0].position) / 50.0;
    EXPECT_NEAR(v.z, 0.0, 1e-12);
    // When it is nearest to the center.
    const Vec3 apart = flight.poses[0].position - settings.center;
    const double passed = -(apart.x * v.x + apart.y * v.y) / glm::dot(v, v);
    EXPECT_GT(passed, -1e-6);
    EXPECT_LT(passed, 50.0 + 1e-6);
    const Vec3 nearest = apart + passed * v;
    EXPECT_LT(std::hypot(nearest.x, nearest.y), 500.0 + 1e-6);
    EXPECT_GT(nearest.z, 10.0 - 1e-6);
    EXPECT_LT(nearest.z, 150.0 + 1e-6);
    offsets += std::hypot(nearest.x, nearest.y) / 2000.0;
    times += passed / 2000.0;
    heights += nearest.z / 2000.0;
    directions += unitVector(v) / 2000.0;
    for (const Pose& pose : flight.poses)
    {
      EXPECT_NEAR(glm::length(pose.orientation), 1.0, 1e-12);
      expectNear(pose.orientation * Forward, unitVector(v), 1e-9);
      expectNear(pose.orientation * Upward, Upward, 1e-12);
    }
  }
  // Evenly spread: means within five standard errors.
  EXPECT_NEAR(offsets, 250.0, 5.0 * 500.0 / std::sqrt(12.0 * 2000.0));
  EXPECT_NEAR(times, 25.0, 5.0 * 50.0 / std::sqrt(12.0 * 2000.0));
  EXPECT_NEAR(heights, 80.0, 5.0 * 140.0 / std::sqrt(12.0 * 2000.0));
  EXPECT_LT(glm::length(directions), 5.0 / std::sqrt(2000.0));
  const statistics::Moments speeds = speedsOf(flights, 12.5);
  EXPECT_NEAR(speeds.mean(), 1.0, 0.012);
  EXPECT_NEAR(std::sqrt(speeds.variance()), 0.1, 0.01);
}

TEST(Flight, CirclesAreBankedForTheirRadiusAndCloselyPosed)
{
  FlightSettings settings = settingsOf(FlightPattern::Circles, 60);
  int toTheRight = 0;
  for (const std::string name : { "starling", "Canada goose" })
  {
    for (const Flight& flight : makeFlights(settings, species(name), 0))
    {
      EXPECT_TRUE(flight.gliding);
      EXPECT_EQ(flight.poses.front().time, -10.0);
      EXPECT_EQ(flight.poses.back().time, 40.0);
      const Pose& first = flight.poses[0];
      const Pose& second = flight.poses[1];
      const Vec3 ahead = first.orientation * Forward;
      const double bank = -std::asin((first.orientation * RightWing).z);
      EXPECT_GT(std::fabs(bank), 20.0 * OneDegree - 1e-9);
      EXPECT_LT(std::fabs(bank), 40.0 * OneDegree + 1e-9);
      toTheRight += bank > 0.0;
      // The circle of this chord and turn.
      const double turn = 2.0 * std::asin(0.5 * glm::length(second.orientation * Forward - ahead));
      const double radius =
        0.5 * glm::length(second.position - first.position) / std::sin(0.5 * turn);
      const double speed = radius * turn / (second.time - first.time);
      EXPECT_NEAR(std::tan(std::fabs(bank)), speed * speed / (9.81 * radius), 1e-9);
      const Vec3 inwards = bank > 0.0 ? glm::cross(ahead, Upward) : glm::cross(Upward, ahead);
      const Vec3 center = first.position + radius * inwards;
      EXPECT_LT(std::hypot(center.x - 100.0, center.y + 200.0), 500.0 + 1e-6);
      double worst = 0.0;
      for (double time = -10.0; time < 40.0; time += 0.013)
      {
        const Pose pose = poseAt(flight, time);
        EXPECT_NEAR(pose.position.z, first.position.z, 1e-9);
        const double flown = (time + 10.0) * speed / radius;
        const Vec3 there = radius * (std::sin(flown) * ahead - std::cos(flown) * inwards);
        worst = std::max(worst, glm::length(pose.position - center - there));
        expectNear(
          pose.orientation * Forward, std::cos(flown) * ahead + std::sin(flown) * inwards, 1e-6);
        EXPECT_NEAR(-std::asin((pose.orientation * RightWing).z), bank, 1e-9);
      }
      EXPECT_LT(worst, 0.01 + 1e-6);
      EXPECT_GT(worst, 0.008);
    }
  }
  EXPECT_GT(toTheRight, 30);
  EXPECT_LT(toTheRight, 90);
}

TEST(Flight, ApproachesDescendToTheThreshold)
{
  FlightSettings settings = settingsOf(FlightPattern::Approach, 500);
  settings.thresholdPosition = Vec3(1000.0, 50.0, 3.0);
  settings.thresholdHeading = 90.0;
  double farthest = 0.0;
  double widest = 0.0;
  for (const Flight& flight : gulls(settings))
  {
    for (const Pose& pose : flight.poses)
    {
      const double distance = 1000.0 - pose.position.x;
      EXPECT_GT(distance, 0.0);
      EXPECT_NEAR(pose.position.z - 3.0, distance * std::tan(3.0 * OneDegree), 1e-9);
      EXPECT_LT(std::fabs(pose.position.y - 50.0), 75.0 + 0.15 * distance);
    }
    const Pose& last = flight.poses.back();
    EXPECT_LT(1000.0 - last.position.x, 1000.0);
    farthest = std::max(farthest, 1000.0 - last.position.x);
    widest = std::max(
      widest, std::fabs(last.position.y - 50.0) / (75.0 + 0.15 * (1000.0 - last.position.x)));
    const Vec3 v = last.position - flight.poses[0].position;
    expectNear(last.orientation * Forward, unitVector(v), 1e-9);
  }
  EXPECT_GT(farthest, 950.0);
  EXPECT_GT(widest, 0.95);
}

TEST(Flight, BirdsDoNotDependOnHowManyFollow)
{
  for (const FlightPattern pattern :
    { FlightPattern::Crossings, FlightPattern::Circles, FlightPattern::Approach })
  {
    const auto few = gulls(settingsOf(pattern, 3));
    const auto many = gulls(settingsOf(pattern, 50));
    std::set<double> phases;
    for (std::size_t i = 0; i < many.size(); ++i)
    {
      EXPECT_EQ(many[i].number, std::to_string(i + 1));
      phases.insert(many[i].wingPhase);
      if (i < few.size())
      {
        EXPECT_EQ(few[i].number, many[i].number);
        EXPECT_EQ(few[i].wingPhase, many[i].wingPhase);
        EXPECT_TRUE(std::equal(few[i].poses.begin(), few[i].poses.end(), many[i].poses.begin(),
          many[i].poses.end(),
          [](const Pose& a, const Pose& b) {
            return a.time == b.time && a.position == b.position && a.orientation == b.orientation;
          }));
      }
    }
    EXPECT_EQ(phases.size(), 50u);
    FlightSettings other = settingsOf(pattern, 1);
    other.seed = 8;
    EXPECT_NE(gulls(other)[0].poses[0].position, few[0].poses[0].position);
    EXPECT_TRUE(gulls(settingsOf(pattern, 0)).empty());
  }
  EXPECT_TRUE(gulls(settingsOf(FlightPattern::Flock, 0)).empty());
}

// Ballerini et al. 2008; the numbers of birds of their smallest flock and of larger ones.
TEST(Flight, FlocksAreThinWithTheSameSidesWhateverTheirSize)
{
  for (const std::size_t birds : { 122, 500, 2000 })
  {
    Vec3 extent(0.0);
    constexpr int flocks = 8;
    for (int seed = 0; seed < flocks; ++seed)
    {
      Vec3 squares(0.0);
      for (const Vec3& place : flockPlaces(seed, birds, 0.39))
      {
        squares += place * place / static_cast<double>(birds);
      }
      extent += glm::sqrt(squares) / static_cast<double>(flocks);
    }
    EXPECT_NEAR(extent.y / extent.z, 2.8, 0.15) << birds;
    EXPECT_NEAR(extent.x / extent.z, 5.6, 0.3) << birds;
  }
}

TEST(Flight, NearestNeighboursInFlocksKeepAWingspanAndDoNotDependOnSize)
{
  const double span = 0.39;
  std::vector<double> means;
  for (const std::size_t birds : { 122, 500, 2000 })
  {
    std::vector<double> all;
    for (int seed = 0; seed < (birds > 1000 ? 2 : 8); ++seed)
    {
      const auto nearest = nearestDistances(flockPlaces(seed, birds, span));
      EXPECT_GE(*std::min_element(nearest.begin(), nearest.end()), span * (1.0 - 1e-12));
      all.insert(all.end(), nearest.begin(), nearest.end());
    }
    EXPECT_LT(*std::min_element(all.begin(), all.end()), 1.2 * span) << birds;
    means.push_back(statistics::meanOf(all));
  }
  for (const double mean : means)
  {
    // Measured flocks have 0.7 to 1.5 m.
    EXPECT_GT(mean, 0.7);
    EXPECT_LT(mean, 1.5);
    EXPECT_NEAR(mean / means.back(), 1.0, 0.08);
  }
}

TEST(Flight, FlocksAreDenserAtTheBorder)
{
  for (const std::size_t birds : { 122, 500, 2000 })
  {
    int inner = 0;
    int total = 0;
    const int flocks = static_cast<int>(16000 / birds);
    for (int seed = 0; seed < flocks; ++seed)
    {
      const double volume = birds * std::pow(4.0 * 0.39, 3);
      const double half = std::cbrt(volume / (4.0 / 3.0 * Pi * 2.8 * 5.6));
      for (const Vec3& place : flockPlaces(seed, birds, 0.39))
      {
        const double radius = glm::length(place / (half * Vec3(5.6, 2.8, 1.0)));
        EXPECT_LE(radius, 1.0);
        inner += radius < std::cbrt(0.5);
        ++total;
      }
    }
    // Of the inner half of the volume: the integral of r^2 (1 + r^2), 0.431. Hard cores make the
    // dense border less dense, by 0.005 or so.
    EXPECT_NEAR(static_cast<double>(inner) / total, 0.431, 0.018) << birds;
  }
}

TEST(Flight, AFlockFliesAsOneBodyBetweenTheHeights)
{
  FlightSettings settings = settingsOf(FlightPattern::Flock, 500);
  settings.heights = { 20.0, 60.0 };
  for (settings.seed = 0; settings.seed < 20; ++settings.seed)
  {
    const auto flights = makeFlights(settings, species("starling"), 0);
    ASSERT_EQ(flights.size(), 500u);
    const Vec3 moved = flights[0].poses[1].position - flights[0].poses[0].position;
    std::set<double> phases;
    for (const Flight& flight : flights)
    {
      expectNear(flight.poses[1].position - flight.poses[0].position, moved, 1e-9);
      EXPECT_GE(flight.poses[0].position.z, 25.0);
      EXPECT_LE(flight.poses[0].position.z, 65.0);
      phases.insert(flight.wingPhase);
    }
    EXPECT_EQ(phases.size(), 500u);
  }
}

TEST(Flight, HeadingPitchAndBankFollowFromThePath)
{
  // A level circle to the right of 50 m at 10 m/s, a pose every 0.2 s.
  Flight circle;
  for (int i = 0; i <= 200; ++i)
  {
    const double angle = 0.04 * i;
    circle.poses.push_back(
      { 0.2 * i, Vec3(50.0 * std::sin(angle), 50.0 * std::cos(angle), 30.0), {} });
  }
  orientAlongPath(circle);
  for (int i = 1; i < 200; ++i)
  {
    const glm::dquat& q = circle.poses[i].orientation;
    const double angle = 0.04 * i;
    expectNear(q * Forward, Vec3(std::cos(angle), -std::sin(angle), 0.0), 1e-9);
    EXPECT_NEAR(-std::asin((q * RightWing).z), std::atan(100.0 / (9.81 * 50.0)), 1e-3);
    EXPECT_GT(glm::dot(q, circle.poses[i - 1].orientation), 0.0);
  }
  // Climbing, then still, then straight up.
  Flight stops;
  for (const Vec3& p : { Vec3(0, 0, 0), Vec3(10, 0, 10), Vec3(10, 0, 10), Vec3(10, 0, 10),
         Vec3(10, 0, 10), Vec3(10, 0, 20) })
  {
    stops.poses.push_back({ 1.0 + stops.poses.size(), p, {} });
  }
  orientAlongPath(stops);
  const double half = std::sqrt(0.5);
  expectNear(stops.poses[0].orientation * Forward, Vec3(half, 0.0, half), 1e-12);
  for (int i = 2; i < 6; ++i)
  {
    expectNear(stops.poses[i].orientation * Forward, Vec3(1.0, 0.0, 0.0), 1e-12);
    expectNear(stops.poses[i].orientation * Upward, Upward, 1e-12);
  }
  // At rest first: the heading that comes, level.
  Flight waits;
  waits.poses = { { 0.0, Vec3(0.0), {} }, { 1.0, Vec3(0.0), {} }, { 2.0, Vec3(0.0), {} },
    { 3.0, Vec3(0.0, -5.0, 0.0), {} } };
  orientAlongPath(waits);
  expectNear(waits.poses[0].orientation * Forward, Vec3(0.0, -1.0, 0.0), 1e-12);
}

TEST(Flight, FilesThatAreWrongSayWhere)
{
  const std::string row = "1,crow,0,0,0,0\n";
  const std::pair<std::string, std::string> cases[] = {
    { "",
      "own.csv: holds no header, expected 'id,species,time,x,y,z' or 'id,species,time,longitude" },
    { "id,time\n", "own.csv: line 1: is not the header" },
    { Header + "1,crow,0,0,0\n", "own.csv: line 2: has 5 columns, expected 6" },
    { Header + "1,crow,0,0,0,high\n", "line 2: z is 'high', expected -1e+09 to 1e+09" },
    { Header + "1,crow,nan,0,0,0\n", "line 2: time is 'nan'" },
    { Header + "1,crow,0,1e10,0,0\n", "line 2: x is '1e10'" },
    { Header + "1,dodo,0,0,0,0\n", "line 2: species is 'dodo', expected one of starling, kestrel" },
    { Header + ",crow,0,0,0,0\n", "line 2: id is empty" },
    { Header + row + "1,crow,0,1,0,0\n",
      "line 3: time is '0', expected more than 0, the time before of id '1'" },
    { Header + row + "1,kestrel,1,1,0,0\n",
      "line 3: species is 'kestrel', expected 'crow', as id '1' has it before" },
    { Header + row, "own.csv: id '1' has one time, expected at least two" },
    { "id,species,time,longitude,latitude,height\n1,crow,0,0,91,0\n",
      "line 2: latitude is '91', expected -90 to 90" },
  };
  for (const auto& [text, message] : cases)
  {
    statistics::expectSays(errorOf(text), message);
  }
}
