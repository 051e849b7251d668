// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTreeBuilder.h"
#include "FinishSetup.h"
#include "Memory.h"
#include "Suites.h"
#include "Tracers.h"
#include "VolumeTree.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
/// Tree of the paper and of preset Paper: k-D, boxes two a node, leaves of one triangle (Sec. 5.1,
/// Algorithm 1).
constexpr TreeOptions PaperTree{ SplitRule::Median, BoundingVolumeType::BinaryAABB, 1 };

/// The same tree with boxes eight a node, as this project uses them.
constexpr TreeOptions EightBoxes{ SplitRule::Median, BoundingVolumeType::AABB, 1 };

/// A tree on which both methods are timed.
struct TimedTree
{
  const char* name;
  std::shared_ptr<const CollisionTree> tree;
  double build; ///< s
};

std::vector<TimedTree> timedTrees(const Scene& scene)
{
  std::vector<TimedTree> trees;
  for (const auto& [name, options] :
    { std::pair("two", PaperTree), std::pair("eight", EightBoxes) })
  {
    std::shared_ptr<const CollisionTree> tree;
    const double build =
      processorSecondsOf([&, o = options]() { tree = buildVolumeTree(scene.mesh, o, {}, 1); });
    trees.push_back({ name, tree, build });
  }
  return trees;
}

/// Settings that add nothing to the paper: independent random rays, all beams sampled alike, one
/// point a range unit, one descent per beam, the light-energy constraint with the paper's
/// threshold.
/// @param change of these settings
ScanSetup makePaperSetup(const Scene& scene, std::shared_ptr<const CollisionTree> tree,
  const std::function<void(EchoSettings&)>& change = {})
{
  ScanSetup setup = makeSetup(scene, std::move(tree));
  setup.settings.sampling = Sampling::MonteCarlo;
  setup.settings.returnMode = ReturnMode::RangeUnits;
  setup.settings.traceMode = TraceMode::Beams;
  setup.settings.lightEnergyThreshold = LightEnergyThreshold::Limit;
  if (change)
  {
    change(setup.settings);
  }
  finishSetup(setup);
  return setup;
}

/// Scenes other than spheres; those whose data are absent are left out.
void forEachOther(const Options& options, const std::function<void(const Scene&)>& measure)
{
  std::vector<SceneEntry> scenes = { { "corridor", makePaperCorridor } };
  if (!options.smoke)
  {
    const std::vector<SceneEntry> more = airports();
    scenes.push_back({ "loggias", makeLoggias });
    scenes.insert(scenes.end(), more.begin(), more.end());
  }
  forEachScene(Options(), scenes, [&](const Scene& scene, const SceneEntry&) { measure(scene); });
}

/// Spheres, then the others.
void forEachSceneOfFigures(const Options& options, const std::function<void(const Scene&)>& measure)
{
  const std::size_t most = options.brief ? 100000 : 5000000;
  for (const std::size_t size :
    { 8, 32, 100, 300, 1000, 3000, 10000, 30000, 100000, 300000, 1000000, 5000000 })
  {
    if (options.smoke ? size == 100 || size == 1000 : size <= most)
    {
      measure(makeSphere(size));
    }
  }
  forEachOther(options, measure);
}

/// Columns of the scan that are left out, so that the slowest way ends in time.
std::int64_t strideOf(const Options& options, const Scene& scene)
{
  const bool small = scene.name == "corridor";
  return options.smoke ? (small ? 16 : 64) : small ? 1 : options.brief ? 16 : 8;
}

RoundLimits figureLimits(const Options& options)
{
  RoundLimits limits = options.limits();
  limits.seconds = options.smoke ? 0.01 : options.brief ? 0.5 : 4.0;
  limits.fewest = options.smoke ? 1 : 3;
  limits.shortestTurn = options.smoke ? 0.0 : 0.03;
  limits.processorTime = true; // one thread; others use the machine, too
  return limits;
}

