// SPDX-License-Identifier: BSD-3-Clause
// A closed surface around the lidar leaks no ray. Random rays are blind to leaks: rays here are
// aimed at edges and vertices, or a few units of round-off beside them.
#include "BeamTracer.h"
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"
#include "Sanitized.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
constexpr std::size_t Share = IsSanitized ? 50 : 1;

struct ClosedScene
{
  std::string name;
  std::shared_ptr<const TriangleMesh> mesh;
  Vec3 apex{ 0.0 };
  bool starShaped = true; ///< from the apex: every ray hits exactly once
};

/// A hall with two steps; the apex (0, 0, 0) lies in the plane of the first tread, which is
/// therefore seen edge-on.
TriangleMesh stairs()
{
  const double profile[8][2] = { { -5, -2 }, { 1, -2 }, { 1, 0 }, { 3, 0 }, { 3, 1 }, { 5, 1 },
    { 5, 3 }, { -5, 3 } };
  TriangleMesh mesh;
  for (const double y : { -4.0, 4.0 })
  {
    for (const auto& p : profile)
    {
      mesh.points.push_back({ p[0], y, p[1] });
    }
  }
  for (std::uint32_t i = 0; i < 8; ++i)
  {
    const std::uint32_t j = (i + 1) % 8;
    mesh.triangles.push_back({ i, j, j + 8 });
    mesh.triangles.push_back({ i, j + 8, i + 8 });
  }
  for (std::uint32_t i = 0; i < 6; ++i)
  {
    mesh.triangles.push_back({ 7, i, i + 1 });
    mesh.triangles.push_back({ 15, i + 9, i + 8 });
  }
  return mesh;
}

std::vector<ClosedScene> closedScenes()
{
  Numbers random(21);
  const auto share = [](TriangleMesh mesh)
  { return std::make_shared<const TriangleMesh>(std::move(mesh)); };
  const Vec3 ecef(-2853445.34, 4667464.94, 3268291.03);
  std::vector<ClosedScene> scenes;
  scenes.push_back({ "bumpy",
    share(closedSurface(4, [&](const Vec3&) { return random(5.0, 50.0); })), Vec3(0.0), true });
  scenes.push_back({ "fine and far",
    share(closedSurface(6, [&](const Vec3&) { return random(999.0, 1001.0); })), Vec3(0.0), true });
  scenes.push_back({ "off centre", share(closedSurface(4, [](const Vec3&) { return 10.0; })),
    { 9.4, 0.3, -0.2 }, true });
  scenes.push_back({ "stairs", share(stairs()), Vec3(0.0), false });
  TriangleMesh turned = stairs();
  const BeamFrame turn = makeBeamFrame(Vec3(0.0), { 0.3, -0.5, 0.7 }, 0.1);
  for (Vec3& p : turned.points)
  {
    p = p.x * turn.e1 + p.y * turn.e2 + p.z * turn.axis;
  }
  scenes.push_back({ "stairs turned", share(turned), Vec3(0.0), false });
  for (Vec3& p : turned.points)
  {
    p += ecef;
  }
  scenes.push_back({ "stairs at ECEF", share(turned), ecef, false });
  // Needles: the poles of a globe of many meridians and few parallels.
  TriangleMesh globe;
  constexpr std::uint32_t Meridians = 300;
  globe.points = { { 0, 0, 7 }, { 0, 0, -7 } };
  for (std::uint32_t i = 0; i < Meridians; ++i)
  {
    const double phi = 2.0 * Pi * i / Meridians;
    globe.points.push_back({ 7.0 * std::cos(phi), 7.0 * std::sin(phi), random(-0.1, 0.1) });
  }
  for (std::uint32_t i = 0; i < Meridians; ++i)
  {
    const std::uint32_t j = (i + 1) % Meridians;
    globe.triangles.push_back({ 0, i + 2, j + 2 });
    globe.triangles.push_back({ 1, j + 2, i + 2 });
  }
  scenes.push_back({ "needles", share(globe), Vec3(0.0), true });
  return scenes;
}

struct Target
{
  Vec3 point;              ///< relative to the apex
  std::uint32_t corner[2]; ///< points of the mesh beside which a hit must lie
};

Target edgeTarget(const ClosedScene& scene, Numbers& random)
{
  const auto t = static_cast<std::uint32_t>(random.index(scene.mesh->size()));
  const int side = static_cast<int>(random.index(3));
  const auto& triangle = scene.mesh->triangles[t];
  Target target{ Vec3(0.0), { triangle[side], triangle[(side + 1) % 3] } };
  const Vec3 a = scene.mesh->points[target.corner[0]] - scene.apex;
  const Vec3 b = scene.mesh->points[target.corner[1]] - scene.apex;
  // Some very near a vertex.
  const double share = random() < 0.2 ? random.logUniform(1e-16, 1e-2) : random();
  target.point = a + share * (b - a);
  return target;
}

Target vertexTarget(const ClosedScene& scene, Numbers& random)
{
  const auto& triangle = scene.mesh->triangles[random.index(scene.mesh->size())];
  const std::uint32_t p = triangle[random.index(3)];
  return { scene.mesh->points[p] - scene.apex, { p, p } };
}

