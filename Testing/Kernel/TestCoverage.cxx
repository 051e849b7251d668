// SPDX-License-Identifier: BSD-3-Clause
// Coverage against looking at every beam and every surface, ranges in free space, and what may not
// change it.
#include "BirdTestScene.h"
#include "BirdViews.h"
#include "Coverage.h"
#include "ScanTestTown.h"
#include "Search905.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

using namespace echotest;

namespace
{
const Vec3 Up(0.0, 0.0, 1.0);

PlaceAt at(const std::vector<Vec3>& places)
{
  return [&places](std::size_t k) { return places[k]; };
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
  }

  static EchoSettings settings()
  {
    EchoSettings settings = usual();
    settings.noise = false;
    settings.returnMode = ReturnMode::RangeUnits;
    return settings;
  }

  std::vector<CoverageSight> look(const std::vector<Vec3>& places, int threads = 2) const
  {
    std::vector<CoverageSight> sights(places.size());
    EXPECT_TRUE(this->coverage.look(::at(places), places.size(), threads, {}, sights.data()));
    return sights;
  }

  CoverageTarget target(double area, double reflectance = 0.3, double aperture = 1.0,
    const TargetViews& views = viewsOf({ Silhouette() })) const
  {
    Sensor sensor = this->setup.sensor;
    sensor.receiverAperture *= aperture;
    return { 8.9e-5, area, reflectance,
      std::make_shared<const DetectionLaw>(sensor, views, this->coverage.lowest(),
        this->coverage.highest(), this->coverage.mostBeams()) };
  }

  std::vector<CoverageValue> values(const std::vector<Vec3>& places, const CoverageTarget& target,
    const std::vector<CoverageSight>& sights) const
  {
    std::vector<CoverageValue> all;
    for (std::size_t i = 0; i < places.size(); ++i)
    {
      all.push_back(this->coverage.valueAt(places[i], sights[i], target));
    }
    return all;
  }
};

const TargetViews GullViews = birdViews(birdtest::HerringGull, false, 0.03);

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
  Sensor sensor = search905();
  sensor.minimumRange = 60.0;
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
  const std::vector<CoverageSight> sights = site.look(places);
  // So large that it is detected wherever a beam is clear.
  const std::vector<CoverageValue> values = site.values(places, site.target(1e3), sights);
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
    const bool isInGate = range >= sensor.minimumRange && range <= sensor.rangeGate;
    const CoverageStatus wanted = !isInGate     ? CoverageStatus::OutsideGate
      : elevation > 5.0 * Degree + half         ? CoverageStatus::AboveBand
      : elevation < -half                       ? CoverageStatus::BelowBand
      : beams == 0                              ? CoverageStatus::BetweenBeams
      : isHidden(*site.setup.tree->mesh, place) ? CoverageStatus::Shadowed
      : clear == 0                              ? CoverageStatus::InClutter
                                                : CoverageStatus::Seen;
    ASSERT_EQ(static_cast<int>(values[i].status), static_cast<int>(wanted)) << i;
    ASSERT_EQ(sights[i].isHidden && beams > 0, wanted == CoverageStatus::Shadowed) << i;
    if (wanted != CoverageStatus::OutsideGate)
    {
      ASSERT_EQ(static_cast<int>(sights[i].beams), beams) << i;
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
  const auto gull = [&](double range, double area)
  {
    const std::vector<Vec3> place = { Vec3(0.0, range, 0.0) };
    return site.values(place, site.target(area), site.look(place))[0];
  };
  const double areas[] = { 0.0052, 0.011, 0.018, 0.030, 0.067 };
  const double ranges[] = { 436.15, 523.95, 590.83, 668.98, 812.60 };
  for (int i = 0; i < 5; ++i)
  {
    // The threshold is met by half of the pulses.
    EXPECT_NEAR(gull(ranges[i], 0.03).leastArea, areas[i], 0.01 * areas[i]);
  }
  EXPECT_NEAR(gull(500.0, 0.03).photoelectrons, 2193.11, 0.03);
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
  const auto sights = site.look(places);
  const auto usual = site.values(places, site.target(0.03, 0.3, 1.0, GullViews), sights);
  const auto large = site.values(places, site.target(0.04, 0.3, 1.0, GullViews), sights);
  const auto bright = site.values(places, site.target(0.03, 0.4, 1.0, GullViews), sights);
  const auto wide = site.values(places, site.target(0.03, 0.3, 1.3, GullViews), sights);
  int seen = 0;
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    const double p = usual[i].probability;
    EXPECT_GE(p, 0.0);
    EXPECT_LE(p, 1.0);
    // Where one is looked at closely and the other is nearly certain.
    EXPECT_GE(large[i].probability, p - 0.01);
    EXPECT_GE(bright[i].probability, p - 0.01);
    EXPECT_GE(wide[i].probability, p - 0.01);
    seen += p > 0.1;
  }
  EXPECT_GT(seen, 30);

  // Nor does it matter whether the probabilities of the poses are asked for; their mean is about
  // the same: one is tabulated.
  const CoverageTarget target = site.target(0.03, 0.3, 1.0, GullViews);
  std::vector<float> poses(target.law->poses());
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    const double p = site.coverage.valueAt(places[i], sights[i], target, poses.data()).probability;
    EXPECT_EQ(p, usual[i].probability);
    const double sum = std::accumulate(poses.begin(), poses.end(), 0.0);
    EXPECT_NEAR(sum / static_cast<double>(poses.size()), p, 0.015);
  }
}

