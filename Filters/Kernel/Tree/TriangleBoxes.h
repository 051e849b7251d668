// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TriangleBoxes.h
 * @brief Boxes of triangles in single precision, in SIMD lanes, from which trees are built.
 *
 * Coordinates are relative to the middle of the scene and rounded outwards. Lower coordinates are
 * negated, so two boxes are merged by taking the larger number in each lane.
 *
 * Source: the primitive references of I. Wald, "On fast Construction of SAH-based Bounding Volume
 * Hierarchies", 2007.
 * Differs: lower coordinates are negated, and a box holds its triangle's number.
 * Valid: finite coordinates up to MaximumCoordinate, at most 2^31 - 1 triangles. Other meshes are
 * refused. Every box holds its triangle, rounding included.
 * Test: TestSplitRule.cxx, TestWideTree.cxx.
 */
#ifndef avianlidar_TriangleBoxes_h
#define avianlidar_TriangleBoxes_h

#include "AABB.h"
#include "Multiversion.h"
#include "ParallelLoop.h"
#include "TriangleMesh.h"

#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>

namespace avianlidar
{
/// Four numbers in one register, on every target of GCC and Clang. Plain loops over four numbers
/// build the same trees in 1.7 to 1.85 times the time (complete Hongqiao airport, rolling ground
/// and a sphere of a million triangles, on one thread and on two threads, GCC 12). The library
/// Highway is scalar code on plain x86-64 without its dispatch. With its dispatch, every loop of
/// the builder would need a separate form.
using Lanes = float __attribute__((vector_size(16)));

AVIANLIDAR_ALWAYS_INLINE Lanes larger(Lanes a, Lanes b)
{
  return a > b ? a : b;
}

/// Upper bound of all numbers whose nearest float is `nearest`.
AVIANLIDAR_ALWAYS_INLINE Lanes roundedUp(Lanes nearest)
{
  // The product is one or two units in the last place of `nearest`. The constant covers underflow.
  const Lanes size = larger(nearest, -nearest);
  return (nearest + size * std::numeric_limits<float>::epsilon()) + 2e-38f;
}

/// Lanes 0 to 2 hold coordinates, m. Lane 3 holds the triangle's number, with the low half in
/// `below` and the high half in `above`. Lane 3 has no meaning in a box of several triangles.
struct LaneBox
{
  Lanes below; ///< the lower corner, negated
  Lanes above; ///< the upper corner

  AVIANLIDAR_ALWAYS_INLINE void clear()
  {
    constexpr float Nothing = std::numeric_limits<float>::lowest();
    this->below = this->above = Lanes{ Nothing, Nothing, Nothing, Nothing };
  }

  AVIANLIDAR_ALWAYS_INLINE void include(const LaneBox& other)
  {
    this->below = larger(this->below, other.below);
    this->above = larger(this->above, other.above);
  }

  /// Twice the centre, m: comparisons need no halving.
  AVIANLIDAR_ALWAYS_INLINE Lanes twiceCenter() const { return this->above - this->below; }

  /// Half the surface area, m2. Floats cannot hold the areas of a very large or tiny scene.
  AVIANLIDAR_ALWAYS_INLINE double halfArea() const
  {
    const Lanes size = this->above + this->below;
    const double x = size[0];
    const double y = size[1];
    const double z = size[2];
    return x * y + (y + x) * z;
  }

  std::uint32_t triangle() const
  {
    return static_cast<std::uint32_t>(this->below[3]) |
      (static_cast<std::uint32_t>(this->above[3]) << 16);
  }
};

/// Box of a set of triangles, and box of twice their centres.
struct LaneExtent
{
  LaneBox box;
  LaneBox centers;

  AVIANLIDAR_ALWAYS_INLINE void clear()
  {
    this->box.clear();
    this->centers.clear();
  }

  AVIANLIDAR_ALWAYS_INLINE void include(const LaneExtent& other)
  {
    this->box.include(other.box);
    this->centers.include(other.centers);
  }

  AVIANLIDAR_ALWAYS_INLINE void include(const LaneBox* boxes, std::size_t count)
  {
    LaneExtent sum = *this;
    for (std::size_t i = 0; i < count; ++i)
    {
      const Lanes center = boxes[i].twiceCenter();
      sum.include({ boxes[i], { -center, center } });
    }
    *this = sum;
  }
};

/// The boxes of all triangles of a mesh.
struct TriangleBoxes
{
  Vec3 reference{ 0.0 };    ///< middle of the triangles, m
  double extent = 0.0;      ///< largest coordinate relative to the reference, m
  std::size_t count = 0;    ///< number of triangles
  LaneBox* boxes = nullptr; ///< boxes by triangle number; null without triangles or if stopped
  LaneBox* room = nullptr;  ///< workspace for `count` more boxes
  std::unique_ptr<LaneBox, void (*)(void*)> memory{ nullptr, std::free }; ///< owner of both arrays

  /// Box of one triangle.
  LaneBox boxOf(const TriangleMesh& mesh, std::uint32_t triangle) const;
};

/// Throws std::invalid_argument if there are too many triangles, or if a corner is missing, not
/// finite or beyond MaximumCoordinate. The message names the first such triangle.
TriangleBoxes makeTriangleBoxes(
  const TriangleMesh& mesh, int threads, const KeepGoing& keepGoing = {});
}

#endif
