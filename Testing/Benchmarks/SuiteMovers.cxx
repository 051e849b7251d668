// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include "Bird.h"
#include "CollisionTreeBuilder.h"
#include "FinishSetup.h"
#include "MeshTools.h"
#include "MovedBeams.h"
#include "ScanRunner.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
constexpr std::size_t MaximumBytes = std::size_t(4) << 30;

template <class T>
void append(const std::vector<T>& more, std::vector<T>& all)
{
  all.insert(all.end(), more.begin(), more.end());
}

/// A herring gull with level wings, in its own frame; body and two wings that flap.
Mover gull(int objectId)
{
  const BirdSpecies species{ "herring gull", 0.95, 0.60, 1.35, 0.20, false, 12.5 };
  const BirdShape shape(species);
  Mover mover;
  for (const BirdPart part : { BirdPart::Body, BirdPart::LeftWing, BirdPart::RightWing })
  {
    const TriangleMesh mesh = birdPart(shape, part, 0.0);
    const auto first = static_cast<std::uint32_t>(mover.mesh.points.size());
    append(mesh.points, mover.mesh.points);
    mover.parts.resize(mover.mesh.points.size(), static_cast<std::uint32_t>(part));
    for (const auto& t : mesh.triangles)
    {
      mover.mesh.triangles.push_back({ first + t[0], first + t[1], first + t[2] });
    }
  }
  mover.materials.assign(mover.mesh.size(), Material{ 0.3, 0.0, 1.0 });
  mover.objectIds.assign(mover.mesh.size(), objectId);
  mover.materialIds.assign(mover.mesh.size(), 0);
  const double side = 0.5 * shape.bodyDiameter;
  const double amplitude = 35.0 * Pi / 180.0;
  const double frequency = wingbeatFrequency(species);
  mover.flaps = { { Vec3(-side, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), amplitude, frequency, 0.0 },
    { Vec3(side, 0.0, 0.0), Vec3(0.0, -1.0, 0.0), amplitude, frequency, 0.0 } };
  return mover;
}

/// Object id of the first bird.
int firstBird(const Scene& scene)
{
  return *std::max_element(scene.objectIds.begin(), scene.objectIds.end()) + 1;
}

/// Gulls in straight level flight, in the middle of the scan 30 to 300 m away and within its
/// elevations; in the order of their content.
std::vector<Mover> gulls(const Scene& scene, int count)
{
  constexpr double Speed = 12.5; // m/s
  const double middle = 0.5 / scene.pattern.rotationRate;
  const double degree = Pi / 180.0;
  int id = firstBird(scene);
  Numbers random(3);
  std::vector<Mover> all;
  for (int k = 0; k < count; ++k)
  {
    Mover mover = gull(id++);
    const double azimuth = 2.0 * Pi * random(0.0, 1.0);
    const double elevation = degree *
      (scene.pattern.minimumElevation +
        scene.pattern.elevationStep * random(0.0, scene.pattern.channels));
    const double range = random(30.0, 300.0);
    const double heading = 2.0 * Pi * random(0.0, 1.0);
    const Vec3 at = scene.apex +
      range *
        Vec3(std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
          std::sin(elevation));
    const Vec3 way = 2.0 * middle * Speed * Vec3(std::sin(heading), std::cos(heading), 0.0);
    const glm::dquat turned = glm::angleAxis(-heading, Vec3(0.0, 0.0, 1.0));
    mover.poses = { { -middle, at - way, turned }, { 3.0 * middle, at + way, turned } };
    mover.flaps[0].phase = mover.flaps[1].phase = random(0.0, 1.0);
    const std::string wrong = prepareMover(mover);
    if (!wrong.empty())
    {
      throw std::logic_error("gull: " + wrong);
    }
    all.push_back(std::move(mover));
  }
  orderMovers(all);
  return all;
}

/// The default settings of the echo filter.
ScanSetup setupOf(
  const Scene& scene, std::shared_ptr<const CollisionTree> tree, std::vector<Mover> movers = {})
{
  ScanSetup setup = makeSetup(scene, std::move(tree));
  setup.settings = EchoSettings{};
  if (!movers.empty())
  {
    setup.movers = std::make_shared<const std::vector<Mover>>(std::move(movers));
  }
  finishSetup(setup);
  return setup;
}

/// The beams of the scan with the time of each.
ScanBeams timedBeams(const Scene& scene)
{
  ScanBeams beams = makeBeams(scene);
  const ScanGenerator scan(scene.pattern);
  for (const std::uint64_t id : beams.ids)
  {
    beams.times.push_back(scan.beam(static_cast<std::int64_t>(id)).time);
  }
  return beams;
}

/// A scan whose static hits are known.
struct KnownScan
{
  ScanSetup setup;
  TraceCache cache;
  ScanResult result;

