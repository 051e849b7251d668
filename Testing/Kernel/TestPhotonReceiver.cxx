// SPDX-License-Identifier: BSD-3-Clause
// The photon receiver: a table calculated by hand, probabilities against counted scans, and what
// free space does to walls and small targets.
#include "BeamReceiver.h"
#include "EchoTestScene.h"
#include "GeometryTestScene.h"
#include "RangeUnits.h"
#include "Search905.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace echotest;

namespace
{
/// A receiver whose numbers were calculated by hand. Ranges where the mean signal of a target of
/// reflectance 0.3 is at the threshold, in air of 8.9e-5/m.
struct Row
{
  Instrument of;
  double background, deviation, factor, threshold;
  double ranges[6]; ///< ranges of the areas below
};

constexpr double Areas[] = { 0.0052, 0.011, 0.018, 0.030, 0.067, Infinity };

constexpr Instrument AtNight{ 3.6e-4, 905e-9, 5.6e-3, 0.1, 0.4, 0.0, 10.0, 15360.0, 4000.0 };

const Row Rows[] = { { Search905, 3525.22, 119.062, 5.57752, 664.069,
                       { 436.15, 523.95, 590.83, 668.98, 812.60, 10598.0 } },
  { AtNight, 0.0, 60.0, 5.57752, 334.651, { 515.82, 619.23, 697.91, 789.75, 958.23, 12550.0 } },
  { Search1550, 584.804, 73.1739, 5.78924, 423.621,
    { 1090.17, 1302.39, 1462.56, 1648.13, 1984.83, 18542.0 } },
  { Automotive16, 31.6158, 60.7853, 5.37153, 326.510,
    { 93.28, 112.40, 127.05, 144.24, 176.08, 315.0 } } };

constexpr double Plumage = 0.3; // reflectance
constexpr double Haze = 8.9e-5; // 1/m

/// Where the mean signal falls to the threshold, m.
double detectionRange(const Sensor& sensor, double area)
{
  double near = 1.0;
  double far = 1e6;
  while (far - near > 1e-6)
  {
    const double middle = 0.5 * (near + far);
    const bool above =
      energyFromTarget(sensor, middle, area, Plumage, Haze) > sensor.lowerEnergyLimit;
    (above ? near : far) = middle;
  }
  return near;
}

/// How many of so many scans perceive a target that sends so many electrons, at random ranges
/// within a unit.
int countTargets(const Sensor& sensor, double electrons, int scans)
{
  const PhotonReceiver receiver(sensor);
  RangeUnitAccumulator units(sensor.samplingInterval, sensor.pulseWidth, sensor.rangeGate);
  const ScanAir clear(sensor, {});
  BeamReceiver beam(sensor, planNoise(sensor, true), 1, ReturnMode::RangeUnits, clear);
  const double length = sensor.rangeUnitLength();
  const double target = 700.0 * length;
  geometrytest::Numbers random(3);
  int count = 0;
  for (int scan = 0; scan < scans; ++scan)
  {
    units.clear();
    units.add(
      { 2.0 * (target + random(0.0, 1.0) * length), electrons / receiver.electronsPerJoule });
    units.accumulate();
    const Received received = beam.receive(
      scan, { units.units(), {}, sensor.backgroundRadiance }, BeamAir(clear), DrawnLeaves());
    bool perceived = false;
    for (const Return& found : received.returns)
    {
      perceived = perceived || std::fabs(found.range - target) < 2.0 * length;
    }
    count += perceived;
  }
  return count;
}

/// Within three standard errors of a probability.
void expectShare(int count, int of, double probability)
{
  const double error = std::sqrt(of * probability * (1.0 - probability));
  EXPECT_NEAR(count, of * probability, 3.0 * error + 1e-9) << probability;
}

constexpr int Scans = 100000;
constexpr double Gull = 0.030; // m^2
}

TEST(PhotonReceiver, HasTheNumbersOfTheTable)
{
  for (const Row& row : Rows)
  {
    const Sensor sensor = sensorOf(row.of);
    const PhotonReceiver receiver(sensor);
    EXPECT_NEAR(receiver.background, row.background, 1e-4 * row.background);
    EXPECT_NEAR(receiver.deviation(0.0), row.deviation, 1e-4 * row.deviation);
    EXPECT_NEAR(
      thresholdFactor(1.0, rangeUnitsOf(sensor, row.of.beams)), row.factor, 1e-4 * row.factor);
    EXPECT_NEAR(
      sensor.lowerEnergyLimit * receiver.electronsPerJoule, row.threshold, 1e-4 * row.threshold);
    EXPECT_NEAR(sensor.upperEnergyLimit / sensor.lowerEnergyLimit, 1e4, 1e-6);
    for (int k = 0; k < 6; ++k)
    {
      const double range = row.ranges[k];
      // The table's walls have no decimals.
      EXPECT_NEAR(detectionRange(sensor, Areas[k]), range, k < 5 ? 1e-4 * range : 0.5) << Areas[k];
    }
  }
}

