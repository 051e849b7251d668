// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "FinishSetup.h"
#include "MeshTools.h"
#include "Results.h"
#include "ScanRunner.h"

#include <algorithm>
#include <cmath>

namespace accuracy
{
using namespace avianlidar;

namespace
{
constexpr double Range = 1000.0; // m
constexpr double Behind = 50.0;  // m, the wall: in range units of its own
/// Box and wall are turned, rad: cells about the middle of a lobe are fine whatever stands there.
constexpr double Turn = 25.0 * RadiansPerDegree;
constexpr double Sizes[] = { 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0 };
constexpr int WallObject = 0;
constexpr int BoxObject = 1;
const Material Matt{ 0.146, 0.0, 1.0 };

/// A box of `size` m.
void addTarget(benchmarks::Scene& scene, double size, int object)
{
  benchmarks::addBox(
    *scene.mesh, 0.0, Range, Vec3(0.5 * size, 0.5 * size, 0.0), Turn, -0.5 * size, 0.5 * size);
  scene.materials.resize(scene.mesh->size(), Matt);
  scene.objectIds.resize(scene.mesh->size(), object);
}

/// A wall of so many parts that a beam is divided into cells.
void addWall(benchmarks::Scene& scene)
{
  constexpr int parts = 24;
  const double size = 2.0 * 12.0 / parts;
  for (int i = 0; i < parts; ++i)
  {
    for (int k = 0; k < parts; ++k)
    {
      const Vec3 u(size * std::cos(Turn), size * std::sin(Turn), 0.0);
      const Vec3 v(0.0, 0.0, size);
      const Vec3 a =
        Vec3(0.0, Range + Behind, 0.0) + double(i - parts / 2) * u + double(k - parts / 2) * v;
      benchmarks::addQuad(*scene.mesh, a, a + u, a + u + v, a + v);
    }
  }
  scene.materials.resize(scene.mesh->size(), Matt);
  scene.objectIds.resize(scene.mesh->size(), WallObject);
}

benchmarks::Scene emptyScene()
{
  benchmarks::Scene scene;
  scene.mesh = std::make_shared<TriangleMesh>();
  scene.apex = Vec3(0.0);
  return scene;
}

/// The energy, J, and its standard error, of what arrives before the wall; by beam.
std::vector<Echo> firstEchoes(const benchmarks::Scene& scene, const ScanBeams& beams,
  const EchoSettings& settings, double limit, std::uint64_t* cells = nullptr)
{
  ScanSetup setup = benchmarks::makeSetup(scene, buildCollisionTree(scene.mesh, {}));
  setup.settings = settings;
  setup.sensor.samplingInterval = 5e-8; // 7.5 m
  setup.sensor.lowerEnergyLimit = limit;
  finishSetup(setup);
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, 0, cache, std::size_t(1) << 30, {}, result);
  std::vector<Echo> echoes(beams.size());
  for (std::size_t i = 0; i < result.echoes.size(); ++i)
  {
    if (result.echoes[i].range < Range + 0.5 * Behind)
    {
      echoes[result.beamOfEcho[i]] = result.echoes[i];
    }
  }
  if (cells)
  {
    *cells = std::count_if(cache.beams.begin(), cache.beams.end(),
      [](const BeamTrace& trace) { return trace.direct() == DirectEcho::Cells; });
  }
  return echoes;
}

/// Beams that hold the box anywhere in their inner half, each with random numbers of its own.
ScanBeams beamsAbout(double halfBeamwidth, std::size_t count)
{
  benchmarks::Numbers random(9);
  ScanBeams beams;
  for (std::size_t i = 0; i < count; ++i)
  {
    beams.ids.push_back(i);
    beams.origins.emplace_back(0.0);
    const double aside = 0.5 * halfBeamwidth * std::sqrt(random(0.0, 1.0));
    const double turn = random(0.0, 2.0 * Pi);
    beams.directions.push_back(
      glm::normalize(Vec3(aside * std::cos(turn), 1.0, aside * std::sin(turn))));
  }
  return beams;
}

/// What becomes of a box.
struct Outcome
{
  double found = 0.0; ///< share of the beams
  double rms = 0.0;   ///< relative error of the energy, where found
  double wide = 0.0;  ///< mean standard error there, relative
  double held = 0.0;  ///< share of them of which 1.96 standard errors hold the truth
};

Outcome outcomeOf(const std::vector<Echo>& truth, const std::vector<Echo>& echoes)
{
  Outcome outcome;
  double found = 0.0;
  for (std::size_t b = 0; b < truth.size(); ++b)
  {
    const double right = truth[b].energyReceived;
    const double error = echoes[b].energyReceived - right;
    if (echoes[b].energyReceived > 0.0)
    {
      found += 1.0;
      outcome.rms += error * error / (right * right);
      outcome.wide += echoes[b].energyStdError / right;
      // The truth is integrated, and has a bound.
      outcome.held +=
        std::fabs(error) <= 1.96 * echoes[b].energyStdError + truth[b].energyStdError ? 1.0 : 0.0;
    }
  }
  outcome.found = found / static_cast<double>(truth.size());
  if (found > 0.0)
  {
    outcome.rms = std::sqrt(outcome.rms / found);
    outcome.wide /= found;
    outcome.held /= found;
  }
  return outcome;
}
}

