// SPDX-License-Identifier: BSD-3-Clause
// The law of detection against closed forms and targets that are drawn one by one.
#include "BirdTestScene.h"
#include "DetectionLaw.h"
#include "Search905.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

using namespace avianlidar;
using echotest::search905;

namespace
{
constexpr double Plumage = 0.3; // reflectance
constexpr double Haze = 8.9e-5; // 1/m

const TargetViews PointViews = viewsOf({ Silhouette() });

/// A plate across the line of sight, or slanted, that shows an area.
Silhouette slanted(double width, double height, double slope, double area)
{
  return Silhouette(birdtest::plateOfSlope(width, height, slope), Vec3(0.0, 1.0, 0.0),
    width * height / (area * std::sqrt(1.0 + slope * slope)));
}

double energyAt(const Sensor& sensor, double range, double area = 0.03)
{
  return energyFromTarget(sensor, range, area, Plumage, Haze);
}
}

TEST(DetectionLaw, PulsesOfOtherBeamsAreIndependent)
{
  const Sensor sensor = search905(0.0);
  const DetectionLaw law(sensor, PointViews);
  for (const double range : { 500.0, 620.0, 660.0, 680.0, 720.0, 900.0 })
  {
    const double energy = energyAt(sensor, range);
    const PhotonReceiver receiver(sensor);
    const double p = receiver.detectionProbability(
      receiver.electronsPerJoule * energy, receiver.electronsPerJoule * sensor.lowerEnergyLimit);
    for (const int beams : { 1, 2, 5, 64 })
    {
      EXPECT_NEAR(law.probability(energy, beams), 1.0 - std::pow(1.0 - p, beams), 2e-4);
    }
    EXPECT_EQ(law.probability(energy, 0), 0.0);
    EXPECT_EQ(law.probability(energy, 1000), law.probability(energy, DetectionLaw::MostBeams));
  }
  EXPECT_EQ(law.probability(0.0, 3), 0.0);
  EXPECT_LT(law.probability(1e-6 * sensor.lowerEnergyLimit, 64), 1e-5);
  EXPECT_NEAR(law.probability(1e9 * sensor.lowerEnergyLimit, 1), 1.0, 1e-12);
}

TEST(DetectionLaw, TargetsDrawnOneByOne)
{
  const std::vector<double> areas = { 0.24, 0.5, 0.7, 0.9, 1.2, 1.46, 2.0 };
  const TargetPoses poses(areas.begin(), areas.end());
  for (const double width : { 2e-9, 5e-9, 12e-9 })
  {
    const Sensor sensor = search905(width);
    const DetectionLaw law(sensor, viewsOf(poses));
    const PhotonReceiver receiver(sensor);
    const double units = width / sensor.samplingInterval;
    const double threshold = receiver.electronsPerJoule * sensor.lowerEnergyLimit;
    for (const double over : { 0.8, 1.3, 2.5 })
    {
      for (const int beams : { 1, 4 })
      {
        std::mt19937_64 random(7);
        std::uniform_real_distribution<double> uniform(0.0, 1.0);
        std::normal_distribution<double> normal;
        constexpr int Targets = 40000;
        int detected = 0;
        for (int target = 0; target < Targets; ++target)
        {
          const double electrons = over * threshold * areas[target % areas.size()];
          const double begin = uniform(random) - 0.5 * units;
          bool perceived = false;
          for (int beam = 0; beam < beams; ++beam)
          {
            for (int unit = -3; unit <= 3; ++unit)
            {
              const double overlap =
                std::min(begin + units, unit + 1.0) - std::max(begin, 1.0 * unit);
              const double n = electrons * std::max(0.0, overlap) / units;
              perceived =
                perceived || (n > 0.0 && n + normal(random) * receiver.deviation(n) > threshold);
            }
          }
          detected += perceived;
        }
        const double p = law.probability(over * sensor.lowerEnergyLimit, beams);
        EXPECT_NEAR(detected / double(Targets), p, 3.5 * std::sqrt(p * (1.0 - p) / Targets) + 3e-4)
          << width << " s, " << over << ", " << beams << " beams";
      }
    }
  }
}

