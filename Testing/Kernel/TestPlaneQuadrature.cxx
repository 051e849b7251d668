// SPDX-License-Identifier: BSD-3-Clause
// Energies of integrated beams in range units, and their bounds, against a quadrature of another
// kind: over polar coordinates about the beam's axis, in extended precision.
#include "EchoTestScene.h"
#include "GeometryTestScene.h"
#include "PlaneOracle.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace echotest;
using namespace planeoracle;
using geometrytest::Numbers;

TEST(PlaneQuadrature, EveryRangeUnitIsRightToItsBound)
{
  Numbers random(6);
#if defined(AVIANLIDAR_SANITIZED)
  constexpr int cases = 40;
#else
  constexpr int cases = 200;
#endif
  double worst = 0.0;
  double widest = 0.0;
  for (int k = 0; k < cases; ++k)
  {
    const Case c = drawCase(random, 0.3, 100.0);
    Scene scene;
    const Vec3 normal(std::cos(c.tilt), std::sin(c.tilt), 0.0);
    const double reach = 100.0 * c.height / std::cos(c.tilt + c.sensor.halfBeamwidth);
    scene.plate(
      c.height * normal, reach * Vec3(-normal.y, normal.x, 0.0), Vec3(0.0, 0.0, reach), c.material);
    const ScanResult result = runScan(makeSetup(scene, c.sensor, c.settings), oneBeam());
    ASSERT_FALSE(result.echoes.empty()) << k;
    ASSERT_EQ(result.reports[0].counters.raysTraced, 0u) << k;
    const auto strongest = std::max_element(result.echoes.begin(), result.echoes.end(),
      [](const Echo& a, const Echo& b) { return a.energyReceived < b.energyReceived; });
    for (const Echo& echo : { *strongest, result.echoes[random.index(result.echoes.size())] })
    {
      const double unit = std::floor(echo.range / c.sensor.rangeUnitLength());
      const double right = static_cast<double>(energyIn(c, unit));
      const double error = std::fabs(echo.energyReceived - right);
      EXPECT_LE(error, echo.energyStdError) << k << " unit " << unit;
      if (right > 0.01 * strongest->energyReceived)
      {
        worst = std::max(worst, error / right);
        // Of a unit of a millionth of the range rounding of the range is a larger part.
        if (c.sensor.rangeUnitLength() > 1e-6 * c.height)
        {
          widest = std::max(widest, echo.energyStdError / right);
        }
      }
    }
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_LT(widest, 1e-4);
}
