// SPDX-License-Identifier: BSD-3-Clause
// An object that most beams miss, and what a beam receives of it over seeds.
#ifndef SmallTargetScene_h
#define SmallTargetScene_h

#include "ScanTestTown.h"

#include <algorithm>
#include <cmath>

namespace echotest
{
const Material Matt{ 0.5, 0.0, 1.0 };

/// Area, m2, and range, m, of a target that most beams miss.
constexpr double Area = 0.15;
constexpr double Range = 1000.0;

/// Sanitizers see the same code in a tenth of the seeds, and of brute force's rays: errors are
/// wider by the root or more.
#if defined(AVIANLIDAR_SANITIZED)
constexpr int FewerSeeds = 10;
#else
constexpr int FewerSeeds = 1;
#endif
const double Wider = std::sqrt(FewerSeeds);

/// A disc across the x axis.
inline void disc(Scene& scene, const Vec3& center, double area, const Material& m, int object)
{
  constexpr int corners = 48;
  // Of the polygon, not of the circle about it.
  const double radius = std::sqrt(2.0 * area / (corners * std::sin(2.0 * Pi / corners)));
  const auto rim = [&](int k)
  {
    const double phi = 2.0 * Pi * (k % corners) / corners;
    return center + radius * Vec3(0.0, std::cos(phi), std::sin(phi));
  };
  for (int k = 0; k < corners; ++k)
  {
    scene.triangle(center, rim(k), rim(k + 1), m, object);
  }
}

/// What a beam down the x axis receives in all, over seeds.
struct Estimate
{
  double mean = 0.0;
  double deviation = 0.0; ///< of one seed
  double error = 0.0;     ///< of the mean
  double covered = 0.0;   ///< share of seeds with the truth within 1.96 standard errors, if given
  double rays = 0.0;      ///< of the last seed
};

inline Estimate estimate(ScanSetup setup, int seeds, double truth = 0.0, int firstSeed = 0)
{
  Estimate e;
  double squares = 0.0;
  int covered = 0;
  for (int seed = 0; seed < seeds; ++seed)
  {
    setup.settings.seed = firstSeed + seed;
    const ScanResult result = runScan(setup, oneBeam());
    double sum = 0.0;
    for (const Echo& echo : result.echoes)
    {
      sum += echo.returnEnergy;
    }
    if (result.echoes.size() == 1)
    {
      covered += std::fabs(sum - truth) <= 1.96 * result.echoes[0].energyStdError;
    }
    e.mean += sum;
    squares += sum * sum;
    e.rays = static_cast<double>(result.reports[0].counters.raysTraced);
  }
  e.mean /= seeds;
  e.deviation = std::sqrt(std::max(0.0, squares / seeds - e.mean * e.mean));
  e.error = e.deviation / std::sqrt(static_cast<double>(seeds));
  e.covered = covered / static_cast<double>(seeds);
  return e;
}

/// The same with very many rays, and none for targets.
inline Estimate bruteForce(ScanSetup setup)
{
  setup.settings.raysPerBeam = 100000 / FewerSeeds;
  setup.settings.sampling = Sampling::Stratified;
  setup.settings.smallTargets = false;
  finishSetup(setup);
  return estimate(setup, 16, 0.0, 1000000);
}

inline Sensor sensorOf(BeamProfile profile)
{
  Sensor sensor = openSensor();
  sensor.beamProfile = profile;
  return sensor;
}

inline EchoSettings settingsOf(Sampling sampling, int rays = 100)
{
  EchoSettings settings = directSettings(rays);
  settings.sampling = sampling;
  return settings;
}
}

#endif