TEST(Coverage, BeamsOfSeveralOriginsAreRefused)
{
  ScanBeams beams = horizon(4, 1);
  EXPECT_EQ(checkOrigins(beams), "");
  beams.origins[2].x = 1.0;
  statistics::expectSays(checkOrigins(beams), "expected those of one sensor");
  EXPECT_NE(checkOrigins(ScanBeams()), "");
}

TEST(Coverage, OfManyBeamsNoneThatHoldsThePlaceIsForgotten)
{
  // 0.5 mrad beams, 1 mrad apart: more than a hundred are near each place.
  Sensor sensor = search905();
  sensor.halfBeamwidth = 5e-4;
  ScanBeams beams = horizon(40, 40);
  for (std::size_t b = 0; b < beams.size(); ++b)
  {
    const double x = 1e-3 * (static_cast<double>(b % 40) - 20.0);
    const double z = 1e-3 * (static_cast<double>(b / 40) - 20.0);
    beams.directions[b] = Vec3(x, 1.0, z);
  }
  const Site site(Scene(), sensor, beams);
  const std::vector<Vec3> places = { Vec3(0.0, 100.0, 0.0), Vec3(1.9, 100.0, 1.9) };
  const auto sights = site.look(places);
  const CoverageTarget bird = site.target(0.03, 0.3, 1.0, GullViews);
  for (const CoverageValue& value : site.values(places, bird, sights))
  {
    EXPECT_EQ(value.status, CoverageStatus::Seen);
    EXPECT_GT(value.probability, 0.99);
  }
}

TEST(Coverage, AGaussianBeamReachesFartherOnItsAxis)
{
  Sensor sensor = search905();
  const Site uniform(Scene(), sensor, horizon(1, 1));
  sensor.beamProfile = BeamProfile::Gaussian;
  const Site gaussian(Scene(), sensor, horizon(1, 1));
  // 2/(1 - exp(-2)) times as much light.
  const double gain = 2.0 / -std::expm1(-2.0);
  double before = 1.0;
  for (double range = 500.0; range < 1200.0; range += 25.0)
  {
    const std::vector<Vec3> place = { Vec3(0.0, range, 0.0) };
    const CoverageValue found =
      gaussian.values(place, gaussian.target(0.03), gaussian.look(place))[0];
    const CoverageValue wanted =
      uniform.values(place, uniform.target(gain * 0.03), uniform.look(place))[0];
    EXPECT_NEAR(found.probability, wanted.probability, 0.01) << range;
    EXPECT_NEAR(found.photoelectrons, wanted.photoelectrons, 1e-6 * wanted.photoelectrons);
    EXPECT_NEAR(found.leastArea, wanted.leastArea / gain, 1e-6 * wanted.leastArea);
    EXPECT_LE(found.probability, before + 0.01);
    before = found.probability;
  }
}
