// SPDX-License-Identifier: BSD-3-Clause
// Rooms of random boxes and slivers about the lidar, and beams that go around.
#ifndef RoomTestScene_h
#define RoomTestScene_h

#include "GeometryTestScene.h"
#include "SecondaryTestScene.h"

#include <cmath>

namespace echotest
{
using geometrytest::Numbers;

/// A room about the lidar with boxes on its floor, slivers in the air, and every wall of two
/// triangles.
inline Scene room(unsigned seed)
{
  const Material materials[] = { Wall, Glass, Metal, Wood };
  Numbers draw(seed);
  Scene scene;
  const double size = draw(1.0, 30.0);
  const double y = draw(1.0, size);
  const double z = draw(1.0, 4.0);
  scene.box(Vec3(0.3, 0.2, 0.1), Vec3(size, y, z), materials[seed % 4], 0);
  for (int i = 1; i < 8; ++i)
  {
    const Vec3 half(draw(0.1, 0.2) * size, draw(0.05, 0.2) * y, draw(0.05, 0.4) * z);
    const double side = draw(0.4, 0.9) * size * (i % 2 ? 1.0 : -1.0);
    scene.box(Vec3(side, draw(-0.8, 0.8) * y, 0.1 - z + half.z), half, materials[i % 4], i);
  }
  for (int i = 8; i < 40; ++i)
  {
    const Vec3 a = 0.3 * size * glm::normalize(draw.inCube(1.0)) + draw.inCube(0.3 * size);
    const Vec3 b = a + draw.inCube(0.2);
    scene.triangle(a, b, b + draw.inCube(i % 4 ? 0.2 : 1e-9), materials[i % 4], i);
  }
  return scene;
}

inline ScanBeams around(unsigned seed, int count)
{
  Numbers draw(seed + 1000);
  ScanBeams beams;
  for (int i = 0; i < count; ++i)
  {
    const double turn = draw(0.0, 2.0 * Pi);
    addBeam(beams, Vec3(std::cos(turn), std::sin(turn), draw(-0.8, 0.8)));
  }
  return beams;
}
}

#endif
