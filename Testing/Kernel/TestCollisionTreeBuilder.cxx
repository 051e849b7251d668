// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTree.h"
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"
#include "Statistics.h"
#include "VolumeTree.h"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <string>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
std::shared_ptr<TriangleMesh> someMesh(std::size_t count)
{
  Numbers random(71);
  const auto mesh = std::make_shared<TriangleMesh>();
  for (std::size_t i = 0; i < count; ++i)
  {
    const Vec3 center = random.inCube(100.0);
    const Vec3 a = center + random.inCube(3.0);
    const Vec3 b = center + random.inCube(3.0);
    // Every tenth without area: they stay in the tree.
    addTriangle(*mesh, a, b, i % 10 == 0 ? a : center + random.inCube(3.0));
  }
  return mesh;
}

class Trees : public testing::TestWithParam<TreeOptions>
{
};

void expectSameTrees(const CollisionTree& a, const CollisionTree& b)
{
  EXPECT_EQ(a.order, b.order);
  EXPECT_EQ(a.leaves, b.leaves);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.wide.depth, b.wide.depth);
  EXPECT_EQ(a.wide.extent, b.wide.extent);
  EXPECT_EQ(a.wide.reference, b.wide.reference);
  ASSERT_EQ(a.wide.nodes.size(), b.wide.nodes.size());
  EXPECT_TRUE(a.wide.nodes.empty() ||
    std::memcmp(a.wide.nodes.data(), b.wide.nodes.data(), a.wide.nodes.size() * sizeof(WideNode)) ==
      0);
}

/// Each triangle once, in the wide tree, too, and within every volume above it in the binary tree,
/// whose leaves are those of the tree. That is numbered as Algorithm 1 does, layer by layer: the
/// children of a layer's P nodes follow from j1 = j0 + P, two for each inner node in turn.
void expectWhole(const CollisionTree& tree)
{
  std::vector<int> seen(tree.mesh->size(), 0);
  const auto binary = volumesOf(tree);
  std::uint32_t leaves = 0;
  std::uint32_t child = 1;
  for (std::size_t i = 0; i < binary->nodes.size(); ++i)
  {
    const BinaryNode& node = binary->nodes[i];
    const bool isLeaf = node.children == 0;
    leaves += isLeaf ? 1 : 0;
    EXPECT_TRUE(!isLeaf || node.count <= static_cast<std::uint32_t>(tree.options.maximumLeafSize));
    for (std::uint32_t k = node.begin; k < node.begin + node.count; ++k)
    {
      seen[tree.order[k]] += isLeaf ? 1 : 0;
      for (int c = 0; c < 3; ++c)
      {
        const Vec3& corner = tree.mesh->corner(tree.order[k], c);
        EXPECT_TRUE(std::visit(
          [&](const auto& volumes) { return contains(volumes[i], corner); }, binary->volumes));
      }
    }
    if (!isLeaf)
    {
      EXPECT_EQ(node.children, child);
      child += 2;
      const BinaryNode* const children = &binary->nodes[node.children];
      EXPECT_EQ(children[0].depth, node.depth + 1);
      EXPECT_EQ(children[0].begin, node.begin);
      EXPECT_EQ(children[1].begin, node.begin + children[0].count);
      EXPECT_EQ(children[0].count + children[1].count, node.count);
    }
  }
  EXPECT_EQ(seen, std::vector<int>(tree.mesh->size(), 1));
  EXPECT_EQ(leaves, tree.leaves);
  EXPECT_EQ(binary->nodes.back().depth, tree.depth);
  std::fill(seen.begin(), seen.end(), 0);
  for (const WideNode& node : tree.wide.nodes)
  {
    for (int lane = 0; lane < WideNode::Width; ++lane)
    {
      for (std::uint32_t k = 0; k < node.count[lane]; ++k)
      {
        ++seen[tree.order[node.first[lane] + k]];
      }
    }
  }
  EXPECT_EQ(seen, std::vector<int>(tree.mesh->size(), tree.wide.nodes.empty() ? 0 : 1));
}

std::string errorOf(const TriangleMesh& mesh)
{
  return statistics::errorOf(
    [&]() { buildVolumeTree(std::make_shared<TriangleMesh>(mesh), TreeOptions()); });
}
}

TEST_P(Trees, HoldEachTriangleOnceWithinEveryVolumeAboveIt)
{
  for (const std::size_t count : { 1, 2, 3, 17, 1000 })
  {
    const auto mesh = someMesh(count);
    const auto tree = buildVolumeTree(mesh, GetParam());
    ASSERT_TRUE(tree);
    EXPECT_EQ(tree->checksum, mesh->checksum());
    EXPECT_EQ(tree->order.size(), count);
    expectWhole(*tree);
  }
}

