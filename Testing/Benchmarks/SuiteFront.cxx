// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "EmbreePeer.h"
#include "FinishSetup.h"
#include "ScanRunner.h"

#include <cmath>
#include <functional>
#include <limits>
#include <utility>

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

namespace
{
/// The airports, a city, a town with its airport and a street: nothing was tuned to the last three.
std::vector<SceneEntry> sixAndMore()
{
  std::vector<SceneEntry> scenes = airports();
  for (const auto& [name, file] :
    { std::pair<const char*, const char*>{ "Shanghai", "shanghai_cbd" },
      { "Neubrandenburg", "neubrandenburg" }, { "Ingolstadt", "ingolstadt" } })
  {
    const std::string path = std::string(AVIANLIDAR_SCENES_DIR "/") + file + ".lidarscene.json";
    scenes.push_back(
      { name, [name = std::string(name), path]() { return readScene(name, path); }, path, "" });
  }
  return scenes;
}

/// A scan that is lit again from what was kept: with other air, or another limit.
class LitAgain
{
public:
  LitAgain(const ScanSetup& setup, const ScanBeams& beams)
    : Setup(setup)
    , Beams(beams)
  {
    this->scan();
  }

  void withOtherAir()
  {
    this->Setup.settings.attenuationCoefficient *= 1.01;
    this->scan();
  }

  void withOtherLimit()
  {
    this->Setup.sensor.lowerEnergyLimit *= 0.99;
    this->scan();
  }

private:
  void scan()
  {
    finishSetup(this->Setup);
    simulateScan(this->Setup, this->Beams, 1, this->Cache, std::size_t(1) << 31, {}, this->Result);
  }

  ScanSetup Setup;
  const ScanBeams& Beams;
  TraceCache Cache;
  ScanResult Result;
};
}

bool suiteFront(const Options& options)
{
  Table table(options.folder + "/front.csv",
    "scene,triangles,reflections,contender,median_s,best_s,rms,wrong,within");
  for (const SceneEntry& entry : sixAndMore())
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
      std::vector<double> scales;
      const auto add = [&](const std::string& name, const ScanSetup& setup, double scale,
                         const std::function<void()>& run)
      {
        const double tolerance =
          setup.sensor.rangeUnitLength() + 0.5 * SpeedOfLight * setup.sensor.pulseWidth;
        errors.push_back(compare(truth, scanOf(setup, beams), tolerance));
        scales.push_back(scale);
        contenders.push_back({ name, run });
      };
      for (const bool cells : { true, false })
      {
        for (const int rays : { 25, 100, 400, 1600 })
        {
          const ScanSetup setup = setupOf(scene, tree, rays, reflections, cells);
          add((cells ? "cells, " : "rays, ") + std::to_string(rays), setup, 1.0,
            [setup, &beams]() { freshScan(setup, beams, 1); });
        }
      }
      const ScanSetup usual = setupOf(scene, tree, 100, reflections, true);
      LitAgain air(usual, beams);
      LitAgain limit(usual, beams);
      add("cells, 100, other air", usual, 1.0, [&air]() { air.withOtherAir(); });
      add("cells, 100, other limit", usual, 1.0, [&limit]() { limit.withOtherLimit(); });
      std::vector<Workload> works;
      works.reserve(4);
      for (const int rays : { 100, 400, 1600, 6400 })
      {
        BeamAxes axes;
        axes.raysPerBeam = std::min(rays, 1600);
        axes.mostRays = beams.size() * 400;
        works.push_back(makeWorkload(scene, axes));
        const double timesAll = static_cast<double>(rays) * beams.size() / works.back().size();
        add("Embree's packets alone, " + std::to_string(rays),
          setupOf(scene, tree, rays, reflections, false), timesAll,
          [&packets, work = &works.back()]() { packets(*work, 1, [](auto...) {}); });
      }
      const std::vector<Timing> timings = compete(contenders, options.limits());
      for (std::size_t k = 0; k < timings.size(); ++k)
      {
        const Timing& t = timings[k];
        table.row(scene.name, scene.mesh->size(), reflections, t.name, scales[k] * t.median,
          scales[k] * t.best, errors[k].rms, errors[k].wrong, errors[k].within);
        say(scene.name + ", " + std::to_string(reflections) + ", " + t.name + ": " +
          std::to_string(1e3 * scales[k] * t.best) + " ms, rms " +
          std::to_string(100.0 * errors[k].rms) + " %, wrong " +
          std::to_string(100.0 * errors[k].wrong) + " %");
      }
    }
  }
  return true;
}
}
