// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTreeBuilder.h"
#include "FinishSetup.h"
#include "Suites.h"
#include "Tracers.h"
#include "VolumeTree.h"

#include <algorithm>
#include <cmath>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
/// Tree of the paper: k-D, boxes, leaves of one triangle (Sec. 5.1, Algorithm 1).
constexpr TreeOptions PaperTree{ SplitRule::Median, BoundingVolumeType::AABB, 1 };

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
  return options.smoke ? (small ? 16 : 64) : small ? 1 : options.brief ? 16 : 4;
}

RoundLimits figureLimits(const Options& options)
{
  RoundLimits limits = options.limits();
  limits.seconds = options.smoke ? 0.01 : options.brief ? 0.5 : 4.0;
  limits.fewest = options.smoke ? 1 : options.suite == "figure10" ? 3 : 4;
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
    const BeamBlock block{ &work.frames[b], 1, rays,
      [&](std::size_t) -> const BeamRays& { return work.rays[b]; } };
    const TraceCounters& counters = tracer.traceBlock(block, TraceMode::Beams).counters[0];
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

/// The proposed method, and its peers. A tree of one leaf is no tree: the rays of a beam, and every
/// ray of a second reflection by itself, are tested against all triangles.
std::vector<Method> methodsOf(const Scene& scene, const ScanBeams& beams)
{
  constexpr double MostTests = 1e6; // of beams against facets, where second reflections are traced
  constexpr std::size_t FewestBeams = 12;
  std::shared_ptr<const CollisionTree> tree;
  const double build =
    processorSecondsOf([&]() { tree = buildCollisionTree(scene.mesh, PaperTree, {}, 1); });
  TreeOptions oneLeaf = PaperTree;
  oneLeaf.maximumLeafSize = static_cast<int>(scene.mesh->size());
  const auto facets = buildCollisionTree(scene.mesh, oneLeaf, {}, 1);
  const auto fewer = [&](double factor)
  {
    const double most = factor * MostTests / static_cast<double>(scene.mesh->size());
    return someOf(beams, std::max(FewestBeams, static_cast<std::size_t>(most)));
  };
  std::vector<Method> methods = { { "proposed", makePaperSetup(scene, tree), beams, build } };
  for (const bool phong : { true, false })
  {
    const std::string model = phong ? "Phong" : "BRDF";
    const auto peer = [&](const auto& with, int reflections, TraceMode mode)
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
    // Packets of a beam's rays against all triangles.
    methods.push_back({ "facet loop, one reflection, " + model,
      peer(facets, 1, TraceMode::Automatic), fewer(10.0) });
    if (scene.mesh->size() < 500000)
    {
      methods.push_back(
        { "facet loop, " + model, peer(facets, 2, TraceMode::Automatic), fewer(1.0) });
    }
    methods.push_back({ "per ray, " + model, peer(tree, 2, TraceMode::SingleRays), beams, build });
  }
  return methods;
}
}

