// SPDX-License-Identifier: BSD-3-Clause
// Visible polygons of awkward scenes: they partition the disc, and every point sees what brute
// force finds there.
#include "DiscPolygon.h"
#include "EchoTestScene.h"
#include "FoundPolygons.h"
#include "GeometryTestScene.h"
#include "Sanitized.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace echotest;
using geometrytest::Numbers;

namespace
{
/// A beam along x and triangles about it; some lie behind the apex, some on its plane.
struct AwkwardCase
{
  Scene scene;
  double half;
  bool covered; ///< a wall behind all fills the beam
};

/// A point at `x` along the axis and (y, z) half-beamwidths beside it.
Vec3 at(double x, double y, double z, double half)
{
  const double t = std::tan(half);
  return { x, x * t * y, x * t * z };
}

AwkwardCase drawCase(Numbers& random)
{
  AwkwardCase c;
  c.half = random() < 0.3 ? random.logUniform(1e-6, 1e-3) : random.logUniform(1e-3, 0.5);
  const auto any = [&]
  { return at(random.logUniform(1.0, 100.0), random(-1.5, 1.5), random(-1.5, 1.5), c.half); };
  const int count = 1 + static_cast<int>(random.index(12));
  for (int i = 0; i < count; ++i)
  {
    const Vec3 a = any();
    Vec3 b = any();
    Vec3 d = any();
    switch (random.index(9))
    {
      case 0: // a sliver
        d = a + (b - a) * random(0.1, 0.9) + random.logUniform(1e-12, 1e-3) * (any() - a);
        break;
      case 1: // through the plane of the apex
        b = -b;
        break;
      case 2: // the apex lies in its plane, but for little
        d = a * random(0.1, 3.0) + b * random(0.1, 3.0) + random.logUniform(1e-14, 1e-3) * any();
        break;
      case 3: // corners on the rim
      {
        const double turn = random(0.0, 2.0 * Pi);
        b = at(b.x, std::cos(turn), std::sin(turn), c.half);
        d = at(d.x, -std::sin(turn), std::cos(turn), c.half);
        break;
      }
      case 4: // twice, in one plane
        c.scene.triangle(a, b, d, Glass, i);
        break;
      case 5: // a neighbour, and one that meets its side half way
        c.scene.triangle(b, a, any(), Glass, i);
        c.scene.triangle(a, a + 0.5 * (d - a), any(), Wood, i);
        break;
      case 6: // overlaps it in its plane
        c.scene.triangle(a, a + 1.5 * (b - a), a + 0.5 * (d - a) + 0.5 * (b - a), Glass, i);
        break;
      case 7: // a parallelogram
        c.scene.triangle(b, a, a + (d - b), Wall, i);
        break;
      default: // whatever pokes through others
        break;
    }
    c.scene.triangle(a, b, d, Wall, i);
  }
  c.covered = random() < 0.6;
  if (c.covered)
  {
    c.scene.square(Vec3(1000.0, 0.0, 0.0), 3e3, Metal, 100);
  }
  return c;
}

double areaInDisc(const VisiblePolygons& found)
{
  double sum = 0.0;
  found.forEach(
    [&](const PlaneSurface& surface, const PlaneRing& ring)
    {
      DiscPolygon disc;
      disc.set(ring, { surface.inverse.x, surface.inverse.y });
      if (!disc.isEmpty())
      {
        PartMoments moments;
        disc.measure({ disc.least(), disc.most() }, moments);
        sum += moments.area[0];
      }
    });
  return sum;
}

/// What a point sees, by trying all triangles; the point may be so near a side that it is not
/// certain.
struct BruteForce
{
  double inverse = 0.0; ///< 1/z
  bool certain = true;
};

BruteForce bruteForce(const TriangleMesh& mesh, const BeamFrame& frame, const PlanePoint& p)
{
  const BeamPlaneMap map(frame);
  const Vec3 d = frame.direction(p.x, p.y);
  BruteForce result;
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    const Corners corners = cornersFrom(mesh, t, frame.origin);
    const TrianglePlane plane = planeOf(corners);
    BeamTriangle triangle;
    if (plane.height == 0.0 || !triangle.set(map, corners))
    {
      continue;
    }
    bool inside = true;
    bool near = false;
    for (const BeamEdge& e : triangle.edges)
    {
      const double value = (e.x * p.x + e.y * p.y) + e.z;
      const double margin = 1e-9 * (std::hypot(e.x, e.y) + 1e-6 * std::fabs(e.z));
      inside = inside && value >= 0.0;
      near = near || std::fabs(value) <= margin;
    }
    const double inverse = glm::dot(plane.normal, d) / plane.height;
    // A plane seen so nearly edge-on has no certain range.
    const double size = std::sqrt(glm::dot(plane.normal, plane.normal)) *
      std::max({ safeLength(corners.a), safeLength(corners.b), safeLength(corners.c) });
    result.certain = result.certain && !near && std::fabs(plane.height) > 1e-9 * size;
    if (inside)
    {
      result.inverse = std::max(result.inverse, inverse);
    }
  }
  return result;
}
}

