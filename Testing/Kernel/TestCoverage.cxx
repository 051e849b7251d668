// SPDX-License-Identifier: BSD-3-Clause
// Coverage against looking at every beam and every surface, ranges in free space, and what may not
// change it.
#include "Coverage.h"
#include "PhotonReceiver.h"
#include "ScanTestTown.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace echotest;

namespace
{
const Vec3 Up(0.0, 0.0, 1.0);

Sensor search905()
{
  Sensor sensor;
  sensor.receiverModel = ReceiverModel::Photons;
  sensor.frequency = SpeedOfLight / 905e-9;
  sensor.receiverAperture = 0.25 * Pi * 0.01;
  EXPECT_EQ(setPhotonLimits(sensor, 1.0, 40.0, 15360.0), "");
  return sensor;
}

/// A scan of surfaces and what covers it.
struct Site
{
  ScanSetup setup;
  ScanBeams beams;
  ScanResult still;
  Coverage coverage;

  Site(const Scene& scene, const Sensor& sensor, const ScanBeams& scanned)
    : setup(makeSetup(scene, sensor, settings()))
    , beams(scanned)
    , still(runScan(setup, beams))
    , coverage(setup, beams, Up, still)
  {
    this->setup.settings.attenuationCoefficient = 8.9e-5;
  }

  static EchoSettings settings()
  {
    EchoSettings settings = usual();
    settings.noise = false;
    settings.returnMode = ReturnMode::RangeUnits;
    return settings;
  }

  std::vector<CoverageView> view(const std::vector<Vec3>& places, int threads = 2) const
  {
    std::vector<CoverageView> views(places.size());
    EXPECT_TRUE(this->coverage.view(places.data(), places.size(), threads, {}, views.data()));
    return views;
  }
};

/// True if a triangle crosses the segment from the origin.
bool isHidden(const TriangleMesh& mesh, const Vec3& to)
{
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    const Vec3 a = mesh.corner(t, 0);
    const Vec3 u = mesh.corner(t, 1) - a;
    const Vec3 v = mesh.corner(t, 2) - a;
    const glm::dmat3 m(u, v, -to);
    if (std::fabs(glm::determinant(m)) > 0.0)
    {
      const Vec3 s = glm::inverse(m) * -a;
      if (s.x >= 0.0 && s.y >= 0.0 && s.x + s.y <= 1.0 && s.z > 0.0 && s.z < 1.0)
      {
        return true;
      }
    }
  }
  return false;
}
}

TEST(Coverage, EveryPlaceOfATownAgainstAllBeamsAndSurfaces)
{
  const Sensor sensor = search905();
  const Site site(town(), sensor, horizon(300, 6));
  ASSERT_GT(site.still.echoes.size(), 500u);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Vec3> places;
  for (int i = 0; i < 20000; ++i)
  {
    const double far = i % 50 == 0 ? 5000.0 : 350.0;
    places.emplace_back(
      far * uniform(random), far * uniform(random), 12.0 + 14.0 * uniform(random));
  }
  for (std::size_t e = 0; e < site.still.echoes.size(); e += 3) // before walls
  {
    const double before = site.still.echoes[e].range - uniform(random) - 0.9;
    places.push_back(before * unitVector(site.beams.directions[site.still.beamOfEcho[e]]));
  }
  const std::vector<CoverageView> views = site.view(places);
  const double half = sensor.halfBeamwidth;
  const double length = sensor.rangeUnitLength();
  int counts[8] = {};
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    const Vec3& place = places[i];
    const double range = glm::length(place);
    const double elevation = std::asin(place.z / range);
    int beams = 0;
    int clear = 0;
    for (std::size_t b = 0; b < site.beams.size(); ++b)
    {
      const double cosine = glm::dot(unitVector(site.beams.directions[b]), place / range);
      if (std::acos(std::clamp(cosine, -1.0, 1.0)) > half)
      {
        continue;
      }
      ++beams;
      bool clutter = false;
      for (std::size_t e = 0; e < site.still.echoes.size(); ++e)
      {
        // A pulse of one unit about the place meets the unit.
        clutter = clutter ||
          (site.still.beamOfEcho[e] == b && std::fabs(site.still.echoes[e].range - range) < length);
      }
      clear += clutter ? 0 : 1;
    }
    const CoverageStatus wanted = range > sensor.rangeGate ? CoverageStatus::OutsideGate
      : elevation > 5.0 * Degree + half                    ? CoverageStatus::AboveBand
      : elevation < -half                                  ? CoverageStatus::BelowBand
      : beams == 0                                         ? CoverageStatus::BetweenBeams
      : isHidden(*site.setup.tree->mesh, place)            ? CoverageStatus::Shadowed
      : clear == 0                                         ? CoverageStatus::InClutter
                                                           : CoverageStatus::Seen;
    ASSERT_EQ(static_cast<int>(views[i].status), static_cast<int>(wanted)) << i;
    if (wanted >= CoverageStatus::Shadowed)
    {
      ASSERT_EQ(views[i].beams, beams) << i;
      ASSERT_EQ(views[i].clear, clear) << i;
    }
    ++counts[static_cast<int>(wanted)];
  }
  for (const CoverageStatus status : { CoverageStatus::OutsideGate, CoverageStatus::AboveBand,
         CoverageStatus::BelowBand, CoverageStatus::BetweenBeams, CoverageStatus::Shadowed,
         CoverageStatus::InClutter, CoverageStatus::Seen })
  {
    EXPECT_GT(counts[static_cast<int>(status)], 20) << static_cast<int>(status);
  }
}

