// SPDX-License-Identifier: BSD-3-Clause
// Photon noise: tails and quantiles at their ends, the bound, and false alarms.
#include "BeamNoise.h"
#include "Distributions.h"
#include "RangeUnits.h"
#include "Sanitized.h"
#include "Search905.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace avianlidar;

namespace
{
/// A sensor whose limit is a few photons, with a gate of about a thousand units.
Sensor photonCounter(double meanPhotons, double limitPhotons)
{
  Sensor sensor;
  sensor.samplingInterval = 1e-9;
  sensor.pulseWidth = 0.0;
  sensor.rangeGate = 150.0;
  sensor.noisePhotonRate = meanPhotons / sensor.samplingInterval;
  sensor.lowerEnergyLimit = limitPhotons * sensor.photonEnergy();
  sensor.upperEnergyLimit = 1.0;
  return sensor;
}
}

// Others are TestStabilityReceiver's.
TEST(Noise, TailsAndQuantilesAtTheEnds)
{
  EXPECT_EQ(poissonCdf(5.0, -1.0), 0.0);
  EXPECT_EQ(poissonTail(5.0, -1.0), 1.0);
  EXPECT_EQ(poissonCdf(0.0, 0.0), 1.0);
  EXPECT_EQ(poissonTail(1e-4, 1e10), 0.0);
  EXPECT_EQ(poissonTail(1e12, 1e3), 1.0);
  EXPECT_EQ(poissonQuantile(1e-4, 1.0, 1e-46), 9.0);
  EXPECT_EQ(poissonQuantile(0.0, 0.5, 0.5), 0.0);
  EXPECT_EQ(poissonQuantile(5.0, 0.0, 1.0), 0.0);
  EXPECT_EQ(poissonQuantile(5.0, 1.0, 0.0), std::numeric_limits<double>::infinity());
}

TEST(NoisePlan, PaperTableTwoIsProvenNegligible)
{
  Sensor sensor;
  EXPECT_NEAR(sensor.photonEnergy(), 2.1951938e-19, 1e-27);
  // One photon is 518 units of round-off of Qlow: it would show in the sum, so it is left out by
  // proof.
  EXPECT_NEAR(std::nextafter(2e-6, 1.0) - 2e-6, 4.235164736e-22, 1e-30);
  const NoisePlan plan = planNoise(sensor, true);
  EXPECT_FALSE(plan.active);
  EXPECT_NEAR(plan.meanPhotons, 1e-4, 1e-18);
  EXPECT_EQ(plan.gateUnits, 5338);
  EXPECT_NEAR(plan.bound / sensor.photonEnergy(), 9.0, 1e-12);
  EXPECT_LT(plan.bound, 1.1e-12 * sensor.lowerEnergyLimit);
  EXPECT_EQ(checkNoise(plan, 1u << 30), "");
  BeamNoise noise;
  noise.begin(plan, { 0, 0 });
  EXPECT_TRUE(noise.alarms().empty());
  EXPECT_EQ(noise.energy(100), 0.0);
}

TEST(NoisePlan, SwitchedOffOrAbsent)
{
  const NoisePlan off = planNoise(photonCounter(3.0, 1.0), false);
  EXPECT_FALSE(off.active);
  EXPECT_EQ(off.bound, 0.0);
  Sensor silent;
  silent.noisePhotonRate = 0.0;
  silent.lowerEnergyLimit = 0.0;
  EXPECT_FALSE(planNoise(silent, true).active);
}

TEST(NoisePlan, TooManyFalseAlarmsAreAnError)
{
  const NoisePlan manyPhotons = planNoise(photonCounter(1e13, 1.0), true);
  statistics::expectSays(checkNoise(manyPhotons, 1), "noise_photon_rate");
  Sensor sensor = photonCounter(10.0, 0.0);
  sensor.rangeGate = 1e6; // 6.7 million units
  statistics::expectSays(checkNoise(planNoise(sensor, true), 1), "per beam");
  const NoisePlan thousand = planNoise(photonCounter(10.0, 0.0), true);
  EXPECT_EQ(checkNoise(thousand, 1000), "");
  statistics::expectSays(checkNoise(thousand, 1000000), "1000000 beams");
}

TEST(NoisePlan, LimitsDecideByTheProduct)
{
  for (const double limit : { 0.0, 0.5, 1.0, 3.0, 7.999999, 1e6 })
  {
    const Sensor sensor = photonCounter(5.0, limit);
    const NoisePlan plan = planNoise(sensor, true);
    EXPECT_LE(plan.alarmPhotons * plan.photonEnergy, sensor.lowerEnergyLimit);
    EXPECT_GT((plan.alarmPhotons + 1.0) * plan.photonEnergy, sensor.lowerEnergyLimit);
  }
}

