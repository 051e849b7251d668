// SPDX-License-Identifier: BSD-3-Clause
// Oracle for integrated beams: the energy of a range unit by a quadrature over polar coordinates
// about the beam's axis, in extended precision. The plane may be parted by lines into two
// materials.
#ifndef PlaneOracle_h
#define PlaneOracle_h

#include "EchoTestScene.h"
#include "GeometryTestScene.h"

#include <boost/math/quadrature/gauss.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace planeoracle
{
using namespace echotest;
using Real = long double;
using geometrytest::unit;

/// A line on the plane: where m . d is positive and negative, d a direction in the axes (axis of
/// the beam, towards the normal, across).
using Line = geometrytest::Vec3L;

struct Case
{
  double height, tilt; // m, rad
  Sensor sensor;
  EchoSettings settings;
  Material material;
  /// The other material lies where an odd number of lines is on its positive side.
  std::vector<Line> lines = {};
  Material other = {};
};

/// @param near share of those that see the foot of the perpendicular, or nearly @param mostUnits
/// range units that it goes over
inline Case drawCase(geometrytest::Numbers& random, double near, double mostUnits)
{
  Case c;
  c.height = random.logUniform(1.0, 500.0);
  c.sensor = openSensor(random.logUniform(1e-4, 0.05));
  const double t = c.sensor.halfBeamwidth;
  c.tilt = random() < near ? random(0.1, 3.0) * t : random(0.0, 0.5 * Pi - 1.2 * t);
  const double first = c.height / std::cos(std::max(0.0, c.tilt - t));
  const double last = c.height / std::cos(c.tilt + t);
  const double units = random.logUniform(0.3, mostUnits);
  c.sensor.samplingInterval = 2.0 * (last - first) / units / SpeedOfLight;
  c.sensor.pulseWidth = random() < 0.2 ? 0.0 : c.sensor.samplingInterval * random(0.1, 3.0);
  c.sensor.beamProfile = random() < 0.3 ? BeamProfile::Gaussian : BeamProfile::Uniform;
  c.settings = inCells(10000);
  c.settings.returnMode = ReturnMode::RangeUnits;
  c.settings.attenuationCoefficient = random() * 1e-3;
  c.settings.reflectanceModel = static_cast<ReflectanceModel>(random.index(4));
  c.material = { random(0.01, 0.5), random(0.0, 0.5), random.logUniform(1.0, 1e6),
    random(0.0, 0.5 * Pi) };
  return c;
}

/// f_sur of a plane towards the lidar (Reflectance.h).
inline Real reflected(const Case& c, const Material& m, Real b)
{
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
    case ReflectanceModel::OrenNayar:
    {
      const Real s2 = Real(m.roughness) * m.roughness;
      const Real even = 1 - Real(0.5) * s2 / (s2 + Real(0.33L));
      const Real rough = Real(0.45L) * s2 / (s2 + Real(0.09L));
      return m.kd * (even * cosine + rough * std::sin(b) * std::sin(b)) + m.ks * lobe;
    }
    case ReflectanceModel::LambertBlinnPhong:
      break;
  }
  return m.kd * cosine + m.ks * lobe;
}

/// Share of a pulse from range `r` that falls into unit `m`.
inline Real shareOf(const Case& c, Real r, Real m)
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
inline std::vector<Real> bordersOf(const Case& c, Real m)
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
  for (const Material& material : { c.material, c.other })
  {
    const Real lobe = 1 / std::sqrt(2 * Real(material.kp) + 1);
    for (const Real times :
      { 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.5, 7.0, 12.0, 25.0, 50.0, 100.0, 200.0, 400.0 })
    {
      borders.push_back(times * lobe);
    }
    if (c.lines.empty())
    {
      break;
    }
  }
  return borders;
}

/// Angles from the axis at which lines meet each other, the axis and circles of incidence.
inline void addLineRings(const Case& c, const std::vector<Real>& borders, std::vector<Real>& rings)
{
  const Line normal = { std::cos(Real(c.tilt)), std::sin(Real(c.tilt)), 0 };
  const auto add = [&](const Line& d)
  {
    const Real across = std::sqrt(d.y * d.y + d.z * d.z);
    rings.push_back(std::atan2(across, std::fabs(d.x)));
  };
  for (std::size_t k = 0; k < c.lines.size(); ++k)
  {
    const Line m = unit(c.lines[k]);
    rings.push_back(std::asin(std::fabs(m.x)));
    for (std::size_t j = 0; j < k; ++j)
    {
      add(unit(cross(m, c.lines[j])));
    }
    const Line f = unit(cross(m, std::fabs(m.x) < 0.5 ? Line{ 1, 0, 0 } : Line{ 0, 1, 0 }));
    const Line g = cross(m, f);
    const Real nf = dot(normal, f);
    const Real ng = dot(normal, g);
    for (const Real b : borders)
    {
      const Real x = std::cos(b) / std::sqrt(nf * nf + ng * ng);
      for (const int side : { -1, 1 })
      {
        if (std::fabs(x) < 1)
        {
          const Real s = std::atan2(ng, nf) + side * std::acos(x);
          add(std::cos(s) * f + std::sin(s) * g);
        }
      }
    }
  }
}

