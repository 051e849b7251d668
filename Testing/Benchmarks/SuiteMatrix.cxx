// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "EmbreePeer.h"
#include "HitComparison.h"
#include "OurTracer.h"

#include <iomanip>
#include <sstream>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
/// Largest share of rays that may disagree without an edge to explain it. Embree's default scenes
/// are not watertight, and single precision is coarse where surfaces are seen at grazing incidence.
constexpr double Tolerated = 1e-3;

struct Cell
{
  BeamAxes axes;
  std::vector<int> threads;
  bool everyone = false; ///< also robust scenes and every way down the tree
};

std::vector<Cell> cells(const Options& options, bool airport)
{
  std::vector<Cell> list;
  const auto add = [&](
                     int rays, double width, int channels, std::vector<int> threads, bool everyone)
  {
    list.push_back({ { rays, width, channels, options.mostRays() }, std::move(threads), everyone });
  };
  if (options.smoke)
  {
    add(16, 5.6e-3, 0, { 2 }, true);
    return list;
  }
  if (options.brief)
  {
    add(1, 5.6e-3, 0, { 1 }, false);
    add(100, 1e-4, 0, { 1 }, false);
    add(100, 5.6e-3, 0, { 1, 2 }, true);
    add(1000, 2e-2, 0, { 1 }, false);
    return list;
  }
  for (const int rays : { 1, 16, 100, 1000 })
  {
    for (const double width : { 1e-4, 1e-3, 5.6e-3, 2e-2 })
    {
      add(rays, width, 0, { 1, 2 }, rays == 100 && width == 5.6e-3);
    }
  }
  if (airport)
  {
    add(100, 5.6e-3, 32, { 1, 2 }, true);
  }
  return list;
}

/// One scene, with every tree that is needed.
class Match
{
public:
  Match(const Scene& scene, Table& times, Table& hits)
    : Surfaces(scene)
    , Times(times)
    , Hits(hits)
    , Tree(buildCollisionTree(scene.mesh, TreeOptions{}))
    , Default(scene, false, 2)
    , Robust(scene, true, 2)
  {
    this->Default.build();
    this->Robust.build();
  }

  bool run(const Cell& cell, const Options& options)
  {
    const Workload work = makeWorkload(this->Surfaces, cell.axes);
    const std::vector<NamedTracer> tracers = this->tracers(cell);
    if (!this->agree(cell, work, tracers))
    {
      return false;
    }
    for (const int threads : cell.threads)
    {
      std::vector<Contender> contenders;
      for (const NamedTracer& t : tracers)
      {
        contenders.push_back({ t.name, [&, threads]() { t.trace(work, threads, nullptr); } });
      }
      this->report(cell, work, threads, compete(contenders, options.limits()));
    }
    return true;
  }

private:
  std::vector<NamedTracer> tracers(const Cell& cell) const
  {
    std::vector<NamedTracer> list = { { "ours", ourTracer(*this->Tree, TraceMode::Automatic) },
      { "embree single", this->Default.single() }, { "embree packets", this->Default.packets() } };
    if (cell.everyone)
    {
      list.push_back({ "ours beams", ourTracer(*this->Tree, TraceMode::Beams) });
      list.push_back({ "ours per ray", ourTracer(*this->Tree, TraceMode::SingleRays) });
      list.push_back({ "embree robust single", this->Robust.single() });
      list.push_back({ "embree robust packets", this->Robust.packets() });
    }
    return list;
  }

  bool agree(const Cell& cell, const Workload& work, const std::vector<NamedTracer>& tracers)
  {
    const std::vector<Hit> ours = allHits(tracers[0].trace, work, 2);
    bool good = true;
    for (std::size_t t = 1; t < tracers.size(); ++t)
    {
      const HitAgreement a =
        compareHits(this->Surfaces, work, ours, allHits(tracers[t].trace, work, 2));
      this->Hits.row(this->Surfaces.name, this->Surfaces.mesh->size(), cell.axes.raysPerBeam,
        cell.axes.halfBeamwidth, tracers[t].name, a.rays, a.hits, a.differ, a.atEdges,
        a.unexplained());
      if (!(a.unexplained() <= Tolerated))
      {
        say("HITS DISAGREE: " + this->Surfaces.name + ", " + tracers[t].name + ": " +
          std::to_string(a.differ - a.atEdges) + " of " + std::to_string(a.rays) + " rays");
        good = false;
      }
    }
    return good;
  }

  void report(
    const Cell& cell, const Workload& work, int threads, const std::vector<Timing>& timings)
  {
    std::ostringstream line;
    line << std::left << std::setw(22) << this->Surfaces.name << " N " << std::setw(5)
         << cell.axes.raysPerBeam << " width " << std::setw(7) << cell.axes.halfBeamwidth
         << " threads " << threads << ":";
    for (const Timing& t : timings)
    {
      this->Times.row(this->Surfaces.name, this->Surfaces.mesh->size(),
        cell.axes.channels ? cell.axes.channels : numberOfChannels(this->Surfaces.pattern),
        work.beams(), cell.axes.raysPerBeam, cell.axes.halfBeamwidth, threads, t.name, t.median,
        t.best, t.rounds);
      line << "  " << t.name << " " << std::setprecision(3) << 1e9 * t.median / work.size();
    }
    say(line.str() + "  (ns per ray)");
  }

  const Scene& Surfaces;
  Table& Times;
  Table& Hits;
  std::shared_ptr<const CollisionTree> Tree;
  EmbreeScene Default;
  EmbreeScene Robust;
};
}

bool suiteMachine(const Options& options)
{
  Table table(options.folder + "/libraries.csv", "what,is");
  table.row("peer", embreeDescription());
  table.row("compiler", std::string("GCC ") + __VERSION__);
  return true;
}

void forEachScene(const Options& options, const std::function<void(const Scene&)>& measure)
{
  for (const std::vector<SceneEntry>& list : { airports(), generatedScenes() })
  {
    for (const SceneEntry& entry : list)
    {
      if (!wanted(options, entry.name))
      {
        continue;
      }
      const Scene scene = entry.make();
      if (scene.mesh->size() > 0)
      {
        measure(scene);
      }
      else
      {
        say(entry.name + ": left out, its data are not here (AVIANLIDAR_DATA_DIR)");
      }
    }
  }
}

bool suiteMatrix(const Options& options)
{
  Table times(options.folder + "/matrix.csv",
    "scene,triangles,channels,beams,rays_per_beam,half_beamwidth,threads,contender,median_s,best_s,"
    "rounds");
  Table hits(options.folder + "/hits.csv",
    "scene,triangles,rays_per_beam,half_beamwidth,contender,rays,hits,differ,at_edges,unexplained");
  bool good = true;
  forEachScene(options,
    [&](const Scene& scene)
    {
      Match match(scene, times, hits);
      for (const Cell& cell : cells(options, scene.airport))
      {
        good = match.run(cell, options) && good;
      }
    });
  return good;
}
}
