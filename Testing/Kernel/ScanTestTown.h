// SPDX-License-Identifier: BSD-3-Clause
// A town of boxes, a scan of its horizon, and the comparison of two scans bit for bit.
#ifndef ScanTestTown_h
#define ScanTestTown_h

#include "EchoTestScene.h"
#include "SameEchoes.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

namespace echotest
{
/// Boxes of four materials on a ground plane, about the point `at`.
inline Scene town(const Vec3& at = Vec3(0.0), double snap = 0.0)
{
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Material materials[] = { Wall, Glass, Metal, Wood };
  // On the grid that far coordinates have, so that moving the scene rounds nothing.
  const auto grid = [snap](double v) { return snap > 0.0 ? snap * std::round(v / snap) : v; };
  Scene scene;
  scene.plate(at + Vec3(0.0, 0.0, -2.0), Vec3(500.0, 0.0, 0.0), Vec3(0.0, 500.0, 0.0), Wall, 0);
  for (int i = 1; i <= 60; ++i)
  {
    const double angle = 2.0 * Pi * uniform(random);
    const double range = 30.0 + 250.0 * uniform(random);
    const Vec3 half(grid(2.0 + 8.0 * uniform(random)), grid(2.0 + 8.0 * uniform(random)),
      grid(3.0 + 9.0 * uniform(random)));
    const Vec3 center(
      grid(range * std::cos(angle)), grid(range * std::sin(angle)), grid(half.z - 2.0));
    scene.box(at + center, half, materials[i % 4], i);
  }
  return scene;
}

/// Add a wall of so many parts that beams which meet it are divided into cells.
inline void addFineWall(Scene& scene)
{
  for (int i = 0; i < 1200; ++i)
  {
    scene.plate(Vec3(-12.0 + 0.2 * (i % 40), 30.0, 0.2 * (i / 40)), Vec3(0.1, 0.0, 0.0),
      Vec3(0.0, 0.0, 0.1), i % 2 ? Wall : Metal, 100 + i % 3);
  }
}

inline ScanBeams horizon(int columns, int channels, const Vec3& origin = Vec3(0.0))
{
  ScanBeams beams;
  for (int i = 0; i < columns * channels; ++i)
  {
    const double azimuth = 2.0 * Pi * (i / channels) / columns;
    const double elevation = Degree * (i % channels);
    addBeam(beams,
      Vec3(std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
        std::sin(elevation)),
      origin);
  }
  return beams;
}

inline bool sameBits(double a, double b)
{
  return std::memcmp(&a, &b, sizeof(double)) == 0;
}

inline void expectSame(const ScanResult& a, const ScanResult& b)
{
  ASSERT_EQ(a.echoes.size(), b.echoes.size());
  EXPECT_EQ(firstDifference(a, b), a.echoes.size());
}

inline EchoSettings usual()
{
  EchoSettings settings;
  settings.raysPerBeam = 40;
  settings.numberOfConnections = 8;
  return settings;
}
}

#endif
