// SPDX-License-Identifier: BSD-3-Clause
// Scenes of many triangles in one beam, and what its cells show.
#ifndef CellTestScene_h
#define CellTestScene_h

#include "BeamCells.h"
#include "EchoTestScene.h"
#include "FoundPolygons.h"
#include "GeometryTestScene.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace celltest
{
using namespace echotest;
using geometrytest::Numbers;

const Material Matt{ 0.5, 0.0, 1.0 };

/// Add a plate of parts x parts quadrilaterals.
inline void fine(Scene& scene, const Vec3& center, const Vec3& u, const Vec3& v, int parts,
  const Material& m, int object)
{
  for (int i = 0; i < parts; ++i)
  {
    for (int j = 0; j < parts; ++j)
    {
      const double a = (2.0 * i + 1.0) / parts - 1.0;
      const double b = (2.0 * j + 1.0) / parts - 1.0;
      scene.plate(center + a * u + b * v, u / double(parts), v / double(parts), m, object);
    }
  }
}

inline Scene fineWall(int parts = 12, const Vec3& tilt = Vec3(0.0, 2.0, 0.0))
{
  Scene scene;
  fine(scene, Vec3(100.0, 0.0, 0.0), tilt, Vec3(0.0, 0.0, 2.0), parts, Matt, 1);
  return scene;
}

/// Slats, boxes and a wall at random in a beam along x.
inline Scene clutter(int seed)
{
  Numbers random(seed);
  Scene scene;
  for (int k = 0; k < 60; ++k)
  {
    const Vec3 at(random(80.0, 160.0), random(-0.9, 0.9), random(-0.9, 0.9));
    const Vec3 half(random(0.01, 0.3), random(0.01, 0.3), random(0.01, 0.3));
    scene.box(at, half, Matt, k);
  }
  fine(scene, Vec3(150.0, 0.0, 0.0), Vec3(random(0.0, 8.0), 4.0, 0.0), Vec3(0.0, 0.0, 4.0), 3, Wall,
    100);
  return scene;
}

/// Share of the pulse that the cells of a beam along x show of an object.
inline double shareInCells(const Scene& scene, const Sensor& sensor, int seed, int object)
{
  const ScanSetup setup = makeSetup(scene, sensor, inCells(100, seed));
  const BeamFrame frame =
    makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), BeamWidth(sensor.halfBeamwidth));
  FoundPolygons found(*setup.tree, 0, MostTrianglesOfCells);
  EXPECT_EQ(found.find(frame), SeenByBeam::TooMuch);
  const std::unique_ptr<CellSamples> cells =
    BeamCells(setup, found.scene()).find(0, frame, found.candidates());
  double sum = 0.0;
  cells->samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      for (; begin < end; ++begin)
      {
        sum += setup.objectIds[triangle] == object ? cells->samples.weight[begin] : 0.0;
      }
    });
  return sum;
}
}

#endif
