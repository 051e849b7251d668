// SPDX-License-Identifier: BSD-3-Clause
// Surfaces of one plane that part a beam: the solid angle of each, against line integrals around
// it.
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

TEST(PlaneSurfaces, MosaicsHaveTheSolidAnglesOfTheirPieces)
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
    if (outcome.planes == 0)
    {
      continue;
    }
    ++integrated;
    // The coordinates of narrow beams have fewer digits.
    const double tolerance = 1e-8 + 1e-15 / t * (1.0 + std::tan(a));
    EXPECT_LT(outcome.worst, tolerance) << k << " t " << t << " a " << a;
    EXPECT_LT(outcome.excess, 1e-10) << k << " t " << t << " a " << a;
  }
  EXPECT_GT(integrated, cases / 2);
}

//--- energies -------------------------------------------------------------------------------------

namespace
{
/// A lattice of straight lines through `centre`, its cells of two materials in turn; its lines for
/// the oracle.
void addLattice(Case& c, const Vec3& centre, double turn, double size, int columns, Scene& scene)
{
  const Vec3 normal(std::cos(c.tilt), std::sin(c.tilt), 0.0);
  const Vec3 along(-std::sin(c.tilt), std::cos(c.tilt), 0.0);
  const Vec3 across(0.0, 0.0, 1.0);
  const Vec3 u = std::cos(turn) * along + std::sin(turn) * across;
  const Vec3 v = std::cos(turn) * across - std::sin(turn) * along;
  const double far = 100.0 * c.height / std::cos(c.tilt + c.sensor.halfBeamwidth);
  const auto place = [&](int i, int n)
  { return i == 0 ? -far : (i == n ? far : (i - 0.5 * n) * size); };
  const auto point = [&](int i, int j)
  { return centre + place(i, columns) * u + place(j, columns > 1 ? columns : 2) * v; };
  const int rows = columns > 1 ? columns : 2;
  for (int i = 0; i < columns; ++i)
  {
    for (int j = 0; j < rows; ++j)
    {
      const Material& m = (i + j) % 2 ? c.other : c.material;
      scene.triangle(point(i, j), point(i + 1, j), point(i + 1, j + 1), m, 0);
      scene.triangle(point(i, j), point(i + 1, j + 1), point(i, j + 1), m, 0);
    }
  }
  const auto line = [&](const Vec3& a, const Vec3& b)
  {
    const Vec3 m = unitVector(glm::cross(a, b));
    c.lines.push_back({ m.x, m.y, m.z });
  };
  for (int i = 1; i < columns; ++i)
  {
    line(centre + place(i, columns) * u, centre + place(i, columns) * u + v);
  }
  for (int j = 1; j < rows; ++j)
  {
    line(centre + place(j, rows) * v, centre + place(j, rows) * v + u);
  }
  // Which of the two cells is on the positive side of an odd number of lines.
  const double off = columns > 1 ? place(1, columns) - 0.1 * size : 0.0;
  const Vec3 first = unitVector(centre + off * u + (place(1, rows) - 0.1 * size) * v);
  if (&materialAt(c, { first.x, first.y, first.z }) == &c.other)
  {
    std::swap(c.material, c.other);
  }
}

struct Errors
{
  double worst = 0.0;  ///< relative, in units that hold at least 1 % of the strongest
  double widest = 0.0; ///< bound, the same
  int integrated = 0;
};

/// The strongest unit, and another.
void check(const Case& c, const Scene& scene, Numbers& random, Errors& errors)
{
  const ScanSetup setup = makeSetup(scene, c.sensor, c.settings);
  const ScanResult result = runScan(setup, oneBeam());
  ASSERT_FALSE(result.echoes.empty());
  if (result.reports[0].counters.raysTraced != 0)
  {
    return;
  }
  ++errors.integrated;
  const auto strongest = std::max_element(result.echoes.begin(), result.echoes.end(),
    [](const Echo& a, const Echo& b) { return a.energyReceived < b.energyReceived; });
  for (const Echo& echo : { *strongest, result.echoes[random.index(result.echoes.size())] })
  {
    const double unit = std::floor(echo.range / c.sensor.rangeUnitLength());
    const double right = static_cast<double>(energyIn(c, unit));
    const double error = std::fabs(echo.energyReceived - right);
    EXPECT_LE(error, echo.energyStdError)
      << "unit " << unit << " " << right / strongest->energyReceived;
    if (right > 0.01 * strongest->energyReceived)
    {
      errors.worst = std::max(errors.worst, error / right);
      // Of a unit of a millionth of the range rounding of the range is a larger part.
      if (c.sensor.rangeUnitLength() > 1e-6 * c.height)
      {
        errors.widest = std::max(errors.widest, echo.energyStdError / right);
      }
    }
  }
}
}

TEST(PlaneSurfaces, EveryRangeUnitOfALatticeIsRightToItsBound)
{
  Numbers random(12);
  Errors errors;
  constexpr int cases = 48;
  for (int k = 0; k < cases; ++k)
  {
    SCOPED_TRACE(k);
    Case c = drawCase(random, 0.4, 20.0);
    c.other = { random(0.01, 0.5), random(0.0, 0.5), random.logUniform(1.0, 1e6) };
    Scene scene;
    const double spot = c.height / std::cos(c.tilt) * c.sensor.halfBeamwidth;
    const Vec3 along(-std::sin(c.tilt), std::cos(c.tilt), 0.0);
    const Vec3 axis(c.height / std::cos(c.tilt), 0.0, 0.0);
    const Vec3 foot = c.height * Vec3(std::cos(c.tilt), std::sin(c.tilt), 0.0);
    // Through the axis, through the foot (a corner there), anywhere.
    const Vec3 centre = k % 8 == 0
      ? axis
      : (k % 8 == 1
            ? foot
            : axis + spot * (random(-1.0, 1.0) * along + Vec3(0.0, 0.0, random(-1.0, 1.0))));
    const double turn = k % 5 == 0 ? 0.5 * Pi * random.index(2) : random(0.0, Pi);
    addLattice(c, centre, turn, spot * random.logUniform(0.3, 2.0), k % 2 ? 1 : 3, scene);
    check(c, scene, random, errors);
  }
  EXPECT_GT(errors.integrated, cases * 3 / 4);
  EXPECT_LT(errors.worst, 1e-6);
  EXPECT_LT(errors.widest, 1e-4);
}
