// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SegmentCulling.h
 * @brief Excludes triangles that a segment within a beam cannot meet, from where its ends lie.
 *
 * A triangle lies on one side of seven planes: the three through the apex and one of its sides, its
 * own plane from either side, and two across the axis, behind and before it. The code of a point
 * has a bit for each plane that the point lies beyond, by more than all rounding. A segment misses
 * the triangle if the codes of its ends have a bit in common.
 *
 * Where many triangles are left, as for long segments among small triangles, both ends are used
 * together. With g1 and g2 the heights of the ends above the plane of a triangle, |g1| and |g2| are
 * the weights of the other end in the point where the segment crosses it. Every edge function of
 * the triangle, being linear, has there the mean with these weights: if one is negative, the
 * segment misses.
 *
 * All is computed in single precision in the beam's own plane, as (x, y) and the inverse of the
 * depth, in which the functions of all planes are linear up to a positive factor. The codes of a
 * point for 16 triangles cost about a hundredth of a descent of the tree, for any number of
 * segments that end there; two codes are compared for eight triangles at a time; cull() for a
 * segment and 16 triangles costs twice as much as the codes of a point.
 *
 * Source: outcodes of Cohen and Sutherland (Newman, Sproull, "Principles of Interactive Computer
 * Graphics", 1973); cull() is Eq. 16 of the paper.
 * Differs: in cull() the segment stands for the ray, and edges are seen from the apex.
 * Valid: conservative; the exact test decides on what is left, so hits do not depend on the
 * culling. A hit lies off its triangle by at most HitMargin times the farthest coordinate
 * (TriangleTest.h). The planes are moved outwards by four times that, by the rounding of their
 * coefficients in double precision, and by that of the evaluation in single precision.
 * Test: TestSegmentCulling.cxx, TestPathSpace.cxx.
 */
#ifndef avianlidar_SegmentCulling_h
#define avianlidar_SegmentCulling_h

#include "BeamFrame.h"
#include "TriangleTest.h"

#include <cstdint>
#include <cstring>
#include <vector>

namespace avianlidar
{
/// Eight codes as one number.
inline std::uint64_t eightOf(const std::uint8_t* codes)
{
  std::uint64_t eight;
  std::memcpy(&eight, codes, sizeof eight);
  return eight;
}

/// True if one of eight bytes is zero.
inline bool anyZero(std::uint64_t eight)
{
  return ((eight - 0x0101010101010101u) & ~eight & 0x8080808080808080u) != 0;
}

/// Triangles of one beam after the other. Reusable without allocation; one per thread.
class SegmentCulling
{
public:
  static constexpr std::size_t Lanes = 16;

  /// Corners of triangles relative to the apex, m, in lanes: a, b, c; and for each triangle the
  /// farthest coordinate from the apex, that of all starts of segments included. All are readable
  /// up to a multiple of Lanes.
  struct Corners
  {
    const double* c[9];
    const double* reach;
  };

  /// Set the triangles. @param farthest distance of the farthest start of a segment from the apex,
  /// m
  void set(const BeamFrame& frame, double farthest, const Corners& corners, std::size_t count);

  std::size_t size() const { return this->Count; }

  /// Bytes of a row of codes, one for each triangle, padded to a multiple of Lanes. Those beyond
  /// size() have no meaning.
  std::size_t stride() const { return (this->Count + Lanes - 1) / Lanes * Lanes; }

  /// A point at depth 1/q along the axis; q = 0: its codes are 0.
  struct Point
  {
    float x, y, q;
  };

  /// Project a point. @param point relative to the apex, m
  Point project(const Vec3& point) const;

  /// Codes of a point: stride() bytes. @param closed blocks of triangles whose bytes here are all
  /// 0xff are skipped
  void code(const Point& point, const std::uint8_t* closed, std::uint8_t* codes) const;

  /// Use both ends of a segment: of the bytes that are zero, set those of triangles that it misses.
  /// @param missed stride() bytes
  void cull(const Point& one, const Point& two, std::uint8_t* missed) const;

private:
  /// Functions of a point (x, y, q) at depth 1/q, one row of sixteen triangles for each
  /// coefficient.
  struct alignas(64) Block
  {
    enum Row
    {
      Side = 0,       ///< a x + b y + c, negative beyond the side; three times
      Plane = 9,      ///< a x + b y + c - d q
      Tolerance = 13, ///< tolerance of the plane: a + b q
      Behind = 15,    ///< q of the farthest corner, 1/m
      Before = 16,    ///< q of the nearest corner, 1/m
      Rows = 17
    };
    float rows[Rows][Lanes];
  };
  static void planesOf(const Corners& corners, const BeamPlaneMap& beam, double most, Block* blocks,
    std::size_t count);
  static void codesOf(const Block* blocks, std::size_t count, const Point& point,
    const std::uint8_t* closed, std::uint8_t* codes);
  static void cullAll(const Block* blocks, std::size_t count, const Point& pointOne,
    const Point& pointTwo, std::uint8_t* missed);

  BeamFrame Frame;
  double LeastDepth = 0.0; ///< m; points nearer than that have q = 0
  std::size_t Count = 0;
  std::vector<Block> Blocks;
};
}

#endif
