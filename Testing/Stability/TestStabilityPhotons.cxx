// SPDX-License-Identifier: BSD-3-Clause
// The photon receiver and its Gaussian noise, from no background light to 1e12 electrons of it,
// beside the complementary error function of 50 digits and the moments and shares that the noise
// must have.
#include "EchoTestScene.h"
#include "PhotonReceiver.h"
#include "RangeUnits.h"
#include "StabilityTable.h"

#include <boost/math/special_functions/erf.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include <gtest/gtest.h>

#include <functional>
#include <limits>

using namespace echotest;
using stability::record;
using stability::Worst;

namespace
{
constexpr double Beams = 1e6; // of a scan
const std::string Range = "0 to 1e12 background electrons, amplifier 0 to 1e6, excess 1 to 1e3";

Sensor dark()
{
  Sensor sensor;
  sensor.receiverModel = ReceiverModel::Photons;
  sensor.receiverAperture = 0.25e-2 * Pi;
  sensor.backgroundRadiance = 0.0;
  sensor.amplifierNoise = 0.0;
  return sensor;
}

/// Every receiver that has noise, with limits for each number of false alarms.
void forEachReceiver(const std::function<void(const Sensor&, double falseAlarms, int number)>& f)
{
  Sensor sensor = dark();
  sensor.backgroundRadiance = 1.0;
  const double electronsOfRadiance = PhotonReceiver(sensor).background;
  int number = 0;
  for (const double background : { 0.0, 1e-6, 1.0, 1e3, 1e6, 1e9, 1e12 })
  {
    for (const double amplifier : { 0.0, 1e-3, 60.0, 1e6 })
    {
      for (const double excess : { 1.0, 3.0, 30.0, 1e3 })
      {
        if (background + amplifier == 0.0)
        {
          continue; // an error
        }
        sensor.backgroundRadiance = background / electronsOfRadiance;
        sensor.amplifierNoise = amplifier;
        sensor.excessNoiseFactor = excess;
        for (const double falseAlarms : { 1.0, 1e4, 1e6, 1e8 })
        {
          ASSERT_EQ(setPhotonLimits(sensor, falseAlarms, 40.0, Beams), "");
          ASSERT_EQ(checkSensor(sensor), "");
          f(sensor, falseAlarms, number++);
        }
      }
    }
  }
  EXPECT_EQ(number, 432);
}
}

TEST(StabilityPhotons, FalseAlarmsAreThoseAskedFor)
{
  using Digits50 = boost::multiprecision::cpp_bin_float_50;
  Worst error;
  Worst counted;
  Worst wrong;
  BeamNoise noise;
  forEachReceiver(
    [&](const Sensor& sensor, double falseAlarms, int number)
    {
      const PhotonReceiver receiver(sensor);
      const NoisePlan plan = planNoise(sensor, true);
      EXPECT_EQ(checkNoise(plan, static_cast<std::uint64_t>(Beams)), "");
      const Digits50 variance = Digits50(receiver.excess) * receiver.background +
        Digits50(sensor.amplifierNoise) * sensor.amplifierNoise;
      const Digits50 k =
        Digits50(sensor.lowerEnergyLimit) * receiver.electronsPerJoule / sqrt(variance);
      const Digits50 expected =
        boost::math::erfc(Digits50(k / sqrt(Digits50(2)))) / 2 * rangeUnitsOf(sensor, Beams);
      error.see(static_cast<double>(abs(expected / falseAlarms - 1)));
      error.see(std::fabs(plan.falseAlarmsPerBeam * Beams / falseAlarms - 1.0));
      // Some 500 of them, if not too many beams are needed.
      const double beams = 500.0 * Beams / falseAlarms;
      if (beams > 1e5)
      {
        return;
      }
      double alarms = 0.0;
      for (std::uint64_t beam = 0; beam < static_cast<std::uint64_t>(beams); ++beam)
      {
        noise.begin(plan, number, beam);
        for (const std::int64_t unit : noise.alarms())
        {
          alarms += 1.0;
          wrong.see(noise.energy(unit) > sensor.lowerEnergyLimit ? 0.0 : 1.0);
        }
      }
      counted.see(std::fabs(alarms - 500.0) / std::sqrt(500.0));
    });
  const std::string range = Range + ", 1 to 1e8 false alarms in 1e6 beams";
  record({ "Gaussian noise", range, "relative error of the false alarms, beside erfc of 50 digits",
    1e-12, error.value() });
  record({ "Gaussian noise", Range + ", 1e4 to 1e8 false alarms in 1e6 beams",
    "false alarms drawn off their number, in standard deviations", 4.5, counted.value() });
  record({ "Gaussian noise", range,
    "1 if the noise of a false alarm does not exceed the limit, else 0", 0.0, wrong.value() });
}

