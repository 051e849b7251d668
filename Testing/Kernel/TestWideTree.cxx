// SPDX-License-Identifier: BSD-3-Clause
// The wide tree holds what the boxes hold: no box that a ray of the cone meets is left out,
// wherever the scene stands.
#include "AABB.h"
#include "CollisionTreeBuilder.h"
#include "Sensor.h"
#include "WideTree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace avianlidar;

namespace
{
constexpr float Never = std::numeric_limits<float>::infinity();

/// A tree of eight random boxes about `at`, in one node.
struct EightBoxes
{
  std::vector<AABB> boxes{ WideNode::Width };
  std::shared_ptr<const CollisionTree> whole;
  WideTree tree;

  EightBoxes(std::mt19937_64& random, const Vec3& at, double extent)
  {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto mesh = std::make_shared<TriangleMesh>();
    for (AABB& box : this->boxes)
    {
      const Vec3 center(uniform(random), uniform(random), uniform(random));
      const Vec3 half(uniform(random), uniform(random), uniform(random));
      const double size = std::pow(10.0, -2.0 * (1.0 + uniform(random)));
      box.extend(at + extent * center - extent * size * half);
      box.extend(at + extent * center + extent * size * half);
      // A triangle whose box it is.
      const auto first = static_cast<std::uint32_t>(mesh->points.size());
      mesh->points.push_back(box.lower);
      mesh->points.push_back(box.upper);
      mesh->triangles.push_back({ first, first + 1, first });
    }
    this->whole = buildCollisionTree(mesh, { SplitRule::Median, BoundingVolumeType::AABB, 1 });
    this->tree = this->whole->wide;
  }

  const AABB& boxOf(int lane) const
  {
    return this->boxes[this->whole->order[this->tree.nodes[0].first[lane]]];
  }
};

Vec3 pointIn(const AABB& box, std::mt19937_64& random)
{
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Vec3 share(uniform(random), uniform(random), uniform(random));
  return box.lower + share * (box.upper - box.lower);
}
}

TEST(WideTree, NoBoxThatARayMeetsIsLeftOut)
{
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Vec3 places[] = { Vec3(0.0), Vec3(342000.0, 3453000.0, 3.0),
    Vec3(-2839000.0, 4663000.0, 3285000.0) };
  int wrong = 0;
  int late = 0;
  int tested = 0;
  for (int i = 0; i < 40000; ++i)
  {
    const Vec3& at = places[i % 3];
    const double extent = std::pow(10.0, -1.0 + 5.0 * std::fabs(uniform(random)));
    const EightBoxes eight(random, at, extent);
    ASSERT_EQ(eight.tree.nodes.size(), 1u);
    const Vec3 apex = at + extent * 1.5 * Vec3(uniform(random), uniform(random), uniform(random));
    const double halfBeamwidth = std::pow(10.0, -7.0 * std::fabs(uniform(random)));
    for (int lane = 0; lane < WideNode::Width; ++lane)
    {
      // A point of the box, and a cone that holds it anywhere inside.
      const Vec3 point = pointIn(eight.boxOf(lane), random) - apex;
      const double range = safeLength(point);
      const BeamFrame straight = makeBeamFrame(apex, point, halfBeamwidth);
      const double angle = 2.0 * Pi * uniform(random);
      const double off = 0.999 * std::fabs(uniform(random));
      const Vec3 axis = straight.direction(off * std::cos(angle), off * std::sin(angle));
      const BeamFrame frame = makeBeamFrame(apex, axis, halfBeamwidth);
      if (!frame.contains(point))
      {
        continue; // tangents of wide cones do not add up
      }
      ++tested;
      const WideCone cone(eight.tree, frame);
      const WideRay ray(eight.tree, apex, Vec3(0.0), point / range, 0.0);
      ASSERT_FALSE(cone.everywhere || ray.everywhere);
      float nearest[WideNode::Width];
      cone.distances(eight.tree.nodes[0], nearest);
      wrong += nearest[lane] == Never;
      late += nearest[lane] > range;
      ray.distances(eight.tree.nodes[0], nearest);
      wrong += nearest[lane] == Never;
      late += nearest[lane] > range;
    }
  }
  EXPECT_GT(tested, 200000);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(late, 0);
}

TEST(WideTree, MostBoxesBesideTheConeAreLeftOut)
{
  std::mt19937_64 random(2);
  int met = 0;
  for (int i = 0; i < 2000; ++i)
  {
    const EightBoxes eight(random, Vec3(0.0), 100.0);
    const BeamFrame frame = makeBeamFrame(Vec3(-300.0, 0.0, 0.0), Vec3(1.0, 1.0, 1.0), 5.6e-3);
    const WideCone cone(eight.tree, frame);
    ASSERT_FALSE(cone.everywhere);
    float nearest[WideNode::Width];
    cone.distances(eight.tree.nodes[0], nearest);
    for (float distance : nearest)
    {
      met += distance < Never;
    }
  }
  EXPECT_LT(met, 2000 * 8 / 100);
}

TEST(WideTree, AllBoxesAreMetBeyondSinglePrecision)
{
  std::mt19937_64 random(4);
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
    const EightBoxes eight(random, Vec3(0.0), extent);
    ASSERT_EQ(eight.tree.nodes.size(), 1u);
    for (const BeamFrame& frame : { away, here })
    {
      const long met = extent == 1.0 && frame.origin == Vec3(0.0) ? -1 : WideNode::Width;
      const WideRay ray(eight.tree, frame.origin, Vec3(0.0), frame.axis, 0.0);
      EXPECT_EQ(metBy(WideCone(eight.tree, frame), eight.tree.nodes[0]), met) << extent;
      EXPECT_EQ(metBy(ray, eight.tree.nodes[0]), met) << extent;
    }
  }
}
