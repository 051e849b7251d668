// SPDX-License-Identifier: BSD-3-Clause
// Tracing, trees and whole scans beside Embree, VTK's locators and brute force.
#include "CollisionTreeBuilder.h"
#include "FinishSetup.h"
#include "Memory.h"
#include "Suites.h"
#include "Tracers.h"

#include <omp.h>

#include <algorithm>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
/// Largest share of rays that may disagree without an edge to explain it. Embree's default scenes
/// are not watertight, and single precision is coarse where surfaces are seen at grazing incidence.
constexpr double Tolerated = 1e-3;

std::vector<BeamAxes> cells(const Options& options, bool airport)
{
  const std::size_t most = options.mostRays();
  if (options.smoke)
  {
    return { { 16, 5.6e-3, 0, most } };
  }
  if (options.brief)
  {
    return { { 1, 5.6e-3, 0, most }, { 100, 1e-4, 0, most }, { 100, 5.6e-3, 0, most },
      { 1000, 2e-2, 0, most } };
  }
  std::vector<BeamAxes> list;
  for (const int rays : { 1, 16, 100, 1000 })
  {
    for (const double width : { 1e-4, 1e-3, 5.6e-3, 2e-2 })
    {
      list.push_back({ rays, width, 0, most });
    }
  }
  if (airport)
  {
    list.push_back({ 100, 5.6e-3, 32, most });
  }
  return list;
}

/// One scene in all cells. @return whether the hits agree
bool match(const Scene& scene, const Options& options, Table& times, Table& hits)
{
  const auto tree = buildCollisionTree(scene.mesh, TreeOptions{});
  EmbreeScene embree(scene, 2);
  embree.build();
  bool good = true;
  for (const BeamAxes& axes : cells(options, scene.airport))
  {
    const Workload work = makeWorkload(scene, axes);
    std::vector<NamedTracer> tracers = { { "ours", ourTracer(*tree, TraceMode::Automatic) },
      { "embree single", embree.single() }, { "embree packets", embree.packets() } };
    if (options.smoke || (axes.raysPerBeam == 100 && axes.halfBeamwidth == 5.6e-3))
    {
      tracers.push_back({ "ours beams", ourTracer(*tree, TraceMode::Beams) });
      tracers.push_back({ "ours per ray", ourTracer(*tree, TraceMode::SingleRays) });
    }
    const std::vector<Hit> ours = allHits(tracers[0].trace, work, 2);
    for (std::size_t t = 1; t < tracers.size(); ++t)
    {
      const HitAgreement a = compareHits(scene, work, ours, allHits(tracers[t].trace, work, 2));
      hits.row(scene.name, tracers[t].name, a.rays, a.hits, a.differ, a.atEdges);
      if (!(a.unexplained() <= Tolerated))
      {
        say("HITS DISAGREE: " + scene.name + ", " + tracers[t].name);
        good = false;
      }
    }
    for (const int threads : { 1, 2 })
    {
      std::vector<Contender> contenders;
      for (const NamedTracer& t : tracers)
      {
        contenders.push_back({ t.name, [&, threads]() { t.trace(work, threads, nullptr); } });
      }
      for (const Timing& t : compete(contenders, options.limits()))
      {
        times.row(scene.name, scene.mesh->size(),
          axes.channels ? axes.channels : numberOfChannels(scene.pattern), work.beams(),
          axes.raysPerBeam, axes.halfBeamwidth, threads, t.name, t.median);
      }
    }
    say(scene.name + ", N " + std::to_string(axes.raysPerBeam) + ", half-beamwidth " +
      std::to_string(axes.halfBeamwidth));
  }
  return good;
}
}

bool suiteMachine(const Options& options)
{
  Table table(options, "libraries", "what,is");
  table.row("peer", embreeDescription());
  table.row("compiler", std::string("GCC ") + __VERSION__);
  return true;
}

bool suiteMatrix(const Options& options)
{
  Table times(options, "matrix",
    "scene,triangles,channels,beams,rays_per_beam,half_beamwidth,threads,contender,median_s");
  Table hits(options, "hits", "scene,contender,rays,hits,differ,at_edges");
  bool good = true;
  forEachScene(options, allScenes(),
    [&](const Scene& scene, const SceneEntry&)
    { good = match(scene, options, times, hits) && good; });
  return good;
}