bool suiteFigure10(const Options& options)
{
  bool good = true;
  Table times(options, "figure10", "scene,triangles,beams,method,run_beams,build_s,scan_s,total_s");
  forEachSceneOfFigures(options,
    [&](const Scene& scene)
    {
      const ScanBeams beams = makeBeams(scene, strideOf(options, scene));
      const std::vector<Method> methods = methodsOf(scene, beams);
      bool same = true;
      // Facet loops have the echoes of the tree; where that takes seconds it is not checked.
      for (std::size_t k = 3; k < methods.size() && scene.mesh->size() < 2000; k += 3)
      {
        const ScanBeams& run = methods[k - 1].beams;
        same = same &&
          sameEchoes(runScan(methods[k - 1].setup, run, 2), runScan(methods[k].setup, run, 2));
      }
      good = good && same;
      const std::vector<Timing> timings = timesOf(methods, options);
      for (std::size_t k = 0; k < methods.size(); ++k)
      {
        const Method& m = methods[k];
        const double scan = timings[k].median * static_cast<double>(beams.size()) /
          static_cast<double>(m.beams.size());
        times.row(scene.name, scene.mesh->size(), beams.size(), m.name, m.beams.size(), m.build,
          scan, m.build + scan);
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

/// Fig. 11 on one scene: all combinations of the three switches, the light-energy constraint with
/// the paper's threshold, and alone also with a share of the limit. Their echoes are compared
/// first. Beside them original ray tracing that ends at the first reflection.
bool ablation(const Scene& scene, const Options& options, Table& times, Table& rays)
{
  const auto tree = buildCollisionTree(scene.mesh, PaperTree);
  const ScanBeams beams = makeBeams(scene, strideOf(options, scene));
  // Bits of the number: beam, energy, batch. Then a share of the limit, and one reflection.
  const char* const names[] = { "original ray tracing", "beam", "energy", "beam + energy", "batch",
    "beam + batch", "energy + batch", "beam + energy + batch", "share", "one reflection" };
  constexpr int share = 8;
  constexpr int direct = 9;
  std::vector<Method> methods;
  std::vector<ScanResult> results;
  for (int k = 0; k <= direct; ++k)
  {
    const auto change = [k](EchoSettings& s)
    {
      const int bits = k < share ? k : 0;
      s.beamConstraint = (bits & 1) != 0;
      s.lightEnergyConstraint = (bits & 2) != 0 || k == share;
      s.lightEnergyThreshold =
        k == share ? LightEnergyThreshold::ShareOfLimit : LightEnergyThreshold::Limit;
      s.numberOfReflections = k == direct ? 1 : 2;
      s.traceMode = (bits & 4) != 0 ? TraceMode::Beams : TraceMode::SingleRays;
    };
    methods.push_back({ names[k], makePaperSetup(scene, tree, change), beams });
    results.push_back(runScan(methods[k].setup, beams, 2));
    if (k < 4 || k == share)
    {
      const auto [energy, second] = energyOf(results[k]);
      rays.row(scene.name, scene.mesh->size(), names[k],
        secondRays(methods[k].setup, beams, results[k]), results[k].echoes.size(), energy, second);
    }
  }
  bool good = true;
  for (int k = 0; k < share; ++k)
  {
    // Beam constraint and batch change no bit; what the energy constraint leaves out is in the
    // table.
    good = good && sameEchoes(results[k], results[k & 2]);
  }
  for (const Timing& t : timesOf(methods, options))
  {
    times.row(scene.name, scene.mesh->size(), t.name, t.best);
  }
  say("Fig. 11, " + scene.name + (good ? "" : ": ECHOES DEPEND ON A SWITCH"));
  return good;
}

/// What is lost by choices of epsilon on one scene, the constraint off being the measure.
void measureEpsilon(const Scene& scene, const Options& options, Table& table)
{
  const auto tree = buildCollisionTree(scene.mesh, PaperTree);
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
  Table times(options, "figure11", "scene,triangles,switches,best_s");
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

bool suiteSection5(const Options& options)
{
  Table table(options, "section5", "scene,triangles,beams,method,build_s,scan_s");
  const auto measure = [&](Scene scene, int channels)
  {
    std::string name = scene.name;
    if (channels > 0)
    {
      scene.pattern = airportPattern(channels);
      name += ", " + std::to_string(channels) + " channels";
    }
    const ScanBeams beams = makeBeams(scene, options.smoke ? 64 : 1);
    std::shared_ptr<const CollisionTree> paper;
    std::shared_ptr<const CollisionTree> ours;
    const std::vector<Timing> builds = compete(
      { { "paper", [&]() { paper = buildCollisionTree(scene.mesh, PaperTree, {}, 1); } },
        { "ours", [&]() { ours = buildCollisionTree(scene.mesh, TreeOptions{}, {}, 1); } } },
      figureLimits(options));
    ScanSetup usual = makeSetup(scene, ours);
    usual.settings.beamSamples = EchoSettings().beamSamples;
    finishSetup(usual);
    const std::vector<Method> methods = { { "original", makePaperSetup(scene, paper, switchOff),
                                            beams, builds[0].best },
      { "proposed", makePaperSetup(scene, paper), beams, builds[0].best },
      { "defaults of this project", usual, beams, builds[1].best } };
    const std::vector<Timing> timings = timesOf(methods, options);
    for (std::size_t k = 0; k < methods.size(); ++k)
    {
      table.row(
        name, scene.mesh->size(), beams.size(), methods[k].name, methods[k].build, timings[k].best);
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
