// SPDX-License-Identifier: BSD-3-Clause
// Extremes of beam, surface, air and energies: beamwidths, glossiness, attenuation, numbers of
// rays. Pulse energies are TestStabilityCoordinates'. The lobe alone is TestReflectance's.
#include "StabilityScenes.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

using namespace echotest;
using namespace stability;

namespace
{
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
      const Echo echo = onlyEcho(wall(500.0), sensor, settings);
      const double right =
        energyOfWall(t, profile == BeamProfile::Uniform ? 0.5 : 0.34348235725033445);
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
    const ScanResult result = runScan(makeSetup(wall(h), openSensor(1e-9), settings), oneBeam());
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
      const Echo echo = onlyEcho(wall(100.0), sensor, settings);
      relative.see(std::fabs(echo.returnEnergy / energyOfWall(sensor.halfBeamwidth) - 1.0));
    }
  }
  record({ "Rays per beam", "1 to 1e6, odd and even, both samplings", "rays",
    "relative error of energy, wall at normal incidence (t^2/4 is 8e-6)", 8e-6, relative.value() });
}
