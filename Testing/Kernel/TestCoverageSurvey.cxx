// SPDX-License-Identifier: BSD-3-Clause
// Surveys against place by place, what is found again after a change, and sums that no number of
// threads changes.
#include "BirdTestScene.h"
#include "BirdViews.h"
#include "CoverageSurvey.h"
#include "ScanTestTown.h"
#include "Search905.h"

#include <gtest/gtest.h>

#include <cmath>
#include <mutex>

using namespace echotest;

namespace
{
/// Places around a town, of two regions; every fifth is of none.
struct Around
{
  std::vector<Vec3> points;
  SurveyPlaces places;

  explicit Around(std::size_t count)
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      const auto x = static_cast<double>(i);
      this->points.emplace_back(
        300.0 * std::sin(x), 300.0 * std::cos(1.7 * x), std::fmod(x, 50.0) - 4.0);
    }
    this->places = { [this](std::size_t k) { return this->points[k]; }, count, 1,
      [](std::size_t k) { return k % 5 == 0 ? SurveyPlaces::NoRegion : k % 2; } };
  }
};

struct Town
{
  Scene scene = town();
  ScanSetup setup;
  ScanBeams beams = horizon(200, 4);
  ScanResult still;

  Town()
  {
    EchoSettings settings = usual();
    settings.noise = false;
    settings.returnMode = ReturnMode::RangeUnits;
    this->setup = makeSetup(this->scene, search905(), settings);
    this->still = runScan(this->setup, this->beams);
  }

  bool look(CoverageSurvey& survey, const Around& around, std::uint64_t geometry = 1) const
  {
    return survey.look(this->setup, this->beams, this->still, around.places, geometry, 2, {});
  }
};

std::shared_ptr<const TargetViews> gullOf(double size)
{
  return std::make_shared<const TargetViews>(
    birdViews(birdtest::HerringGull.scaled(size), false, 0.03));
}

const SurveyTarget Gull{ 0.03, 0.3, gullOf(1.0) };
const SurveyRules Rules{ 2, 3, true, { 0.0, 15.0, 30.0 } };

std::vector<CoverageShares> sumsOf(CoverageSurvey& survey, const SurveyTarget& target,
  const SurveyRules& rules = Rules, int threads = 2)
{
  std::vector<CoverageShares> sums(2 * rules.bands());
  EXPECT_TRUE(survey.evaluate(target, rules, threads, {}, {}, sums.data()));
  return sums;
}

void expectSame(const std::vector<CoverageShares>& a, const std::vector<CoverageShares>& b)
{
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    EXPECT_EQ(a[i].byStatus, b[i].byStatus) << i;
    EXPECT_EQ(a[i].detected.value, b[i].detected.value) << i;
    EXPECT_EQ(a[i].tracked.value, b[i].tracked.value) << i;
  }
}
}