/// A tree of Fig. 9.
struct Figure9Tree
{
  std::string rule;
  std::string volume;
  std::shared_ptr<const CollisionTree> tree;
  double build; ///< s
};

/// Trees with leaves of one triangle (Algorithm 1) by the paper's rules and volumes: boxes two a
/// node, boxes eight a node as this project uses them, and spheres.
std::vector<Figure9Tree> treesOf(const Scene& scene)
{
  const int builds = scene.mesh->size() > 200000 ? 1 : 3;
  std::vector<Figure9Tree> trees;
  for (const SplitRule rule : { SplitRule::Halves, SplitRule::Median })
  {
    for (const BoundingVolumeType volume :
      { BoundingVolumeType::BinaryAABB, BoundingVolumeType::AABB, BoundingVolumeType::Sphere })
    {
      const TreeOptions options{ rule, volume, PaperTree.maximumLeafSize };
      const std::string name = rule == SplitRule::Halves ? "BVH (halves)" : "k-D (median)";
      std::shared_ptr<const CollisionTree> tree;
      const double build =
        compete({ { name, [&]() { tree = buildVolumeTree(scene.mesh, options, {}, 1); } } },
          { 0.0, builds, builds, 0.01, true })[0]
          .median;
      const bool isWide = volume == BoundingVolumeType::AABB;
      const bool isSphere = volume == BoundingVolumeType::Sphere;
      trees.push_back({ name,
        isSphere   ? "SBV"
          : isWide ? "AABB, eight a node"
                   : "AABB",
        tree, build });
    }
  }
  return trees;
}

/// Means over the beams: nodes that a beam's cone meets, and triangles against which a packet of
/// its rays is tested.
std::pair<double, double> workOf(const CollisionTree& tree, const Workload& work)
{
  const SceneTriangles tracerScene(tree);
  BeamTracer tracer(tracerScene);
  const auto rays = static_cast<std::uint32_t>(work.raysPerBeam);
  const double packets = std::ceil(static_cast<double>(rays) / 64.0);
  std::pair<double, double> sum{ 0.0, 0.0 };
  for (std::size_t b = 0; b < work.beams(); ++b)
  {
    DrawnRays given(&work.rays[b]);
    const TracedBeams block{ &work.frames[b], 1, rays, &given };
    const TraceCounters& counters = tracer.traceBeams(block, TraceMode::Beams).counters[0];
    sum.first += static_cast<double>(counters.nodesVisited);
    sum.second += static_cast<double>(counters.candidates) / packets;
  }
  const auto beams = static_cast<double>(work.beams());
  return { sum.first / beams, sum.second / beams };
}
}

bool suiteFigure9(const Options& options)
{
  Table times(options, "figure9",
    "scene,triangles,rays,split_rule,volume,build_s,detection_s,total_s,nodes,tests");
  forEachSceneOfFigures(options,
    [&](const Scene& scene)
    {
      const Workload work = makeWorkload(
        scene, { 100, 5.6e-3, 0, options.smoke ? options.mostRays() : std::size_t(200000) });
      const std::vector<Figure9Tree> trees = treesOf(scene);
      std::vector<Contender> detectors;
      for (const Figure9Tree& kind : trees)
      {
        detectors.push_back({ kind.rule + ", " + kind.volume,
          [&work, tracer = ourTracer(*kind.tree, TraceMode::Beams)]()
          { tracer(work, 1, nullptr); } });
      }
      const std::vector<Timing> detections = compete(detectors, figureLimits(options));
      for (std::size_t k = 0; k < trees.size(); ++k)
      {
        const Figure9Tree& kind = trees[k];
        const auto [nodes, tests] = workOf(*kind.tree, work);
        times.row(scene.name, scene.mesh->size(), work.size(), kind.rule, kind.volume, kind.build,
          detections[k].median, kind.build + detections[k].median, nodes, tests);
      }
      say("Fig. 9, " + scene.name);
    });
  return true;
}