// 12,000 triangles: several layers are divided by all threads together.
TEST_P(Trees, AreTheSameForAnyNumberOfThreads)
{
  const auto mesh = someMesh(12000);
  const auto expected = buildVolumeTree(mesh, GetParam(), {}, 1);
  expectWhole(*expected);
  for (const int threads : { 2, 3, 8 })
  {
    expectSameTrees(*expected, *buildVolumeTree(mesh, GetParam(), {}, threads));
  }
}

INSTANTIATE_TEST_SUITE_P(CollisionTreeBuilder, Trees, testing::ValuesIn(allTreeOptions({ 1, 4 })));

TEST(CollisionTreeBuilder, HalvesOfSixTrianglesAreThePapersExample)
{
  // S_layer: {6} -> {3, 3} -> {1, 2, 1, 2} -> {1, 1, 1, 1}; 0-based numbers.
  const auto tree =
    buildVolumeTree(someMesh(6), { SplitRule::Halves, BoundingVolumeType::AABB, 1 });
  const auto binary = volumesOf(*tree);
  ASSERT_EQ(binary->nodes.size(), 11u);
  const std::uint32_t expected[11][4] = { { 0, 6, 0, 1 }, { 0, 3, 1, 3 }, { 3, 3, 1, 5 },
    { 0, 1, 2, 0 }, { 1, 2, 2, 7 }, { 3, 1, 2, 0 }, { 4, 2, 2, 9 }, { 1, 1, 3, 0 }, { 2, 1, 3, 0 },
    { 4, 1, 3, 0 }, { 5, 1, 3, 0 } };
  EXPECT_EQ(std::memcmp(binary->nodes.data(), expected, sizeof expected), 0);
  EXPECT_EQ(tree->order, (std::vector<std::uint32_t>{ 0, 1, 2, 3, 4, 5 }));
  EXPECT_EQ(tree->leaves, 6u);
  EXPECT_EQ(tree->depth, 3u);
}

TEST(CollisionTreeBuilder, GeometricProgressionStaysShallow)
{
  // A rule that peels off the largest triangle each time would make a list.
  const auto mesh = std::make_shared<TriangleMesh>();
  for (int i = 0; i < 4000; ++i)
  {
    const double s = std::ldexp(1.0, -(i % 180)) * (1.0 + i / 180);
    addTriangle(*mesh, { s, 0, 0 }, { s, 0.1 * s, 0 }, { s, 0, 0.1 * s });
  }
  for (const TreeOptions& options : allTreeOptions({ 1 }))
  {
    EXPECT_LE(buildVolumeTree(mesh, options)->depth, 96u + 12u);
  }
}

// Nothing to divide by.
TEST(CollisionTreeBuilder, EqualTrianglesAreHalvedAsTheyStand)
{
  const auto mesh = std::make_shared<TriangleMesh>();
  for (int i = 0; i < 5000; ++i)
  {
    addTriangle(*mesh, { 7, 8, 9 }, { 8, 8, 9 }, { 7, 9, 9 });
  }
  const auto tree = buildVolumeTree(mesh, TreeOptions(), {}, 3);
  expectWhole(*tree);
  for (std::uint32_t i = 0; i < 5000; ++i)
  {
    ASSERT_EQ(tree->order[i], i);
  }
  EXPECT_EQ(tree->depth, 11u);
}

// Sizes from 1e-3 m beside coordinates of 1e8 m to 1e15 m, tiny, huge and flat scenes: the boxes in
// single precision hold the corners.
TEST(CollisionTreeBuilder, WideBoxesHoldTheirTriangles)
{
  Numbers random(72);
  for (const double place : { 0.0, 1e8, 1e15 })
  {
    for (const double size : { 1e-30, 1e-3, 1.0, 1e13, 1e28 })
    {
      const auto mesh = std::make_shared<TriangleMesh>();
      for (int i = 0; i < 500; ++i)
      {
        const Vec3 flat(1.0, i % 2, 1.0);
        const Vec3 at = Vec3(place) + flat * random.inCube(10.0 * size);
        addTriangle(*mesh, at, at + flat * random.inCube(size), at + flat * random.inCube(size));
      }
      const auto tree = buildVolumeTree(mesh, TreeOptions());
      ASSERT_FALSE(tree->wide.nodes.empty());
      int outside = 0;
      for (const WideNode& node : tree->wide.nodes)
      {
        for (int lane = 0; lane < WideNode::Width; ++lane)
        {
          for (std::uint32_t i = 0; i < 3 * node.count[lane]; ++i)
          {
            const std::uint32_t triangle = tree->order[node.first[lane] + i / 3];
            const Vec3 d = glm::abs(mesh->corner(triangle, i % 3) - tree->wide.reference -
              Vec3(node.x[lane], node.y[lane], node.z[lane]));
            outside += d.x > node.halfX[lane] || d.y > node.halfY[lane] || d.z > node.halfZ[lane];
          }
        }
      }
      EXPECT_EQ(outside, 0) << place << " " << size;
    }
  }
}