TEST(DetectionLaw, LimitsWithoutNoise)
{
  Sensor sensor; // the paper's
  const DetectionLaw law(sensor, PointViews);
  const double limit = sensor.lowerEnergyLimit;
  EXPECT_EQ(law.probability(0.95 * limit, 9), 0.0);
  EXPECT_NEAR(law.probability(2.1 * limit, 1), 1.0, 1e-12);
  for (const double over : { 1.2, 1.5, 1.8 })
  {
    // The larger of s and 1 - s exceeds the limit.
    const double wanted = 2.0 * (1.0 - 1.0 / over);
    EXPECT_NEAR(law.probability(over * limit, 1), wanted, 1.0 / 32.0);
    EXPECT_EQ(law.probability(over * limit, 1), law.probability(over * limit, 7));
  }
}

TEST(DetectionLaw, EnergyForAProbability)
{
  const Sensor sensor = search905(5e-9);
  const DetectionLaw law(sensor, viewsOf({ Silhouette(0.3), Silhouette(0.8), Silhouette(1.9) }));
  for (const int beams : { 1, 3, 10 })
  {
    double before = 0.0;
    for (const double wanted : { 0.01, 0.1, 0.5, 0.9, 0.999 })
    {
      const double energy = law.energyFor(wanted, beams);
      EXPECT_NEAR(law.probability(energy, beams), wanted, 1e-6);
      EXPECT_GT(energy, before);
      before = energy;
    }
    EXPECT_GT(law.energyFor(0.5, beams), law.energyFor(0.5, beams + 1));
  }
  EXPECT_TRUE(std::isinf(law.energyFor(0.5, 0)));
}

TEST(DetectionLaw, WholeTargetsInSeveralBeams)
{
  const Sensor sensor = search905(5e-9);
  TargetPoses poses;
  for (int i = 0; i < 24; ++i)
  {
    poses.push_back(slanted(1.0, 0.4, 0.2, 0.2 + 1.6 * (i + 0.5) / 24.0));
  }
  const DetectionLaw law(sensor, viewsOf(poses, 0.6));
  EXPECT_EQ(law.reach(), 0.6);
  const BeamAtTarget whole{ 3.0, 0.2, 0.0 };
  const BeamAtTarget half{ 60.0, 0.0, 60.0 };
  for (double over = 0.5; over < 20.0; over *= 1.3)
  {
    const double energy = over * sensor.lowerEnergyLimit;
    for (const std::size_t beams : { 1u, 2u, 5u })
    {
      const std::vector<BeamAtTarget> all(beams, whole);
      EXPECT_NEAR(law.probability(energy, 1.0, all.data(), beams),
        law.probability(energy, static_cast<int>(beams)), 0.015)
        << over;
    }
    EXPECT_NEAR(law.probability(energy, 1.0, &half, 1), law.probability(0.5 * energy, 1), 0.02);
  }
  EXPECT_EQ(law.probability(1.0, 1.0, nullptr, 0), 0.0);
}

TEST(DetectionLaw, ManyNarrowBeamsLightTheirPartsEach)
{
  // Each beam is filled by the plate; energies are spread by 15 %.
  Sensor sensor; // limits
  sensor.pulseWidth = 0.0;
  const DetectionLaw law(sensor, viewsOf({ slanted(1.0, 0.5, 0.0, 1.0) }, 0.6));
  const double limit = sensor.lowerEnergyLimit;
  const double radius = 0.05;
  const double share = Pi * radius * radius / 0.5; // of the plate, in a beam that it fills
  const std::vector<BeamAtTarget> row = { { radius, -0.3, 0.0 }, { radius, 0.0, 0.1 },
    { radius, 0.3, 0.0 }, { radius, 2.0, 0.0 } };
  EXPECT_EQ(law.probability(1.5 * limit / share, 1.0, row.data(), row.size()), 1.0);
  EXPECT_EQ(law.probability(0.7 * limit / share, 1.0, row.data(), row.size()), 0.0);
  // Between two beams it lies unseen, however bright.
  const std::vector<BeamAtTarget> beside = { { radius, 0.0, 0.4 }, { radius, 0.0, -0.4 } };
  EXPECT_EQ(law.probability(1e6 * limit, 1.0, beside.data(), beside.size()), 0.0);
}

