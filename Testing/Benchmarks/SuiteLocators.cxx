// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "HitComparison.h"
#include "OurTracer.h"
#include "Subprocess.h"
#include "VtkPeers.h"

#include <algorithm>

namespace benchmarks
{
using namespace avianlidar;

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

/// What one peer needs for one scene: build s, ns per ray, rays, hits, differ, at edges, ours ns.
std::vector<double> duel(const Scene& scene, const CollisionTree& tree, const Workload& beams,
  const PeerMaker& maker, const Options& options)
{
  const VtkPeer peer = maker.make(scene);
  const double patience = options.smoke ? 0.02 : options.brief ? 0.5 : 5.0;
  const Workload pilot = someOf(beams, 100, 1);
  const double pilotSeconds = std::max(secondsOf([&]() { peer.trace(pilot, 1, nullptr); }), 1e-7);
  const double affordable = patience / pilotSeconds * static_cast<double>(pilot.size());
  const auto rays = static_cast<std::size_t>(
    std::clamp(affordable / static_cast<double>(beams.beams()), 1.0, double(Rays)));
  const Workload work = someOf(
    beams, std::clamp<std::size_t>(static_cast<std::size_t>(affordable), 20, beams.beams()), rays);
  const Tracer ours = ourTracer(tree, TraceMode::Automatic);
  std::vector<Hit> theirs;
  secondsOf([&]() { theirs = allHits(peer.trace, work, 1); });
  const HitAgreement a = compareHits(scene, work, allHits(ours, work, 1), theirs);
  RoundLimits limits = options.limits();
  limits.seconds = patience;
  limits.fewest = options.smoke ? 1 : 2;
  const std::vector<Timing> timings =
    compete({ { "ours", [&]() { ours(beams, 1, nullptr); } },
              { maker.name, [&]() { peer.trace(work, 1, nullptr); } } },
      limits);
  return { peer.buildSeconds, 1e9 * timings[1].median / work.size(), double(a.rays), double(a.hits),
    double(a.differ), double(a.atEdges), 1e9 * timings[0].median / beams.size() };
}

void match(const Scene& scene, const Options& options, Table& times)
{
  const auto tree = buildCollisionTree(scene.mesh, TreeOptions{});
  const Workload beams =
    someOf(makeWorkload(scene, { Rays, 5.6e-3, 0, 0 }), options.smoke ? 50 : Beams, Rays);
  std::vector<PeerMaker> makers = vtkPeers();
  if (scene.mesh->size() <= SmallScene)
  {
    makers.push_back({ "brute force", [](const Scene& s) {
                        return VtkPeer{ 0.0, bruteForce(s) };
                      } });
  }
  for (const PeerMaker& maker : makers)
  {
    const auto numbers = inSubprocess(
      [&]() { return duel(scene, *tree, beams, maker, options); }, options.brief ? 10 : 60);
    if (!numbers || numbers->size() != 7)
    {
      times.row(scene.name, scene.mesh->size(), maker.name, "", "", "", "", "", "", "", "");
      say(scene.name + ", " + maker.name + ": crashed, or was not done in time");
      continue;
    }
    const std::vector<double>& n = *numbers;
    times.row(scene.name, scene.mesh->size(), maker.name, n[0], n[1], n[6], n[1] / n[6], n[2], n[3],
      n[4], n[5]);
    say(scene.name + ", " + maker.name + ": " + std::to_string(n[1]) + " ns per ray, " +
      std::to_string(n[1] / n[6]) + " times ours; of " + std::to_string(long(n[2])) + " rays " +
      std::to_string(long(n[4] - n[5])) + " differ");
  }
}
}

bool suiteLocators(const Options& options)
{
  Table times(options.folder + "/locators.csv",
    "scene,triangles,contender,build_s,ns_per_ray,ours_ns_per_ray,ratio,rays,hits,differ,at_edges");
  forEachScene(options,
    [&](const Scene& scene)
    {
      if (scene.mesh->size() <= LargeScene)
      {
        match(scene, options, times);
      }
    });
  return true;
}
}