namespace
{
/// A way to scan.
struct Method
{
  std::string name;
  ScanSetup setup;
  ScanBeams beams;
  double build = 0.0; ///< s, of its tree
};

/// Times of whole scans on one thread.
std::vector<Timing> timesOf(const std::vector<Method>& methods, const Options& options)
{
  std::vector<Contender> contenders;
  for (const Method& m : methods)
  {
    contenders.push_back({ m.name, [&m]() { runScan(m.setup, m.beams, 1); } });
  }
  return compete(contenders, figureLimits(options));
}

/// `count` of the beams, spread over the scan by the golden ratio.
ScanBeams someOf(const ScanBeams& all, std::size_t count)
{
  if (count >= all.size())
  {
    return all;
  }
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double place = (static_cast<double>(i) + 0.5) * golden;
    places.push_back(
      static_cast<std::size_t>((place - std::floor(place)) * static_cast<double>(all.size())));
  }
  std::sort(places.begin(), places.end());
  return echotest::chosen(all, places);
}

/// The original method: no acceleration.
void switchOff(EchoSettings& settings)
{
  settings.beamConstraint = false;
  settings.lightEnergyConstraint = false;
  settings.traceMode = TraceMode::SingleRays;
}

/// The proposed method on a tree, with its peers: those without a tree, and rays one by one.
struct Figure10
{
  std::vector<Method> methods;
  std::vector<std::size_t> proposed; ///< place in `methods`, by tree
};

/// A tree of one leaf is no tree: the rays of a beam, and every ray of a second reflection by
/// itself, are tested against all triangles.
Figure10 methodsOf(const Scene& scene, const ScanBeams& beams, const std::vector<TimedTree>& trees)
{
  constexpr double MostTests = 1e6; // of beams against facets, where second reflections are traced
  constexpr std::size_t FewestBeams = 12;
  TreeOptions oneLeaf = EightBoxes;
  oneLeaf.maximumLeafSize = static_cast<int>(scene.mesh->size());
  const auto facets = buildCollisionTree(scene.mesh, oneLeaf, {}, 1);
  const auto fewer = [&](double factor)
  {
    const double most = factor * MostTests / static_cast<double>(scene.mesh->size());
    return someOf(beams, std::max(FewestBeams, static_cast<std::size_t>(most)));
  };
  const auto peer = [&](const auto& with, bool phong, int reflections, TraceMode mode)
  {
    return makePaperSetup(scene, with,
      [&](EchoSettings& s)
      {
        switchOff(s);
        s.reflectanceModel = phong ? ReflectanceModel::Phong : ReflectanceModel::Microfacet;
        s.traceMode = mode;
        s.numberOfReflections = reflections;
      });
  };
  constexpr std::pair<const char*, bool> Models[] = { { "Phong", true }, { "BRDF", false } };
  Figure10 figure;
  for (const auto& [model, phong] : Models)
  {
    // Packets of a beam's rays against all triangles.
    figure.methods.push_back({ std::string("facet loop, one reflection, ") + model,
      peer(facets, phong, 1, TraceMode::Automatic), fewer(10.0) });
    if (scene.mesh->size() < 500000)
    {
      figure.methods.push_back({ std::string("facet loop, ") + model,
        peer(facets, phong, 2, TraceMode::Automatic), fewer(1.0) });
    }
  }
  for (const TimedTree& t : trees)
  {
    figure.proposed.push_back(figure.methods.size());
    figure.methods.push_back({ "proposed", makePaperSetup(scene, t.tree), beams, t.build });
    for (const auto& [model, phong] : Models)
    {
      figure.methods.push_back({ std::string("per ray, ") + model,
        peer(t.tree, phong, 2, TraceMode::SingleRays), beams, t.build });
    }
  }
  return figure;
}

