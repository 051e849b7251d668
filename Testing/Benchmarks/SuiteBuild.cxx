// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "EmbreePeer.h"
#include "Memory.h"

#include <omp.h>

#include <memory>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
/// Bytes that a tree of ours takes beside the mesh, as malloc() sees it.
std::size_t ourBytes(const Scene& scene)
{
  const std::size_t before = heapBytes();
  const auto tree = buildCollisionTree(scene.mesh, TreeOptions{});
  return heapBytes() - before;
}

void measureBuild(const Scene& scene, const Options& options, Table& times)
{
  for (const int threads : { 1, 2 })
  {
    omp_set_num_threads(threads);
    // Embree's builder wants a new scene each time; copying the mesh into it is not timed.
    double embreeSeconds = 0.0;
    std::size_t embreeBytes = 0;
    const auto embree = [&]()
    {
      EmbreeScene peer(scene, false, threads);
      const std::size_t before = peer.bytes();
      embreeSeconds = secondsOf([&]() { peer.build(); });
      embreeBytes = peer.bytes() - before;
    };
    const auto ours = [&]() { buildCollisionTree(scene.mesh, TreeOptions{}); };
    std::vector<double> ourTurns;
    std::vector<double> embreeTurns;
    ours();
    embree();
    const RoundLimits limits = options.limits();
    double spent = 0.0;
    for (int round = 0; round < limits.fewest || (round < limits.most && spent < limits.seconds);
         ++round)
    {
      ourTurns.push_back(secondsOf(ours));
      embree();
      embreeTurns.push_back(embreeSeconds);
      spent += ourTurns.back() + embreeTurns.back();
    }
    const std::size_t bytes = ourBytes(scene);
    const double n = static_cast<double>(scene.mesh->size());
    times.row(scene.name, scene.mesh->size(), threads, medianOf(ourTurns), medianOf(embreeTurns),
      medianOf(embreeTurns) / medianOf(ourTurns), bytes / n, embreeBytes / n);
    say(scene.name + ", threads " + std::to_string(threads) + ": build " +
      std::to_string(medianOf(ourTurns)) + " s, Embree " + std::to_string(medianOf(embreeTurns)) +
      " s; " + std::to_string(bytes / n) + " and " + std::to_string(embreeBytes / n) +
      " bytes per triangle");
  }
}
}

bool suiteBuild(const Options& options)
{
  Table times(options.folder + "/build.csv",
    "scene,triangles,threads,ours_s,embree_s,ratio,ours_bytes_per_triangle,"
    "embree_bytes_per_triangle");
  forEachScene(options, [&](const Scene& scene) { measureBuild(scene, options, times); });
  return true;
}
}
