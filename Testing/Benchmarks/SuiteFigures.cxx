// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "CollisionTreeBuilder.h"
#include "FinishSetup.h"
#include "OurTracer.h"
#include "ScanRunner.h"
#include "VolumeTree.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
const char* const Rules[] = { "BVH (halves)", "k-D (median)", "BSP (principal plane)",
  "surface area heuristic" };

std::vector<std::size_t> sphereSizes(const Options& options)
{
  if (options.smoke)
  {
    return { 100, 1000 };
  }
  if (options.brief)
  {
    return { 8, 100, 1000, 10000, 100000 };
  }
  return { 8, 32, 100, 300, 1000, 3000, 10000, 30000, 100000, 300000, 1000000, 5000000 };
}

/// Scenes other than spheres; those whose data are absent are left out.
void forEachOther(const Options& options, const std::function<void(const Scene&)>& measure)
{
  measure(makePaperCorridor());
  if (options.smoke)
  {
    return;
  }
  measure(makeLoggias());
  for (const SceneEntry& airport : airports())
  {
    const Scene scene = airport.make();
    if (scene.mesh->size() > 0)
    {
      measure(scene);
    }
  }
}

/// Spheres, then the others.
void forEachSceneOfFigures(const Options& options, const std::function<void(const Scene&)>& measure)
{
  for (const std::size_t size : sphereSizes(options))
  {
    measure(makeSphere(size));
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

/// Time of the processor that a build takes, s: of large trees once, else the median of three.
double buildSeconds(const Scene& scene, const TreeOptions& options)
{
  std::vector<double> times;
  for (int round = 0; round < (scene.mesh->size() > 200000 ? 1 : 3); ++round)
  {
    int builds = 0;
    const double all = processorSecondsOf(
      [&]()
      {
        const double enough = secondsOf([&]() { buildVolumeTree(scene.mesh, options, {}, 1); });
        for (builds = 1; builds * enough < 0.01; ++builds)
        {
          buildVolumeTree(scene.mesh, options, {}, 1);
        }
      });
    times.push_back(all / builds);
  }
  return medianOf(times);
}

/// Trees with leaves of one triangle (Algorithm 1) by all rules and volumes. Boxes stand two a
/// node, as the other volumes do, and eight a node, as this project uses them; one builder makes
/// both. The rules and volumes that the paper lacks are left out where trees are very large.
std::vector<Figure9Tree> treesOf(const Scene& scene)
{
  const bool all = scene.mesh->size() < 2000000;
  std::vector<Figure9Tree> trees;
  for (const SplitRule rule : { SplitRule::Halves, SplitRule::Median, SplitRule::PrincipalPlane,
         SplitRule::SurfaceAreaHeuristic })
  {
    for (const BoundingVolumeType volume :
      { BoundingVolumeType::AABB, BoundingVolumeType::OBB, BoundingVolumeType::Sphere })
    {
      if (!all && (rule > SplitRule::Median || volume == BoundingVolumeType::OBB))
      {
        continue;
      }
      const TreeOptions options{ rule, volume, PaperTree.maximumLeafSize };
      const std::string name = Rules[static_cast<int>(rule)];
      const double build = buildSeconds(scene, options);
      const auto tree = buildVolumeTree(scene.mesh, options);
      if (volume == BoundingVolumeType::AABB)
      {
        trees.push_back({ name, "AABB", withPlainBoxes(*tree), build });
        trees.push_back({ name, "AABB, eight a node", tree, build });
      }
      else
      {
        trees.push_back({ name, volume == BoundingVolumeType::OBB ? "OBB" : "SBV", tree, build });
      }
    }
  }
  return trees;
}

/// Nodes that a beam's cone meets, and triangles against which a packet of its rays is tested;
/// means over the beams.
struct Figure9Work
{
  double nodes = 0.0;
  double triangles = 0.0;
};

Figure9Work workOf(const CollisionTree& tree, const Workload& work)
{
  BeamTracer tracer(tree);
  const auto rays = static_cast<std::uint32_t>(work.raysPerBeam);
  const double packets = std::ceil(static_cast<double>(rays) / 64.0);
  Figure9Work mean;
  for (std::size_t b = 0; b < work.beams(); ++b)
  {
    const BeamBlock block{ &work.frames[b], 1, rays,
      [&](std::size_t) -> const BeamRays& { return work.rays[b]; } };
    const TraceCounters& counters = tracer.traceBlock(block, TraceMode::Beams).counters[0];
    mean.nodes += static_cast<double>(counters.nodesVisited);
    mean.triangles += static_cast<double>(counters.candidates) / packets;
  }
  mean.nodes /= static_cast<double>(work.beams());
  mean.triangles /= static_cast<double>(work.beams());
  return mean;
}
}

bool suiteFigure9(const Options& options)
{
  Table times(options.folder + "/figure9.csv",
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
        const Figure9Work done = workOf(*kind.tree, work);
        times.row(scene.name, scene.mesh->size(), work.size(), kind.rule, kind.volume, kind.build,
          detections[k].median, kind.build + detections[k].median, done.nodes, done.triangles);
      }
      say("Fig. 9, " + scene.name);
    });
  return true;
}