// Down to a depth, with the numbers of the whole.
TEST(VolumeTree, BoxesAreMadeWhenAskedFor)
{
  const auto mesh = someMesh(300);
  const auto tree = buildVolumeTree(mesh, TreeOptions());
  const auto all = volumesOf(*tree);
  const auto some = volumesOf(*tree, 4);
  ASSERT_LT(some->nodes.size(), all->nodes.size());
  EXPECT_EQ(some->nodes.back().depth, 4u);
  const auto& boxes = std::get<std::vector<AlignedBox>>(all->volumes);
  for (std::size_t i = 0; i < some->nodes.size(); ++i)
  {
    EXPECT_EQ(some->nodes[i].begin, all->nodes[i].begin);
    EXPECT_EQ(some->nodes[i].count, all->nodes[i].count);
    const AlignedBox& box = std::get<std::vector<AlignedBox>>(some->volumes)[i];
    EXPECT_EQ(box.center, boxes[i].center);
    EXPECT_EQ(box.half, boxes[i].half);
  }
}

TEST(CollisionTreeBuilder, OtherVolumesAreNotTheKernels)
{
  const TreeOptions spheres{ SplitRule::Median, BoundingVolumeType::Sphere, 4 };
  EXPECT_THROW(buildCollisionTree(someMesh(5), spheres), std::invalid_argument);
}

TEST(CollisionTreeBuilder, EmptyMeshGivesAnEmptyTree)
{
  const auto tree = buildVolumeTree(std::make_shared<TriangleMesh>(), TreeOptions());
  ASSERT_TRUE(tree);
  EXPECT_TRUE(tree->empty());
  EXPECT_TRUE(tree->wide.nodes.empty());
  EXPECT_TRUE(volumesOf(*tree)->nodes.empty());
}

TEST(CollisionTreeBuilder, BadInputIsNamed)
{
  EXPECT_THROW(buildVolumeTree(nullptr, TreeOptions()), std::invalid_argument);
  TriangleMesh mesh = *someMesh(5);
  mesh.triangles[3][1] = 15;
  statistics::expectSays(errorOf(mesh), "triangle 3 names point 15 of 15");
  for (const double bad : std::initializer_list<double>{ NAN, INFINITY, -INFINITY, 1e31 })
  {
    mesh = *someMesh(5);
    mesh.points[mesh.triangles[2][2]].y = bad;
    statistics::expectSays(errorOf(mesh), "triangle 2 has the corner");
  }
  // A point that no triangle uses may be anything.
  mesh = *someMesh(5);
  mesh.points.push_back(Vec3(NAN));
  EXPECT_EQ(errorOf(mesh), "");
}

TEST(VolumeTree, ReportsProgressAndStops)
{
  const auto mesh = someMesh(100000);
  for (const BoundingVolumeType volume :
    { BoundingVolumeType::AABB, BoundingVolumeType::OBB, BoundingVolumeType::Sphere })
  {
    TreeOptions options;
    options.boundingVolume = volume;
    double last = 0.0;
    int calls = 0;
    const auto tree = buildVolumeTree(mesh, options,
      [&](double fraction)
      {
        EXPECT_GE(fraction, last);
        EXPECT_LE(fraction, 1.0);
        last = fraction;
        ++calls;
        return true;
      });
    EXPECT_TRUE(tree);
    EXPECT_EQ(last, 1.0);
    EXPECT_GT(calls, 10);
    for (const double share : { 0.05, 0.5, 0.95 })
    {
      bool stopped = false;
      const auto goOn = [&](double fraction)
      {
        EXPECT_FALSE(stopped);
        stopped = fraction >= share;
        return !stopped;
      };
      EXPECT_FALSE(buildVolumeTree(mesh, options, goOn)) << share;
      EXPECT_TRUE(stopped) << share;
    }
  }
  const auto none = std::make_shared<TriangleMesh>();
  const TreeOptions spheres{ SplitRule::Median, BoundingVolumeType::Sphere, 4 };
  EXPECT_TRUE(buildVolumeTree(none, spheres));
}
