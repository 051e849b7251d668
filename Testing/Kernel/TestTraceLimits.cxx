// SPDX-License-Identifier: BSD-3-Clause
// Where single precision says little: ties at a vertex, scenes of atomic size.
#include "BeamTracer.h"
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
/// Rays whose hits differ from those of single rays.
std::size_t differing(
  const std::shared_ptr<const TriangleMesh>& mesh, const BeamFrame& frame, const BeamRays& rays)
{
  const auto tree = buildCollisionTree(mesh, TreeOptions{});
  OneBeamTracer tracer(*tree);
  tracer.setBeam(frame);
  std::vector<Hit> together;
  std::vector<Hit> singly;
  tracer.trace(rays, TraceMode::Automatic, together);
  tracer.trace(rays, TraceMode::SingleRays, singly);
  std::size_t different = 0;
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    different += sameBits(together[i], singly[i]) ? 0 : 1;
  }
  return different;
}
}

TEST(TraceLimits, TiesAtTheVertexOfAFanGoToTheLowestNumber)
{
  // A ray just outside a triangle, within the tolerance of its edge, has the range of its corner,
  // not that of the plane where the ray passes: far off where the plane is seen at grazing
  // incidence. All triangles of the fan tie.
  Numbers random(5);
  std::size_t different = 0;
  for (int round = 0; round < 6000; ++round)
  {
    const double width = std::vector<double>{ Pi / 3.0, 0.7, 0.3, 0.1, 0.02 }[round % 5];
    const Vec3 vertex(random(-1.0, 1.0), random(-1.0, 1.0), 1.0);
    const Vec3 aside = width * Vec3(random(-0.5, 0.5), random(-0.5, 0.5), 0.0);
    const BeamFrame frame = makeBeamFrame(Vec3(0.0), vertex + aside, width);
    const double depth = glm::dot(vertex, frame.axis);
    const double x = glm::dot(vertex, frame.e1) / depth / frame.tanHalf;
    const double y = glm::dot(vertex, frame.e2) / depth / frame.tanHalf;
    if (x * x + y * y > 0.9)
    {
      continue;
    }
    // A plane through the vertex that leans towards the line of sight.
    const double lean = random.logUniform(1e-3, 1.0);
    const BeamFrame sight = makeBeamFrame(Vec3(0.0), vertex, 0.1);
    const Vec3 along = sight.axis + lean * sight.e2;
    auto mesh = std::make_shared<TriangleMesh>();
    mesh->points.push_back(vertex);
    const double length = (random() < 0.5 ? -1.0 : 1.0) * random.logUniform(1e-3, 10.0);
    const double opening = random(0.02, 0.5);
    const double first = random(-0.5, 0.5);
    const std::uint32_t blades = 9 + static_cast<std::uint32_t>(random() * 12.0);
    for (std::uint32_t i = 0; i <= blades; ++i)
    {
      const double angle = first + opening * i;
      mesh->points.push_back(
        vertex + length * (std::cos(angle) * along + lean * std::sin(angle) * sight.e1));
    }
    for (std::uint32_t i = 0; i < blades; ++i)
    {
      mesh->triangles.push_back({ 0u, 1u + i, 2u + i });
    }
    std::swap(mesh->triangles.front(), mesh->triangles[random() < 0.5 ? 0 : blades - 1]);
    BeamRays rays;
    rays.resize(64);
    const double near = random.logUniform(1e-8, 3e-6);
    for (std::size_t i = 0; i < rays.size(); ++i)
    {
      rays.x[i] = x + near * random(-1.0, 1.0);
      rays.y[i] = y + near * random(-1.0, 1.0);
    }
    different += differing(mesh, frame, rays);
  }
  EXPECT_EQ(different, 0u);
}

TEST(TraceLimits, ScenesTooSmallForSquaresInSinglePrecision)
{
  Numbers random(6);
  std::size_t lost = 0;
  std::size_t hits = 0;
  for (const double scale : { 1e-18, 1e-21, 3.16e-22, 1e-22, 1e-26, 1e-29 })
  {
    for (int round = 0; round < 400; ++round)
    {
      auto mesh = std::make_shared<TriangleMesh>();
      for (int i = 0; i < 30; ++i)
      {
        const Vec3 center(random(-0.3, 0.3), random(-0.3, 0.3), 1.0);
        const double size = random.logUniform(1e-3, 1e-1);
        const auto corner = [&] { return scale * (center + random.inCube(size)); };
        const Vec3 a = corner();
        const Vec3 b = corner();
        addTriangle(*mesh, a, b, corner());
      }
      const double width = random.logUniform(1e-4, 1e-1);
      std::vector<BeamFrame> frames;
      std::vector<BeamRays> rays;
      for (int b = 0; b < 4; ++b)
      {
        const auto point = static_cast<std::size_t>(random() * 90.0);
        const Vec3 aim = mesh->points[point] / scale + random.inCube(width);
        frames.push_back(makeBeamFrame(Vec3(0.0), aim, width));
        rays.push_back(raysInDisc(random, 32));
      }
      const BeamBlock block{ frames.data(), 4, 32,
        [&](std::size_t b) -> const BeamRays& { return rays[b]; } };
      const auto tree = buildCollisionTree(mesh, TreeOptions{});
      OneBeamTracer tracer(*tree);
      const BlockHits& found = tracer.traceBlock(block, TraceMode::Automatic);
      OneBeamTracer alone(*tree);
      std::vector<Hit> singly;
      for (std::size_t b = 0; b < 4; ++b)
      {
        alone.setBeam(frames[b]);
        alone.trace(rays[b], TraceMode::SingleRays, singly);
        for (std::size_t i = 0; i < singly.size(); ++i)
        {
          const std::uint32_t triangle = found.triangles[b] ? found.triangles[b][i] : NoTriangle;
          hits += singly[i].valid() ? 1 : 0;
          lost += triangle == singly[i].triangle ? 0 : 1;
        }
      }
    }
  }
  EXPECT_GT(hits, 10000u);
  EXPECT_EQ(lost, 0u);
}
