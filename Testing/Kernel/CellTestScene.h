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

/// What the cells of a beam along x show.
class SeenInCells
{
public:
  explicit SeenInCells(const ScanSetup& setup)
    : SeenInCells(
        setup, makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), BeamWidth(setup.sensor.halfBeamwidth)))
  {
  }

  SeenInCells(const ScanSetup& setup, const BeamFrame& frame)
    : Setup(setup)
    , Found(*setup.tree, 0, MostTrianglesOfCells)
  {
    EXPECT_EQ(this->Found.find(frame), SeenByBeam::TooMuch);
    this->shares.resize(setup.tree->mesh->size(), 0.0);
    const std::unique_ptr<CellSamples> found =
      BeamCells(setup, this->Found.scene()).find(0, frame, this->Found.candidates());
    found->samples.forEachSurface(
      [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
      {
        for (; begin < end; ++begin)
        {
          this->shares[triangle] += found->samples.weight[begin];
        }
      });
  }

  double ofObject(int id) const
  {
    double sum = 0.0;
    for (std::size_t t = 0; t < this->shares.size(); ++t)
    {
      sum += this->Setup.objectIds[t] == id ? this->shares[t] : 0.0;
    }
    return sum;
  }

  std::vector<double> shares; ///< share of the pulse on each triangle

private:
  const ScanSetup& Setup;
  FoundPolygons Found;
};
}

#endif
