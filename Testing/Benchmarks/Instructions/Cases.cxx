// SPDX-License-Identifier: BSD-3-Clause
// Three fixed pieces of work whose instructions callgrind counts (check_instructions.py). What is
// made ready before is not counted: callgrind looks only at avianlidarCounted().
#include "BeamTracer.h"
#include "CollisionTreeBuilder.h"
#include "Workload.h"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <string>

using namespace avianlidar;
using namespace benchmarks;

extern "C" __attribute__((noinline)) void avianlidarCounted(const std::function<void()>& work)
{
  work();
}

namespace
{
/// Tracing what beams of 100 rays see of `scene`.
std::size_t countTracing(const Scene& scene, std::size_t mostRays)
{
  const auto tree = buildCollisionTree(scene.mesh, TreeOptions{});
  const Workload work = makeWorkload(scene, { 100, 5.6e-3, 0, mostRays });
  std::size_t found = 0;
  avianlidarCounted(
    [&]()
    {
      const SceneTriangles tracerScene(*tree);
      BeamTracer tracer(tracerScene);
      for (std::size_t b = 0; b < work.beams(); ++b)
      {
        DrawnRays given(&work.rays[b]);
        const TracedBeams block{ &work.frames[b], 1, 100, &given };
        const TracedHits& hits = tracer.traceBeams(block, TraceMode::Automatic);
        if (const std::uint32_t* const triangles = hits.triangles[0])
        {
          found += 100 - std::count(triangles, triangles + 100, NoTriangle);
        }
      }
    });
  return found;
}

/// The whole method without VTK: sampling, tracing, energies, returns.
std::size_t countScan()
{
  const Scene scene = makeCorridor();
  const ScanSetup setup = makeSetup(scene, buildCollisionTree(scene.mesh, TreeOptions{}));
  const ScanBeams beams = makeBeams(scene, 12);
  std::size_t echoes = 0;
  avianlidarCounted([&]() { echoes = runScan(setup, beams, 1).echoes.size(); });
  return echoes;
}
}

int main(int argc, char* argv[])
{
  const std::string name = argc > 1 ? argv[1] : "";
  const std::size_t found = name == "trace-boxes" ? countTracing(makeBoxes(500), 50000)
    : name == "trace-fine-sphere"                 ? countTracing(makeSphere(100000), 20000)
    : name == "scan-corridor"                     ? countScan()
                                                  : 0;
  std::cout << name << ": " << found << "\n";
  return found > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
