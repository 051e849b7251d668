// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MediumTestScene.h
 * @brief Media in boxes before a wall, and a search lidar: what tests of media share.
 */
#ifndef MediumTestScene_h
#define MediumTestScene_h

#include "CollisionTreeBuilder.h"
#include "EchoTestScene.h"
#include "Search905.h"

#include <memory>

namespace echotest
{
inline MediumVolume boxOf(const Vec3& centre, const Vec3& half)
{
  MediumVolume box;
  box.shape = MediumShape::Box;
  box.centre = centre;
  box.halfAxes = { Vec3(half.x, 0.0, 0.0), Vec3(0.0, half.y, 0.0), Vec3(0.0, 0.0, half.z) };
  return box;
}

/// Corners by bits, sides that face outwards.
inline TriangleMesh trianglesOf(const MediumVolume& box)
{
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
  {
    Vec3 point = box.centre;
    for (int axis = 0; axis < 3; ++axis)
    {
      point += (corner >> axis & 1 ? 1.0 : -1.0) * box.halfAxes[static_cast<std::size_t>(axis)];
    }
    mesh.points.push_back(point);
  }
  mesh.triangles = { { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 }, { 5, 7, 6 }, { 0, 1, 4 }, { 1, 5, 4 },
    { 2, 6, 3 }, { 3, 6, 7 }, { 0, 4, 2 }, { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 } };
  return mesh;
}

/// The same by a mesh.
inline MediumVolume meshOf(const MediumVolume& box)
{
  MediumVolume mesh = box;
  mesh.shape = MediumShape::Surface;
  mesh.surface =
    buildCollisionTree(std::make_shared<TriangleMesh>(trianglesOf(box)), TreeOptions{}, {}, 1);
  return mesh;
}

inline ScanSetup inMedium(const Scene& scene, Sensor sensor, const Medium& medium,
  const MediumVolume& volume, bool cells = true)
{
  ScanSetup setup = makeSetup(scene, sensor, cells ? inCells(400) : directSettings(400));
  setup.media = { { medium, volume } };
  planModel(setup);
  return setup;
}

inline Scene wallAt(double x, double from = -50.0, double to = 50.0)
{
  Scene scene;
  scene.plate(Vec3(x, 0.5 * (from + to), 0.0), Vec3(0.0, 0.5 * (to - from), 0.0),
    Vec3(0.0, 0.0, 50.0), Wall, 7);
  return scene;
}
}

#endif