TEST(CoverageSurvey, IsThatOfEachPlaceAndSumsThoseWithARegion)
{
  const Town site;
  const Around around(9000); // more than one block
  CoverageSurvey survey;
  ASSERT_TRUE(site.look(survey, around));
  EXPECT_EQ(survey.traced(), 9000u);

  const Coverage coverage(site.setup, site.beams, Vec3(0.0, 0.0, 1.0), site.still);
  const CoverageTarget target = { site.setup.settings.attenuationCoefficient, Gull.area,
    Gull.reflectance,
    std::make_shared<const DetectionLaw>(site.setup.sensor, *Gull.views, coverage.lowest(),
      coverage.highest(), coverage.mostBeams()) };
  std::vector<CoverageSight> sights(around.points.size());
  ASSERT_TRUE(coverage.look(around.places.at, sights.size(), 1, {}, sights.data()));
  std::vector<CoverageShares> wanted(8);
  std::vector<CoverageValue> values;
  std::size_t seen = 0;
  for (std::size_t k = 0; k < sights.size(); ++k)
  {
    const Vec3& p = around.points[k];
    values.push_back(coverage.valueAt(p, sights[k], target));
    EXPECT_EQ(values.back().beams, sights[k].beams);
    const double q = values.back().probability;
    seen += q > 0.5;
    const int band = (p.z >= 0.0) + (p.z >= 15.0) + (p.z >= 30.0);
    if (k % 5 != 0)
    {
      wanted[k % 2 * 4 + band].add(
        strikeHeightDensity(p.z), values.back(), q * q * (3.0 - 2.0 * q)); // two of three
    }
  }
  EXPECT_GT(seen, 100u);

  std::vector<CoverageShares> sums(8);
  std::mutex mutex;
  std::size_t called = 0;
  ASSERT_TRUE(survey.evaluate(
    Gull, Rules, 2, {},
    [&](std::size_t k, const CoverageValue& value, double track)
    {
      const std::lock_guard<std::mutex> lock(mutex);
      ++called;
      EXPECT_EQ(value.status, values[k].status);
      EXPECT_TRUE(sameBits(value.probability, values[k].probability));
      const double q = value.probability;
      EXPECT_NEAR(track, q * q * (3.0 - 2.0 * q), 1e-12);
    },
    sums.data()));
  EXPECT_EQ(called, sights.size());
  for (std::size_t i = 0; i < sums.size(); ++i)
  {
    EXPECT_EQ(sums[i].detected.weight[0], wanted[i].detected.weight[0]) << i;
    EXPECT_NEAR(sums[i].detected.value[0], wanted[i].detected.value[0], 1e-10) << i;
    EXPECT_NEAR(sums[i].tracked.value[0], wanted[i].tracked.value[0], 1e-10) << i;
    if (wanted[i].detected.weight[1] > 0.0)
    {
      EXPECT_NEAR(sums[i].detected.stdError(), wanted[i].detected.stdError(), 1e-12) << i;
    }
    for (std::size_t s = 0; s < CoverageShares::Statuses; ++s)
    {
      EXPECT_NEAR(sums[i].byStatus[s], wanted[i].byStatus[s], 1e-10) << i << " " << s;
    }
  }
}

TEST(CoverageSurvey, LooksAgainOnlyWhereSomethingIsAnother)
{
  Town site;
  Around around(500);
  CoverageSurvey survey;
  const auto traced = [&](std::uint64_t geometry)
  {
    EXPECT_TRUE(site.look(survey, around, geometry));
    CoverageSurvey fresh;
    EXPECT_TRUE(site.look(fresh, around, geometry));
    expectSame(sumsOf(survey, Gull), sumsOf(fresh, Gull));
    return survey.traced();
  };
  EXPECT_EQ(traced(1), 500u);
  EXPECT_EQ(traced(1), 0u);
  EXPECT_EQ(traced(2), 500u);
  around.places.hash = 2;
  EXPECT_EQ(traced(2), 500u);
  site.setup.sensor.receiverAperture *= 2.0; // another law of detection alone
  EXPECT_EQ(traced(2), 0u);
  site.setup.settings.attenuationCoefficient = 1e-3;
  EXPECT_EQ(traced(2), 0u);
  site.setup.sensor.rangeGate = 200.0;
  EXPECT_EQ(traced(2), 500u);
  site.setup.sensor.minimumRange = 50.0;
  EXPECT_EQ(traced(2), 500u);
  site.setup.sensor.halfBeamwidth *= 2.0;
  EXPECT_EQ(traced(2), 500u);
  for (Vec3& origin : site.beams.origins)
  {
    origin.z += 1.0;
  }
  EXPECT_EQ(traced(2), 500u);
}

