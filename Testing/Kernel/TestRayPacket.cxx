// SPDX-License-Identifier: BSD-3-Clause
// Packets of rays give the bits of brute force with the exact functions of TriangleTest.h: what
// single precision decides, it decides as they would.
#include "BeamTracer.h"
#include "GeometryTestScene.h"
#include "InstructionTargets.h"
#include "RayPacket.h"
#include "VolumeTree.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
/// Nearest hit of one ray by the definition, on the planes that faces which coincide share.
Hit nearest(const CollisionTree& tree, const BeamFrame& frame, double x, double y)
{
  const TriangleMesh& mesh = *tree.mesh;
  const Vec3 d = unitDirection(frame.direction(x, y));
  const BeamPlaneMap map(frame);
  Hit best;
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    const Corners corners = cornersFrom(mesh, t, frame.origin);
    if (beamRayAccepted(map, corners, x, y))
    {
      const TrianglePlane plane = planeOf(tree, t, corners, frame.origin);
      const double range = rangeOf(corners, plane, d, beamRayMargin(frame));
      if (range > 0.0 && range < best.range)
      {
        best = { t, range };
      }
    }
  }
  return best;
}

struct Ray
{
  std::size_t beam;
  double x, y;
};

/// Rays in packets of `fill`, in their order.
std::vector<RayPacket> packed(
  const std::vector<BeamFrame>& frames, const std::vector<Ray>& rays, int fill)
{
  std::vector<RayPacket> packets;
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    if (i % static_cast<std::size_t>(fill) == 0)
    {
      packets.emplace_back();
    }
    RayPacket& p = packets.back();
    p.frame[p.count] = &frames[rays[i].beam];
    p.x[p.count] = rays[i].x;
    p.y[p.count++] = rays[i].y;
  }
  return packets;
}

struct Outcome
{
  std::size_t wrong = 0;
  std::size_t hits = 0;
  std::string first;
};

std::vector<Hit> bruteForce(
  const CollisionTree& tree, const std::vector<BeamFrame>& frames, const std::vector<Ray>& rays)
{
  std::vector<Hit> hits;
  for (const Ray& ray : rays)
  {
    hits.push_back(nearest(tree, frames[ray.beam], ray.x, ray.y));
  }
  return hits;
}

Outcome compare(const std::shared_ptr<const TriangleMesh>& mesh, const TreeOptions& options,
  const std::vector<BeamFrame>& frames, const std::vector<Ray>& rays, int fill,
  const std::vector<Hit>& brute)
{
  const auto tree = buildVolumeTree(mesh, options);
  std::vector<RayPacket> packets = packed(frames, rays, fill);
  PacketWorkspace work;
  for (RayPacket& packet : packets)
  {
    tracePacket(*tree, packet, work);
  }
  Outcome outcome;
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    const std::size_t width = static_cast<std::size_t>(fill);
    const std::uint32_t found = packets[i / width].triangle[i % width];
    const Hit& expected = brute[i];
    outcome.hits += expected.valid();
    if (found != expected.triangle && outcome.wrong++ == 0)
    {
      outcome.first = "ray " + std::to_string(i) + ": triangle " + std::to_string(found) +
        ", not " + std::to_string(expected.triangle) + " at " + std::to_string(expected.range);
    }
  }
  return outcome;
}

void expectSameHits(const std::string& what, const TriangleMesh& triangles,
  const std::vector<BeamFrame>& frames, const std::vector<Ray>& rays, double leastHits,
  int fill = RayPacket::Width, const TreeOptions& options = {})
{
  const auto mesh = std::make_shared<TriangleMesh>(triangles);
  const std::vector<Hit> brute = bruteForce(*buildVolumeTree(mesh, options), frames, rays);
  echotest::forEachInstructionTarget(
    [&]()
    {
      const Outcome found = compare(mesh, options, frames, rays, fill, brute);
      EXPECT_EQ(found.wrong, 0u) << what << ": " << found.first;
      EXPECT_GE(found.hits, leastHits * static_cast<double>(rays.size())) << what;
    });
}