TEST(PhotonReceiver, DetectsAsOftenAsItsProbabilitySays)
{
  Sensor sensor = sensorOf(Search905);
  sensor.pulseWidth = 0.0;
  const PhotonReceiver receiver(sensor);
  const double threshold = sensor.lowerEnergyLimit * receiver.electronsPerJoule;
  const struct
  {
    double range, electrons, probability;
  } cases[] = { { 300.0, 17535.4, 1.0 }, { 500.0, 2193.11, 1.0 }, { 600.0, 1038.97, 0.997821 },
    { 700.0, 550.918, 0.184228 }, { 668.98, 664.069, 0.5 } };
  for (const auto& c : cases)
  {
    const double electrons =
      receiver.electronsPerJoule * energyFromTarget(sensor, c.range, Gull, Plumage, Haze);
    EXPECT_NEAR(electrons, c.electrons, 1e-4 * c.electrons);
    const double probability = receiver.detectionProbability(electrons, threshold);
    EXPECT_NEAR(probability, c.probability, 2e-4);
    expectShare(countTargets(sensor, electrons, Scans), Scans, probability);
  }
}

TEST(PhotonReceiver, LosesWhatAPulseSharesBetweenTwoUnits)
{
  const Sensor sensor = sensorOf(Search905); // the pulse is as long as a unit
  expectShare(countTargets(sensor, 1038.97, Scans), Scans, 0.7154);
  expectShare(countTargets(sensor, 550.918, Scans), Scans, 0.0449);
}

TEST(PhotonReceiver, HasNoiseThatGrowsWithTheSignal)
{
  Sensor sensor = sensorOf(Search905);
  sensor.pulseWidth = 0.0;
  const PhotonReceiver receiver(sensor);
  const NoisePlan plan = planNoise(sensor, true);
  BeamNoise noise;
  for (const double electrons : { 1.0, 1000.0, 1e5 })
  {
    const double light = electrons / receiver.electronsPerJoule;
    statistics::Moments received;
    for (int scan = 0; scan < Scans; ++scan)
    {
      noise.begin(plan, { 1, static_cast<std::uint64_t>(scan) });
      received.add((light + noise.energy(700, light)) * receiver.electronsPerJoule);
    }
    const double expected = 3.0 * (electrons + 3525.22) + 60.0 * 60.0;
    EXPECT_NEAR(received.mean(), electrons, 3.0 * std::sqrt(expected / Scans)) << electrons;
    EXPECT_NEAR(received.variance() / expected, 1.0, 3.0 * std::sqrt(2.0 / Scans)) << electrons;
    EXPECT_NEAR(receiver.signalToNoise(electrons), electrons / std::sqrt(expected), 1e-4);
  }
}

TEST(PhotonReceiver, FaintLightIsPerceivedWithRareDeviatesAlone)
{
  const Sensor sensor = sensorOf(Search905);
  const NoisePlan plan = planNoise(sensor, true);
  const double limit = sensor.lowerEnergyLimit;
  BeamNoise noise;
  int faint = 0;
  int rare = 0;
  int perceived = 0;
  for (std::uint64_t beam = 0; beam < 400; ++beam)
  {
    noise.begin(plan, { 3, static_cast<std::uint64_t>(beam) });
    for (std::int64_t unit = 0; unit < 1000; ++unit)
    {
      const double light = limit * static_cast<double>(unit % 100) / 80.0;
      const double received = light + noise.energy(unit, light);
      const bool isRare = noise.isRare(unit);
      perceived += received > limit;
      rare += isRare;
      if (light < plan.faintLight && !isRare)
      {
        ++faint;
        ASSERT_LT(received, limit);
      }
    }
  }
  EXPECT_GT(faint, 100000);
  EXPECT_GT(perceived, 50000);
  expectShare(rare, 400000, 1.0 - 0.9986);
}

