// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "EmbreePeer.h"
#include "HitComparison.h"
#include "OurTracer.h"

namespace benchmarks
{
using namespace avianlidar;

bool suiteGrowth(const Options& options)
{
  Table times(options.folder + "/growth.csv", "triangles,rays,contender,median_s,best_s,rounds");
  std::vector<std::size_t> sizes = { 5000, 10000, 20000, 50000, 100000, 200000, 500000, 1000000,
    2000000, 5000000 };
  if (options.brief || options.smoke)
  {
    sizes = options.smoke ? std::vector<std::size_t>{ 5000, 20000 }
                          : std::vector<std::size_t>{ 5000, 50000, 500000 };
  }
  bool good = true;
  for (const std::size_t size : sizes)
  {
    const Scene scene = makeFacade(size);
    const auto tree = buildCollisionTree(scene.mesh, TreeOptions{});
    EmbreeScene embree(scene, false, 2);
    embree.build();
    const Workload work = makeWorkload(scene, { 100, 5.6e-3, 0, options.mostRays() });
    const std::vector<NamedTracer> tracers = { { "ours", ourTracer(*tree, TraceMode::Automatic) },
      { "embree packets", embree.packets() }, { "embree single", embree.single() } };
    const std::vector<Hit> ours = allHits(tracers[0].trace, work, 2);
    std::vector<Contender> contenders;
    for (const NamedTracer& t : tracers)
    {
      const HitAgreement a = compareHits(scene, work, ours, allHits(t.trace, work, 2));
      good = good && a.unexplained() <= 1e-3 && a.hits == work.size();
      contenders.push_back({ t.name, [&]() { t.trace(work, 1, nullptr); } });
    }
    for (const Timing& t : compete(contenders, options.limits()))
    {
      times.row(scene.mesh->size(), work.size(), t.name, t.median, t.best, t.rounds);
      say(scene.name + ", " + t.name + ": " + std::to_string(1e9 * t.median / work.size()) +
        " ns per ray");
    }
  }
  return good;
}
}
