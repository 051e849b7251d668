// SPDX-License-Identifier: BSD-3-Clause
// Of every triangle its share of a beam, by line integrals around it, against the integrated
// beam's.
#ifndef SolidAngleOracle_h
#define SolidAngleOracle_h

#include "EchoTestScene.h"
#include "PlaneOracle.h"
#include "PolygonQuadrature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <climits>
#include <map>
#include <vector>

namespace solidangle
{
using namespace echotest;
using namespace planeoracle;

/// Share of the beam's energy on one side of all lines, by integrals around what they enclose: the
/// profile's integral from the axis to the line is a function of the radius alone.
inline double shareOf(const BeamFrame& frame, BeamProfile profile, const Vec3 (&corners)[3])
{
  static const auto rule = gauss<16>();
  const Real T = frame.tanHalf;
  const bool gaussian = profile == BeamProfile::Gaussian;
  const Real rim =
    2 * std::sin(Real(frame.halfBeamwidth) / 2) * std::sin(Real(frame.halfBeamwidth) / 2);
  // Integral of the profile up to a radius, over the squared radius.
  const auto density = [&](Real r2)
  {
    const Real w = std::sqrt(1 + T * T * r2);
    const Real one = T * T / (w * (1 + w)); // (1 - cos)/r2
    if (!gaussian)
    {
      return one;
    }
    return r2 > 0 ? rim * -std::expm1(-2 * one * r2 / rim) / (2 * r2) : one;
  };
  std::array<std::array<Real, 2>, 3> p;
  for (int i = 0; i < 3; ++i)
  {
    const Real z = Real(corners[i].x) * frame.axis.x + Real(corners[i].y) * frame.axis.y +
      Real(corners[i].z) * frame.axis.z;
    const auto along = [&](const Vec3& e)
    {
      return (Real(corners[i].x) * e.x + Real(corners[i].y) * e.y + Real(corners[i].z) * e.z) /
        (z * T);
    };
    p[i] = { along(frame.e1), along(frame.e2) };
  }
  const Real pi = std::acos(Real(-1));
  Real sum = 0;
  std::vector<std::array<Real, 2>> leaving, entering; // the disc
  Real area = 0;
  for (int i = 0; i < 3; ++i)
  {
    const auto& a = p[i];
    const auto& b = p[(i + 1) % 3];
    area += a[0] * b[1] - a[1] * b[0];
    const Real dx = b[0] - a[0];
    const Real dy = b[1] - a[1];
    const Real length = std::sqrt(dx * dx + dy * dy);
    const Real distance = (a[0] * dy - a[1] * dx) / length; // left of the axis: positive
    const Real from = (a[0] * dx + a[1] * dy) / length;
    const Real to = (b[0] * dx + b[1] * dy) / length;
    const Real half2 = 1 - distance * distance;
    if (half2 <= 0)
    {
      continue;
    }
    const Real half = std::sqrt(half2);
    const Real lower = std::max(from, -half);
    const Real upper = std::min(to, half);
    if (lower >= upper)
    {
      continue;
    }
    const auto at = [&](Real s) -> std::array<Real, 2> {
      return { (s * dx + distance * dy) / length, (s * dy - distance * dx) / length };
    };
    if (from < -half)
    {
      entering.push_back(at(-half));
    }
    if (to > half)
    {
      leaving.push_back(at(half));
    }
    for (int piece = 0; piece < 8; ++piece)
    {
      for (const auto& [q, v] : rule)
      {
        const Real s = lower + (upper - lower) * (piece + q) / 8;
        sum += v * (upper - lower) / 8 * distance * density(distance * distance + s * s);
      }
    }
  }
  const Real whole = density(1);
  const Real sign = area > 0 ? 1 : -1;
  if (leaving.empty())
  {
    bool inside = true; // the axis, if no side enters the disc
    for (int i = 0; i < 3; ++i)
    {
      const auto& a = p[i];
      const auto& b = p[(i + 1) % 3];
      inside = inside && sign * (a[0] * b[1] - a[1] * b[0]) > 0;
    }
    const bool cut = sum != 0;
    sum += !cut && inside ? sign * 2 * pi * whole : 0;
  }
  for (const auto& l : leaving)
  {
    Real nearest = 2 * pi;
    for (const auto& e : entering)
    {
      Real turn = sign * (std::atan2(e[1], e[0]) - std::atan2(l[1], l[0]));
      turn = turn < 0 ? turn + 2 * pi : turn;
      nearest = std::min(nearest, turn);
    }
    sum += sign * nearest * whole;
  }
  return static_cast<double>(std::fabs(sum) / (2 * pi * whole));
}

struct Shares
{
  std::size_t polygons = 0; ///< that are integrated; 0: it is not
  double worst = 0.0;       ///< of the surfaces' shares, absolute
  double excess = 0.0;      ///< of their sum over 1
};

/// Shares of the objects of a scene in a beam along x, against the oracle. Triangles of objects up
/// to `last` must be seen entirely and lie before the apex; the others hide.
inline Shares compareShares(
  const Scene& scene, double halfBeamwidth, BeamProfile profile, int last = INT_MAX)
{
  Sensor sensor = openSensor(halfBeamwidth);
  sensor.beamProfile = profile;
  const ScanSetup setup = makeSetup(scene, sensor, directSettings(10000));
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), halfBeamwidth);
  const SceneTriangles finderScene(*setup.tree);
  PolygonFinder finder(finderScene, 100);
  finder.begin(frame);
  finder.add(setup.tree->order.data(), setup.tree->order.size());
  std::unique_ptr<VisiblePolygons> seen;
  PolygonQuadrature quadrature(setup);
  Shares outcome;
  if (finder.find(seen) != SeenByBeam::Polygons)
  {
    return outcome;
  }
  if (!quadrature.fits(*seen))
  {
    return outcome;
  }
  quadrature.begin(frame, *seen);
  outcome.polygons = seen->polygons.size();
  const PolygonNodes& nodes = quadrature.place();
  std::map<int, double> found, right;
  double sum = 0.0;
  nodes.samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      for (std::uint32_t i = begin; i < end; ++i)
      {
        found[scene.objects[triangle]] += nodes.samples.weight[i];
        sum += nodes.samples.weight[i];
      }
    });
  for (std::size_t t = 0; t < scene.objects.size(); ++t)
  {
    const Vec3 corners[3] = { scene.mesh->corner(static_cast<std::uint32_t>(t), 0),
      scene.mesh->corner(static_cast<std::uint32_t>(t), 1),
      scene.mesh->corner(static_cast<std::uint32_t>(t), 2) };
    if (scene.objects[t] <= last)
    {
      right[scene.objects[t]] += shareOf(frame, profile, corners);
    }
  }
  double all = 0.0;
  for (const auto& [object, share] : right)
  {
    outcome.worst = std::max(outcome.worst, std::fabs(share - found[object]));
    all += share;
  }
  if (!(std::fabs(all - 1.0) < 1e-9)) // the oracle fails where a side all but touches the rim
  {
    return Shares();
  }
  outcome.excess = std::fabs(sum - 1.0);
  return outcome;
}
}

#endif