namespace
{
/// A method of Fig. 10.
struct Method
{
  std::string name;
  ScanSetup setup;
  ScanBeams beams; ///< beams that are run, of those of the scan
  double build;    ///< s, of its tree
};

/// `count` of the beams, spread over the scan by the golden ratio.
ScanBeams someOf(const ScanBeams& all, std::size_t count)
{
  if (count >= all.size())
  {
    return all;
  }
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double place = (static_cast<double>(i) + 0.5) * golden;
    chosen.push_back(
      static_cast<std::size_t>((place - std::floor(place)) * static_cast<double>(all.size())));
  }
  std::sort(chosen.begin(), chosen.end());
  ScanBeams some;
  for (const std::size_t b : chosen)
  {
    some.ids.push_back(all.ids[b]);
    some.origins.push_back(all.origins[b]);
    some.directions.push_back(all.directions[b]);
  }
  return some;
}

ScanResult resultOf(const ScanSetup& setup, const ScanBeams& beams)
{
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, 2, cache, 0, {}, result);
  return result;
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
  std::vector<Method> methods;
  methods.push_back({ "proposed", makePaperSetup(scene, tree), beams, build });
  for (const bool phong : { true, false })
  {
    const std::string model = phong ? "Phong" : "BRDF";
    ScanSetup setup = makePaperSetup(scene, facets);
    switchOff(setup.settings);
    setup.settings.reflectanceModel =
      phong ? ReflectanceModel::Phong : ReflectanceModel::Microfacet;
    setup.settings.traceMode = TraceMode::Automatic; // packets of a beam's rays
    setup.settings.numberOfReflections = 1;
    finishSetup(setup);
    methods.push_back({ "facet loop, one reflection, " + model, setup, fewer(10.0), 0.0 });
    setup.settings.numberOfReflections = 2;
    finishSetup(setup);
    if (scene.mesh->size() < 500000)
    {
      methods.push_back({ "facet loop, " + model, setup, fewer(1.0), 0.0 });
    }
    setup.tree = tree;
    setup.settings.traceMode = TraceMode::SingleRays;
    finishSetup(setup);
    methods.push_back({ "per ray, " + model, setup, beams, build });
  }
  return methods;
}

/// Whether the facet loops have the echoes of the tree; where that takes seconds it is not checked.
bool sameForAllMethods(const std::vector<Method>& methods)
{
  bool same = true;
  for (std::size_t k = 2; k + 1 < methods.size(); ++k)
  {
    const Method& loop = methods[k];
    const Method& perRay = methods[k + 1];
    if (loop.name.rfind("facet loop, ", 0) == 0 && perRay.name.rfind("per ray", 0) == 0 &&
      loop.setup.tree->mesh->size() < 2000)
    {
      same =
        same && sameEchoes(resultOf(loop.setup, loop.beams), resultOf(perRay.setup, loop.beams));
    }
  }
  return same;
}
}