TEST(Coverage, RangesInFreeSpace)
{
  Sensor sensor = search905();
  sensor.pulseWidth = 0.0;
  const Site site(Scene(), sensor, horizon(1, 1));
  const DetectionLaw law(sensor, { 1.0 });
  const double areas[] = { 0.0052, 0.011, 0.018, 0.030, 0.067 };
  const double ranges[] = { 436.15, 523.95, 590.83, 668.98, 812.60 };
  for (int i = 0; i < 5; ++i)
  {
    // The threshold is met by half of the pulses.
    double near = 1.0;
    double far = 3000.0;
    while (far - near > 1e-3)
    {
      const double middle = 0.5 * (near + far);
      const CoverageView view = site.view({ Vec3(0.0, middle, 0.0) })[0];
      const CoverageValue value = site.coverage.valueAt(view, { areas[i], 0.3 }, law);
      (value.probability > 0.5 ? near : far) = middle;
    }
    EXPECT_NEAR(near, ranges[i], 0.002 * ranges[i]);
    const CoverageView there = site.view({ Vec3(0.0, ranges[i], 0.0) })[0];
    EXPECT_NEAR(
      site.coverage.valueAt(there, { 0.03, 0.3 }, law).leastArea, areas[i], 0.01 * areas[i]);
  }
  const CoverageView view = site.view({ Vec3(0.0, 500.0, 0.0) })[0];
  EXPECT_NEAR(site.coverage.valueAt(view, { 0.03, 0.3 }, law).photoelectrons, 2193.11, 0.03);
}

TEST(Coverage, MoreAreaLightOrBeamsSeeNoLess)
{
  const Site site(town(), search905(), horizon(300, 6));
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Vec3> places;
  for (int i = 0; i < 3000; ++i)
  {
    places.emplace_back(
      900.0 * uniform(random), 900.0 * uniform(random), 40.0 + 40.0 * uniform(random));
  }
  const std::vector<CoverageView> views = site.view(places);
  const DetectionLaw law(site.setup.sensor, { 0.3, 1.0, 1.7 });
  int seen = 0;
  for (CoverageView view : views)
  {
    const double p = site.coverage.valueAt(view, { 0.03, 0.3 }, law).probability;
    EXPECT_GE(p, 0.0);
    EXPECT_LE(p, 1.0);
    EXPECT_GE(site.coverage.valueAt(view, { 0.04, 0.3 }, law).probability, p);
    EXPECT_GE(site.coverage.valueAt(view, { 0.03, 0.4 }, law).probability, p);
    view.clear += view.clear > 0 ? 1 : 0;
    EXPECT_GE(site.coverage.valueAt(view, { 0.03, 0.3 }, law).probability, p);
    seen += p > 0.1;
  }
  EXPECT_GT(seen, 30);
}

TEST(Coverage, TheSameOnAnyThreadsAndStops)
{
  const Site site(town(), search905(), horizon(100, 4));
  std::vector<Vec3> places;
  for (int i = 0; i < 30000; ++i)
  {
    places.emplace_back(400.0 * std::sin(i), 400.0 * std::cos(1.7 * i), i % 40);
  }
  const auto one = site.view(places, 1);
  const auto two = site.view(places, 2);
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    ASSERT_EQ(one[i].status, two[i].status);
    ASSERT_EQ(one[i].clear, two[i].clear);
    ASSERT_EQ(one[i].range, two[i].range);
  }
  std::vector<CoverageView> views(places.size());
  EXPECT_FALSE(site.coverage.view(
    places.data(), places.size(), 1, [](double done) { return done < 0.3; }, views.data()));
}

TEST(Coverage, BeamsOfSeveralOriginsAreRefused)
{
  ScanBeams beams = horizon(4, 1);
  EXPECT_EQ(checkOrigins(beams), "");
  beams.origins[2].x = 1.0;
  EXPECT_NE(checkOrigins(beams).find("expected those of one sensor"), std::string::npos);
  EXPECT_NE(checkOrigins(ScanBeams()), "");
}