TEST(PhotonReceiver, SeesWallsFallWithTheSquareOfTheRangeAndTargetsWithTheFourthPower)
{
  Sensor sensor = sensorOf(Search905);
  sensor.samplingInterval = 1e-3; // all in one unit
  sensor.pulseWidth = 0.0;
  sensor.rangeGate = 1e6;
  sensor.lowerEnergyLimit = 0.0;
  const EchoSettings settings = inCells(1000);
  const Material matt{ Plumage, 0.0, 1.0 };
  const auto energyOf = [&](double range, double size)
  {
    Scene scene = squareAt(range, size, matt);
    const ScanResult result = runScan(makeSetup(scene, sensor, settings), oneBeam());
    return result.echoes.empty() ? 0.0 : result.echoes[0].energyReceived;
  };
  EXPECT_NEAR(energyOf(1000.0, 100.0) / energyOf(100.0, 100.0), 1e-2, 2e-4);
  EXPECT_NEAR(energyOf(1000.0, 0.05) / energyOf(100.0, 0.05), 1e-4, 2e-6);
  // And as much as the closed form says.
  for (const double half : { 100.0, 0.05 })
  {
    const double area = half > 1.0 ? Infinity : 4.0 * half * half;
    EXPECT_NEAR(
      energyOf(1000.0, half) / energyFromTarget(sensor, 1000.0, area, Plumage, 0.0), 1.0, 1e-3);
  }
}

TEST(PhotonReceiver, SaysHowManyFalseAlarmsSingleElectronsWouldRaise)
{
  // Of SciPy: of P(F N - n_b + n_a z > k sigma0) over P(z > k), N a Poisson number of mean n_b/F,
  // summed over N. The first three are presets.
  const struct
  {
    double background, excess, amplifier, factor, times, within;
  } cases[] = { { 3525.22, 3.0, 60.0, 5.57752, 1.68135, 0.01 },
    { 584.804, 3.0, 60.0, 5.78924, 1.54070, 0.02 }, { 31.6158, 3.0, 60.0, 5.37153, 1.03514, 0.01 },
    { 3525.22, 3.0, 10.0, 5.57752, 2.15929, 0.02 }, { 20.0, 3.0, 5.0, 5.58, 81.6327, 0.2 },
    { 20.0, 1.0, 0.0, 5.58, 88.1648, 0.1 }, { 3.5, 1.0, 2.0, 5.58, 46.4667, 0.2 },
    { 3.5, 1.0, 0.0, 4.5, 85.0559, 0.2 }, { 3.5, 1.0, 0.0, 5.57752, 1525.01, 0.1 },
    // Far from one electron a unit counts are no gamma distribution; they warn.
    { 0.18, 1.0, 0.0, 5.57752, 69417.0, 9.0 }, { 0.07, 1.0, 0.0, 5.57752, 190000.0, 9.0 } };
  for (const auto& c : cases)
  {
    Sensor sensor = sensorOf(Search905);
    sensor.backgroundRadiance *= c.background / PhotonReceiver(sensor).background;
    sensor.excessNoiseFactor = c.excess;
    sensor.amplifierNoise = c.amplifier;
    const PhotonReceiver receiver(sensor);
    sensor.lowerEnergyLimit = c.factor * receiver.deviation(0.0) / receiver.electronsPerJoule;
    EXPECT_NEAR(falseAlarmsOfElectrons(sensor) / c.times, 1.0, c.within) << c.background;
    EXPECT_EQ(warningOnElectrons(sensor).empty(), c.times < 10.0) << c.background;
  }
  // None is added to the noise of the amplifier alone, nor where there are ever so many electrons.
  EXPECT_EQ(falseAlarmsOfElectrons(sensorOf(AtNight)), 1.0);
  Sensor bright = sensorOf(Search905);
  for (double radiance = 1.0; radiance < 1e10; radiance *= 10.0)
  {
    bright.backgroundRadiance = radiance;
    ASSERT_EQ(setPhotonLimits(bright, 1.0, 40.0, 15360.0), "");
    EXPECT_NEAR(falseAlarmsOfElectrons(bright), 1.0, 1.0 / std::sqrt(radiance)) << radiance;
    EXPECT_GE(falseAlarmsOfElectrons(bright), 1.0 - 1e-9) << radiance;
  }
  // A receiver of given limits counts its photons.
  Sensor given = sensorOf(Search905);
  given.receiverModel = ReceiverModel::EnergyLimits;
  given.backgroundRadiance = 0.0;
  EXPECT_EQ(warningOnElectrons(given), "");
}

TEST(PhotonReceiver, NamesWhatIsWrong)
{
  const Sensor good = sensorOf(Search905);
  Sensor dark = good;
  dark.backgroundRadiance = 0.0;
  dark.amplifierNoise = 0.0;
  statistics::expectSays(checkSensor(dark), "amplifier_noise is 0");
  Sensor sensor = good;
  for (const double alarms : { 0.0, -1.0, 1e9, static_cast<double>(NAN) })
  {
    statistics::expectSays(
      setPhotonLimits(sensor, alarms, 40.0, 15360.0), "false_alarms_per_scan is");
  }
  statistics::expectSays(setPhotonLimits(sensor, 1000.0, 40.0, 1.0), "a tenth of the range units");
  statistics::expectSays(setPhotonLimits(sensor, 1.0, -1.0, 15360.0), "dynamic_range is -1");
}
