// SPDX-License-Identifier: BSD-3-Clause
// Beams that hold a direction, against looking at all of them.
#include "BeamDirections.h"
#include "GeometryTestScene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

using namespace avianlidar;

namespace
{
void expectAll(const std::vector<Vec3>& beams, double half, const std::vector<Vec3>& directions)
{
  const BeamDirections finder(beams, half, { 0.01, 0.04 });
  for (const double reach : { 0.0, 0.009, 0.04 })
  {
    const double cosine = std::cos(half + reach);
    std::size_t held = 0;
    for (const Vec3& direction : directions)
    {
      std::vector<std::uint32_t> wanted;
      for (std::uint32_t beam = 0; beam < beams.size(); ++beam)
      {
        if (glm::dot(unitVector(beams[beam]), direction) >= cosine)
        {
          wanted.push_back(beam);
        }
      }
      std::vector<std::uint32_t> found;
      finder.forEachNear(direction, reach,
        [&](std::uint32_t beam, double from)
        {
          if (from >= cosine)
          {
            found.push_back(beam);
          }
        });
      ASSERT_EQ(found, wanted) << half;
      held += wanted.size();
    }
    EXPECT_GT(held, 0u) << half;
  }
}
}

TEST(BeamDirections, AnywhereAndNearBorders)
{
  geometrytest::Numbers random(3);
  for (const double half : { 1e-4, 1.5e-3, 5.6e-3, 0.05, 0.3, 1.0 })
  {
    std::vector<Vec3> beams;
    std::vector<Vec3> directions;
    for (int i = 0; i < 500; ++i)
    {
      beams.push_back(3.0 * random.direction());
      directions.push_back(random.direction());
    }
    // Axes, edges and corners of the cube, and places near them.
    for (int x = -1; x <= 1; ++x)
    {
      for (int y = -1; y <= 1; ++y)
      {
        for (int z = -1; z <= 1; ++z)
        {
          if (x != 0 || y != 0 || z != 0)
          {
            const Vec3 d = unitVector(Vec3(x, y, z));
            beams.push_back(d);
            beams.push_back(unitVector(d + 0.7 * half * random.direction()));
          }
        }
      }
    }
    for (const Vec3& beam : beams)
    {
      for (const double away : { 0.0, 0.5, 0.99, 1.01, 1.5 })
      {
        const Vec3 axis = unitVector(beam);
        const Vec3 across = unitVector(glm::cross(axis, random.direction()));
        directions.push_back(
          unitVector(std::cos(away * half) * axis + std::sin(away * half) * across));
      }
    }
    expectAll(beams, half, directions);
  }
}