TEST(DetectionLaw, ElevationsAreInterpolatedPoseByPose)
{
  const Sensor sensor = search905(5e-9);
  TargetViews views = viewsOf(TargetPoses(60));
  views.step = 0.1;
  views.from = [](double elevation)
  { return std::make_shared<const TargetPoses>(60, Silhouette(elevation > 0.05 ? 2.0 : 0.5)); };
  const DetectionLaw law(sensor, views, 0.0, 0.1, 2);
  ASSERT_EQ(law.views(), 2u);
  const BeamAtTarget beam{ 1.0, 0.0, 0.0 };
  for (const double share : { 0.0, 0.2, 0.5, 0.7, 1.0 })
  {
    const double energy = 1.2 * sensor.lowerEnergyLimit;
    const auto at = law.betweenAt(0.1 * share);
    const double wanted = (1.0 - share) * law.probability(energy, 1, law.betweenAt(-1.0)) +
      share * law.probability(energy, 1, law.betweenAt(1.0));
    EXPECT_NEAR(law.probability(energy, 1, at), wanted, 1e-9);
    EXPECT_NEAR(law.probability(energy, 1.0, &beam, 1, at), wanted, 0.025);
    std::vector<double> each(60);
    law.probability(energy, 1.0, &beam, 1, at, each.data());
    double mean = 0.0;
    for (const double p : each)
    {
      mean += p / 60.0;
    }
    EXPECT_NEAR(mean, law.probability(energy, 1.0, &beam, 1, at), 1e-12);
    law.ofPoses(energy, 1, at, each.data());
    for (const double p : each)
    {
      mean -= p / 60.0;
    }
    EXPECT_NEAR(mean, 0.0, 1e-12);
  }
}

TEST(DetectionLaw, ABeamReceivesNoMoreThanOfATargetThatFillsIt)
{
  const Sensor sensor = search905(5e-9);
  const DetectionLaw law(sensor, PointViews);
  const BeamAtTarget narrow{ 0.05, 0.0, 0.0 };
  const double most = 5.0 * sensor.lowerEnergyLimit;
  EXPECT_NEAR(law.probability(1000.0 * most, most, &narrow, 1), law.probability(most, 1), 0.01);
}

TEST(DetectionLaw, ALimitOfZeroPerceivesEverything)
{
  Sensor sensor;
  sensor.lowerEnergyLimit = 0.0;
  const DetectionLaw law(sensor, PointViews);
  EXPECT_NEAR(law.probability(1e-30, 1), 1.0, 1e-12);
  EXPECT_EQ(law.probability(0.0, 1), 0.0);
}

TEST(DetectionLaw, ManyUnitsAreAsFewTogether)
{
  // Without noise of the amplifier and background a deep target in short units.
  Sensor sensor = search905(5e-9);
  sensor.samplingInterval = 1e-18;
  EXPECT_EQ(setPhotonLimits(sensor, 1.0, 40.0, 1.0), "");
  const DetectionLaw law(sensor, viewsOf({ slanted(1.0, 0.3, 1.0, 1.0) }, 0.6)); // returns soon
  EXPECT_LT(law.probability(sensor.lowerEnergyLimit, 1), 0.1);
  double before = 0.0;
  for (double over = 1.0; over < 1e4; over *= 2.0)
  {
    const double p = law.probability(over * sensor.lowerEnergyLimit, 1);
    EXPECT_GE(p, before);
    before = p;
  }
}