bool suiteFigure10(const Options& options)
{
  bool good = true;
  Table times(options.folder + "/figure10.csv",
    "scene,triangles,beams,method,run_beams,build_s,scan_s,total_s");
  forEachSceneOfFigures(options,
    [&](const Scene& scene)
    {
      const ScanBeams beams = makeBeams(scene, strideOf(options, scene));
      const std::vector<Method> methods = methodsOf(scene, beams);
      if (!sameForAllMethods(methods))
      {
        say("ECHOES DEPEND ON THE METHOD: " + scene.name);
        good = false;
      }
      std::vector<Contender> contenders;
      for (const Method& m : methods)
      {
        contenders.push_back({ m.name, [&m]() { freshScan(m.setup, m.beams, 1); } });
      }
      const std::vector<Timing> timings = compete(contenders, figureLimits(options));
      for (std::size_t k = 0; k < methods.size(); ++k)
      {
        const Method& m = methods[k];
        const double scan = timings[k].median * static_cast<double>(beams.size()) /
          static_cast<double>(m.beams.size());
        times.row(scene.name, scene.mesh->size(), beams.size(), m.name, m.beams.size(), m.build,
          scan, m.build + scan);
      }
      say("Fig. 10, " + scene.name);
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
  return result.raysTraced - resultOf(setup, beams).raysTraced;
}

/// Energy of all echoes, J, and of it what came over two reflections.
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
  std::vector<ScanSetup> setups;
  std::vector<Contender> contenders;
  constexpr int share = 8; // of the limit
  constexpr int direct = 16;
  const int masks[] = { 0, 1, 2, 3, 4, 5, 6, 7, share, direct };
  setups.reserve(std::size(masks));
  std::vector<ScanResult> results(direct + 1);
  for (const int mask : masks)
  {
    setups.push_back(makePaperSetup(scene, tree));
    EchoSettings& s = setups.back().settings;
    s.beamConstraint = (mask & 1) != 0;
    s.lightEnergyConstraint = (mask & 2) != 0 || mask == share;
    s.lightEnergyThreshold =
      mask == share ? LightEnergyThreshold::ShareOfLimit : LightEnergyThreshold::Limit;
    s.numberOfReflections = mask == direct ? 1 : 2;
    s.traceMode = (mask & 4) != 0 ? TraceMode::Beams : TraceMode::SingleRays;
    finishSetup(setups.back());
    std::string name = mask == 0 ? "original ray tracing"
      : mask == share            ? "share"
      : mask == direct           ? "one reflection"
                                 : "";
    const char* const words[] = { "beam", "energy", "batch" };
    for (int k = 0; k < 3; ++k)
    {
      if (mask >> k & 1)
      {
        name += (name.empty() ? "" : " + ") + std::string(words[k]);
      }
    }
    const ScanSetup& setup = setups.back();
    results[mask] = resultOf(setup, beams);
    contenders.push_back({ name, [&setup, &beams]() { freshScan(setup, beams, 1); } });
    if (mask < 4 || mask == share)
    {
      const auto [energy, second] = energyOf(results[mask]);
      rays.row(scene.name, scene.mesh->size(), beams.size(), name,
        secondRays(setup, beams, results[mask]), results[mask].echoes.size(), energy, second);
    }
  }
  bool good = true;
  for (int mask = 0; mask < 8; ++mask)
  {
    // Beam constraint and batch change no bit; what the energy constraint leaves out is in the
    // table.
    good = good && sameEchoes(results[mask], results[mask & 2]);
  }
  if (!good)
  {
    say("ECHOES DEPEND ON A SWITCH: " + scene.name);
  }
  for (const Timing& t : compete(contenders, figureLimits(options)))
  {
    times.row(scene.name, scene.mesh->size(), beams.size(), t.name, t.median, t.best, t.rounds);
  }
  say("Fig. 11, " + scene.name);
  return good;
}
}

