// SPDX-License-Identifier: BSD-3-Clause
// The photon receiver and its Gaussian noise, from no background light to 1e12 electrons of it,
// beside the complementary error function of 50 digits. Moments and shares of the noise are
// TestPhotonReceiver's. What is out of range is TestPhotonReceiver's and TestStabilitySweep's.
#include "EchoTestScene.h"
#include "PhotonReceiver.h"
#include "RangeUnits.h"
#include "StabilityTable.h"

#include <boost/math/special_functions/erf.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include <gtest/gtest.h>

#include <functional>

using namespace echotest;
using stability::record;
using stability::Worst;

namespace
{
constexpr double Beams = 1e6; // of a scan
const std::string Range = "0 to 1e12 background electrons, amplifier 0 to 1e6, excess 1 to 1e3";

/// Every receiver that has noise, with limits for each number of false alarms.
void forEachReceiver(const std::function<void(const Sensor&, double falseAlarms, int number)>& f)
{
  Sensor sensor;
  sensor.receiverModel = ReceiverModel::Photons;
  sensor.receiverAperture = 0.25e-2 * Pi;
  sensor.backgroundRadiance = 1.0;
  const double electronsOfRadiance = PhotonReceiver(sensor).background;
  int number = 0;
  for (const double background : { 0.0, 1e-6, 1.0, 1e6, 1e12 })
  {
    for (const double amplifier : { 0.0, 1e-3, 1e6 })
    {
      for (const double excess : { 1.0, 3.0, 1e3 })
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
  EXPECT_EQ(number, 168);
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
        noise.begin(plan, { number, static_cast<std::uint64_t>(beam) });
        for (const std::int64_t unit : noise.alarms())
        {
          alarms += 1.0;
          wrong.see(noise.energy(unit) > sensor.lowerEnergyLimit ? 0.0 : 1.0);
        }
      }
      counted.see(std::fabs(alarms - 500.0) / std::sqrt(500.0));
    });
  const std::string range = Range + ", 1 to 1e8 false alarms in 1e6 beams";
  record({ "Gaussian noise", range, "-",
    "relative error of the false alarms, beside erfc of 50 digits", 1e-12, error.value() });
  record({ "Gaussian noise", Range + ", 1e4 to 1e8 false alarms in 1e6 beams", "-",
    "false alarms drawn off their number, in standard deviations", 4.5, counted.value() });
  record({ "Gaussian noise", range, "-",
    "1 if the noise of a false alarm does not exceed the limit, else 0", 0.0, wrong.value() });
}