TEST(NoiseBeam, EveryUnitIsPoissonAndAlarmsAreItsTail)
{
  for (const double mean : { 0.05, 2.0, 9.0 })
  {
    const Sensor sensor = photonCounter(mean, 4.0);
    const NoisePlan plan = planNoise(sensor, true);
    ASSERT_TRUE(plan.active);
    constexpr int most = 40;
    std::vector<double> counts(most + 1, 0.0);
    double units = 0.0;
    BeamNoise noise;
    for (std::uint64_t beam = 0; beam < 100; ++beam)
    {
      noise.begin(plan, { 12, static_cast<std::uint64_t>(beam) });
      for (std::int64_t unit = 0; unit < plan.gateUnits; ++unit)
      {
        const double energy = noise.energy(unit);
        const bool alarm = std::binary_search(noise.alarms().begin(), noise.alarms().end(), unit);
        ASSERT_EQ(alarm, energy > sensor.lowerEnergyLimit);
        counts[std::min<std::size_t>(most, std::llround(energy / plan.photonEnergy))] += 1.0;
        units += 1.0;
      }
    }
    for (int count = 0; count < most; ++count)
    {
      const double p = std::exp(count * std::log(mean) - mean - std::lgamma(count + 1.0));
      EXPECT_NEAR(counts[count], units * p, 4.5 * std::sqrt(units * p) + 4.0)
        << mean << ' ' << count;
    }
  }
}

TEST(NoiseBeam, RareAlarmsComeAtTheirRate)
{
  // Photons: P(b > 8) = 1.1e-6 per unit at a mean of 1, in a thousand units of each beam. Gaussian
  // noise: one alarm in a scan of 15,360 beams.
  for (const bool gaussian : { false, true })
  {
    const Sensor sensor = gaussian ? echotest::search905() : photonCounter(1.0, 8.0);
    const NoisePlan plan = planNoise(sensor, true);
    const double rate =
      gaussian ? 1.0 / 15360.0 / static_cast<double>(plan.gateUnits) : poissonTail(1.0, 8.0);
    EXPECT_NEAR(plan.falseAlarmsPerBeam / (rate * plan.gateUnits), 1.0, 1e-9);
    BeamNoise noise;
    double alarms = 0.0;
    double place = 0.0;
    double excess = 0.0;
    const std::uint64_t beams = IsSanitized || !gaussian ? 1000000 : 15360000;
    for (std::uint64_t beam = 0; beam < beams; ++beam)
    {
      noise.begin(plan, { 5, beam });
      for (const std::int64_t unit : noise.alarms())
      {
        alarms += 1.0;
        place += (static_cast<double>(unit) + 0.5) / static_cast<double>(plan.gateUnits);
        excess += noise.energy(unit) / sensor.lowerEnergyLimit;
        ASSERT_GT(noise.energy(unit), sensor.lowerEnergyLimit);
      }
    }
    const double expected = plan.falseAlarmsPerBeam * static_cast<double>(beams);
    EXPECT_NEAR(alarms, expected, 4.0 * std::sqrt(expected));
    EXPECT_NEAR(place / alarms, 0.5, 4.0 / std::sqrt(12.0 * alarms));
    if (gaussian)
    {
      // The mean of a Gaussian tail beyond k is density over probability, its variance about 1/k^2.
      const double k = 5.57752;
      const double beyond =
        std::exp(-0.5 * k * k) / std::sqrt(2.0 * Pi) / (0.5 * std::erfc(k / std::sqrt(2.0)));
      EXPECT_NEAR(k * excess / alarms, beyond, 3.0 / k / std::sqrt(alarms));
    }
  }
}

TEST(NoiseBeam, AlmostEveryUnitAlarms)
{
  const NoisePlan plan = planNoise(photonCounter(1e4, 1.0), true);
  BeamNoise noise;
  noise.begin(plan, { 0, 0 });
  EXPECT_EQ(noise.alarms().size(), static_cast<std::size_t>(plan.gateUnits));
  EXPECT_TRUE(std::is_sorted(noise.alarms().begin(), noise.alarms().end()));
  Sensor gated = photonCounter(1e4, 1.0);
  gated.minimumRange = 30.0;
  noise.begin(planNoise(gated, true), { 0, 0 });
  EXPECT_EQ(noise.alarms().front(), 200); // units of 0.1499 m
  EXPECT_EQ(noise.energy(199), 0.0);
  EXPECT_GT(noise.energy(200), 0.0);
}
