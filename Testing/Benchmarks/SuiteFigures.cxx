// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "OurTracer.h"
#include "ScanRunner.h"

#include <algorithm>
#include <map>
#include <memory>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
const char* const Rules[] = { "BVH (halves)", "k-D (median)", "BSP (principal plane)",
  "surface area heuristic" };
const char* const Volumes[] = { "AABB", "OBB", "SBV" };

/// A combination that took longer than this at one size is left out at the next.
constexpr double Patience = 8.0;

std::vector<std::size_t> sphereSizes(const Options& options)
{
  if (options.smoke)
  {
    return { 100, 1000 };
  }
  if (options.brief)
  {
    return { 100, 1000, 10000, 100000 };
  }
  return { 100, 300, 1000, 3000, 10000, 30000, 100000, 300000, 1000000, 5000000 };
}

/// Columns of the sphere's scan that are left out, so that the slowest way ends in time.
std::int64_t strideOf(const Options& options)
{
  return options.smoke ? 64 : options.brief ? 16 : 4;
}

RoundLimits figureLimits(const Options& options)
{
  RoundLimits limits = options.limits();
  limits.seconds = options.brief ? 0.5 : 6.0;
  limits.fewest = options.smoke ? 1 : 2;
  return limits;
}
}

bool suiteFigure9(const Options& options)
{
  Table times(options.folder + "/figure9.csv",
    "triangles,rays,split_rule,volume,build_s,detection_s,total_s");
  std::map<std::pair<int, int>, double> last;
  for (const std::size_t size : sphereSizes(options))
  {
    const Scene scene = makeSphere(size);
    const Workload work = makeWorkload(
      scene, { 100, 5.6e-3, 0, options.smoke ? options.mostRays() : std::size_t(400000) });
    for (int rule = 0; rule < 4; ++rule)
    {
      for (int volume = 0; volume < 3; ++volume)
      {
        double& before = last[{ rule, volume }];
        if (before > Patience)
        {
          continue;
        }
        const TreeOptions tree{ static_cast<SplitRule>(rule),
          static_cast<BoundingVolumeType>(volume), TreeOptions{}.maximumLeafSize };
        std::vector<double> build;
        std::vector<double> detect;
        for (int round = 0; round < (size <= 100000 ? 3 : 1); ++round)
        {
          std::shared_ptr<const CollisionTree> made;
          build.push_back(secondsOf([&]() { made = buildCollisionTree(scene.mesh, tree); }));
          const Tracer tracer = ourTracer(*made, TraceMode::Automatic);
          detect.push_back(secondsOf([&]() { tracer(work, 1, nullptr); }));
        }
        before = medianOf(build) + medianOf(detect);
        times.row(scene.mesh->size(), work.size(), Rules[rule], Volumes[volume], medianOf(build),
          medianOf(detect), before);
        say("Fig. 9, " + std::to_string(size) + ", " + Rules[rule] + ", " + Volumes[volume] + ": " +
          std::to_string(before) + " s");
      }
    }
  }
  return true;
}

bool suiteFigure10(const Options& options)
{
  Table times(options.folder + "/figure10.csv", "triangles,beams,method,build_s,scan_s,total_s");
  for (const std::size_t size : sphereSizes(options))
  {
    const Scene scene = makeSphere(size);
    std::shared_ptr<const CollisionTree> tree;
    const double build = secondsOf([&]() { tree = buildCollisionTree(scene.mesh, TreeOptions{}); });
    const ScanBeams beams = makeBeams(scene, strideOf(options));
    ScanSetup ours = makeSetup(scene, tree);
    ScanSetup brdf = ours;
    brdf.settings.beamConstraint = false;
    brdf.settings.lightEnergyConstraint = false;
    brdf.settings.traceMode = TraceMode::SingleRays;
    brdf.settings.reflectanceModel = ReflectanceModel::Microfacet;
    ScanSetup phong = brdf;
    phong.settings.reflectanceModel = ReflectanceModel::Phong;
    const std::vector<Contender> contenders = {
      { "proposed method", [&]() { freshScan(ours, beams, 1); } },
      { "bidirectional BRDF, per ray", [&]() { freshScan(brdf, beams, 1); } },
      { "Phong, per ray", [&]() { freshScan(phong, beams, 1); } },
    };
    for (const Timing& t : compete(contenders, figureLimits(options)))
    {
      times.row(scene.mesh->size(), beams.size(), t.name, build, t.median, build + t.median);
      say("Fig. 10, " + std::to_string(size) + ", " + t.name + ": " + std::to_string(t.median) +
        " s");
    }
  }
  return true;
}

namespace
{
/// Fig. 11 on one scene: all combinations of the three switches. Their echoes are compared first.
bool ablation(const Scene& scene, std::int64_t stride, const Options& options, Table& times)
{
  const auto tree = buildCollisionTree(scene.mesh, TreeOptions{});
  const ScanBeams beams = makeBeams(scene, stride);
  std::vector<ScanSetup> setups;
  std::vector<Contender> contenders;
  setups.reserve(8);
  std::vector<ScanResult> results(8);
  for (int mask = 0; mask < 8; ++mask)
  {
    setups.push_back(makeSetup(scene, tree));
    EchoSettings& s = setups.back().settings;
    s.beamConstraint = (mask & 1) != 0;
    s.lightEnergyConstraint = (mask & 2) != 0;
    s.traceMode = (mask & 4) != 0 ? TraceMode::Automatic : TraceMode::SingleRays;
    std::string name = mask == 0 ? "original ray tracing" : "";
    const char* const words[] = { "beam", "energy", "batch" };
    for (int k = 0; k < 3; ++k)
    {
      if (mask >> k & 1)
      {
        name += (name.empty() ? "" : " + ") + std::string(words[k]);
      }
    }
    TraceCache cache;
    simulateScan(setups[mask], beams, 2, cache, 0, {}, results[mask]);
    const ScanSetup& setup = setups.back();
    contenders.push_back({ name, [&setup, &beams]() { freshScan(setup, beams, 1); } });
  }
  bool good = true;
  for (int mask = 0; mask < 8; ++mask)
  {
    // Beam constraint and batch change no bit; the energy constraint works within its bound.
    good = good && sameEchoes(results[mask], results[mask & 2]);
  }
  if (!good)
  {
    say("ECHOES DEPEND ON A SWITCH: " + scene.name);
  }
  for (const Timing& t : compete(contenders, figureLimits(options)))
  {
    times.row(scene.name, scene.mesh->size(), beams.size(), t.name, t.median, t.best, t.rounds);
    say("Fig. 11, " + scene.name + ", " + t.name + ": " + std::to_string(t.median) + " s");
  }
  return good;
}
}

bool suiteFigure11(const Options& options)
{
  Table times(
    options.folder + "/figure11.csv", "scene,triangles,beams,switches,median_s,best_s,rounds");
  bool good = true;
  for (const std::size_t size : sphereSizes(options))
  {
    good = ablation(makeSphere(size), strideOf(options), options, times) && good;
  }
  if (!options.smoke)
  {
    good = ablation(makeCorridor(), 1, options, times) && good;
    for (const SceneEntry& airport : airports())
    {
      const Scene scene = airport.make();
      if (scene.mesh->size() > 0)
      {
        good = ablation(scene, strideOf(options), options, times) && good;
      }
    }
  }
  return good;
}
}
