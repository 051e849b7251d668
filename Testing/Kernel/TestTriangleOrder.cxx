// SPDX-License-Identifier: BSD-3-Clause
// However triangles are given, they come in one order.
#include "TriangleOrder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

using namespace avianlidar;

namespace
{
/// Triangles and object ids in a shuffled order, each with points of its own.
struct Shuffled
{
  Shuffled(const TriangleMesh& mesh, const std::vector<int>& ofObjects,
    const std::vector<int>& ofMaterials, unsigned seed)
  {
    std::vector<std::uint32_t> order(mesh.size());
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    for (const std::uint32_t t : order)
    {
      const auto first = static_cast<std::uint32_t>(this->of.points.size());
      for (int c = 0; c < 3; ++c)
      {
        this->of.points.push_back(mesh.corner(t, c));
      }
      this->of.triangles.push_back({ first, first + 1, first + 2 });
      this->objects.push_back(ofObjects[t]);
      this->materials.push_back(ofMaterials[t]);
    }
    const std::vector<std::uint32_t> sorted =
      triangleOrder(this->of, this->objects, this->materials);
    reorder(this->of.triangles, sorted);
    reorder(this->objects, sorted);
    reorder(this->materials, sorted);
  }
  TriangleMesh of;
  std::vector<int> objects, materials;
};
}

TEST(TriangleOrder, DoesNotDependOnTheOrderGiven)
{
  std::mt19937 random(7);
  for (const double size : { 0.0, 1e-30, 1.0, 1e29 })
  {
    TriangleMesh mesh;
    std::vector<int> objects, materials;
    for (std::uint32_t t = 0; t < 300; ++t)
    {
      for (int c = 0; c < 3; ++c)
      {
        // Few places, so that centroids coincide.
        const auto at = [&]() { return size * static_cast<double>(random() % 4); };
        mesh.points.emplace_back(at(), at(), at());
      }
      mesh.triangles.push_back({ 3 * t, 3 * t + 1, 3 * t + 2 });
      objects.push_back(static_cast<int>(random() % 3));
      materials.push_back(static_cast<int>(random() % 2));
    }
    // The same triangles again, of other materials.
    for (std::uint32_t t = 0; t < 100; ++t)
    {
      mesh.triangles.push_back(mesh.triangles[t]);
      objects.push_back(objects[t]);
      materials.push_back(1 - materials[t]);
    }
    const Shuffled one(mesh, objects, materials, 1);
    EXPECT_TRUE(std::is_sorted(one.objects.begin(), one.objects.end()));
    EXPECT_TRUE(triangleOrder(one.of, one.objects, one.materials).empty());
    for (const unsigned seed : { 2u, 3u })
    {
      const Shuffled other(mesh, objects, materials, seed);
      EXPECT_EQ(one.objects, other.objects);
      EXPECT_EQ(one.materials, other.materials);
      for (std::uint32_t t = 0; t < mesh.size(); ++t)
      {
        for (int c = 0; c < 3; ++c)
        {
          EXPECT_EQ(one.of.corner(t, c), other.of.corner(t, c)) << size << " " << t;
        }
      }
    }
  }
}
