// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ApexTriangles.h
 * @brief Triangles seen from one apex, prepared for the single-precision tests of packets: scaled
 * edge vectors and planes, computed once and kept in a table.
 *
 * Unless the sensor moves, all beams of a scan begin at one point. Neighbouring beams meet the same
 * triangles. The table has 8192 places. The place of a triangle follows from the triangle's
 * position in the tree's order. A later triangle replaces an earlier triangle in the same place. A
 * record fills one cache line. The table fills much of a core's second-level cache. Preparing eight
 * triangles takes about as long as testing 64 rays against a few triangles.
 *
 * Source: none; the bounds are derived in RayPacketTriangles.h.
 * Valid: any triangle. Where the bounds decide nothing (`inside` is infinite, or an edge vector is
 * 0), the exact functions of TriangleTest.h decide.
 * Test: TestApexTriangles.cxx, TestRayPacket.cxx.
 */
#ifndef avianlidar_ApexTriangles_h
#define avianlidar_ApexTriangles_h

#include "BeamFrame.h"
#include "CollisionTree.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// A prepared triangle; symbols as in RayPacketTriangles.h.
struct alignas(64) ApexTriangle
{
  float edge[3][3];       ///< scaled edge vectors E; a ray with e < -1 at one edge misses
  float w[3];             ///< vector W of the plane
  float error;            ///< bound of the error of w
  float inside;           ///< limit: a ray with e >= inside at all edges hits; infinity: undecided
  std::uint32_t number;   ///< number of the triangle in the mesh
  std::uint32_t position; ///< position in the tree's order
};

/// Corners of several triangles relative to the apex, m.
struct alignas(64) ApexCorners
{
  static constexpr int Width = 8;
  double corner[3][3][Width] = {}; ///< coordinates by corner, axis and triangle, m
};

/// The triangles of a tree seen from one apex.
class ApexTriangles
{
public:
  static constexpr int Batch = ApexCorners::Width;

  /// Clear the table if its records are for another tree or apex, or only for narrower beams.
  /// @param widest beam of the packet with the largest half-beamwidth
  void begin(const CollisionTree& tree, const BeamFrame& widest);

  /// The record at a position of the tree's order; null if it is not in the table.
  const ApexTriangle* find(std::uint32_t position) const
  {
    const ApexTriangle& place = this->Table[position % Places];
    return place.position == position ? &place : nullptr;
  }

  /// Prepare records of `count` triangles, at most Batch, in `fresh`.
  void see(const std::uint32_t* positions, int count, ApexTriangle* fresh);

  /// Put a record into the table, in place of any other record there.
  void keep(const ApexTriangle& triangle)
  {
    const std::uint32_t number = triangle.position % Places;
    ApexTriangle& place = this->Table[number];
    if (place.position == NoTriangle)
    {
      this->Used.push_back(number);
    }
    place = triangle;
  }

private:
  float errorOfOwner(std::uint32_t position, const float* w) const;

  static constexpr std::uint32_t Places = 8192;

  std::vector<ApexTriangle> Table;
  std::vector<std::uint32_t> Used; ///< occupied places, so that begin() clears only these
  ApexCorners Corners;             ///< workspace of see()
  const CollisionTree* Tree = nullptr;
  Vec3 Apex{ 0.0 };
  double Tangent = 0.0; ///< tangent of the largest half-beamwidth
};
}

#endif
