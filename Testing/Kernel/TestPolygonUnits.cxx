// SPDX-License-Identifier: BSD-3-Clause
// Energies of integrated beams in range units, and their bounds, against a quadrature of another
// kind: over polar coordinates about the beam's axis, in extended precision.
#include "EchoTestScene.h"
#include "GeometryTestScene.h"
#include "PlaneOracle.h"
#include "Sanitized.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace echotest;
using namespace planeoracle;
using geometrytest::Numbers;

namespace
{
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
  if (result.reports[0].direct != DirectEcho::Polygons)
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
    // Lines of equal range are curved by less than a thousandth of a range unit.
    const double tangent = std::tan(c.sensor.halfBeamwidth);
    const bool isFlat = 0.5 * tangent * tangent * echo.range < 1e-3 * c.sensor.rangeUnitLength();
    if (right > 0.01 * strongest->energyReceived && isFlat)
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

TEST(PolygonUnits, EveryRangeUnitIsRightToItsBound)
{
  Numbers random(6);
  constexpr int cases = IsSanitized ? 40 : 200;
  Errors errors;
  for (int k = 0; k < cases; ++k)
  {
    SCOPED_TRACE(k);
    const Case c = drawCase(random, 0.3, 100.0);
    Scene scene;
    const Vec3 normal(std::cos(c.tilt), std::sin(c.tilt), 0.0);
    const double reach = 100.0 * c.height / std::cos(c.tilt + c.sensor.halfBeamwidth);
    scene.plate(
      c.height * normal, reach * Vec3(-normal.y, normal.x, 0.0), Vec3(0.0, 0.0, reach), c.material);
    check(c, scene, random, errors);
  }
  EXPECT_GT(errors.integrated, cases / 2);
  EXPECT_LT(errors.worst, 5e-5);
  EXPECT_LT(errors.widest, 3e-3);
}

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
}

TEST(PolygonUnits, EveryRangeUnitOfALatticeIsRightToItsBound)
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
  EXPECT_GT(errors.integrated, cases / 3);
  EXPECT_LT(errors.worst, 5e-5);
  EXPECT_LT(errors.widest, 3e-3);
}
