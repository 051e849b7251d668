// SPDX-License-Identifier: BSD-3-Clause
// Extremes of beam, surface, air and energies: beamwidths, glossiness, attenuation, pulse energies,
// numbers of rays. The lobe alone is TestReflectance's.
#include "EchoTestScene.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

using namespace echotest;
using stability::record;
using stability::Worst;

namespace
{
constexpr double Qs = 3.6e-4;

/// A plate across the axis x that every beam of less than a radian lies on.
Scene wall(double distance, const Material& material)
{
  Scene scene;
  scene.plate(Vec3(distance, 0.0, 0.0), Vec3(0.0, 1e3 * distance, 0.0),
    Vec3(0.0, 0.0, 1e3 * distance), material);
  return scene;
}

double logStep(double first, double last, int step, int steps)
{
  return first * std::pow(last / first, static_cast<double>(step) / steps);
}

/// Qs/(1 - cos t) times the integral of ks max(0, cos 2 theta)^kp sin theta, by Simpson's rule.
double specularEnergy(double ks, double kp, double t)
{
  const long double end = std::fmin(
    static_cast<long double>(t), 12.0L / std::sqrt(std::fmax(1.0L, static_cast<long double>(kp))));
  constexpr int Panels = 20000;
  long double sum = 0.0L;
  for (int i = 0; i <= Panels; ++i)
  {
    const long double theta = end * i / Panels;
    const long double cosine = std::cos(2.0L * theta);
    const long double f = cosine > 0.0L ? std::pow(cosine, static_cast<long double>(kp)) : 0.0L;
    sum += (i == 0 || i == Panels ? 1 : i % 2 ? 4 : 2) * f * std::sin(theta);
  }
  const long double half = std::sin(0.5L * t);
  return static_cast<double>(Qs * ks * sum * end / (3.0L * Panels) / (2.0L * half * half));
}
}

TEST(StabilityBeam, Beamwidths)
{
  Worst relative;
  Worst inErrors;
  for (const BeamProfile profile : { BeamProfile::Uniform, BeamProfile::Gaussian })
  {
    for (int step = 0; step <= 36; ++step)
    {
      const double t = logStep(1e-9, 1.0, step, 36);
      Sensor sensor = openSensor(t);
      sensor.beamProfile = profile;
      EchoSettings settings = directSettings(20000);
      const Echo echo = onlyEcho(wall(500.0, { 0.146, 0.0, 0.0 }), sensor, settings);
      const double u = profile == BeamProfile::Uniform ? 0.5 : 0.34348235725033445;
      const double half = std::sin(0.5 * t);
      const double right = Qs * 0.146 * (1.0 - 2.0 * half * half * u);
      relative.see(std::fabs(echo.returnEnergy / right - 1.0));
      inErrors.see(std::fabs(echo.returnEnergy - right) / (echo.energyStdError + 1e-12 * right));
    }
  }
  const std::string range = "1e-9 to 1 rad, uniform and Gaussian";
  record({ "Half-beamwidth", range, "rays",
    "relative error of energy, wall at normal incidence, 20,000 rays", 1e-4, relative.value() });
  record({ "Half-beamwidth", range, "rays", "the same in stated standard errors", 5.0,
    inErrors.value() });
}

TEST(StabilityBeam, GlossinessOfAWall)
{
  Worst inErrors;
  Worst excess;
  for (const double kp : { 0.0, 1e-3, 0.5, 1.0, 10.0, 112.0, 1e3, 8046.0, 1e5, 1e6 })
  {
    for (const double t : { 1e-6, 5.6e-3, 0.3, 0.9 })
    {
      if (2.0 * 20000.0 / (std::fmax(kp, 1.0) * t * t) < 100.0)
      {
        continue; // random rays miss such a glint, or most of it
      }
      const Echo echo =
        onlyEcho(wall(100.0, { 0.0, 0.852, kp }), openSensor(t), directSettings(20000));
      const double right = specularEnergy(0.852, kp, t);
      inErrors.see(std::fabs(echo.returnEnergy - right) / (echo.energyStdError + 1e-9 * right));
      excess.see(echo.returnEnergy / (0.852 * Qs));
    }
  }
  const std::string range =
    "0 to 1e6, half-beamwidth 1e-6 to 0.9 rad, where 50 of 20,000 rays fall into the lobe";
  record({ "Glossiness", range, "rays", "deviation from the integral, in stated standard errors",
    5.0, inErrors.value() });
  // One last place: a sum of equal numbers may be rounded up.
  record(
    { "Glossiness", range, "rays", "energy over its bound ks Qs", 1.0 + 1e-12, excess.value() });
}

TEST(StabilityBeam, Attenuation)
{
  Worst error;
  std::size_t unlike = 0;
  for (int step = 0; step <= 60; ++step)
  {
    const double mu = step == 0 ? 0.0 : logStep(1e-12, 1e9, step, 60);
    EchoSettings settings = directSettings(100);
    settings.attenuationCoefficient = mu;
    const double h = 500.0;
    const ScanResult result =
      runScan(makeSetup(wall(h, { 0.146, 0.0, 0.0 }), openSensor(1e-9), settings), oneBeam());
    const long double share = std::exp(-2.0L * mu * h);
    if (share > 1e-290L)
    {
      const double energy = result.echoes.size() == 1 ? result.echoes[0].returnEnergy : NAN;
      error.see(static_cast<double>(
        std::fabs(energy / (Qs * 0.146L * share) - 1.0L) / (1.0L + 2.0L * mu * h)));
    }
    else if (share < 1e-330L)
    {
      unlike += !result.echoes.empty();
    }
  }
  record({ "Attenuation", "0 and 1e-12 to 1e9 1/m over 1 km", "rays",
    "relative error of energy over (1 + length x attenuation)", 1e-14, error.value() });
  record(
    { "Attenuation", "where exp underflows", "rays", "echoes", 0.0, static_cast<double>(unlike) });
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
    "both", "echoes that change by a bit but for the power of two", 0.0,
    static_cast<double>(differing) });
}

TEST(StabilityBeam, NumbersOfRays)
{
  Worst relative;
  for (const Sampling sampling : { Sampling::MonteCarlo, Sampling::Stratified })
  {
    for (const int rays : { 1, 2, 3, 4, 5, 7, 8, 33, 100, 101, 999, 10001, 1000000 })
    {
      EchoSettings settings = directSettings(rays);
      settings.sampling = sampling;
      const Sensor sensor = openSensor();
      const Echo echo = onlyEcho(wall(100.0, { 0.146, 0.0, 0.0 }), sensor, settings);
      const double right = Qs * 0.146 * std::pow(std::cos(0.5 * sensor.halfBeamwidth), 2);
      relative.see(std::fabs(echo.returnEnergy / right - 1.0));
    }
  }
  record({ "Rays per beam", "1 to 1e6, odd and even, both samplings", "rays",
    "relative error of energy, wall at normal incidence (t^2/4 is 8e-6)", 8e-6, relative.value() });
}
