// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that part a beam, in one plane or several: the solid angle of each, against line
// integrals around it.
#include "EchoTestScene.h"
#include "GeometryTestScene.h"
#include "PlaneOracle.h"
#include "SolidAngleOracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

using namespace echotest;
using namespace planeoracle;
using namespace solidangle;
using geometrytest::Numbers;

namespace
{
/// A plane at `height` whose normal makes the angle `tilt` with the axis x, in triangles.
struct Plane
{
  double height, tilt;
  Vec3 normal, along, across; ///< along: from the axis to the normal
  Vec3 origin;                ///< where the axis meets it
  Plane(double h, double a, double turn)
    : height(h)
    , tilt(a)
    , normal(std::cos(a), std::sin(a) * std::cos(turn), std::sin(a) * std::sin(turn))
    , along(-std::sin(a), std::cos(a) * std::cos(turn), std::cos(a) * std::sin(turn))
    , across(0.0, -std::sin(turn), std::cos(turn))
    , origin(h / std::cos(a), 0.0, 0.0)
  {
  }
  Vec3 foot() const { return this->height * this->normal; }
};

/// n x n cells whose inner corners are moved, of random objects.
Scene mosaic(const Plane& plane, const Vec3& centre, double size, Numbers& random, int objects,
  double move = 0.3, int n = 4)
{
  Scene scene;
  std::vector<std::vector<Vec3>> points(n + 1, std::vector<Vec3>(n + 1));
  const double far = 200.0 * (size + plane.height / std::cos(plane.tilt));
  // Before the apex: the oracle knows no corners behind it.
  const double foot = glm::dot(centre - plane.foot(), plane.along);
  const double most = std::min(far, 0.9 * plane.height / std::tan(plane.tilt) - foot);
  size = std::min(size, 0.9 * most / (0.5 * n));
  for (int i = 0; i <= n; ++i)
  {
    for (int j = 0; j <= n; ++j)
    {
      const double u = i == 0 ? -far : (i == n ? most : (i - 0.5 * n + random(-move, move)) * size);
      const double v = j == 0 ? -far : (j == n ? far : (j - 0.5 * n + random(-move, move)) * size);
      points[i][j] = centre + u * plane.along + v * plane.across;
    }
  }
  for (int i = 0; i < n; ++i)
  {
    for (int j = 0; j < n; ++j)
    {
      for (const int half : { 0, 1 })
      {
        const Vec3& b = half ? points[i + 1][j + 1] : points[i + 1][j];
        const Vec3& c = half ? points[i][j + 1] : points[i + 1][j + 1];
        scene.triangle(points[i][j], b, c, Wall, static_cast<int>(random.index(objects)));
      }
    }
  }
  return scene;
}

}

TEST(PolygonShares, MosaicsHaveTheSolidAnglesOfTheirPieces)
{
  Numbers random(11);
  int integrated = 0;
  constexpr int cases = 600;
  for (int k = 0; k < cases; ++k)
  {
    const double t = k % 4 == 0 ? random.logUniform(1e-9, 1e-3) : random.logUniform(1e-3, 1.0);
    const double steepest = 0.5 * Pi - 1.1 * t;
    const double a = k % 3 == 0 ? std::min(steepest, random(0.0, 1.5) * t) : random(0.0, steepest);
    const Plane plane(random.logUniform(1.0, 500.0), a, random(0.0, 2.0 * Pi));
    const double spot = plane.height / std::cos(a) * std::tan(t);
    const Vec3 centre = plane.origin + spot * random(-1.0, 1.0) * plane.along +
      spot * random(-1.0, 1.0) * plane.across;
    const double size = spot * random.logUniform(0.5, 5.0);
    const BeamProfile profile = k % 5 == 0 ? BeamProfile::Gaussian : BeamProfile::Uniform;
    const Shares outcome = compareShares(mosaic(plane, centre, size, random, 5), t, profile);
    if (outcome.polygons == 0)
    {
      continue;
    }
    ++integrated;
    // The coordinates of narrow beams have fewer digits: of the mosaics that one compiler or the
    // other draws (they order the draws of an expression differently) 3.4e-15 / t are the worst.
    const double tolerance = 1e-7 + 4e-15 / t * (1.0 + std::tan(a));
    EXPECT_LT(outcome.worst, tolerance) << k << " t " << t << " a " << a;
    EXPECT_LT(outcome.excess, 1e-7) << k << " t " << t << " a " << a;
  }
  EXPECT_GT(integrated, cases / 2);
}