/// `rays` random rays of each beam.
std::vector<Ray> raysOf(Numbers& random, const std::vector<BeamFrame>& frames, std::size_t rays)
{
  std::vector<Ray> list;
  for (std::size_t b = 0; b < frames.size(); ++b)
  {
    for (std::size_t i = 0; i < rays; ++i)
    {
      const auto [x, y] = random.inDisc();
      list.push_back({ b, x, y });
    }
  }
  return list;
}
}

TEST(RayPacket, RaysAimedAtEdgesAndVerticesOfAClosedSurface)
{
  Numbers random(3);
  const TriangleMesh mesh = closedSurface(4, [](const Vec3& p) { return 20.0 + 3.0 * p.y * p.z; });
  for (const double width : { 1e-7, 1e-4, 5.6e-3 })
  {
    std::vector<BeamFrame> frames;
    std::vector<Ray> rays;
    for (int i = 0; i < 400; ++i)
    {
      const auto& t = mesh.triangles[random.index(mesh.size())];
      const Vec3 a = mesh.points[t[0]];
      const Vec3 b = mesh.points[t[1]];
      const Vec3 at = i % 4 == 0 ? a : a + random() * (b - a);
      // The point anywhere in the beam, in the middle of a packet of others.
      const auto [x, y] = random.inDisc();
      const BeamFrame straight = makeBeamFrame(Vec3(0.0), at, width);
      frames.push_back(makeBeamFrame(Vec3(0.0), straight.direction(0.9 * x, 0.9 * y), width));
      const Vec3 p = frames.back().toPlane(at);
      rays.push_back({ frames.size() - 1, p.x / p.z, p.y / p.z });
      for (int k = 0; k < 3; ++k)
      {
        const auto [u, v] = random.inDisc();
        rays.push_back({ frames.size() - 1, u, v });
      }
    }
    expectSameHits("width " + std::to_string(width), mesh, frames, rays, 1.0, 4);
  }
}

// On which side of a triangle the apex lies is a matter of rounding then.
TEST(RayPacket, ApexOnATriangleOrInItsPlane)
{
  Numbers random(8);
  for (int i = 0; i < 200; ++i)
  {
    const TriangleMesh mesh = randomTriangles(random, 8, 3.0, 5.0);
    const auto& t = mesh.triangles[0];
    const Vec3 a = mesh.points[t[0]];
    const double reach = i % 2 ? 0.5 : 3.0;
    Vec3 apex = a + reach * random() * (mesh.points[t[1]] - a);
    apex += reach * random() * (mesh.points[t[2]] - a);
    const std::vector<BeamFrame> frames =
      window(apex, random.direction(), 4, 4, 0.1, random.logUniform(1e-9, 1.0));
    expectSameHits("scene " + std::to_string(i), mesh, frames, raysOf(random, frames, 4), 0.0);
  }
}

TEST(RayPacket, ScenesFarAwayTinyAndHuge)
{
  Numbers random(6);
  const TriangleMesh unit = closedSurface(4, [](const Vec3& p) { return 1.0 + 0.2 * p.x * p.y; });
  const Vec3 places[] = { Vec3(0.0), Vec3(-2853445.34, 4667464.94, 3268291.03) };
  for (const Vec3& place : places)
  {
    for (const double scale : { 1e-30, 1e-12, 1e-3, 1.0, 1e4, 1e12, 1e29 })
    {
      if (place != Vec3(0.0) && (scale < 1.0 || scale > 1e5))
      {
        continue; // nothing of it is left beside the offset, or the other way round
      }
      TriangleMesh mesh = unit;
      for (Vec3& p : mesh.points)
      {
        p = place + scale * p;
      }
      for (const Vec3& apex : { Vec3(0.1, 0.2, 0.0), Vec3(3.0, 1.0, -2.0) })
      {
        const std::vector<BeamFrame> frames = window(
          place + scale * apex, apex.x > 1.0 ? -apex : Vec3(1.0, 2.0, 3.0), 8, 8, 0.03, 5.6e-3);
        expectSameHits(
          "scale " + std::to_string(scale), mesh, frames, raysOf(random, frames, 4), 0.9);
      }
    }
  }
}
