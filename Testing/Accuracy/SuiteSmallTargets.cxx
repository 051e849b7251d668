// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "FinishSetup.h"
#include "MeshTools.h"
#include "Results.h"
#include "ScanRunner.h"
#include "SmallTargets.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace accuracy
{
using namespace avianlidar;

namespace
{
//--- detection by size ----------------------------------------------------------------------------

constexpr double Range = 1000.0; // m
constexpr double Sizes[] = { 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 1.5, 1.8, 1.9, 2.0, 3.0, 4.0, 5.0 };

/// How many of so many beams, each with random numbers of its own and a box anywhere in its inner
/// half, see it.
constexpr std::size_t Beams = 2000;

/// Share of beams that see a box of `size` m, and deviation of its energy over its mean.
struct Seen
{
  double share = 0.0;
  double deviation = 0.0;
};

/// Qlow: half of what the front of the smallest box returns.
double limitFor(const Sensor& sensor, const Material& material)
{
  const double beam = Pi * std::pow(Range * std::tan(sensor.halfBeamwidth), 2);
  return 0.5 * sensor.pulseEnergy * material.kd * Sizes[0] * Sizes[0] / beam;
}

Seen seenOf(double size, int rays, Sampling sampling, bool own)
{
  const Material matt{ 0.146, 0.0, 1.0 };
  benchmarks::Scene scene;
  scene.mesh = std::make_shared<TriangleMesh>();
  scene.apex = Vec3(0.0);
  benchmarks::addBox(
    *scene.mesh, 0.0, Range, Vec3(0.5 * size, 0.5 * size, 0.0), 0.0, -0.5 * size, 0.5 * size);
  scene.materials.assign(scene.mesh->size(), matt);
  scene.objectIds.assign(scene.mesh->size(), 1);
  ScanSetup setup = benchmarks::makeSetup(scene, buildCollisionTree(scene.mesh, {}));
  setup.settings.raysPerBeam = rays;
  setup.settings.sampling = sampling;
  setup.settings.smallTargets = own;
  setup.settings.planeIntegration = false; // it is sampled beams that need these rays
  setup.settings.numberOfReflections = 1;
  setup.settings.attenuationCoefficient = 0.0;
  setup.settings.noise = false;
  setup.settings.refineNearLimit = false;
  setup.sensor.samplingInterval = 1e-6;
  setup.sensor.lowerEnergyLimit = limitFor(setup.sensor, matt);
  finishSetup(setup);
  benchmarks::Numbers random(9);
  ScanBeams beams;
  for (std::size_t i = 0; i < Beams; ++i)
  {
    beams.ids.push_back(i);
    beams.origins.push_back(scene.apex);
    const double aside = 0.5 * setup.sensor.halfBeamwidth * std::sqrt(random(0.0, 1.0));
    const double turn = random(0.0, 2.0 * Pi);
    beams.directions.push_back(
      glm::normalize(Vec3(aside * std::cos(turn), 1.0, aside * std::sin(turn))));
  }
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, 1, cache, 0, {}, result);
  Seen seen;
  seen.share = static_cast<double>(result.echoes.size()) / Beams;
  setup.sensor.lowerEnergyLimit *= 1e-3;
  finishSetup(setup);
  TraceCache another;
  simulateScan(setup, beams, 1, another, 0, {}, result);
  double sum = 0.0;
  double squares = 0.0;
  for (const Echo& echo : result.echoes)
  {
    sum += echo.returnEnergy;
    squares += echo.returnEnergy * echo.returnEnergy;
  }
  seen.deviation = std::sqrt(Beams * squares / (sum * sum) - 1.0);
  return seen;
}

/// @return false if a larger box is seen less often than a smaller one, but for chance
bool detection(const Options& options)
{
  benchmarks::Table table(
    options.folder + "/small_targets.csv", "size,rays,sampling,own,seen,deviation");
  bool good = true;
  for (const int rays : { 100, 16 })
  {
    for (const Sampling sampling : { Sampling::Stratified, Sampling::MonteCarlo })
    {
      double most = 0.0;
      for (const double size : Sizes)
      {
        for (const bool own : { true, false })
        {
          const Seen seen = seenOf(size, rays, sampling, own);
          table.row(size, rays, sampling == Sampling::Stratified ? "Stratified" : "MonteCarlo", own,
            seen.share, seen.deviation);
          if (own)
          {
            good = good && seen.share > most - 4.0 * std::sqrt(0.25 / Beams);
            most = std::max(most, seen.share);
          }
        }
      }
    }
  }
  benchmarks::say(std::string("detection by size") + (good ? "" : " BAR NOT MET"));
  return good;
}

//--- what it costs --------------------------------------------------------------------------------

constexpr int Rounds = 31;

/// CPU time of a fresh scan on one thread, s.
double secondsOf(const ScanSetup& setup, const ScanBeams& beams)
{
  const std::clock_t start = std::clock();
  benchmarks::freshScan(setup, beams, 1);
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

double medianOf(std::vector<double>& values)
{
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// On and off in turn: what else the machine does falls on both.
void cost(const benchmarks::Scene& scene, const std::string& objects, int channels, int rounds,
  benchmarks::Table& table)
{
  ScanSetup with = benchmarks::makeSetup(scene, buildCollisionTree(scene.mesh, {}));
  with.settings.planeIntegration = false;
  finishSetup(with);
  ScanSetup without = with;
  without.settings.smallTargets = false;
  finishSetup(without);
  const ScanBeams beams = benchmarks::makeBeams(scene);
  TraceCache cache;
  ScanResult result;
  simulateScan(with, beams, 1, cache, std::size_t(2) << 30, {}, result);
  std::size_t beamsWith = 0;
  double targets = 0.0;
  for (const BeamTrace& trace : cache.beams)
  {
    beamsWith += trace.targets != nullptr;
    targets += trace.targets ? static_cast<double>(trace.targets->size()) : 0.0;
  }
  std::vector<double> on;
  std::vector<double> off;
  std::vector<double> ratios;
  for (int round = 0; round < rounds; ++round)
  {
    const bool first = round % 2 == 0;
    const double a = secondsOf(first ? with : without, beams);
    const double b = secondsOf(first ? without : with, beams);
    on.push_back(first ? a : b);
    off.push_back(first ? b : a);
    ratios.push_back(on.back() / off.back());
  }
  table.row(scene.name, objects, with.objects->size(), channels, beams.size(), beamsWith, targets,
    rounds, 1e3 * medianOf(off), 1e3 * medianOf(on), medianOf(ratios) - 1.0);
  benchmarks::say(
    scene.name + ", " + objects + ", " + std::to_string(channels) + " channels: done");
}

void costs(const Options& options)
{
  benchmarks::Table table(options.folder + "/small_targets_cost.csv",
    "scene,object,objects,channels,beams,beams_with,targets,rounds,off_ms,on_ms,more");
  std::vector<benchmarks::SceneEntry> entries = benchmarks::airports();
  entries.push_back({ "boxes 100000", []() { return benchmarks::makeBoxes(100000); }, "", "" });
  for (const benchmarks::SceneEntry& entry : entries)
  {
    benchmarks::Scene scene =
      options.scene.empty() || options.scene == entry.name ? entry.make() : benchmarks::Scene{};
    if (!scene.mesh || scene.mesh->size() == 0)
    {
      continue;
    }
    for (const char* const objects : { "as given", "each part" })
    {
      for (const int channels : { 16, 32 })
      {
        scene.pattern = benchmarks::airportPattern(channels);
        cost(scene, objects, channels, Rounds, table);
      }
      if (entry.file.empty())
      {
        break; // its objects are its parts
      }
      benchmarks::numberObjects(scene);
    }
  }
}
}

bool suiteSmallTargets(const Options& options)
{
  const bool good = !options.scene.empty() || detection(options);
  if (!options.check)
  {
    costs(options);
  }
  return good;
}
}