namespace
{
/// Number of objects that are not seen.
constexpr int Hidden = 100;

/// A body like an umbrella: its tip, and `sides` sides that fall away from it at random slopes. The
/// normals of convex ones lie within a cone about -x.
struct Umbrella
{
  Vec3 tip;
  std::vector<Vec3> rim;
};

Umbrella umbrella(Numbers& random, int sides, const Vec3& tip, double size, double depth)
{
  Umbrella u;
  u.tip = tip;
  const double turn = random(0.0, 2.0 * Pi);
  for (int i = 0; i < sides; ++i)
  {
    const double angle = turn + 2.0 * Pi * (i + random(-0.2, 0.2)) / sides;
    u.rim.push_back(tip + Vec3(depth, size * std::cos(angle), size * std::sin(angle)));
  }
  return u;
}

Scene sceneOf(const Umbrella& u, const Material& even = Wall, const Material& odd = Wall)
{
  Scene scene;
  const std::size_t n = u.rim.size();
  for (std::size_t i = 0; i < n; ++i)
  {
    scene.triangle(u.tip, u.rim[i], u.rim[(i + 1) % n], i % 2 ? odd : even, static_cast<int>(i));
  }
  return scene;
}
}

TEST(PolygonShares, CornersHaveTheSolidAnglesOfTheirSides)
{
  Numbers random(5);
  int integrated = 0;
  constexpr int cases = 300;
  for (int k = 0; k < cases; ++k)
  {
    const double t = k % 3 == 0 ? random.logUniform(1e-8, 1e-3) : random.logUniform(1e-3, 0.5);
    const double distance = random.logUniform(2.0, 2000.0);
    const double spot = distance * std::tan(t);
    const double size = 5.0 * spot;
    const Vec3 tip(distance, spot * random(-1.2, 1.2), spot * random(-1.2, 1.2));
    // Towards the lidar, or away from it like the corner of a room.
    const double depth = std::min(size * random(0.05, 2.0), 10.0 * distance);
    const int sides = 3 + static_cast<int>(random.index(2));
    const BeamProfile profile = k % 4 == 0 ? BeamProfile::Gaussian : BeamProfile::Uniform;
    const Shares outcome =
      compareShares(sceneOf(umbrella(random, sides, tip, size, depth)), t, profile);
    if (outcome.polygons == 0)
    {
      continue;
    }
    ++integrated;
    const double tolerance = 1e-7 + 1e-14 / t * (1.0 + depth / size);
    EXPECT_LT(outcome.worst, tolerance) << k << " t " << t;
    EXPECT_LT(outcome.excess, tolerance) << k << " t " << t;
  }
  EXPECT_GT(integrated, cases / 2);
}

TEST(PolygonShares, BoxesBeforeOthersAgreeWithTheirVisibleFaces)
{
  Numbers random(17);
  int several = 0;
  for (int k = 0; k < 60; ++k)
  {
    // A box whose front faces turn a corner to the lidar; its back, ground and a wall behind it.
    const double t = random.logUniform(1e-4, 5e-2);
    const double distance = random.logUniform(5.0, 500.0);
    const double spot = distance * std::tan(t);
    const double turn = random(0.2, 1.3);
    const Vec3 left(std::cos(turn), std::sin(turn), 0.0);
    const Vec3 right(std::sin(turn), -std::cos(turn), 0.0);
    const double size = 4.0 * spot;
    const Vec3 corner(distance, spot * random(-0.8, 0.8), 0.0);
    const Vec3 up(0.0, 0.0, size);
    Scene scene;
    const auto face = [&](const Vec3& from, const Vec3& along, const Vec3& across, int object)
    {
      scene.triangle(from, from + along, from + along + across, Wall, object);
      scene.triangle(from, from + along + across, from + across, Wall, object);
    };
    face(corner - up, size * left, 2.0 * up, 0);
    face(corner - up, size * right, 2.0 * up, 1);
    face(corner - up + size * left, size * right, 2.0 * up, Hidden);
    face(corner - up + size * right, size * left, 2.0 * up, Hidden);
    face(corner - up, size * left, size * right, Hidden);
    scene.plate(Vec3(3.0 * distance, 0.0, 0.0), Vec3(0.0, distance, 0.0), Vec3(0.0, 0.0, distance),
      Glass, Hidden);
    const Shares outcome = compareShares(scene, t, BeamProfile::Uniform, Hidden - 1);
    several += outcome.polygons >= 2;
    if (outcome.polygons > 0)
    {
      EXPECT_LT(outcome.worst, 1e-7 + 1e-13 / t) << k;
      EXPECT_LT(outcome.excess, 1e-7) << k;
    }
  }
  EXPECT_GT(several, 40);
}
