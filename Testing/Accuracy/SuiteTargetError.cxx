// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "Results.h"
#include "SmallTargets.h"
#include "Windows.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>

namespace accuracy
{
using namespace avianlidar;

namespace
{
constexpr int Seeds = 2;

/// A scene, where errors are measured, and which beams cost anything.
struct Measured
{
  AccuracyScene scene;
  std::vector<Window> windows;
  std::vector<std::size_t> meeting; ///< beams that meet something
};

/// What a choice of rays reaches in the windows, and what it costs.
struct Reached
{
  double median = 0.0;  ///< of relative errors
  double ninety = 0.0;  ///< their 90th percentile
  double rms = 0.0;     ///< theirs
  double rays = 0.0;    ///< primary, with the pilot's and small targets', of beams that meet
                        ///< something; mean of seeds
  double seconds = 0.0; ///< CPU time of the whole scan on one thread; mean of seeds
};

double processSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Measured prepare(const AccuracySceneEntry& entry)
{
  Measured measured;
  measured.scene = entry.make(entry.stride);
  if (measured.scene.beams.size() == 0)
  {
    return measured;
  }
  EchoSettings settings = measured.scene.setup.settings;
  settings.seed = SeedOfWindows;
  settings.planeIntegration = false;
  measured.windows = findWindows(measured.scene, settings, 20000 * entry.reference);
  settings.raysPerBeam = 400;
  TraceCache cache;
  unitEchoes(measured.scene.setup, measured.scene.beams, settings,
    measured.scene.setup.sensor.lowerEnergyLimit, cache);
  for (std::size_t beam = 0; beam < cache.beams.size(); ++beam)
  {
    if (cache.beams[beam].hits)
    {
      measured.meeting.push_back(beam);
    }
  }
  return measured;
}

/// A window in which nothing is perceived has received nothing.
Reached measure(const Measured& in, EchoSettings settings)
{
  Reached reached;
  std::vector<double> errors;
  for (int seed = 1; seed <= Seeds; ++seed)
  {
    settings.seed = seed;
    TraceCache cache;
    const double start = processSeconds();
    const std::vector<UnitEcho> echoes = unitEchoes(
      in.scene.setup, in.scene.beams, settings, in.scene.setup.sensor.lowerEnergyLimit, cache, 1);
    reached.seconds += (processSeconds() - start) / Seeds;
    std::map<std::pair<std::size_t, std::int64_t>, double> energies;
    for (const UnitEcho& echo : echoes)
    {
      energies[{ echo.beam, echo.unit }] = echo.echo.energyReceived;
    }
    for (const Window& window : in.windows)
    {
      const auto found = energies.find({ window.beam, window.unit });
      const double energy = found == energies.end() ? 0.0 : found->second;
      errors.push_back(std::abs(energy / window.truth - 1.0));
      reached.rms += errors.back() * errors.back();
    }
    for (const std::size_t beam : in.meeting)
    {
      const BeamTrace& trace = cache.beams[beam];
      const double pilot = trace.pilot ? trace.pilot->allRays() : 0.0;
      const double ofTargets = trace.targets ? sumOf(*trace.targets) : 0.0;
      reached.rays += (trace.rays + ofTargets + pilot) / Seeds;
    }
  }
  reached.rms = std::sqrt(reached.rms / static_cast<double>(errors.size()));
  std::sort(errors.begin(), errors.end());
  reached.median = errors[errors.size() / 2];
  reached.ninety = errors[errors.size() * 9 / 10];
  return reached;
}

/// What equal error costs with a fixed number of rays: straight lines between logarithms, and
/// beyond the last number the last line.
double atError(const std::vector<Reached>& fixed, double rms, double Reached::*what)
{
  std::size_t i = 1;
  while (i + 1 < fixed.size() && fixed[i].rms > rms)
  {
    ++i;
  }
  const Reached& a = fixed[i - 1];
  const Reached& b = fixed[i];
  const double t = std::log(rms / a.rms) / std::log(b.rms / a.rms);
  return a.*what * std::pow(b.*what / (a.*what), t);
}

void measureScene(const Measured& in, benchmarks::Table& fixedTable, benchmarks::Table& table)
{
  EchoSettings settings = in.scene.setup.settings;
  settings.planeIntegration = false; // it is sampling whose costs are measured
  std::map<Sampling, std::vector<Reached>> fixed;
  const std::pair<Sampling, std::string> samplings[] = { { Sampling::Stratified, "Stratified" },
    { Sampling::MonteCarlo, "MonteCarlo" } };
  for (const auto& [sampling, name] : samplings)
  {
    settings.sampling = sampling;
    const int most = sampling == Sampling::Stratified ? 1024 : 4096;
    for (int rays = 16; rays <= most; rays *= 2)
    {
      settings.raysPerBeam = rays;
      const Reached r = measure(in, settings);
      fixed[sampling].push_back(r);
      fixedTable.row(in.scene.name, name, rays, r.median, r.ninety, r.rms, r.rays, r.seconds);
    }
  }
  settings.raysPerBeam = 100;
  for (const auto& [sampling, name] : samplings)
  {
    settings.sampling = sampling;
    for (const double target : { 0.1, 0.05, 0.02, 0.01 })
    {
      settings.targetRelativeError = target;
      const Reached r = measure(in, settings);
      const auto times = [&](Sampling other, double Reached::*what)
      { return atError(fixed[other], r.rms, what) / (r.*what); };
      table.row(in.scene.name, name, target, r.median, r.ninety, r.rms, r.rays, r.seconds,
        times(Sampling::MonteCarlo, &Reached::rays), times(Sampling::MonteCarlo, &Reached::seconds),
        times(Sampling::Stratified, &Reached::rays),
        times(Sampling::Stratified, &Reached::seconds));
    }
    settings.targetRelativeError = 0.0;
  }
}
}

bool suiteTargetError(const Options& options)
{
  benchmarks::Table fixed(
    options.folder + "/fixed_rays.csv", "scene,sampling,rays,median,ninety,rms,primary,seconds");
  benchmarks::Table table(options.folder + "/target_error.csv",
    "scene,sampling,target,median,ninety,rms,primary,seconds,carlo_rays,carlo_seconds,"
    "strata_rays,strata_seconds");
  for (const AccuracySceneEntry& entry : accuracyScenes())
  {
    if (options.scene.empty() ? !entry.everyTarget : options.scene != entry.name)
    {
      continue;
    }
    const Measured measured = prepare(entry);
    if (measured.windows.empty())
    {
      benchmarks::say(entry.name + ": left out, its data are not here");
      continue;
    }
    measureScene(measured, fixed, table);
    benchmarks::say(entry.name + ": done");
  }
  return true;
}
}