  void run(const ScanBeams& beams)
  {
    simulateScan(this->setup, beams, 1, this->cache, MaximumBytes, {}, this->result);
  }
};

/// Static surfaces and movers as one scene of which everything moves.
class RebuiltScene
{
public:
  RebuiltScene(const Scene& scene, const std::vector<Mover>& movers)
    : Static(scene)
    , Movers(movers)
    , All(scene)
  {
    for (const Mover& mover : movers)
    {
      append(mover.materials, this->All.materials);
      append(mover.objectIds, this->All.objectIds);
    }
  }

  /// Surfaces and movers at a time; movers that are absent then are left out.
  const Scene& at(double time)
  {
    this->All.mesh = std::make_shared<TriangleMesh>(*this->Static.mesh);
    for (const Mover& mover : this->Movers)
    {
      Pose pose;
      if (!poseAt(mover, time, pose))
      {
        throw std::logic_error("a mover is absent");
      }
      place(mover, pose, *this->All.mesh);
    }
    return this->All;
  }

private:
  const Scene& Static;
  const std::vector<Mover>& Movers;
  Scene All;
};

/// Sums over a sample of beams, s of the processor.
struct SampledBeams
{
  std::size_t count = 0;
  double building = 0.0;
  double simulating = 0.0;
  bool same = true; ///< the echoes of both ways

  double perBeam() const
  {
    return (this->building + this->simulating) /
      static_cast<double>(std::max<std::size_t>(1, this->count));
  }
};

/// Simulate each beam of a sample alone, with a tree over everything at its time. Copies of
/// surfaces and all that precedes the tree are not timed.
SampledBeams rebuildForEach(const KnownScan& known, const Scene& scene, const ScanBeams& beams,
  const std::vector<std::size_t>& sample)
{
  RebuiltScene rebuilt(scene, *known.setup.movers);
  SampledBeams sums;
  for (const std::size_t b : sample)
  {
    const Scene& all = rebuilt.at(beams.times[b]);
    std::shared_ptr<const CollisionTree> tree;
    sums.building +=
      processorSecondsOf([&]() { tree = buildCollisionTree(all.mesh, TreeOptions{}, {}, 1); });
    const ScanSetup setup = setupOf(all, tree);
    ScanBeams one;
    one.ids = { beams.ids[b] };
    one.origins = { beams.origins[b] };
    one.directions = { beams.directions[b] };
    TraceCache cache;
    ScanResult result;
    sums.simulating +=
      processorSecondsOf([&]() { simulateScan(setup, one, 1, cache, MaximumBytes, {}, result); });
    ++sums.count;
    const std::vector<std::size_t>& of = known.result.beamOfEcho;
    const auto range = std::equal_range(of.begin(), of.end(), b);
    ScanResult wanted;
    const auto first = known.result.echoes.begin() + (range.first - of.begin());
    wanted.echoes.assign(first, first + (range.second - range.first));
    wanted.beamOfEcho.assign(wanted.echoes.size(), 0);
    if (!sameEchoes(result, wanted))
    {
      say(scene.name + ": echoes of beam " + std::to_string(beams.ids[b]) + " differ");
      sums.same = false;
    }
  }
  return sums;
}

/// The beams that movers may touch, and the others, each in random order.
struct Touched
{
  std::vector<std::size_t> touched;
  std::vector<std::size_t> others;

  Touched(const ScanSetup& setup, const ScanBeams& beams)
  {
    BeamSampler sampler(setup.sensor, setup.settings.sampling, setup.settings.raysPerBeam);
    MovedBeams moved(setup, beams, sampler, {}, false);
    moved.find(0, beams.size());
    for (std::size_t b = 0; b < beams.size(); ++b)
    {
      (moved.isTouched(b) ? this->touched : this->others).push_back(b);
    }
    Numbers random(4);
    for (std::vector<std::size_t>* some : { &this->touched, &this->others })
    {
      for (std::size_t i = some->size(); i > 1; --i)
      {
        std::swap((*some)[i - 1], (*some)[static_cast<std::size_t>(random(0.0, double(i)))]);
      }
    }
  }
};

/// Beams with an echo of a bird, each once. @param first object id of a bird
std::vector<std::size_t> beamsOfBirds(const ScanResult& result, int first)
{
  std::vector<std::size_t> beams;
  for (std::size_t i = 0; i < result.echoes.size(); ++i)
  {
    const std::size_t b = result.beamOfEcho[i];
    if (result.echoes[i].objectId >= first && (beams.empty() || beams.back() != b))
    {
      beams.push_back(b);
    }
  }
  return beams;
}

std::vector<std::size_t> firstOf(const std::vector<std::size_t>& all, std::size_t count)
{
  return { all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(count, all.size())) };
}

