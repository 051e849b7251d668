// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that lie on each other: the one with the lower number is seen, in every way of looking,
// however finely the other is meshed and wherever the scene lies. Oracle: the scene without what is
// hidden, in which nothing coincides.
#include "CoincidentTestScene.h"

#include "CollisionTreeBuilder.h"

#include <algorithm>
#include <utility>
#include <vector>

using namespace coincidenttest;

namespace
{
Scene roundedToSingle(const Scene& scene)
{
  const auto rounded = [](double x)
  {
    volatile float single = static_cast<float>(x); // else GCC 12 does not round
    return static_cast<double>(single);
  };
  return changed(
    scene, [&](const Vec3& p) { return Vec3(rounded(p.x), rounded(p.y), rounded(p.z)); });
}
}

TEST(CoincidentFaces, TheLowerNumberIsSeenInEveryWay)
{
  struct Way
  {
    int parts;
    EchoSettings ofPair, ofSeen;
    double tolerance;
    int volumes; ///< kind of volumes of the tree
  };
  for (const Way& way : { Way{ 20, directSettings(1000), directSettings(1000), 1e-6, 3 },
         Way{ 60, directSettings(1000), directSettings(1000), 1e-6, 1 },
         Way{ 20, inCells(), inCells(), 3e-3, 1 }, Way{ 60, inCells(), inCells(), 3e-3, 1 },
         Way{ 8, inCells(9000), inCells(), 1e-5, 1 } }) // the last integrates polygons
  {
    for (const CoincidentPlates& pair : pairs(way.parts))
    {
      for (const bool wallFirst : { true, false })
      {
        const double right = receivedAt(Vec3(0.0), pair.seen(wallFirst), way.ofSeen);
        for (const Vec3& place : { Vec3(0.0), Utm })
        {
          for (int volume = 0; volume < way.volumes; ++volume)
          {
            TreeOptions options;
            options.boundingVolume = static_cast<BoundingVolumeType>(volume);
            EXPECT_NEAR(receivedAt(place, pair.scene(wallFirst), way.ofPair, options) / right, 1.0,
              way.tolerance)
              << way.parts << ' ' << pair.u.x << ' ' << wallFirst << ' ' << place.x << ' '
              << volume;
          }
        }
      }
    }
  }
}

TEST(CoincidentFaces, CornersInSinglePrecisionCoincide)
{
  for (const CoincidentPlates& pair : pairs(60))
  {
    for (const bool wallFirst : { true, false })
    {
      const Scene scene = roundedToSingle(pair.scene(wallFirst));
      const double right = received(pair.seen(wallFirst), openSensor(), inCells());
      EXPECT_NEAR(received(scene, openSensor(), inCells()) / right, 1.0, 3e-3);
      EXPECT_NEAR(received(scene, openSensor(), directSettings(1000)) / right, 1.0, 1e-2);
    }
  }
}

TEST(CoincidentFaces, LightOfSecondReflectionsIsNotStoppedByTheHiddenFace)
{
  // A wall and the floor before it; what the floor adds after two reflections.
  Sensor sensor = openSensor();
  for (const double aperture : { 0.0, 0.00785 })
  {
    sensor.receiverAperture = aperture;
    for (const CoincidentPlates& pair : pairs(60))
    {
      const auto secondary = [&](Scene scene, bool single)
      {
        scene.plate(Vec3(97.0, 0.0, -0.3), Vec3(3.4, 0.0, 0.0), Vec3(0.0, 2.0, 0.0), Matt, 3);
        scene = single ? roundedToSingle(scene) : scene;
        EchoSettings settings = directSettings(1000);
        const double direct = received(scene, sensor, settings);
        settings.numberOfReflections = 2;
        return received(scene, sensor, settings) / direct - 1.0;
      };
      const double right = secondary(pair.seen(false), false);
      EXPECT_GT(right, 1e-4);
      EXPECT_NEAR(secondary(pair.scene(false), true) / right, 1.0, 2e-2) << aperture;
    }
  }
}

