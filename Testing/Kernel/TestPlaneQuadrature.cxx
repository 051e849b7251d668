// SPDX-License-Identifier: BSD-3-Clause
// Energies of integrated beams in range units, and their bounds, against a quadrature of another
// kind: over polar coordinates about the beam's axis, in extended precision.
#include "EchoTestScene.h"
#include "GeometryTestScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

using namespace echotest;
using geometrytest::Numbers;

namespace
{
using Real = long double;

/// Gauss's rule on [0, 1] by Newton's method on Legendre's polynomial.
template <int N>
std::array<std::array<Real, 2>, N> gauss()
{
  std::array<std::array<Real, 2>, N> rule;
  for (int i = 0; i < N; ++i)
  {
    Real x = std::cos(std::acos(Real(-1)) * (i + Real(0.75)) / (N + Real(0.5)));
    Real slope = 1;
    for (int step = 0; step < 30; ++step)
    {
      Real p0 = 1;
      Real p1 = x;
      for (int n = 2; n <= N; ++n)
      {
        const Real p2 = ((2 * n - 1) * x * p1 - (n - 1) * p0) / n;
        p0 = p1;
        p1 = p2;
      }
      slope = N * (x * p1 - p0) / (x * x - 1);
      x -= p1 / slope;
    }
    rule[i] = { (1 + x) / 2, 1 / ((1 - x * x) * slope * slope) };
  }
  return rule;
}

struct Case
{
  double height, tilt; // m, rad
  Sensor sensor;
  EchoSettings settings;
  Material material;
};

/// f_sur of a plane towards the lidar (Reflectance.h).
Real reflected(const Case& c, Real b)
{
  const Material& m = c.material;
  const Real cosine = std::cos(b);
  const Real lobe = std::cos(2 * b) > 0 ? std::pow(std::cos(2 * b), Real(m.kp)) : 0;
  switch (c.settings.reflectanceModel)
  {
    case ReflectanceModel::Phong:
      return (m.kd + m.ks * lobe) * cosine;
    case ReflectanceModel::Microfacet:
    {
      const Real a2 = 1 / (2 * Real(m.kp) + 1);
      const Real sine2 = std::sin(b) * std::sin(b);
      const Real d = a2 / (a2 * cosine * cosine + sine2);
      return m.kd * cosine + m.ks * d * d * cosine / std::sqrt(a2 + (1 - a2) * cosine * cosine);
    }
    case ReflectanceModel::LambertBlinnPhong:
      break;
  }
  return m.kd * cosine + m.ks * lobe;
}

/// Share of a pulse from range `r` that falls into unit `m`.
Real shareOf(const Case& c, Real r, Real m)
{
  const Real delay = r / Real(c.sensor.rangeUnitLength());
  const Real width = Real(c.sensor.pulseWidth) / Real(c.sensor.samplingInterval);
  if (width == 0)
  {
    return std::floor(delay) == m ? 1 : 0;
  }
  // What would arrive before the pulse is sent counts in unit 0.
  const Real from = m > 0 ? std::max(m, delay - width / 2) : delay - width / 2;
  const Real to = std::min(m + 1, delay + width / 2);
  return to > from ? (to - from) / width : 0;
}

/// Angles of incidence between which everything is smooth.
std::vector<Real> bordersOf(const Case& c, Real m)
{
  std::vector<Real> borders;
  const Real width = Real(c.sensor.pulseWidth) / Real(c.sensor.samplingInterval);
  for (const Real edge : { m, m + 1 })
  {
    for (const Real side : { -width / 2, width / 2 })
    {
      const Real r = (edge + side) * Real(c.sensor.rangeUnitLength());
      if (r > c.height)
      {
        borders.push_back(std::atan2(std::sqrt((r - c.height) * (r + c.height)), Real(c.height)));
      }
    }
  }
  const Real lobe = 1 / std::sqrt(2 * Real(c.material.kp) + 1);
  for (const Real times : { 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.5, 7.0, 12.0, 25.0 })
  {
    borders.push_back(times * lobe);
  }
  return borders;
}

/// Energy, J, that the beam puts into unit `m`.
Real energyIn(const Case& c, double m)
{
  static const auto outer = gauss<16>();
  static const auto inner = gauss<12>();
  const Real pi = std::acos(Real(-1));
  const Real t = c.sensor.halfBeamwidth;
  const Real a = c.tilt;
  const std::vector<Real> borders = bordersOf(c, m);
  std::vector<Real> rings = { 0, t };
  for (const Real b : borders)
  {
    for (const Real ring : { std::fabs(b - a), b + a })
    {
      if (ring < t)
      {
        rings.push_back(ring);
      }
    }
  }
  if (a < t)
  {
    rings.push_back(a);
  }
  std::sort(rings.begin(), rings.end());
  const Real most = 2 * std::sin(t / 2) * std::sin(t / 2); // 1 - cos t
  const bool gaussian = c.sensor.beamProfile == BeamProfile::Gaussian;
  const Real norm = gaussian ? pi * most * (1 - std::exp(Real(-2))) : 2 * pi * most;
  Real sum = 0;
  std::vector<Real> turns;
  for (std::size_t k = 1; k < rings.size(); ++k)
  {
    const Real length = rings[k] - rings[k - 1];
    for (const auto& [p, w] : outer)
    {
      // Roots at both ends vanish.
      const Real s = std::sin(p * pi / 2);
      const Real ring = rings[k - 1] + length * s * s;
      const Real weight = w * length * (pi / 2) * std::sin(p * pi);
      turns = { 0, pi };
      for (const Real b : borders)
      {
        // cos b = cos(a - ring) - 2 sin a sin(ring) sin^2(phi/2)
        const Real x = std::sin((b + a - ring) / 2) * std::sin((b - a + ring) / 2) /
          (std::sin(a) * std::sin(ring));
        if (x > 0 && x < 1)
        {
          turns.push_back(2 * std::asin(std::sqrt(x)));
        }
      }
      std::sort(turns.begin(), turns.end());
      Real around = 0;
      for (std::size_t j = 1; j < turns.size(); ++j)
      {
        for (const auto& [q, v] : inner)
        {
          const Real phi = turns[j - 1] + (turns[j] - turns[j - 1]) * q;
          const Real h2 = std::sin((a - ring) / 2) * std::sin((a - ring) / 2) +
            std::sin(a) * std::sin(ring) * std::sin(phi / 2) * std::sin(phi / 2);
          const Real b = 2 * std::asin(std::sqrt(h2));
          const Real r = c.height / std::cos(b);
          around += v * (turns[j] - turns[j - 1]) * reflected(c, b) * shareOf(c, r, m) *
            std::exp(-2 * Real(c.settings.attenuationCoefficient) * r);
        }
      }
      const Real u = 2 * std::sin(ring / 2) * std::sin(ring / 2) / most;
      sum += weight * 2 * around * std::sin(ring) * (gaussian ? std::exp(-2 * u) : 1);
    }
  }
  return c.sensor.pulseEnergy * sum / norm;
}

Case draw(Numbers& random)
{
  Case c;
  c.height = random.logUniform(1.0, 500.0);
  c.sensor = openSensor(random.logUniform(1e-3, 0.2));
  const double t = c.sensor.halfBeamwidth;
  c.tilt = random() < 0.3 ? random(0.1, 3.0) * t : random(0.0, 0.5 * Pi - 1.2 * t);
  const double near = c.height / std::cos(std::max(0.0, c.tilt - t));
  const double far = c.height / std::cos(c.tilt + t);
  // From one range unit to some hundred.
  const double units = random.logUniform(0.3, 100.0);
  c.sensor.samplingInterval = 2.0 * (far - near) / units / SpeedOfLight;
  c.sensor.pulseWidth = random() < 0.2 ? 0.0 : c.sensor.samplingInterval * random(0.1, 3.0);
  c.sensor.beamProfile = random() < 0.3 ? BeamProfile::Gaussian : BeamProfile::Uniform;
  c.settings = directSettings(100);
  c.settings.planeIntegration = true;
  c.settings.returnMode = ReturnMode::RangeUnits;
  c.settings.attenuationCoefficient = random() * 1e-3;
  c.settings.reflectanceModel = static_cast<ReflectanceModel>(random.index(3));
  c.material = { random(0.01, 0.5), random(0.0, 0.5), random.logUniform(1.0, 1e6) };
  return c;
}
}

TEST(PlaneQuadrature, EveryRangeUnitIsRightToItsBound)
{
  Numbers random(6);
#if defined(AVIANLIDAR_SANITIZED)
  constexpr int cases = 40;
#else
  constexpr int cases = 400;
#endif
  double worst = 0.0;
  double widest = 0.0;
  for (int k = 0; k < cases; ++k)
  {
    const Case c = draw(random);
    Scene scene;
    const Vec3 normal(std::cos(c.tilt), std::sin(c.tilt), 0.0);
    const double reach = 1e4 * c.height;
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
        widest = std::max(widest, echo.energyStdError / right);
      }
    }
  }
  EXPECT_LT(worst, 1e-6);
  // Bounds exceed errors by far where a unit holds little of the beam.
  EXPECT_LT(widest, 0.05);
}