TEST(StabilityPhotons, NoiseHasItsMomentsAndDetectsWithItsProbability)
{
  constexpr int Draws = 5000;
  Worst mean;
  Worst variance;
  Worst share;
  Worst wrong;
  BeamNoise noise;
  forEachReceiver(
    [&](const Sensor& sensor, double, int number)
    {
      const PhotonReceiver receiver(sensor);
      const NoisePlan plan = planNoise(sensor, true);
      ASSERT_GE(plan.gateUnits, Draws);
      const double limit = sensor.lowerEnergyLimit;
      const double threshold = limit * receiver.electronsPerJoule;
      double before = 0.0;
      for (const double electrons : { 0.0, 0.5 * threshold, threshold, 2.0 * threshold, 1e12 })
      {
        const double light = electrons / receiver.electronsPerJoule;
        const double deviation = receiver.deviation(electrons);
        double sum = 0.0;
        double squares = 0.0;
        double perceived = 0.0;
        noise.begin(plan, number, 7, static_cast<int>(std::min(electrons, 1e6)));
        for (std::int64_t unit = 0; unit < Draws; ++unit)
        {
          const double energy = noise.energy(unit, light);
          const double z = energy * receiver.electronsPerJoule / deviation;
          sum += z;
          squares += z * z;
          perceived += light + energy > limit;
          const auto& alarms = noise.alarms();
          const bool alarm = std::binary_search(alarms.begin(), alarms.end(), unit);
          wrong.see(electrons > 0.0 || (energy > limit) == alarm ? 0.0 : 1.0);
          wrong.see(
            light >= plan.faintLight || alarm || noise.isRare(unit) || light + energy <= limit
              ? 0.0
              : 1.0);
        }
        mean.see(std::fabs(sum) / std::sqrt(Draws));
        variance.see(std::fabs(squares / Draws - 1.0) / std::sqrt(2.0 / Draws));
        const double p = receiver.detectionProbability(electrons, threshold);
        wrong.see(p >= 0.0 && p <= 1.0 && (electrons == 1e12 || p >= before) ? 0.0 : 1.0);
        before = p;
        if (p > 0.01 && p < 0.99)
        {
          share.see(std::fabs(perceived - p * Draws) / std::sqrt(p * (1.0 - p) * Draws));
        }
      }
    });
  const std::string range = Range + ", light of 0 to 1e12 electrons";
  record({ "Gaussian noise", range, "mean off 0, in standard deviations of 5,000 draws", 4.5,
    mean.value() });
  record({ "Gaussian noise", range, "variance off F (n + n_b) + n_a^2, likewise", 4.5,
    variance.value() });
  record({ "Gaussian noise", range, "units perceived off their probability, likewise", 4.5,
    share.value() });
  record({ "Gaussian noise", range,
    "1 if a unit is perceived that must not be, or a probability is none, else 0", 0.0,
    wrong.value() });
}

TEST(StabilityPhotons, ScansHaveEchoesThatAreNumbers)
{
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.0, 20.0, 0.0), Vec3(0.0, 0.0, 20.0), Wall);
  std::size_t echoes = 0;
  std::size_t bad = 0;
  forEachReceiver(
    [&](const Sensor& sensor, double, int number)
    {
      EchoSettings settings;
      settings.seed = number;
      // To the end of its last unit.
      const double gate = sensor.rangeUnitLength() *
        static_cast<double>(unitsInsideGate(sensor.samplingInterval, sensor.rangeGate));
      const ScanSetup setup = makeSetup(scene, sensor, settings);
      for (const Echo& echo : runScan(setup, oneBeam()).echoes)
      {
        ++echoes;
        bad += !(echo.range >= 0.0 && echo.range <= gate &&
          echo.energyReceived > sensor.lowerEnergyLimit && std::isfinite(echo.energyReceived) &&
          std::isfinite(echo.returnEnergy) && std::isfinite(echo.energyStdError));
      }
      const double times = falseAlarmsOfElectrons(sensor);
      bad += !(times >= 0.0 && times < std::numeric_limits<double>::infinity());
    });
  EXPECT_GT(echoes, 10000u);
  record({ "Gaussian noise", Range + ", 1 to 1e8 false alarms in 1e6 beams",
    "echoes outside the gate, not above the limit or with a value that is no number", 0.0,
    static_cast<double>(bad) });
}

TEST(StabilityPhotons, WhatLiesBeyondIsNamed)
{
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Sensor sensor = dark();
  sensor.backgroundRadiance = 0.05;
  std::size_t unnamed = checkSensor(dark()).find("amplifier_noise is 0") == std::string::npos;
  for (const double falseAlarms : { nan, -1.0, 0.0, 1.001e8, 1e9, 1e308 })
  {
    unnamed += setPhotonLimits(sensor, falseAlarms, 40.0, Beams).find("false_alarms_per_scan is") ==
      std::string::npos;
  }
  // A tenth of the units of one beam, and more.
  for (const double falseAlarms : { 534.0, 1e8 })
  {
    unnamed += setPhotonLimits(sensor, falseAlarms, 40.0, 1.0)
                 .find("less than a tenth of the range units") == std::string::npos;
  }
  const auto errorOf = [&](double Sensor::*member, double value)
  {
    Sensor other = sensor;
    other.*member = value;
    return checkSensor(other);
  };
  for (const double value : { nan, -1e-9, 1e-4, 1.1e20 })
  {
    unnamed +=
      errorOf(&Sensor::amplifierNoise, value).find("amplifier_noise is") == std::string::npos;
  }
  for (const double value : { nan, 0.0, 0.999, 1.1e6 })
  {
    unnamed += errorOf(&Sensor::excessNoiseFactor, value).find("excess_noise_factor is") ==
      std::string::npos;
  }
  for (const double value : { nan, -1e-9, 1.1e10 })
  {
    unnamed += errorOf(&Sensor::backgroundRadiance, value).find("background_radiance is") ==
      std::string::npos;
  }
  record({ "Out of range", "photon receiver: no noise, more than 1e8 false alarms, each number",
    "values without an error that names them", 0.0, static_cast<double>(unnamed) });
}