bool suiteFigure11(const Options& options)
{
  Table times(
    options.folder + "/figure11.csv", "scene,triangles,beams,switches,median_s,best_s,rounds");
  Table rays(options.folder + "/rays11.csv",
    "scene,triangles,beams,switches,second_rays,echoes,energy_j,second_energy_j");
  bool good = true;
  forEachSceneOfFigures(
    options, [&](const Scene& scene) { good = ablation(scene, options, times, rays) && good; });
  return good;
}

namespace
{
/// A choice of what a path must carry.
struct Choice
{
  const char* name;
  bool on;
  double fraction;
};

/// What is lost by choices of epsilon on one scene, the constraint off being the measure.
void measureEpsilon(const Scene& scene, const Options& options, Table& table)
{
  const auto tree = buildCollisionTree(scene.mesh, PaperTree);
  const ScanBeams beams = makeBeams(scene, strideOf(options, scene));
  ScanSetup setup = makePaperSetup(scene, tree);
  setup.settings.lightEnergyThreshold = LightEnergyThreshold::ShareOfLimit;
  const double paths = setup.settings.raysPerBeam * (2.0 + setup.settings.numberOfConnections);
  const Choice choices[] = { { "off", false, 0.0 }, { "1e-6", true, 1e-6 }, { "1e-3", true, 1e-3 },
    { "0.1", true, 0.1 }, { "a path against Qlow/N", true, paths / setup.settings.raysPerBeam },
    { "a path against Qlow", true, paths } };
  std::vector<ScanSetup> setups;
  std::vector<ScanResult> results;
  std::vector<Contender> contenders;
  setups.reserve(std::size(choices));
  for (const Choice& choice : choices)
  {
    setup.settings.lightEnergyConstraint = choice.on;
    setup.settings.lightEnergyFraction = choice.fraction;
    finishSetup(setup);
    setups.push_back(setup);
    results.push_back(resultOf(setup, beams));
    contenders.push_back(
      { choice.name, [&s = setups.back(), &beams]() { freshScan(s, beams, 1); } });
  }
  const std::vector<Timing> timings = compete(contenders, figureLimits(options));
  for (std::size_t k = 0; k < setups.size(); ++k)
  {
    table.row(scene.name, scene.mesh->size(), beams.size(), timings[k].name, choices[k].fraction,
      timings[k].best, secondRays(setups[k], beams, results[k]), results[k].echoes.size(),
      energyOf(results[k]).first);
  }
  say("epsilon, " + scene.name);
}
}

bool suiteEpsilon(const Options& options)
{
  Table table(options.folder + "/epsilon.csv",
    "scene,triangles,beams,choice,fraction,best_s,second_rays,echoes,energy_j");
  measureEpsilon(makeSphere(options.smoke ? 100 : 10000), options, table);
  forEachOther(options, [&](const Scene& scene) { measureEpsilon(scene, options, table); });
  return true;
}

bool suiteSection5(const Options& options)
{
  Table table(
    options.folder + "/section5.csv", "scene,triangles,beams,method,build_s,scan_s,echoes,rounds");
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
    ScanSetup original = makePaperSetup(scene, paper);
    switchOff(original.settings);
    finishSetup(original);
    const ScanSetup proposed = makePaperSetup(scene, paper);
    ScanSetup usual = makeSetup(scene, ours);
    usual.settings.beamSamples = EchoSettings().beamSamples;
    finishSetup(usual);
    const ScanSetup* const setups[] = { &original, &proposed, &usual };
    std::vector<Contender> contenders;
    for (const char* method : { "original", "proposed", "defaults of this project" })
    {
      const ScanSetup& setup = *setups[contenders.size()];
      contenders.push_back({ method, [&setup, &beams]() { freshScan(setup, beams, 1); } });
    }
    const std::vector<Timing> timings = compete(contenders, figureLimits(options));
    for (std::size_t k = 0; k < timings.size(); ++k)
    {
      table.row(name, scene.mesh->size(), beams.size(), timings[k].name, builds[k / 2].best,
        timings[k].best, resultOf(*setups[k], beams).echoes.size(), timings[k].rounds);
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