/// Whether facet loops with two reflections have the echoes of rays one by one.
bool echoesOfFacetLoops(const std::vector<Method>& methods)
{
  bool same = true;
  for (const Method& loop : methods)
  {
    const std::string start = "facet loop, ";
    if (loop.name == start + "Phong" || loop.name == start + "BRDF")
    {
      const ScanResult expected = runScan(loop.setup, loop.beams, 2);
      const std::string single = "per ray, " + loop.name.substr(start.size());
      for (const Method& m : methods)
      {
        same = same && (m.name != single || sameEchoes(expected, runScan(m.setup, loop.beams, 2)));
      }
    }
  }
  return same;
}
}

bool suiteFigure10(const Options& options)
{
  bool good = true;
  Table times(options, "figure10",
    "scene,triangles,boxes,beams,method,run_beams,build_s,scan_s,total_s,ratio,least,most");
  forEachSceneOfFigures(options,
    [&](const Scene& scene)
    {
      const ScanBeams beams = makeBeams(scene, strideOf(options, scene));
      const std::vector<TimedTree> trees = timedTrees(scene);
      const auto [methods, proposed] = methodsOf(scene, beams, trees);
      // Where a facet loop takes seconds, its echoes are not compared.
      const bool same = scene.mesh->size() >= 2000 || echoesOfFacetLoops(methods);
      good = good && same;
      const std::vector<Timing> timings = timesOf(methods, options);
      const auto write = [&](std::size_t k, std::size_t tree)
      {
        const Method& m = methods[k];
        const double scale =
          static_cast<double>(beams.size()) / static_cast<double>(m.beams.size());
        const double scan = scale * timings[k].median;
        const Ratio ratio = ratioOf(timings[k], timings[proposed[tree]]);
        times.row(scene.name, scene.mesh->size(), trees[tree].name, beams.size(), m.name,
          m.beams.size(), m.build, scan, m.build + scan, scale * ratio.median, scale * ratio.least,
          scale * ratio.most);
      };
      for (std::size_t tree = 0; tree < trees.size(); ++tree)
      {
        const std::size_t peers = proposed[1] - proposed[0];
        for (std::size_t k = 0; k < peers; ++k)
        {
          write(proposed[tree] + k, tree);
        }
        for (std::size_t k = 0; k < proposed[0]; ++k)
        {
          write(k, tree);
        }
      }
      say("Fig. 10, " + scene.name + (same ? "" : ": ECHOES DEPEND ON THE METHOD"));
    });
  return good;
}

