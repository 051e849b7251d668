// SPDX-License-Identifier: BSD-3-Clause
#include "Bird.h"
#include "CollisionTreeBuilder.h"
#include "FinishSetup.h"
#include "GeometryTestScene.h"
#include "Suites.h"
#include "Workload.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace benchmarks
{
using namespace avianlidar;
using geometrytest::Numbers;

namespace
{
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

/// Gulls in straight level flight, in the middle of the scan 30 to 300 m away and within its
/// elevations; in the order of their content.
std::vector<Mover> gulls(const Scene& scene, int count)
{
  constexpr double Speed = 12.5; // m/s
  const double middle = 0.5 / scene.pattern.rotationRate;
  const double degree = Pi / 180.0;
  int id = *std::max_element(scene.objectIds.begin(), scene.objectIds.end());
  Numbers random(3);
  std::vector<Mover> all;
  for (int k = 0; k < count; ++k)
  {
    Mover mover = gull(++id);
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
ScanSetup setupOf(const Scene& scene, std::shared_ptr<const CollisionTree> tree, int birds)
{
  ScanSetup setup = makeSetup(scene, std::move(tree));
  setup.settings = EchoSettings{};
  if (birds > 0)
  {
    setup.movers = std::make_shared<const std::vector<Mover>>(gulls(scene, birds));
  }
  finishSetup(setup);
  return setup;
}

/// Static surfaces and birds as one scene of which everything moves, at the beginning of the scan.
Scene atStart(const Scene& scene, const std::vector<Mover>& movers)
{
  Scene all = scene;
  all.mesh = std::make_shared<TriangleMesh>(*scene.mesh);
  for (const Mover& mover : movers)
  {
    append(mover.materials, all.materials);
    append(mover.objectIds, all.objectIds);
    Pose pose;
    if (!poseAt(mover, 0.0, pose))
    {
      throw std::logic_error("a mover is absent");
    }
    place(mover, pose, *all.mesh);
  }
  return all;
}
}

bool suiteMovers(const Options& options)
{
  Table times(options, "movers", "scene,triangles,birds,touched_beams,scan_s,one_time_s");
  std::vector<SceneEntry> scenes = airports();
  for (const SceneEntry& entry : generatedScenes())
  {
    if (entry.name == "boxes 500" || entry.name == "boxes 50000" || entry.name == "terrain")
    {
      scenes.push_back(entry); // the others are indoors, or seen by a narrow scan
    }
  }
  std::vector<int> counts = { 0, 10, 100, 1000 };
  constexpr std::size_t Main = 2; // the number of birds that are also made part of the scene
  counts.resize(options.smoke ? Main + 1 : counts.size());
  forEachScene(options, scenes,
    [&](const Scene& scene, const SceneEntry&)
    {
      const ScanBeams beams = makeBeams(scene);
      const std::shared_ptr<const CollisionTree> tree =
        buildCollisionTree(scene.mesh, TreeOptions{}, {}, 1);
      std::vector<ScanSetup> setups;
      std::vector<TraceCache> caches(counts.size()); // static hits are known after the first scan
      std::vector<ScanResult> results(counts.size());
      std::vector<Contender> contenders;
      for (std::size_t i = 0; i < counts.size(); ++i)
      {
        setups.push_back(setupOf(scene, tree, counts[i]));
        contenders.push_back(
          { std::to_string(counts[i]) + " birds", [&, i]() {
             simulateScan(setups[i], beams, 1, caches[i], std::size_t(4) << 30, {}, results[i]);
           } });
      }
      // The scene as of one time, as a source that moves all surfaces gives it.
      const Scene moved = atStart(scene, *setups[Main].movers);
      const ScanSetup anew = setupOf(moved, buildCollisionTree(moved.mesh, {}, {}, 1), 0);
      contenders.push_back({ "tree and scan of one time",
        [&]()
        {
          buildCollisionTree(moved.mesh, {}, {}, 1);
          runScan(anew, beams, 1);
        } });
      RoundLimits limits = options.limits();
      limits.processorTime = true;
      const std::vector<Timing> timings = compete(contenders, limits);
      for (std::size_t i = 0; i < counts.size(); ++i)
      {
        times.row(scene.name, scene.mesh->size(), counts[i], results[i].beamsTouched,
          timings[i].median, timings.back().median);
      }
      say(scene.name);
    });
  return true;
}
}
