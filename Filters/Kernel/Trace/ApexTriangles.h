// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ApexTriangles.h
 * @brief What single precision needs to know of the triangles that are seen from one apex, found
 * once and kept.
 *
 * All beams of a scan begin at one point, and neighbouring beams meet the same triangles. So edge
 * vectors and planes are not made for every packet anew: the last ones are kept in a table in which
 * every triangle of the tree's order has one place.
 *
 * Cost: what eight triangles take is about what the tests of sixty-four rays with a few of them
 * take; a record fills one line of the cache, the table a good part of a core's second-level cache.
 */
#ifndef avianlidar_ApexTriangles_h
#define avianlidar_ApexTriangles_h

#include "BeamFrame.h"
#include "CollisionTree.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// See RayPacketTriangles.h.
struct alignas(64) ApexTriangle
{
  float edge[3][3];       ///< edge; x, y, z: the ray surely passes outside below -1
  float w[3];             ///< plane
  float error;            ///< of the inverse range
  float inside;           ///< edges at least: surely inside; infinity: bounds say nothing
  std::uint32_t number;   ///< of the triangle
  std::uint32_t position; ///< in the tree's order
};

/// Corners of several triangles relative to the apex, m.
struct alignas(64) ApexCorners
{
  static constexpr int Width = 8;
  double corner[3][3][Width] = {}; ///< corner, coordinate
};

/// The triangles of a tree seen from one apex.
class ApexTriangles
{
public:
  static constexpr int Batch = ApexCorners::Width;

  /// Forget what belongs to another tree or apex, or to narrower beams only. @param widest the beam
  /// of the largest half-beamwidth of those that look
  void begin(const CollisionTree& tree, const BeamFrame& widest);

  /// The triangle at a position of the tree's order if it is known; null if not.
  const ApexTriangle* find(std::uint32_t position) const
  {
    const ApexTriangle& place = this->Table[position % Places];
    return place.position == position ? &place : nullptr;
  }

  /// Find out about `count` triangles, at most Batch, into `fresh`.
  void see(const std::uint32_t* positions, int count, ApexTriangle* fresh);

  /// Keep it in the place of another.
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
  static constexpr std::uint32_t Places = 8192;

  std::vector<ApexTriangle> Table;
  std::vector<std::uint32_t> Used; ///< places, so that few are to be cleared where apexes are many
  ApexCorners Corners;             ///< of the triangles that are looked at
  const CollisionTree* Tree = nullptr;
  Vec3 Apex{ 0.0 };
  double Tangent = 0.0; ///< of the largest half-beamwidth
};
}

#endif