TEST(CoincidentFaces, NeighboursAndCloseSurfacesKeepTheirPlanes)
{
  Scene scene = fineWall(20, Vec3(17.0, 1.9, 0.3));
  scene.box(Vec3(50.1, 0.1, 0.0), Vec3(1.0, 2.0, 3.0), Wall, 3);
  scene.box(Vec3(50.1, 4.1, 0.0), Vec3(1.0, 1.999999, 3.0), Wall, 4);
  EXPECT_TRUE(buildCollisionTree(scene.mesh, {})->planeOwners.empty());
  const Scene there = changed(scene, [](const Vec3& p) { return p + Utm; });
  EXPECT_TRUE(buildCollisionTree(there.mesh, {})->planeOwners.empty());
}

TEST(CoincidentFaces, OwnersDependOnTheMeshAlone)
{
  const Scene scene = pairs(20)[3].scene(false);
  const auto usual = buildCollisionTree(scene.mesh, {}, {}, 1);
  const std::uint32_t wall = static_cast<std::uint32_t>(scene.mesh->size()) - 2;
  std::size_t taken = 0;
  for (const std::uint32_t owner : usual->planeOwners)
  {
    taken += owner == wall || owner == wall + 1 ? 1 : 0;
  }
  EXPECT_GT(taken, scene.mesh->size() / 2);
  for (const SplitRule rule : { SplitRule::Halves, SplitRule::Median, SplitRule::PrincipalPlane })
  {
    for (const int threads : { 1, 3 })
    {
      EXPECT_EQ(
        buildCollisionTree(scene.mesh, { rule }, {}, threads)->planeOwners, usual->planeOwners);
    }
  }
  // Leaves of any size: millions of triangles in one leaf would be compared in pairs for minutes.
  const auto large = buildCollisionTree(
    scene.mesh, { SplitRule::SurfaceAreaHeuristic, BoundingVolumeType::AABB, 1000000 }, {}, 2);
  EXPECT_EQ(large->leaves, 1u);
  EXPECT_EQ(large->planeOwners, usual->planeOwners);
  EXPECT_EQ(large->planeDepth, usual->planeDepth);
}

TEST(CoincidentFaces, AScanNamesObjectsOfWhichOneIsSeen)
{
  const auto pairsOf = [](const Scene& scene, const EchoSettings& settings)
  {
    const ScanSetup setup = makeSetup(scene, openSensor(), settings);
    std::vector<std::pair<int, int>> objects;
    for (const CoincidentPair& pair : runScan(setup, oneBeam()).coincident)
    {
      objects.emplace_back(setup.objectIds[pair.first], setup.objectIds[pair.second]);
    }
    return objects;
  };
  using Objects = std::vector<std::pair<int, int>>;
  for (const EchoSettings& settings : { directSettings(100), inCells(), inCells(9000) })
  {
    Scene scene = pairs(6)[3].scene(true);
    EXPECT_EQ(pairsOf(scene, settings), (Objects{ { 1, 2 } }));
    EXPECT_EQ(pairsOf(pairs(6)[3].scene(false), settings), (Objects{ { 2, 1 } }));
    std::fill(scene.objects.begin(), scene.objects.end(), 1);
    EXPECT_EQ(pairsOf(scene, settings), (Objects{ { 1, 1 } }));
    std::fill(scene.materials.begin(), scene.materials.end(), Matt);
    EXPECT_EQ(pairsOf(scene, settings), Objects());
    // A common wall, of which only the part above the lower building is seen.
    Scene buildings;
    buildings.box(Vec3(110.0, 0.0, -1.5), Vec3(10.0, 2.0, 1.5), Wall, 1);
    buildings.box(Vec3(130.0, 0.0, 0.0), Vec3(10.0, 2.0, 3.0), Wood, 2);
    EXPECT_FALSE(buildCollisionTree(buildings.mesh, {})->planeOwners.empty());
    EXPECT_EQ(pairsOf(buildings, settings), Objects());
  }
}
