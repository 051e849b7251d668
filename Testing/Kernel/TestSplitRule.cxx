// SPDX-License-Identifier: BSD-3-Clause
#include "GeometryTestScene.h"
#include "SplitRule.h"

#include <gtest/gtest.h>

#include <set>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
/// Triangles without area whose boxes are cubes about these centres.
TriangleMesh cubesAt(const std::vector<Vec3>& centers, double half)
{
  TriangleMesh mesh;
  for (const Vec3& center : centers)
  {
    addTriangle(mesh, center - Vec3(half), center + Vec3(half), center);
  }
  return mesh;
}

struct Split
{
  std::set<std::uint32_t> first;
  std::set<std::uint32_t> second;
};

Split split(SplitRule rule, const TriangleMesh& mesh, std::uint32_t depth = 0)
{
  const TriangleBoxes scene = makeTriangleBoxes(mesh, 1);
  std::vector<LaneBox> from(scene.boxes, scene.boxes + mesh.size());
  std::vector<LaneBox> to(mesh.size());
  LaneExtent extent;
  extent.clear();
  extent.include(from.data(), from.size());
  const std::size_t n =
    splitTriangles(rule, from.data(), to.data(), from.size(), extent.centers, depth);
  EXPECT_GE(n, 1u);
  EXPECT_LT(n, mesh.size());
  Split parts;
  for (std::size_t i = 0; i < to.size(); ++i)
  {
    (i < n ? parts.first : parts.second).insert(to[i].triangle());
  }
  return parts;
}
}

TEST(SplitRule, MedianAlternatesAxesWithDepth)
{
  // Four boxes whose order differs along each axis.
  const TriangleMesh boxes = cubesAt({ { 1, 8, 3 }, { 2, 7, 9 }, { 8, 2, 2 }, { 9, 1, 8 } }, 0.1);
  EXPECT_EQ(split(SplitRule::Median, boxes, 0).first, (std::set<std::uint32_t>{ 0, 1 }));
  EXPECT_EQ(split(SplitRule::Median, boxes, 1).first, (std::set<std::uint32_t>{ 2, 3 }));
  EXPECT_EQ(split(SplitRule::Median, boxes, 2).first, (std::set<std::uint32_t>{ 0, 2 }));
  EXPECT_EQ(split(SplitRule::Median, boxes, 3).first, (std::set<std::uint32_t>{ 0, 1 }));
}

TEST(SplitRule, PrincipalPlaneCutsAcrossTheLongestExtentThroughTheMean)
{
  // Along an oblique line, three near one end and one far out: the mean, not the median, divides.
  const Vec3 line = glm::normalize(Vec3(1, 1, 0.5));
  const TriangleMesh boxes = cubesAt({ 0.0 * line, 1.0 * line, 2.0 * line, 30.0 * line }, 0.1);
  const Split parts = split(SplitRule::PrincipalPlane, boxes);
  const std::set<std::uint32_t> near{ 0, 1, 2 };
  EXPECT_TRUE(parts.first == near || parts.second == near);
}

TEST(SplitRule, SurfaceAreaHeuristicSeparatesClusters)
{
  Numbers random(63);
  std::vector<Vec3> centers;
  std::set<std::uint32_t> cluster;
  for (std::uint32_t i = 0; i < 100; ++i)
  {
    const bool far = i % 10 == 0;
    centers.push_back(random.inCube(1.0) + (far ? Vec3(0, 100, 0) : Vec3(0.0)));
    if (far)
    {
      cluster.insert(i);
    }
  }
  EXPECT_EQ(split(SplitRule::SurfaceAreaHeuristic, cubesAt(centers, 0.1)).second, cluster);
}