TEST(VisiblePolygons, PartitionTheDiscAndShowWhatBruteForceFinds)
{
  const std::uint64_t beams = casesAskedFor("AVIANLIDAR_POLYGON_BEAMS", IsSanitized ? 2000 : 20000);
  Numbers random(31);
  std::uint64_t seen = 0;
  std::uint64_t points = 0;
  std::size_t most = 0;
  for (std::uint64_t k = 0; k < beams; ++k)
  {
    const AwkwardCase c = drawCase(random);
    CollisionTree tree;
    tree.mesh = c.scene.mesh;
    const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), c.half);
    FoundPolygons beam(tree);
    const SeenByBeam outcome = beam.find(frame);
    const std::unique_ptr<VisiblePolygons> found = std::move(beam.polygons);
    ASSERT_EQ(beam.find(frame, true), outcome) << k;
    if (outcome != SeenByBeam::Polygons)
    {
      continue;
    }
    ++seen;
    most = std::max(most, found->polygons.size());
    ASSERT_EQ(found->corners.size(), beam.polygons->corners.size()) << k;
    for (std::size_t i = 0; i < found->corners.size(); ++i)
    {
      ASSERT_EQ(found->corners[i].x, beam.polygons->corners[i].x) << k;
    }
    const double area = areaInDisc(*found);
    if (c.covered)
    {
      ASSERT_NEAR(area + found->lost * Pi, Pi, 1e-9 * Pi) << k;
    }
    ASSERT_LE(area, Pi * (1.0 + 1e-9)) << k;
    ASSERT_LE(found->lost, 1e-11) << k;
    for (int i = 0; i < 20; ++i)
    {
      const double r = std::sqrt(random());
      const double turn = random(0.0, 2.0 * Pi);
      const PlanePoint p{ r * std::cos(turn), r * std::sin(turn) };
      const BruteForce right = bruteForce(*c.scene.mesh, frame, p);
      if (!right.certain)
      {
        continue;
      }
      ++points;
      const std::uint32_t triangle = found->triangleAt(p);
      double inverse = 0.0;
      if (triangle != NoTriangle)
      {
        const TrianglePlane plane = planeOf(cornersFrom(*c.scene.mesh, triangle, frame.origin));
        inverse = glm::dot(plane.normal, frame.direction(p.x, p.y)) / plane.height;
      }
      ASSERT_NEAR(inverse, right.inverse, 1e-6 * right.inverse) << k;
    }
  }
  EXPECT_GT(seen, beams * 8 / 10);
  EXPECT_GT(points, seen * 10);
  EXPECT_LE(most, 300u);
}

TEST(VisiblePolygons, SurfacesThatFaceEachOtherAreToldFromThoseThatDoNot)
{
  const Vec3 up(0.0, 0.0, 5.0);
  const Vec3 fold(20.0, 0.0, 0.0);
  for (const double x : { 15.0, 25.0 }) // a valley, a ridge
  {
    Scene scene;
    for (const auto& [from, to] :
      { std::pair<Vec3, Vec3>{ Vec3(x, 5.0, 0.0), fold }, { fold, Vec3(x, -5.0, 0.0) } })
    {
      scene.triangle(from - up, to - up, to + up, Wall, 0);
      scene.triangle(from - up, to + up, from + up, Wall, 0);
    }
    const ScanSetup setup = makeSetup(scene, openSensor(), directSettings(100));
    const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), 5.6e-3);
    FoundPolygons found(*setup.tree);
    ASSERT_EQ(found.find(frame), SeenByBeam::Polygons);
    EXPECT_EQ(found.polygons->facing, x < 20.0);
  }
}

TEST(VisiblePolygons, TheHalvesOfAPlateStayOneSurfaceInCoordinatesFarAway)
{
  // Tilted quadrilaterals, in coordinates of their own and in those of a map, which rounds them.
  Numbers random(17);
  for (int i = 0; i < 200; ++i)
  {
    const Vec3 u(random(-0.3, 0.3), random(0.5, 2.0), random(-0.3, 0.3));
    const Vec3 v(random(-0.3, 0.3), random(-0.3, 0.3), random(0.5, 2.0));
    const Vec3 middle(random(50.0, 500.0), 0.0, 0.0);
    for (const Vec3& there : { Vec3(0.0), Vec3(3452345.678, 351234.567, 12.3) })
    {
      Scene scene;
      const auto corner = [&](double s, double t) { return there + (middle + s * u + t * v); };
      scene.triangle(corner(-1.0, -1.0), corner(1.3, -0.9), corner(1.0, 1.1), Wall, 0);
      scene.triangle(corner(-1.0, -1.0), corner(1.0, 1.1), corner(-0.8, 1.2), Wall, 0);
      CollisionTree tree;
      tree.mesh = scene.mesh;
      FoundPolygons seen(tree);
      ASSERT_EQ(seen.find(makeBeamFrame(there, Vec3(1.0, 0.0, 0.0), 0.05)), SeenByBeam::Polygons);
      EXPECT_EQ(seen.polygons->surfaces.size(), 1u) << i << ", " << there.x;
    }
  }
}

TEST(DiscPolygon, AreasOfTwoKindsAreTheSame)
{
  // Corners near and far: triangles of the ground reach behind the lidar.
  Numbers random(4);
  DiscPolygon disc;
  PartMoments parts;
  for (const double far : { 0.0, 1.0, 3.0, 6.0, 9.0 })
  {
    int hits = 0;
    double most = 0.0;
    for (int i = 0; i < 5000; ++i)
    {
      PlaneRing ring;
      for (int k = 0; k < 3; ++k)
      {
        const double size = std::pow(10.0, random(0.0, far));
        ring.add({ random(-size, size), random(-size, size) });
      }
      disc.set(ring, { 0.0, 0.0 });
      double area = 0.0;
      if (!disc.isEmpty())
      {
        disc.measure({ disc.least(), disc.most() }, parts);
        area = parts.area[0];
      }
      hits += area > 1e-6;
      most = std::max(most, std::fabs(areaInDisc(ring) - area));
    }
    EXPECT_GT(hits, 500);
    EXPECT_LT(most, 3e-15 * std::pow(10.0, far)) << far;
  }
}
