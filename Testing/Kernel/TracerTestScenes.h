// SPDX-License-Identifier: BSD-3-Clause
// Scenes that are hard to trace: coplanar, slivers, huge and tiny, nested, duplicated, far out.
#ifndef TracerTestScenes_h
#define TracerTestScenes_h

#include "GeometryTestScene.h"

#include <functional>
#include <string>
#include <vector>

namespace geometrytest
{
using namespace avianlidar;

/// A mesh that is made from random numbers, and from where it is seen.
struct MadeScene
{
  std::string name;
  std::function<TriangleMesh(Numbers&)> make;
  Vec3 apex{ 0.0 };
};

inline TriangleMesh coplanar(Numbers& random)
{
  // Overlapping triangles in three oblique planes and in one of the coordinate planes.
  TriangleMesh mesh;
  for (int plane = 0; plane < 4; ++plane)
  {
    const Vec3 normal = plane == 0 ? Vec3(0, 0, 1) : random.direction();
    const BeamFrame frame = makeBeamFrame(Vec3(0.0), normal, 0.1);
    for (int i = 0; i < 60; ++i)
    {
      Vec3 corner[3];
      for (Vec3& c : corner)
      {
        const double x = random(-50.0, 50.0);
        c = 30.0 * frame.axis + x * frame.e1 + random(-50.0, 50.0) * frame.e2;
      }
      addTriangle(mesh, corner[0], corner[1], corner[2]);
    }
  }
  return mesh;
}

inline TriangleMesh slivers(Numbers& random)
{
  TriangleMesh mesh;
  for (int i = 0; i < 300; ++i)
  {
    const Vec3 a = random.inCube(50.0);
    const Vec3 b = a + random.logUniform(0.1, 100.0) * random.direction();
    // Needles (third corner beside an end) and flat ones (beside the middle).
    const Vec3 foot = a + (i % 2 ? 1.0 : random()) * (b - a);
    addTriangle(mesh, a, b, foot + random.logUniform(1e-9, 1e-1) * random.direction());
  }
  return mesh;
}

inline TriangleMesh nested(Numbers& random)
{
  TriangleMesh mesh;
  for (double radius = 1.0; radius < 1000.0; radius *= 3.0)
  {
    const TriangleMesh shell =
      closedSurface(2, [&](const Vec3&) { return radius * random(0.9, 1.1); });
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), shell.points.begin(), shell.points.end());
    for (const auto& t : shell.triangles)
    {
      // Holes, so that the outer shells are seen.
      if (random() < 0.6)
      {
        mesh.triangles.push_back({ first + t[0], first + t[1], first + t[2] });
      }
    }
  }
  return mesh;
}

inline TriangleMesh duplicated(Numbers& random)
{
  TriangleMesh mesh = randomTriangles(random, 100, 50.0, 20.0);
  for (int copy = 0; copy < 2; ++copy)
  {
    for (std::size_t t = 0; t < 100; ++t)
    {
      const auto triangle = mesh.triangles[t];
      mesh.triangles.push_back(triangle);
    }
  }
  // Some seen from the other side, and some without area.
  for (std::size_t t = 0; t < 50; ++t)
  {
    const auto triangle = mesh.triangles[t];
    mesh.triangles.push_back({ triangle[1], triangle[0], triangle[2] });
    mesh.triangles.push_back({ triangle[0], triangle[0], triangle[1] });
  }
  return mesh;
}

/// What hits are compared on, with apexes.
inline std::vector<MadeScene> tracerScenes()
{
  const Vec3 ecef(-2853445.34, 4667464.94, 3268291.03);
  const auto moved = [ecef](Numbers& random)
  {
    TriangleMesh mesh = randomTriangles(random, 300, 200.0, 30.0);
    for (Vec3& p : mesh.points)
    {
      p += ecef;
    }
    return mesh;
  };
  return { { "random", [](Numbers& r) { return randomTriangles(r, 300, 100.0, 20.0); } },
    { "coplanar", coplanar }, { "slivers", slivers },
    { "huge", [](Numbers& r) { return randomTriangles(r, 200, 1e6, 3e6); } },
    { "as huge as may be", [](Numbers& r) { return randomTriangles(r, 200, 1e29, 3e28); } },
    { "as tiny as may be", [](Numbers& r) { return randomTriangles(r, 200, 1e-30, 3e-31); } },
    { "tiny", [](Numbers& r) { return randomTriangles(r, 400, 100.0, r.logUniform(1e-6, 1e-3)); } },
    { "tiny and huge",
      [](Numbers& r)
      {
        TriangleMesh mesh = randomTriangles(r, 200, 10.0, 1e-4);
        const TriangleMesh huge = randomTriangles(r, 50, 1e5, 1e6);
        for (std::uint32_t t = 0; t < huge.size(); ++t)
        {
          addTriangle(mesh, huge.corner(t, 0), huge.corner(t, 1), huge.corner(t, 2));
        }
        return mesh;
      } },
    { "nested", nested }, { "duplicated", duplicated }, { "ECEF", moved, ecef } };
}
}

#endif
