// SPDX-License-Identifier: BSD-3-Clause
// Extremes of air and energies. Beamwidths are TestEchoClosedForms', glossiness is
// TestReflectance's.
#include "EchoTestScene.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

using namespace echotest;
using stability::record;
using stability::Worst;

TEST(StabilityBeam, Attenuation)
{
  Worst error;
  std::size_t unlike = 0;
  const double h = 500.0;
  Scene wall;
  wall.plate(
    Vec3(h, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0), Material{ 0.146, 0.0, 0.0 });
  for (int step = 0; step <= 60; ++step)
  {
    const double mu = step == 0 ? 0.0 : 1e-12 * std::pow(1e21, step / 60.0);
    EchoSettings settings = directSettings(100);
    settings.attenuationCoefficient = mu;
    const ScanResult result = runScan(makeSetup(wall, openSensor(1e-9), settings), oneBeam());
    const long double share = std::exp(-2.0L * mu * h);
    if (share > 1e-290L)
    {
      const double energy = result.echoes.size() == 1 ? result.echoes[0].returnEnergy : NAN;
      error.see(static_cast<double>(
        std::fabs(energy / (3.6e-4L * 0.146L * share) - 1.0L) / (1.0L + 2.0L * mu * h)));
    }
    else if (share < 1e-330L)
    {
      unlike += !result.echoes.empty();
    }
  }
  record({ "Attenuation", "0 and 1e-12 to 1e9 1/m over 1 km",
    "relative error of energy over (1 + length x attenuation)", 1e-14, error.value() });
  record({ "Attenuation", "where exp underflows", "echoes", 0.0, static_cast<double>(unlike) });
}

TEST(StabilityBeam, PulseEnergies)
{
  // All energies scale with the pulse's. By a power of two every bit of the digits stays.
  EchoSettings settings;
  settings.noise = false;
  Sensor sensor;
  sensor.halfBeamwidth = 0.05;
  sensor.lowerEnergyLimit = 1e-8;
  Scene scene; // a dihedral corner: two reflections, several units
  for (int side : { -1, 1 })
  {
    const Vec3 along = 10.0 * Vec3(-1.0, side, 0.0);
    scene.plate(
      Vec3(100.0, 0.0, 0.0) + along, along, Vec3(0.0, 0.0, 20.0), side > 0 ? Metal : Wall, side);
  }
  std::size_t differing = 0;
  for (const bool integrated : { true, false })
  {
    settings.beamSamples = integrated ? BeamSampleSource::Cells : BeamSampleSource::Rays;
    const ScanResult plain = runScan(makeSetup(scene, sensor, settings), oneBeam());
    ASSERT_GT(plain.echoes.size(), 0u);
    ASSERT_GT(plain.echoes[0].secondaryShare, 0.0);
    for (int exponent = -88; exponent <= 22; exponent += 5)
    {
      const double factor = std::ldexp(1.0, exponent);
      Sensor scaled = sensor;
      scaled.pulseEnergy *= factor;
      scaled.lowerEnergyLimit *= factor;
      scaled.upperEnergyLimit *= factor;
      const ScanResult result = runScan(makeSetup(scene, scaled, settings), oneBeam());
      differing += result.echoes.size() != plain.echoes.size();
      for (std::size_t i = 0; i < std::min(result.echoes.size(), plain.echoes.size()); ++i)
      {
        const Echo& a = plain.echoes[i];
        const Echo& b = result.echoes[i];
        differing +=
          !(a.energy * factor == b.energy && a.energyReceived * factor == b.energyReceived &&
            a.returnEnergy * factor == b.returnEnergy && a.range == b.range &&
            a.energyStdError * factor == b.energyStdError && a.secondaryShare == b.secondaryShare);
      }
    }
  }
  record({ "Energies", "pulse and limits times 2^-88 to 2^22 (1e-30 to 1.5e3 J), two reflections",
    "echoes that change by a bit but for the power of two", 0.0, static_cast<double>(differing) });
}
