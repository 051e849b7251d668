// SPDX-License-Identifier: BSD-3-Clause
// The wide tree leaves boxes out that a cone does not meet, and none where single precision ends.
// That it leaves out no box that a ray meets is TestGeometryProperties' and TestBeamTracer's.
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"
#include "Sensor.h"
#include "WideTree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
constexpr float Never = std::numeric_limits<float>::infinity();

/// A tree of eight random boxes, in one node.
WideTree eightBoxes(Numbers& random, double extent)
{
  const auto mesh = std::make_shared<TriangleMesh>();
  for (int lane = 0; lane < WideNode::Width; ++lane)
  {
    const Vec3 center = extent * random.inCube(1.0);
    const Vec3 half = extent * random.logUniform(1e-4, 1.0) * random.inCube(1.0);
    addTriangle(*mesh, center - half, center + half, center - half);
  }
  return buildCollisionTree(mesh, { SplitRule::Median, BoundingVolumeType::AABB, 1 })->wide;
}
}

TEST(WideTree, MostBoxesBesideTheConeAreLeftOut)
{
  Numbers random(2);
  int met = 0;
  for (int i = 0; i < 2000; ++i)
  {
    const WideTree tree = eightBoxes(random, 100.0);
    const BeamFrame frame = makeBeamFrame(Vec3(-300.0, 0.0, 0.0), Vec3(1.0, 1.0, 1.0), 5.6e-3);
    const WideCone cone(tree, frame);
    ASSERT_FALSE(cone.everywhere);
    float nearest[WideNode::Width];
    cone.distances(tree.nodes[0], nearest);
    for (float distance : nearest)
    {
      met += distance < Never;
    }
  }
  EXPECT_LT(met, 2000 * 8 / 100);
}

TEST(WideTree, AllBoxesAreMetBeyondSinglePrecision)
{
  Numbers random(4);
  const auto metBy = [](const auto& query, const WideNode& node)
  {
    float nearest[WideNode::Width];
    query.distances(node, nearest);
    return query.everywhere ? std::count(nearest, nearest + WideNode::Width, 0.0f) : -1;
  };
  const BeamFrame away = makeBeamFrame(Vec3(1e20), Vec3(1.0), 0.1);
  const BeamFrame here = makeBeamFrame(Vec3(0.0), Vec3(1.0), 0.1);
  for (const double extent : { 1e-14, 1.0, 1e16, 1e29 })
  {
    const WideTree tree = eightBoxes(random, extent);
    ASSERT_EQ(tree.nodes.size(), 1u);
    for (const BeamFrame& frame : { away, here })
    {
      const long met = extent == 1.0 && frame.origin == Vec3(0.0) ? -1 : WideNode::Width;
      const WideRay ray(tree, frame.origin, Vec3(0.0), frame.axis, 0.0);
      EXPECT_EQ(metBy(WideCone(tree, frame), tree.nodes[0]), met) << extent;
      EXPECT_EQ(metBy(ray, tree.nodes[0]), met) << extent;
    }
  }
}