TEST(CoverageSurvey, SurveysShareLawsOfEqualInputs)
{
  // A law of 64 beams and one view takes 1 MB: the sixty-sixth pushes the first out.
  DetectionLaws laws;
  const auto views = std::make_shared<const TargetViews>(viewsOf({ Silhouette() }));
  Sensor sensor = search905();
  const auto of = [&](double limit)
  {
    sensor.lowerEnergyLimit = limit;
    return laws.get(sensor, views, 0.0, 0.0, DetectionLaw::MostBeams);
  };
  const auto first = of(1e-17);
  EXPECT_EQ(of(1e-17), first);
  EXPECT_NE(laws.get(sensor, views, 0.0, 4.0, DetectionLaw::MostBeams), first);
  EXPECT_NE(laws.get(sensor, gullOf(1.0), 0.0, 0.0, 1), first);
  sensor.receiverModel = search905().receiverModel == ReceiverModel::Photons
    ? ReceiverModel::EnergyLimits
    : ReceiverModel::Photons;
  EXPECT_NE(of(1e-17), first);
  sensor.receiverModel = search905().receiverModel;
  EXPECT_EQ(of(1e-17), first);
  const std::weak_ptr<const DetectionLaw> second = of(2e-17);
  for (int i = 0; i < 66; ++i)
  {
    of(1e-16 * (i + 1));
  }
  EXPECT_TRUE(second.expired());
  EXPECT_EQ(of(66e-16), of(66e-16));
}

TEST(CoverageSurvey, KeepsNoTargetForAnother)
{
  const Town site;
  const Around around(2000);
  CoverageSurvey survey;
  ASSERT_TRUE(site.look(survey, around));
  std::vector<std::shared_ptr<const TargetViews>> others;
  for (int i = 0; i < 20; ++i)
  {
    others.push_back(gullOf(1.0 + 0.1 * i));
  }
  for (int round = 0; round < 2; ++round)
  {
    for (int i = 0; i < 20; ++i) // more than are kept
    {
      SurveyTarget target = Gull;
      target.area *= i % 2 == 0 ? 1.0 + 0.1 * i : 1.0;
      target.views = i % 2 == 0 ? target.views : others[i];
      CoverageSurvey fresh;
      ASSERT_TRUE(site.look(fresh, around));
      expectSame(sumsOf(survey, target), sumsOf(fresh, target));
    }
  }
}

TEST(CoverageSurvey, TheSameOnAnyThreadsAndStops)
{
  const Town site;
  const Around around(20000);
  CoverageSurvey survey;
  const auto stop = [](double) { return false; };
  EXPECT_FALSE(survey.look(site.setup, site.beams, site.still, around.places, 1, 2, stop));
  ASSERT_TRUE(site.look(survey, around));
  EXPECT_EQ(survey.traced(), 20000u); // what was stopped is not kept
  expectSame(sumsOf(survey, Gull, Rules, 1), sumsOf(survey, Gull, Rules, 2));
  std::vector<CoverageShares> sums(2 * Rules.bands());
  EXPECT_FALSE(survey.evaluate(Gull, Rules, 2, stop, {}, sums.data()));
  expectSame(sums, std::vector<CoverageShares>(sums.size()));
}

TEST(CoverageSurvey, WithoutBeamsAllLiesBetweenThem)
{
  Town site;
  site.beams = {};
  const Around around(100);
  CoverageSurvey survey;
  ASSERT_TRUE(survey.look(site.setup, site.beams, {}, around.places, 1, 2, {}));
  SurveyRules rules = Rules;
  rules.strikeHeightWeights = false;
  double all = 0.0;
  for (const CoverageShares& sum : sumsOf(survey, Gull, rules))
  {
    EXPECT_EQ(sum.detected.value[0], 0.0);
    all += sum.byStatus[static_cast<std::size_t>(CoverageStatus::BetweenBeams)];
  }
  EXPECT_EQ(all, 80.0);
}

TEST(CoverageSurvey, RulesAreChecked)
{
  EXPECT_EQ(checkRules(Rules), "");
  EXPECT_EQ(checkRules({ 1, 101, false, {} }), "NumberOfScans is 101, expected 1 to 100");
  EXPECT_EQ(
    checkRules({ 4, 3, false, {} }), "RequiredDetections is 4, expected 1 to NumberOfScans");
  EXPECT_EQ(
    checkRules({ 1, 3, false, { 5.0, 5.0 } }), "HeightLimits is 5, expected finite and rising m");
}
