// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "EmbreePeer.h"
#include "FinishSetup.h"
#include "ScanRunner.h"

#include <cmath>
#include <limits>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
constexpr int ReferenceRays = 30000;
constexpr int ReferenceRaysOfSmoke = 300;

/// Settings of a scan without noise.
ScanSetup setupOf(const Scene& scene, const std::shared_ptr<const CollisionTree>& tree, int rays,
  int reflections, bool integrates)
{
  ScanSetup setup = makeSetup(scene, tree);
  setup.settings.raysPerBeam = rays;
  setup.settings.numberOfReflections = reflections;
  setup.settings.beamSamples = integrates ? BeamSampleSource::Cells : BeamSampleSource::Rays;
  setup.settings.noise = false;
  finishSetup(setup);
  return setup;
}

ScanResult scanOf(const ScanSetup& setup, const ScanBeams& beams)
{
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result);
  return result;
}

/// Errors of the echoes of one scan against those of another.
struct Errors
{
  double rms = 0.0;    ///< relative, of the energy of echoes that both have
  double wrong = 0.0;  ///< missed and invented, over those of the reference
  double within = 0.0; ///< share of echoes whose energy is off by less than two standard errors
};

Errors compare(const ScanResult& truth, const ScanResult& scan, double tolerance)
{
  Errors errors;
  std::size_t both = 0;
  std::size_t within = 0;
  std::vector<bool> used(scan.echoes.size(), false);
  std::size_t first = 0;
  for (std::size_t i = 0; i < truth.echoes.size(); ++i)
  {
    while (first < scan.echoes.size() && scan.beamOfEcho[first] < truth.beamOfEcho[i])
    {
      ++first;
    }
    std::size_t nearest = scan.echoes.size();
    double distance = tolerance;
    for (std::size_t k = first; k < scan.echoes.size() && scan.beamOfEcho[k] == truth.beamOfEcho[i];
         ++k)
    {
      const double apart = std::fabs(scan.echoes[k].range - truth.echoes[i].range);
      if (!used[k] && apart <= distance)
      {
        nearest = k;
        distance = apart;
      }
    }
    if (nearest < scan.echoes.size())
    {
      used[nearest] = true;
      ++both;
      const Echo& echo = scan.echoes[nearest];
      const double off = echo.energyReceived - truth.echoes[i].energyReceived;
      const double relative = off / truth.echoes[i].energyReceived;
      errors.rms += relative * relative;
      const double own = 0.002 * truth.echoes[i].energyReceived; // of the reference
      within += std::fabs(off) <= 2.0 * std::hypot(echo.energyStdError, own) ? 1 : 0;
    }
  }
  const double all = static_cast<double>(std::max<std::size_t>(1, truth.echoes.size()));
  errors.rms = std::sqrt(errors.rms / static_cast<double>(std::max<std::size_t>(1, both)));
  errors.within = within / static_cast<double>(std::max<std::size_t>(1, both));
  errors.wrong = (truth.echoes.size() - both + scan.echoes.size() - both) / all;
  return errors;
}
}

bool suiteFront(const Options& options)
{
  Table table(options.folder + "/front.csv",
    "scene,triangles,reflections,contender,median_s,best_s,rms,wrong,within");
  for (const SceneEntry& entry : airports())
  {
    if (!wanted(options, entry.name))
    {
      continue;
    }
    Scene scene = entry.make();
    if (scene.mesh->size() == 0)
    {
      continue;
    }
    scene.pattern = airportPattern(16);
    const ScanBeams beams = makeBeams(scene, 2);
    const std::shared_ptr<const CollisionTree> tree = buildCollisionTree(scene.mesh, TreeOptions{});
    EmbreeScene embree(scene, false, 1);
    embree.build();
    const Tracer packets = embree.packets();
    for (const int reflections : { 1, 2 })
    {
      const ScanResult truth =
        scanOf(setupOf(scene, tree, options.smoke ? ReferenceRaysOfSmoke : ReferenceRays,
                 reflections, false),
          beams);
      std::vector<Contender> contenders;
      std::vector<Errors> errors;
      std::vector<Workload> works;
      works.reserve(3);
      const auto judge = [&](const ScanSetup& setup)
      {
        const double tolerance =
          setup.sensor.rangeUnitLength() + 0.5 * SpeedOfLight * setup.sensor.pulseWidth;
        errors.push_back(compare(truth, scanOf(setup, beams), tolerance));
      };
      for (const int rays : { 50, 100, 400 })
      {
        const ScanSetup setup = setupOf(scene, tree, rays, reflections, true);
        judge(setup);
        contenders.push_back({ "default, " + std::to_string(rays),
          [setup, &beams]() { freshScan(setup, beams, 1); } });
      }
      for (const int rays : { 100, 1600, 6400 })
      {
        BeamAxes axes;
        axes.raysPerBeam = std::min(rays, 1600);
        axes.mostRays = beams.size() * 400;
        works.push_back(makeWorkload(scene, axes));
        judge(setupOf(scene, tree, rays, reflections, false));
        contenders.push_back({ "Embree's packets alone, " + std::to_string(rays),
          [&packets, work = &works.back()]() { packets(*work, 1, [](auto...) {}); } });
      }
      const std::vector<Timing> timings = compete(contenders, options.limits());
      for (std::size_t k = 0; k < timings.size(); ++k)
      {
        double scale = 1.0;
        if (k >= 3) // time of one ray, times all
        {
          const double rays[] = { 100.0, 1600.0, 6400.0 };
          scale = rays[k - 3] * beams.size() / works[k - 3].size();
        }
        const Timing& t = timings[k];
        table.row(scene.name, scene.mesh->size(), reflections, t.name, scale * t.median,
          scale * t.best, errors[k].rms, errors[k].wrong, errors[k].within);
        say(scene.name + ", " + std::to_string(reflections) + ", " + t.name + ": " +
          std::to_string(1e3 * scale * t.best) + " ms, rms " +
          std::to_string(100.0 * errors[k].rms) + " %, wrong " +
          std::to_string(100.0 * errors[k].wrong) + " %, within " +
          std::to_string(100.0 * errors[k].within) + " %");
      }
    }
  }
  return true;
}
}
