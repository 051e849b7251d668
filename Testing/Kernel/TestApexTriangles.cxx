// SPDX-License-Identifier: BSD-3-Clause
// What single precision says of a triangle and a ray holds for the exact functions of
// TriangleTest.h.
#include "ApexTriangles.h"
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"
#include "TriangleTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
struct Verdict
{
  float edge; ///< least of the three
  float w;
};

/// The evaluation of RayPacketTriangles.cxx without fused operations.
Verdict verdictOf(const ApexTriangle& t, const Vec3& direction)
{
  const auto x = static_cast<float>(direction.x);
  const auto y = static_cast<float>(direction.y);
  const auto z = static_cast<float>(direction.z);
  float least = INFINITY;
  for (const auto& e : t.edge)
  {
    least = std::min(least, e[0] * x + (e[1] * y + e[2] * z));
  }
  return { least, t.w[0] * x + (t.w[1] * y + t.w[2] * z) };
}

struct Counts
{
  int inside = 0, outside = 0, undecided = 0, wrong = 0;
};

/// A point beside an edge of a triangle, by a share of the triangle's height.
Vec3 besideAnEdge(
  Numbers& random, const TriangleMesh& mesh, std::uint32_t triangle, double least, double most)
{
  const std::size_t i = random.index(3);
  const Vec3 a = mesh.corner(triangle, static_cast<int>(i));
  const Vec3 b = mesh.corner(triangle, static_cast<int>((i + 1) % 3));
  const Vec3 c = mesh.corner(triangle, static_cast<int>((i + 2) % 3));
  const Vec3 at = a + random() * (b - a);
  const double off = random.logUniform(least, most) * (random() < 0.5 ? -1.0 : 1.0);
  return at + off * (c - at);
}

void check(Counts& counts, const ApexTriangle& seen, const TriangleMesh& mesh,
  const BeamFrame& frame, double x, double y)
{
  const Vec3 direction = frame.direction(x, y);
  const Verdict verdict = verdictOf(seen, direction);
  const Corners corners = cornersFrom(mesh, seen.number, frame.origin);
  const bool accepted = beamRayAccepted(BeamPlaneMap(frame), corners, x, y);
  const TrianglePlane plane = planeOf(corners);
  const Vec3 d = unitDirection(direction);
  const double range = rangeOf(corners, plane, d, beamRayMargin(frame));
  if (verdict.edge >= seen.inside)
  {
    ++counts.inside;
    const double exact = std::sqrt(glm::dot(direction, direction)) / range;
    const bool behind = verdict.w + seen.error < 0.0f && !(range > 0.0);
    const bool level = range > 0.0 && std::fabs(verdict.w - exact) <= seen.error;
    const bool plain = !(range > 0.0) || rangeOnPlane(corners, plane, d.x, d.y, d.z).kind == 1;
    counts.wrong += !(accepted && plain && (behind || level));
  }
  else if (verdict.edge < -1.0f)
  {
    ++counts.outside;
    counts.wrong += accepted;
  }
  else
  {
    ++counts.undecided;
  }
}
}

TEST(ApexTriangles, WhatIsSureIsSo)
{
  Numbers random(1);
  Counts counts;
  ApexTriangles known;
  for (const double size : { 1e-8, 1e-6, 1e-3, 0.3, 30.0 })
  {
    const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 3000, 30.0, size));
    const auto tree = buildCollisionTree(mesh, TreeOptions{});
    for (const double width : { 1e-9, 1e-4, 5.6e-3, 0.1, 1.0 })
    {
      for (std::uint32_t position = 0; position < mesh->size(); ++position)
      {
        const std::uint32_t number = tree->order[position];
        const Vec3 apex = random.inCube(60.0);
        // Around where single precision, or double precision of a tiny triangle, begins to matter.
        const Vec3 at = besideAnEdge(random, *mesh, number, 1e-9, 0.3);
        const BeamFrame frame =
          makeBeamFrame(apex, at - apex + 0.5 * std::tan(width) * random.direction(), width);
        const Vec3 p = frame.toPlane(at - apex);
        if (!(p.z > 0.0) || !(p.x * p.x + p.y * p.y <= p.z * p.z))
        {
          continue;
        }
        known.begin(*tree, frame);
        ApexTriangle seen;
        known.see(&position, 1, &seen);
        ASSERT_EQ(seen.number, number);
        check(counts, seen, *mesh, frame, p.x / p.z, p.y / p.z);
      }
    }
  }
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_GT(counts.inside, 300);
  EXPECT_GT(counts.outside, 300);
  EXPECT_GT(counts.undecided, 300);
}
