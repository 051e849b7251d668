// SPDX-License-Identifier: BSD-3-Clause
// Received energies against closed forms: a small target, narrow lobes, apertures. Planes, ground,
// spheres, corners, edges and profiles, by rays and integrated, are TestOracles'.
#include "IntegrationTestScene.h"

#include <gtest/gtest.h>

using namespace echotest;

namespace
{
/// What a plane across the axis returns, as an integral over the angle from the axis.
double acrossAxis(const Sensor& sensor, const EchoSettings& settings, const Material& m, double h)
{
  const double t = sensor.halfBeamwidth;
  const double all = 1.0 - std::cos(t);
  double sum = 0.0;
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i)
  {
    // Fine near the axis, where a lobe may be narrow.
    const double a = t * std::pow((i + 0.0) / steps, 4.0);
    const double b = t * std::pow((i + 1.0) / steps, 4.0);
    const double angle = 0.5 * (a + b);
    const double inner = (1.0 - std::cos(angle)) / all;
    const double density = sensor.beamProfile == BeamProfile::Uniform
      ? 1.0
      : 2.0 * std::exp(-2.0 * inner) / -std::expm1(-2.0);
    const Reflectance f =
      reflectance(settings.reflectanceModel, m, monostaticGeometry(std::cos(angle)));
    const double returned =
      throughAperture(f, m, sensor.receiverAperture, h / std::cos(angle)).total();
    sum += returned * density * (std::cos(a) - std::cos(b)) / all;
  }
  return sensor.pulseEnergy * sum;
}
}

TEST(EchoClosedForms, SmallTargetIsPerceivedUpToTwoHundredMetres)
{
  Sensor sensor = openSensor();
  sensor.lowerEnergyLimit = 2e-6;
  for (const double share : { 0.99, 1.01 })
  {
    // 0.15 m2
    const Scene scene = squareAt(share * 200.0303589, 0.5 * std::sqrt(0.15), { 0.146, 0.0, 0.0 });
    EXPECT_EQ(runScan(makeSetup(scene, sensor, integrating()), oneBeam()).echoes.size(),
      share < 1.0 ? 1u : 0u);
  }
}

TEST(EchoClosedForms, LobesFarNarrowerThanTheBeam)
{
  for (const double t : { 5.6e-3, 0.05, 0.5, 1.0 })
  {
    for (const BeamProfile profile : { BeamProfile::Uniform, BeamProfile::Gaussian })
    {
      for (int model = 0; model < 4; ++model)
      {
        for (const double exponent : { 1e3, 1e4, 1e5, 1e6 })
        {
          SCOPED_TRACE(testing::Message()
            << t << ' ' << static_cast<int>(profile) << ' ' << model << ' ' << exponent);
          Sensor sensor = openSensor(t);
          sensor.beamProfile = profile;
          EchoSettings settings = integrating();
          settings.reflectanceModel = static_cast<ReflectanceModel>(model);
          const Material shiny{ 0.02, 0.8, exponent, 0.5 };
          const double expected = acrossAxis(sensor, settings, shiny, 100.0);
          const ScanResult result =
            runScan(makeSetup(squareAt(100.0, 1e5, shiny), sensor, settings), oneBeam());
          ASSERT_TRUE(isIntegrated(result));
          ASSERT_EQ(result.echoes.size(), 1u);
          // To the bound that is stated, too (the oracle has ten digits).
          const Echo& echo = result.echoes[0];
          EXPECT_NEAR(echo.returnEnergy, expected, 4e-6 * expected);
          EXPECT_NEAR(echo.returnEnergy, expected, echo.energyStdError + 2e-9 * expected);
          EXPECT_LE(echo.energyStdError, 1e-5 * expected);
          EXPECT_EQ(echo.labelShare, 1.0);
        }
      }
    }
  }
}

TEST(EchoClosedForms, WhereAnApertureGathersAllOnlyInThatItsBoundIsWide)
{
  int capped = 0;
  for (const double t : { 5.6e-3, 0.05, 0.5 })
  {
    for (const double exponent : { 0.0, 1e3, 1e5 })
    {
      for (const double h : { 0.3, 1.0, 3.0 })
      {
        Sensor sensor = openSensor(t);
        const Material m{ 0.2, exponent > 0.0 ? 0.6 : 0.0, exponent };
        const EchoSettings settings = integrating();
        for (double aperture = 1e-4; aperture < 100.0; aperture *= 2.3)
        {
          SCOPED_TRACE(testing::Message() << t << ' ' << exponent << ' ' << h << ' ' << aperture);
          sensor.receiverAperture = aperture;
          const ScanResult result =
            runScan(makeSetup(squareAt(h, 1e3 * h, m), sensor, settings), oneBeam());
          ASSERT_TRUE(isIntegrated(result));
          ASSERT_EQ(result.echoes.size(), 1u);
          const Echo& echo = result.echoes[0];
          const double expected = acrossAxis(sensor, settings, m, h);
          EXPECT_NEAR(echo.returnEnergy, expected, echo.energyStdError + 4e-6 * expected);
          EXPECT_LE(echo.energyStdError, 0.011 * expected);
          capped += echo.energyStdError > 5e-3 * expected;
        }
      }
    }
  }
  EXPECT_GT(capped, 50);
}

TEST(EchoClosedForms, RangesBeyondWholeNumbersOfUnitsAreSampled)
{
  // One more than 2^53 is 2^53: borders of units could be counted for ever.
  Sensor sensor = openSensor(3e-8);
  sensor.samplingInterval = 1e-12;
  sensor.rangeGate = 1e11;
  const ScanResult result =
    runScan(makeSetup(squareAt(1e13, 1e16, { 0.146, 0.0, 0.0 }), sensor, integrating()), oneBeam());
  EXPECT_FALSE(isIntegrated(result));
}
