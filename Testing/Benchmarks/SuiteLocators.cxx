// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "HitComparison.h"
#include "OurTracer.h"
#include "VtkPeers.h"

#include <algorithm>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
constexpr std::size_t Beams = 500;

/// Brute force takes part up to so many triangles.
constexpr std::size_t SmallScene = 20000;

/// 500 beams spread over the scan.
Workload someBeams(const Scene& scene, std::size_t beams, int rays)
{
  Workload all = makeWorkload(scene, { rays, 5.6e-3, 0, 0 });
  Workload some;
  some.raysPerBeam = all.raysPerBeam;
  const std::size_t stride = std::max<std::size_t>(1, all.beams() / beams);
  for (std::size_t b = 0; b < all.beams() && some.beams() < beams; b += stride)
  {
    some.frames.push_back(all.frames[b]);
    some.rays.push_back(all.rays[b]);
  }
  return some;
}

/// A thousandth of the time of one run is enough to say that a peer is slow: few rays for those.
void match(const Scene& scene, const Options& options, Table& times, Table& hits)
{
  const auto tree = buildCollisionTree(scene.mesh, TreeOptions{});
  const int rays = options.smoke ? 2 : options.brief ? 10 : 100;
  const Workload work = someBeams(scene, options.smoke ? 50 : Beams, rays);
  std::vector<VtkPeer> peers = vtkPeers(scene);
  if (scene.mesh->size() <= SmallScene)
  {
    peers.push_back({ "brute force", 0.0, bruteForce(scene) });
  }
  const Tracer ours = ourTracer(*tree, true);
  const std::vector<Hit> ourHits = allHits(ours, work, 1);
  for (const VtkPeer& p : peers)
  {
    std::vector<Hit> theirs;
    const double seconds = secondsOf([&]() { theirs = allHits(p.trace, work, 1); });
    const HitAgreement a = compareHits(scene, work, ourHits, theirs);
    hits.row(
      scene.name, scene.mesh->size(), p.name, a.rays, a.hits, a.differ, a.atEdges, a.unexplained());
    const std::vector<Contender> pair = { { "ours", [&]() { ours(work, 1, [](auto...) {}); } },
      { p.name, [&]() { p.trace(work, 1, [](auto...) {}); } } };
    RoundLimits limits = options.limits();
    limits.fewest = seconds > limits.seconds ? 1 : limits.fewest;
    const std::vector<Timing> timings = compete(pair, limits);
    times.row(scene.name, scene.mesh->size(), work.beams(), rays, p.name, p.buildSeconds,
      1e9 * timings[1].median / work.size(), 1e9 * timings[0].median / work.size(),
      timings[1].median / timings[0].median);
    say(scene.name + ", " + p.name + ": " + std::to_string(1e9 * timings[1].median / work.size()) +
      " ns per ray, " + std::to_string(timings[1].median / timings[0].median) + " times ours; " +
      std::to_string(100.0 * a.unexplained()) + " % of hits differ");
  }
}
}

bool suiteLocators(const Options& options)
{
  Table times(options.folder + "/locators.csv",
    "scene,triangles,beams,rays_per_beam,contender,build_s,ns_per_ray,ours_ns_per_ray,ratio");
  Table hits(options.folder + "/locators_hits.csv",
    "scene,triangles,contender,rays,hits,differ,at_edges,unexplained");
  for (const std::vector<SceneEntry>& list : { airports(), generatedScenes() })
  {
    for (const SceneEntry& entry : list)
    {
      if (wanted(options, entry.name))
      {
        const Scene scene = entry.make();
        if (scene.mesh->size() > 0)
        {
          match(scene, options, times, hits);
        }
      }
    }
  }
  return true;
}
}
