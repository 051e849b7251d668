// SPDX-License-Identifier: BSD-3-Clause
// A wall and a second surface in its plane, and the same scene without what is hidden, in which
// nothing coincides.
#ifndef CoincidentTestScene_h
#define CoincidentTestScene_h

#include "CellTestScene.h"

#include <algorithm>
#include <vector>

namespace coincidenttest
{
using namespace celltest;
const Material Dark{ 0.05, 0.0, 1.0 };

/// A wall, and a second surface in its plane.
struct CoincidentPlates
{
  Vec3 center, u, v;
  Vec3 patch, half; ///< centre and extent of the second surface in units of u and v
  int parts;        ///< the second surface has parts x parts quadrilaterals
  bool turned;      ///< it is wound the other way

  Vec3 at(double a, double b) const { return this->center + a * this->u + b * this->v; }

  void addWall(Scene& scene) const { scene.plate(this->center, this->u, this->v, Matt, 1); }

  void addPatch(Scene& scene) const
  {
    const Vec3 x = this->half.x * this->u;
    const Vec3 y = this->half.y * this->v;
    fine(scene, this->at(this->patch.x, this->patch.y), this->turned ? y : x, this->turned ? x : y,
      this->parts, Dark, 2);
  }

  Scene scene(bool wallFirst) const
  {
    Scene scene;
    wallFirst ? this->addWall(scene) : this->addPatch(scene);
    wallFirst ? this->addPatch(scene) : this->addWall(scene);
    return scene;
  }

  /// What is seen of them, as plates beside each other.
  Scene seen(bool wallFirst) const
  {
    Scene scene;
    if (wallFirst)
    {
      this->addWall(scene);
      return scene;
    }
    const double low[] = { std::max(-1.0, this->patch.x - this->half.x),
      std::max(-1.0, this->patch.y - this->half.y) };
    const double high[] = { std::min(1.0, this->patch.x + this->half.x),
      std::min(1.0, this->patch.y + this->half.y) };
    const auto part = [&](double a0, double a1, double b0, double b1, const Material& m)
    {
      if (a1 > a0 && b1 > b0)
      {
        scene.plate(this->at(0.5 * (a0 + a1), 0.5 * (b0 + b1)), 0.5 * (a1 - a0) * this->u,
          0.5 * (b1 - b0) * this->v, m);
      }
    };
    part(this->patch.x - this->half.x, this->patch.x + this->half.x, this->patch.y - this->half.y,
      this->patch.y + this->half.y, Dark);
    part(-1.0, low[0], -1.0, 1.0, Matt);
    part(high[0], 1.0, -1.0, 1.0, Matt);
    part(low[0], high[0], -1.0, low[1], Matt);
    part(low[0], high[0], high[1], 1.0, Matt);
    return scene;
  }
};

const Vec3 Utm(500000.0, 4000000.0, 30.0);

inline std::vector<CoincidentPlates> pairs(int parts)
{
  std::vector<CoincidentPlates> all;
  for (const Vec3& tilt : { Vec3(0.0, 2.0, 0.0), Vec3(0.3, 1.7, 0.11), Vec3(17.0, 1.9, 0.3) })
  {
    const Vec3 v(0.37, -0.1, 1.4);
    all.push_back({ Vec3(100.0, 0.1, 0.2), tilt, v, Vec3(0.0), Vec3(0.99), parts, false });
    all.push_back(
      { Vec3(100.0, 0.1, 0.2), tilt, v, Vec3(0.21, 0.9, 0.0), Vec3(0.17, 0.83, 0.0), parts, true });
  }
  return all;
}

inline double receivedAt(const Vec3& place, const Scene& scene, const EchoSettings& settings,
  const TreeOptions& options = {})
{
  const Scene there = changed(scene, [&](const Vec3& p) { return p + place; });
  return receivedFrom(runScan(
    makeSetup(there, openSensor(), settings, options), oneBeam(Vec3(1.0, 0.0, 0.0), place)));
}
}

#endif