bool suiteSmallTargets(const Options& options)
{
  benchmarks::Table table(options.folder + "/small_targets.csv",
    "size,share,samples,own_id,rays,beams,cells,found,rms,stated,held");
  const std::size_t count = options.check ? 100 : 400;
  bool good = true;
  for (const double size : Sizes)
  {
    EchoSettings settings;
    settings.numberOfReflections = 1;
    settings.attenuationCoefficient = 0.0;
    settings.noise = false;
    const Sensor sensor;
    const double beam = Pi * std::pow(Range * std::tan(sensor.halfBeamwidth), 2);
    const double share = size * size / beam;
    // Half of what its front returns.
    const double limit = 0.5 * sensor.pulseEnergy * Matt.kd * share;
    const ScanBeams beams = beamsAbout(sensor.halfBeamwidth, count);
    benchmarks::Scene alone = emptyScene();
    addTarget(alone, size, BoxObject);
    const std::vector<Echo> truth = firstEchoes(alone, beams, settings, limit);
    const auto measure = [&](BeamSampleSource source, bool ownId, int rays)
    {
      benchmarks::Scene scene = emptyScene();
      addWall(scene);
      addTarget(scene, size, ownId ? BoxObject : WallObject);
      settings.beamSamples = source;
      settings.raysPerBeam = rays;
      std::uint64_t cells = 0;
      const Outcome seen = outcomeOf(truth, firstEchoes(scene, beams, settings, limit, &cells));
      const bool inCells = source == BeamSampleSource::Cells;
      table.row(size, share, inCells ? "Cells" : "Rays", ownId, rays, count, cells, seen.found,
        seen.rms, seen.wide, seen.held);
      const bool met = !inCells || !ownId || (seen.found > 0.99 && seen.held > 0.93);
      benchmarks::say(std::to_string(size) + " m, " + (inCells ? "cells" : "rays") +
        (ownId ? "" : ", no id of its own") + ", N = " + std::to_string(rays) + ": found " +
        std::to_string(seen.found) + ", rms " + std::to_string(seen.rms) + ", held " +
        std::to_string(seen.held) + (met ? "" : " BAR NOT MET"));
      good = good && met;
    };
    for (const int rays : { 25, 100 })
    {
      measure(BeamSampleSource::Cells, true, rays);
      measure(BeamSampleSource::Cells, false, rays);
    }
    if (!options.check)
    {
      measure(BeamSampleSource::Cells, true, 400);
      measure(BeamSampleSource::Rays, true, 100);
      measure(BeamSampleSource::Rays, true, 100000);
    }
  }
  return good;
}
}