namespace
{
/// Rays traced on from the first reflection.
std::uint64_t secondRays(ScanSetup setup, const ScanBeams& beams, const ScanResult& result)
{
  setup.settings.numberOfReflections = 1;
  finishSetup(setup);
  return result.raysTraced - runScan(setup, beams, 2).raysTraced;
}

/// Energy of all echoes, J, and of it what came after two reflections.
std::pair<double, double> energyOf(const ScanResult& result)
{
  std::pair<double, double> sum{ 0.0, 0.0 };
  for (const Echo& echo : result.echoes)
  {
    sum.first += echo.energyReceived;
    sum.second += echo.energyReceived * echo.secondaryShare;
  }
  return sum;
}

/// A combination of Fig. 11.
struct Switches
{
  std::string name;
  bool beam = false;
  bool batch = false;
  std::optional<LightEnergyThreshold> energy = std::nullopt; ///< none: without the constraint
  int reflections = 2;
};

/// All combinations of the three switches, with each threshold of the light-energy constraint;
/// that constraint alone with a share of the limit; and original ray tracing that ends at the first
/// reflection.
std::vector<Switches> combinations()
{
  constexpr auto Limit = LightEnergyThreshold::Limit;
  constexpr auto PerRay = LightEnergyThreshold::LimitPerRay;
  return { { "original ray tracing" }, { "beam", true }, { "batch", false, true },
    { "beam + batch", true, true }, { "energy", false, false, Limit },
    { "beam + energy", true, false, Limit }, { "energy + batch", false, true, Limit },
    { "beam + energy + batch", true, true, Limit }, { "energy/N", false, false, PerRay },
    { "beam + energy/N", true, false, PerRay }, { "energy/N + batch", false, true, PerRay },
    { "beam + energy/N + batch", true, true, PerRay },
    { "share", false, false, LightEnergyThreshold::ShareOfLimit },
    { "one reflection", false, false, {}, 1 } };
}

/// Fig. 11 on one scene. Echoes are compared first.
bool ablation(const Scene& scene, const Options& options, Table& times, Table& rays)
{
  const ScanBeams beams = makeBeams(scene, strideOf(options, scene));
  const std::vector<Switches> kinds = combinations();
  std::vector<Method> methods;
  const std::vector<TimedTree> trees = timedTrees(scene);
  for (const TimedTree& t : trees)
  {
    for (const Switches& k : kinds)
    {
      const auto change = [&k](EchoSettings& s)
      {
        s.beamConstraint = k.beam;
        s.lightEnergyConstraint = k.energy.has_value();
        s.lightEnergyThreshold = k.energy.value_or(LightEnergyThreshold::Limit);
        s.numberOfReflections = k.reflections;
        s.traceMode = k.batch ? TraceMode::Beams : TraceMode::SingleRays;
      };
      methods.push_back({ k.name, makePaperSetup(scene, t.tree, change), beams });
    }
  }
  // Beam constraint, batch and tree change no bit; what thresholds leave out is in the table.
  bool good = true;
  std::map<std::pair<int, int>, ScanResult> alike;
  for (std::size_t k = 0; k < methods.size(); ++k)
  {
    const Switches& kind = kinds[k % kinds.size()];
    ScanResult result = runScan(methods[k].setup, beams, 2);
    if (k < kinds.size() && !kind.batch && kind.reflections == 2)
    {
      const auto [energy, second] = energyOf(result);
      rays.row(scene.name, scene.mesh->size(), kind.name,
        secondRays(methods[k].setup, beams, result), result.echoes.size(), energy, second);
    }
    const int threshold = kind.energy ? static_cast<int>(*kind.energy) : -1;
    const auto place = alike.try_emplace({ threshold, kind.reflections }, std::move(result));
    good = good && (place.second || sameEchoes(result, place.first->second));
  }
  const std::vector<Timing> timings = timesOf(methods, options);
  for (std::size_t k = 0; k < methods.size(); ++k)
  {
    const std::size_t tree = k / kinds.size();
    const Ratio ratio = ratioOf(timings[tree * kinds.size()], timings[k]);
    times.row(scene.name, scene.mesh->size(), trees[tree].name, timings[k].name, timings[k].best,
      ratio.median, ratio.least, ratio.most);
  }
  say("Fig. 11, " + scene.name + (good ? "" : ": ECHOES DEPEND ON A SWITCH"));
  return good;
}

/// What is lost by choices of epsilon on one scene, the constraint off being the measure.
void measureEpsilon(const Scene& scene, const Options& options, Table& table)
{
  const auto tree = buildVolumeTree(scene.mesh, PaperTree);
  const ScanBeams beams = makeBeams(scene, strideOf(options, scene));
  const EchoSettings usual;
  const double paths = usual.raysPerBeam * (2.0 + usual.numberOfConnections);
  const std::pair<const char*, double> choices[] = { { "off", 0.0 }, { "1e-6", 1e-6 },
    { "1e-3", 1e-3 }, { "0.1", 0.1 }, { "a path against Qlow/N", paths / usual.raysPerBeam },
    { "a path against Qlow", paths } };
  std::vector<Method> methods;
  for (const auto& [name, fraction] : choices)
  {
    const auto change = [f = fraction](EchoSettings& s)
    {
      s.lightEnergyThreshold = LightEnergyThreshold::ShareOfLimit;
      s.lightEnergyConstraint = f > 0.0;
      s.lightEnergyFraction = f;
    };
    methods.push_back({ name, makePaperSetup(scene, tree, change), beams });
  }
  const std::vector<Timing> timings = timesOf(methods, options);
  for (std::size_t k = 0; k < methods.size(); ++k)
  {
    const ScanResult result = runScan(methods[k].setup, beams, 2);
    table.row(scene.name, scene.mesh->size(), methods[k].name, choices[k].second, timings[k].best,
      secondRays(methods[k].setup, beams, result), result.echoes.size(), energyOf(result).first);
  }
  say("epsilon, " + scene.name);
}
}