bool suiteBuild(const Options& options)
{
  Table times(options, "build",
    "scene,triangles,threads,ours_s,embree_s,ratio,ours_bytes_per_triangle,"
    "embree_bytes_per_triangle");
  const auto measure = [&](const Scene& scene, int threads)
  {
    omp_set_num_threads(threads);
    const auto timeOf = threads == 1 ? processorSecondsOf : secondsOf;
    std::vector<double> ours;
    std::vector<double> theirs; // a new scene each time: copying the mesh into it is not timed
    std::size_t theirBytes = 0;
    std::size_t ourBytes = 0;
    double spent = 0.0;
    const RoundLimits limits = options.limits();
    for (int i = 0; i <= limits.fewest || (i <= limits.most && spent < limits.seconds); ++i)
    {
      std::shared_ptr<const CollisionTree> tree;
      EmbreeScene peer(scene, threads);
      theirBytes = peer.bytes();
      theirs.push_back(timeOf([&]() { peer.build(); }));
      theirBytes = peer.bytes() - theirBytes;
      ourBytes = heapBytes();
      ours.push_back(timeOf([&]() { tree = buildCollisionTree(scene.mesh, TreeOptions{}); }));
      ourBytes = heapBytes() - ourBytes;
      spent += ours.back() + theirs.back();
      if (i == 0) // to warm up
      {
        ours.clear();
        theirs.clear();
        spent = 0.0;
      }
    }
    const double n = static_cast<double>(scene.mesh->size());
    times.row(scene.name, scene.mesh->size(), threads, medianOf(ours), medianOf(theirs),
      medianOf(theirs) / medianOf(ours), ourBytes / n, theirBytes / n);
    say(scene.name + ", threads " + std::to_string(threads));
  };
  forEachScene(options, allScenes(),
    [&](const Scene& scene, const SceneEntry&)
    {
      measure(scene, 1);
      measure(scene, 2);
    });
  return true;
}

bool suiteScan(const Options& options)
{
  Table times(options, "scan", "scene,triangles,contender,median_s,speed");
  forEachScene(options, airports(),
    [&](const Scene& scene, const SceneEntry&)
    {
      const ScanBeams beams = makeBeams(scene);
      const Workload hundred = makeWorkload(scene, {});
      // So many rays reach an error of about 1 %; every k-th column of them, scaled to all.
      const Workload thousand = makeWorkload(scene, { 1000, 5.6e-3, 0, options.mostRays() });
      const double share = static_cast<double>(thousand.beams()) / hundred.beams();
      const auto tree = buildCollisionTree(scene.mesh, TreeOptions{});
      EmbreeScene embree(scene, 1);
      embree.build();
      const Tracer packets = embree.packets();
      std::vector<Contender> contenders = {
        { "Embree's packets, 100 rays", [&]() { packets(hundred, 1, [](auto...) {}); } },
        { "Embree's packets, 1,000 rays", [&]() { packets(thousand, 1, [](auto...) {}); } },
      };
      const auto add = [&](const std::string& name, int reflections, int connections,
                         BeamSampleSource source = BeamSampleSource::Rays)
      {
        ScanSetup setup = makeSetup(scene, tree);
        setup.settings.numberOfReflections = reflections;
        setup.settings.numberOfConnections = connections;
        setup.settings.beamSamples = source;
        finishSetup(setup);
        contenders.push_back({ name, [setup, &beams]() { runScan(setup, beams, 1); } });
      };
      add("one reflection", 1, 0);
      add("two reflections, 2 connections", 2, 2);
      add("two reflections, 8 connections", 2, 8);
      add("one reflection, cells", 1, 0, BeamSampleSource::Cells);
      add("two reflections, 2 connections, cells", 2, 2, BeamSampleSource::Cells);
      RoundLimits limits = options.limits();
      limits.processorTime = true; // one thread
      std::vector<Timing> timings = compete(contenders, limits);
      timings[1].median /= share;
      for (const Timing& t : timings)
      {
        times.row(scene.name, scene.mesh->size(), t.name, t.median, timings[0].median / t.median);
        say(scene.name + ", " + t.name + ": " + std::to_string(1e3 * t.median) + " ms");
      }
    });
  return true;
}