/// A beam that holds the target somewhere, with rays at it and some units of round-off beside it.
void aim(const Target& target, const Vec3& apex, Numbers& random, BeamFrame& frame, BeamRays& rays)
{
  const double widths[] = { 1e-5, 5.6e-3, 0.1 };
  const double half = widths[random.index(3)];
  const auto [u, v] = random.inDisc();
  const BeamFrame towards = makeBeamFrame(Vec3(0.0), target.point, half);
  frame = makeBeamFrame(apex, towards.direction(0.9 * u, 0.9 * v), half);
  const Vec3 p = frame.toPlane(target.point);
  rays.resize(8);
  for (std::size_t i = 0; i < 8; ++i)
  {
    const double offset = i == 0 ? 0.0 : 0x1p-52 * (i < 4 ? 1.0 : 8.0);
    rays.x[i] = p.x / p.z + offset * std::round(random(-1.5, 1.5));
    rays.y[i] = p.y / p.z + offset * std::round(random(-1.5, 1.5));
  }
}

std::string describe(const ClosedScene& scene, const BeamFrame& frame, double x, double y)
{
  char text[256];
  std::snprintf(text, sizeof text,
    "%s: axis (%.17g, %.17g, %.17g), half-beamwidth %g, ray (%.17g, %.17g)", scene.name.c_str(),
    frame.axis.x, frame.axis.y, frame.axis.z, frame.halfBeamwidth, x, y);
  return text;
}

template <class MakeTarget>
void expectNoLeak(std::size_t rayCount, std::uint64_t seed, MakeTarget&& makeTarget)
{
  const std::vector<ClosedScene> scenes = closedScenes();
  for (std::size_t s = 0; s < scenes.size(); ++s)
  {
    const ClosedScene& scene = scenes[s];
    Numbers random(seed + s);
    const auto tree = buildCollisionTree(scene.mesh, TreeOptions());
    OneBeamTracer tracer(*tree);
    BeamFrame frame;
    BeamRays rays;
    std::vector<Hit> hits;
    std::size_t leaks = 0;
    std::size_t astray = 0;
    std::string example;
    for (std::size_t done = 0; done < rayCount / scenes.size() / Share; done += 8)
    {
      const Target target = makeTarget(scene, random);
      aim(target, scene.apex, random, frame, rays);
      tracer.setBeam(frame);
      // Most beams are traced whole; one in ten also ray by ray and in free rays, which must leak
      // no more.
      for (int way = 0; way < (done % 80 == 0 ? 3 : 1); ++way)
      {
        if (way < 2)
        {
          tracer.trace(rays, way == 0 ? TraceMode::Automatic : TraceMode::SingleRays, hits);
        }
        else
        {
          hits[0] = tracer.traceFromApex(target.point);
          std::fill(hits.begin() + 1, hits.end(), hits[0]);
        }
        for (std::size_t i = 0; i < hits.size(); ++i)
        {
          if (!hits[i].valid())
          {
            ++leaks;
            example = describe(scene, frame, rays.x[i], rays.y[i]);
            continue;
          }
          const auto& triangle = scene.mesh->triangles[hits[i].triangle];
          const bool beside = std::any_of(triangle.begin(), triangle.end(),
            [&](std::uint32_t p) { return p == target.corner[0] || p == target.corner[1]; });
          astray += scene.starShaped && i == 0 && !beside ? 1 : 0;
        }
      }
    }
    EXPECT_EQ(leaks, 0u) << "e.g. " << example;
    EXPECT_EQ(astray, 0u) << scene.name
                          << ": hits of triangles that do not touch the edge or vertex aimed at";
  }
}
}

TEST(Watertight, MillionRaysAimedAtEdges)
{
  expectNoLeak(1000000 + 7 * 8, 31, edgeTarget);
}

TEST(Watertight, MillionRaysAimedAtVertices)
{
  expectNoLeak(1000000 + 7 * 8, 32, vertexTarget);
}

TEST(Watertight, ARayThroughASharedEdgeOrVertexHasTheRangeOfItsPoint)
{
  Numbers random(34);
  const ClosedScene scene = closedScenes()[0];
  const auto tree = buildCollisionTree(scene.mesh, TreeOptions());
  OneBeamTracer tracer(*tree);
  BeamFrame frame;
  BeamRays rays;
  std::vector<Hit> hits;
  for (int i = 0; i < 20000; ++i)
  {
    const Target target = i % 2 ? edgeTarget(scene, random) : vertexTarget(scene, random);
    aim(target, scene.apex, random, frame, rays);
    tracer.setBeam(frame);
    tracer.trace(rays, TraceMode::Automatic, hits);
    // Edge functions are accepted a few units of round-off outside, at a sharp corner some dozens;
    // a steep triangle turns that into range.
    const SeenTriangle triangle = seeTriangle(SceneTriangles(*tree), hits[0].triangle, scene.apex);
    const double cosine = std::fabs(glm::dot(triangle.normal, glm::normalize(target.point)));
    const double range = safeLength(target.point);
    EXPECT_NEAR(hits[0].range, range, range * 1e-13 / cosine);
  }
}