bool suiteFigure11(const Options& options)
{
  Table times(options, "figure11", "scene,triangles,boxes,switches,best_s,ratio,least,most");
  Table rays(
    options, "rays11", "scene,triangles,switches,second_rays,echoes,energy_j,second_energy_j");
  bool good = true;
  forEachSceneOfFigures(
    options, [&](const Scene& scene) { good = ablation(scene, options, times, rays) && good; });
  return good;
}

bool suiteEpsilon(const Options& options)
{
  Table table(
    options, "epsilon", "scene,triangles,choice,fraction,best_s,second_rays,echoes,energy_j");
  measureEpsilon(makeSphere(options.smoke ? 100 : 10000), options, table);
  forEachOther(options, [&](const Scene& scene) { measureEpsilon(scene, options, table); });
  return true;
}

namespace
{
/// The most memory that a scan takes beside scene and tree, MiB.
double peakOf(const Method& m)
{
  resetPeak();
  const std::size_t before = peakBytes();
  runScan(m.setup, m.beams, 1);
  return static_cast<double>(peakBytes() - before) / (1 << 20);
}
}

bool suiteSection5(const Options& options)
{
  Table table(options, "section5",
    "scene,triangles,boxes,beams,method,build_s,scan_s,ratio,least,most,held_mib");
  const auto measure = [&](Scene scene, int channels)
  {
    std::string name = scene.name;
    if (channels > 0)
    {
      scene.pattern = airportPattern(channels);
      name += ", " + std::to_string(channels) + " channels";
    }
    const ScanBeams beams = makeBeams(scene, options.smoke ? 64 : 1);
    std::shared_ptr<const CollisionTree> ours;
    const double build =
      processorSecondsOf([&]() { ours = buildCollisionTree(scene.mesh, TreeOptions{}, {}, 1); });
    ScanSetup usual = makeSetup(scene, ours);
    usual.settings.beamSamples = EchoSettings().beamSamples;
    finishSetup(usual);
    const std::vector<TimedTree> trees = timedTrees(scene);
    std::vector<Method> methods = { { "defaults of this project", usual, beams, build } };
    for (const TimedTree& t : trees)
    {
      methods.push_back({ "original", makePaperSetup(scene, t.tree, switchOff), beams, t.build });
      methods.push_back({ "proposed", makePaperSetup(scene, t.tree), beams, t.build });
    }
    const std::vector<Timing> timings = timesOf(methods, options);
    for (std::size_t tree = 0; tree < trees.size(); ++tree)
    {
      const std::size_t original = 1 + 2 * tree;
      for (const std::size_t k : { original, original + 1, std::size_t(0) })
      {
        const Ratio ratio = ratioOf(timings[original], timings[k]);
        table.row(name, scene.mesh->size(), trees[tree].name, beams.size(), methods[k].name,
          methods[k].build, timings[k].best, ratio.median, ratio.least, ratio.most,
          peakOf(methods[k]));
      }
    }
    say("Sec. 5, " + name);
  };
  forEachOther(options,
    [&](const Scene& scene)
    {
      measure(scene, scene.airport ? 16 : 0);
      if (scene.airport)
      {
        measure(scene, 32);
      }
    });
  return true;
}
}