inline const Material& materialAt(const Case& c, const Line& d)
{
  bool odd = false;
  for (const Line& m : c.lines)
  {
    odd = odd != (dot(m, d) > 0);
  }
  return odd ? c.other : c.material;
}

/// Turns about the axis at which a ring crosses lines and circles of incidence, in [0, 2 pi].
inline std::vector<Real> turnsOf(const Case& c, const std::vector<Real>& borders, Real ring)
{
  const Real pi = std::acos(Real(-1));
  const Real a = c.tilt;
  std::vector<Real> turns = { 0, pi, 2 * pi };
  for (const Real b : borders)
  {
    // cos b = cos(a - ring) - 2 sin a sin(ring) sin^2(phi/2)
    const Real x =
      std::sin((b + a - ring) / 2) * std::sin((b - a + ring) / 2) / (std::sin(a) * std::sin(ring));
    if (x > 0 && x < 1)
    {
      turns.push_back(2 * std::asin(std::sqrt(x)));
      turns.push_back(2 * pi - turns.back());
    }
  }
  for (const Line& m : c.lines)
  {
    const Real x = -m.x * std::cos(ring) / (std::sin(ring) * std::hypot(m.y, m.z));
    for (const int side : { -1, 1 })
    {
      if (std::fabs(x) < 1)
      {
        const Real turn = std::atan2(m.z, m.y) + side * std::acos(x);
        turns.push_back(turn < 0 ? turn + 2 * pi : turn);
      }
    }
  }
  std::sort(turns.begin(), turns.end());
  return turns;
}

/// Energy, J, that the beam puts into unit `m`.
inline Real energyIn(const Case& c, double m)
{
  using Outer = boost::math::quadrature::gauss<Real, 25>;
  using Inner = boost::math::quadrature::gauss<Real, 15>;
  const Real pi = std::acos(Real(-1));
  const Real t = c.sensor.halfBeamwidth;
  const Real a = c.tilt;
  const std::vector<Real> borders = bordersOf(c, m);
  std::vector<Real> rings = { 0, t };
  for (const Real b : borders)
  {
    rings.push_back(std::fabs(b - a));
    rings.push_back(b + a);
  }
  rings.push_back(a);
  addLineRings(c, borders, rings);
  std::sort(rings.begin(), rings.end());
  while (rings.back() > t)
  {
    rings.pop_back();
  }
  const Real most = 2 * std::sin(t / 2) * std::sin(t / 2); // 1 - cos t
  const bool gaussian = c.sensor.beamProfile == BeamProfile::Gaussian;
  const Real norm = gaussian ? pi * most * (1 - std::exp(Real(-2))) : 2 * pi * most;
  Real sum = 0;
  for (std::size_t k = 1; k < rings.size(); ++k)
  {
    const Real length = rings[k] - rings[k - 1];
    const auto onRing = [&](Real p)
    {
      // Roots at both ends vanish.
      const Real s = std::sin(p * pi / 2);
      const Real ring = rings[k - 1] + length * s * s;
      const std::vector<Real> turns = turnsOf(c, borders, ring);
      Real around = 0;
      for (std::size_t j = 1; j < turns.size(); ++j)
      {
        const Real middle = (turns[j - 1] + turns[j]) / 2;
        const Material material = materialAt(c,
          { std::cos(ring), std::sin(ring) * std::cos(middle), std::sin(ring) * std::sin(middle) });
        // Without lines one half is the mirror image of the other.
        if (c.lines.empty() && middle > pi)
        {
          break;
        }
        const auto at = [&](Real phi)
        {
          const Real h2 = std::sin((a - ring) / 2) * std::sin((a - ring) / 2) +
            std::sin(a) * std::sin(ring) * std::sin(phi / 2) * std::sin(phi / 2);
          const Real b = 2 * std::asin(std::sqrt(h2));
          const Real r = c.height / std::cos(b);
          return reflected(c, material, b) * shareOf(c, r, m) *
            std::exp(-2 * Real(c.settings.attenuationCoefficient) * r);
        };
        around += Inner::integrate(at, turns[j - 1], turns[j]);
      }
      const Real u = 2 * std::sin(ring / 2) * std::sin(ring / 2) / most;
      return length * (pi / 2) * std::sin(p * pi) * (c.lines.empty() ? 2 : 1) * around *
        std::sin(ring) * (gaussian ? std::exp(-2 * u) : 1);
    };
    sum += Outer::integrate(onRing, Real(0), Real(1));
  }
  return c.sensor.pulseEnergy * sum / norm;
}
}

#endif