/// Beams of a sample: fewer where a tree takes longer.
std::size_t sampleSize(const Scene& scene, const Options& options)
{
  constexpr std::size_t Triangles = 12000000; // of all trees, about
  return options.smoke
    ? 20
    : std::clamp<std::size_t>(Triangles / scene.mesh->size(), 20, options.brief ? 100 : 300);
}

bool measureMovers(const Scene& scene, const Options& options, Table& times)
{
  const ScanBeams beams = timedBeams(scene);
  const std::shared_ptr<const CollisionTree> tree =
    buildCollisionTree(scene.mesh, TreeOptions{}, {}, 1);
  std::vector<int> counts = { 0, 10, 100, 1000 };
  constexpr std::size_t Main = 2; // the number of birds for which trees are rebuilt
  counts.resize(options.smoke ? Main + 1 : counts.size());
  std::vector<KnownScan> scans(counts.size());
  std::vector<Contender> contenders;
  for (std::size_t i = 0; i < scans.size(); ++i)
  {
    scans[i].setup = setupOf(scene, tree, gulls(scene, counts[i]));
    contenders.push_back(
      { std::to_string(counts[i]) + " birds", [&, i]() { scans[i].run(beams); } });
  }
  // The scene as of one time, as a source that moves all surfaces gives it.
  RebuiltScene rebuilt(scene, *scans[Main].setup.movers);
  const Scene atStart = rebuilt.at(0.0);
  const ScanSetup anew = setupOf(atStart, buildCollisionTree(atStart.mesh, TreeOptions{}, {}, 1));
  contenders.push_back({ "tree and scan of one time",
    [&]()
    {
      buildCollisionTree(atStart.mesh, TreeOptions{}, {}, 1);
      freshScan(anew, beams, 1);
    } });
  RoundLimits limits = options.limits();
  limits.processorTime = true;
  const std::vector<Timing> timings = compete(contenders, limits);

  const std::size_t half = sampleSize(scene, options) / 2;
  const Touched beamsOf(scans[Main].setup, beams);
  if (beamsOf.touched.size() != scans[Main].result.beamsTouched)
  {
    say(scene.name + ": the beams that birds may touch are others than in the scan");
    return false;
  }
  const SampledBeams touched =
    rebuildForEach(scans[Main], scene, beams, firstOf(beamsOf.touched, half));
  const SampledBeams others =
    rebuildForEach(scans[Main], scene, beams, firstOf(beamsOf.others, half));
  const std::vector<std::size_t> seeing = beamsOfBirds(scans[Main].result, firstBird(scene));
  const SampledBeams seen =
    rebuildForEach(scans[Main], scene, beams, firstOf(seeing, half)); // compared, not counted
  const double ofTouched = touched.perBeam() * static_cast<double>(beamsOf.touched.size());
  const double ofAll = ofTouched + others.perBeam() * static_cast<double>(beamsOf.others.size());
  const double still = timings[0].median;
  for (std::size_t i = 0; i < scans.size(); ++i)
  {
    const double seconds = timings[i].median;
    const std::string text =
      scene.name + ", " + timings[i].name + ": " + std::to_string(1e3 * seconds) + " ms";
    const std::size_t count = scans[i].result.beamsTouched;
    if (i != Main)
    {
      times.row(scene.name, scene.mesh->size(), beams.size(), counts[i], count, seconds,
        seconds - still, "", "", "", "", "", "", "", "", "");
      say(text);
      continue;
    }
    times.row(scene.name, scene.mesh->size(), beams.size(), counts[i], count, seconds,
      seconds - still, timings.back().median, touched.count + others.count,
      (touched.building + others.building) / static_cast<double>(touched.count + others.count),
      ofTouched, ofAll, ofTouched / seconds, ofAll / seconds, seeing.size(), seen.count);
    say(text + "; a tree for each beam " + std::to_string(ofAll) + " s, ratio " +
      std::to_string(ofAll / seconds) + "; for each beam that a bird may touch, ratio " +
      std::to_string(ofTouched / seconds));
  }
  return touched.same && others.same && seen.same;
}
}

bool suiteMovers(const Options& options)
{
  Table times(options.folder + "/movers.csv",
    "scene,triangles,beams,birds,touched_beams,scan_s,above_still_s,one_time_s,sampled_beams,"
    "build_s,each_touched_beam_s,each_beam_s,ratio_touched,ratio,seeing_beams,seeing_compared");
  std::vector<SceneEntry> scenes = airports();
  for (const SceneEntry& entry : generatedScenes())
  {
    if (entry.name == "boxes 500" || entry.name == "boxes 50000" || entry.name == "terrain")
    {
      scenes.push_back(entry); // the others are indoors, or seen by a narrow scan
    }
  }
  bool good = true;
  for (const SceneEntry& entry : scenes)
  {
    if (wanted(options, entry.name))
    {
      const Scene scene = entry.make();
      good = (scene.mesh->size() == 0 || measureMovers(scene, options, times)) && good;
    }
  }
  return good;
}
}
