// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "EmbreePeer.h"
#include "FinishSetup.h"
#include "ScanRunner.h"

namespace benchmarks
{
using namespace avianlidar;

namespace
{
/// The settings of a scan.
struct Variant
{
  const char* name;
  int reflections;
  int connections;
  BeamSampleSource source = BeamSampleSource::Rays;
};

ScanSetup setupOf(
  const Scene& scene, std::shared_ptr<const CollisionTree> tree, const Variant& variant)
{
  ScanSetup setup = makeSetup(scene, std::move(tree));
  setup.settings.numberOfReflections = variant.reflections;
  setup.settings.numberOfConnections = variant.connections;
  setup.settings.beamSamples = variant.source;
  finishSetup(setup);
  return setup;
}
}

bool suiteScan(const Options& options)
{
  Table times(
    options.folder + "/scan.csv", "scene,triangles,contender,median_s,best_s,rounds,speed");
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
    const ScanBeams beams = makeBeams(scene);
    const Workload work = makeWorkload(scene, {});
    const std::shared_ptr<const CollisionTree> tree = buildCollisionTree(scene.mesh, TreeOptions{});
    EmbreeScene embree(scene, false, 1);
    embree.build();
    const Tracer packets = embree.packets();
    std::vector<Contender> contenders = {
      { "Embree's packets, rays alone", [&]() { packets(work, 1, [](auto...) {}); } },
    };
    std::vector<ScanSetup> setups;
    for (const Variant& variant :
      { Variant{ "one reflection", 1, 0 }, Variant{ "two reflections, 2 connections", 2, 2 },
        Variant{ "two reflections, 8 connections", 2, 8 },
        Variant{ "two reflections, 2 connections, cells", 2, 2, BeamSampleSource::Cells } })
    {
      setups.push_back(setupOf(scene, tree, variant));
      contenders.push_back(
        { variant.name, [setup = setups.back(), &beams]() { freshScan(setup, beams, 1); } });
    }
    const std::vector<Timing> timings = compete(contenders, options.limits());
    for (const Timing& t : timings)
    {
      const double speed = timings[0].median / t.median;
      times.row(scene.name, scene.mesh->size(), t.name, t.median, t.best, t.rounds, speed);
      say(scene.name + ", " + t.name + ": " + std::to_string(1e3 * t.median) +
        " ms, speed of Embree's packets times " + std::to_string(speed));
    }
  }
  return true;
}
}