namespace
{
constexpr std::size_t Beams = 500;
constexpr int Rays = 100;

/// Brute force takes part up to so many triangles, VTK up to so many.
constexpr std::size_t SmallScene = 20000;
constexpr std::size_t LargeScene = 2000000;

/// Up to `beams` beams spread over those of `all`, and of each `rays` rays spread over its own.
Workload someOf(const Workload& all, std::size_t beams, std::size_t rays)
{
  Workload some;
  some.raysPerBeam = rays;
  beams = std::min(beams, all.beams());
  for (std::size_t i = 0; i < beams; ++i)
  {
    const std::size_t b = i * all.beams() / beams;
    some.frames.push_back(all.frames[b]);
    BeamRays part;
    for (std::size_t n = 0; n < rays; ++n)
    {
      part.x.push_back(all.rays[b].x[n * all.raysPerBeam / rays]);
      part.y.push_back(all.rays[b].y[n * all.raysPerBeam / rays]);
    }
    some.rays.push_back(part);
  }
  return some;
}

/// One peer on one scene: as many beams and rays as fit in seconds.
void duel(const Scene& scene, const CollisionTree& tree, const Workload& beams,
  const PeerMaker& maker, const Options& options, Table& times)
{
  const VtkPeer peer = maker.make(scene);
  const double patience = options.smoke ? 0.02 : options.brief ? 0.5 : 5.0;
  const Workload pilot = someOf(beams, 100, 1);
  const double pilotSeconds = std::max(secondsOf([&]() { peer.trace(pilot, 1, nullptr); }), 1e-7);
  const double affordable = patience / pilotSeconds * static_cast<double>(pilot.size());
  const Workload work =
    someOf(beams, std::clamp<std::size_t>(static_cast<std::size_t>(affordable), 20, beams.beams()),
      static_cast<std::size_t>(
        std::clamp(affordable / static_cast<double>(beams.beams()), 1.0, double(Rays))));
  const Tracer ours = ourTracer(tree, TraceMode::Automatic);
  const HitAgreement a =
    compareHits(scene, work, allHits(ours, work, 1), allHits(peer.trace, work, 1));
  RoundLimits limits = options.limits();
  limits.seconds = patience;
  limits.fewest = options.smoke ? 1 : 2;
  const std::vector<Timing> timings =
    compete({ { "ours", [&]() { ours(beams, 1, nullptr); } },
              { maker.name, [&]() { peer.trace(work, 1, nullptr); } } },
      limits);
  const double our = 1e9 * timings[0].median / beams.size();
  const double their = 1e9 * timings[1].median / work.size();
  times.row(scene.name, maker.name, peer.buildSeconds, their, their / our, a.rays, a.hits, a.differ,
    a.atEdges);
}
}

bool suiteLocators(const Options& options)
{
  Table times(
    options, "locators", "scene,contender,build_s,ns_per_ray,ratio,rays,hits,differ,at_edges");
  forEachScene(options, allScenes(),
    [&](const Scene& scene, const SceneEntry&)
    {
      if (scene.mesh->size() > LargeScene)
      {
        return;
      }
      const auto tree = buildCollisionTree(scene.mesh, TreeOptions{});
      const Workload beams =
        someOf(makeWorkload(scene, {}), options.smoke ? Beams / 10 : Beams, Rays);
      std::vector<PeerMaker> makers = vtkPeers();
      if (scene.mesh->size() <= SmallScene)
      {
        makers.push_back({ "brute force", [](const Scene& s) {
                            return VtkPeer{ 0.0, bruteForce(s) };
                          } });
      }
      for (const PeerMaker& maker : makers)
      {
        const bool done = inSubprocess(
          [&]() { duel(scene, *tree, beams, maker, options, times); }, options.brief ? 10 : 60);
        say(scene.name + ", " + maker.name + (done ? "" : ": crashed, or was not done in time"));
      }
    });
  return true;
}
}
