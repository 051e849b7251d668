// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SegmentCulling.h
 * @brief Which of some triangles a segment within a beam may meet, from what is known of its ends.
 *
 * A triangle lies on one side of seven planes: the three through the apex and one of its sides, its
 * own plane from either side, and two across the axis, behind and before it. The code of a point
 * has a bit for each of them that the point lies beyond, by more than all rounding. A segment
 * misses the triangle if the codes of its ends have a bit in common (the outcodes of Cohen and
 * Sutherland; Newman and Sproull, Principles of Interactive Computer Graphics, 1973). What is left
 * over the exact test decides, so that what a segment hits does not depend on the culling.
 *
 * Where much is left over, as of long segments among small triangles, both ends together tell more.
 * With g1 and g2 the heights of the ends above the plane of a triangle, |g1| and |g2| are the
 * weights of the other end in the point where the segment crosses it, and every edge function of
 * the triangle, being linear, has there the mean with these weights: if one is negative, the
 * segment misses. (The same as Eq. 16 of the paper, with the segment for the ray and edges seen
 * from the apex.)
 *
 * All is worked out in single precision in the beam's own plane, as (x, y) and the inverse of the
 * depth, in which the functions of all planes are linear up to a positive factor. Codes of a
 * point for 16 triangles cost about a hundredth of the descent of a tree, however many segments end
 * there; two codes are compared eight triangles at a time; the closer look at a segment and 16
 * triangles costs twice as much as the codes of a point.
 *
 * A hit lies off its triangle by HitMargin times the farthest coordinate at most (TriangleTest.h).
 * The planes are moved outwards by four times that, by the rounding of their coefficients in double
 * precision, and by that of the evaluation in single precision.
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
/// Eight codes at once.
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

/// Reusable without allocation; one per thread.
class SegmentCulling
{
public:
  static constexpr std::size_t Lanes = 16;

  /// Corners of triangles relative to the apex, m, in lanes: a, b, c; and the farthest coordinate
  /// from the apex of each, and of all beginnings of segments besides. All readable up to a
  /// multiple of Lanes.
  struct Corners
  {
    const double* c[9];
    const double* reach;
  };

  /// @param farthest m, the farthest beginning of a segment from the apex
  void set(const BeamFrame& frame, double farthest, const Corners& corners, std::size_t count);

  std::size_t size() const { return this->Count; }

  /// Bytes of a row of codes, one for each triangle: a multiple of eight. Those beyond size() say
  /// nothing.
  std::size_t stride() const { return (this->Count + Lanes - 1) / Lanes * Lanes; }

  /// A point at depth 1/q along the axis; q = 0: it is not told from triangles.
  struct Point
  {
    float x, y, q;
  };

  /// @param point relative to the apex, m
  Point project(const Vec3& point) const;

  /// Codes of a point: stride() bytes. @param closed blocks of triangles whose bytes here are all
  /// 0xff are left out
  void code(const Point& point, const std::uint8_t* closed, std::uint8_t* codes) const;

  /// A closer look at the segment between two points: of the bytes that are zero set those that
  /// belong to triangles which it misses. @param missed stride() bytes
  void sift(const Point& one, const Point& two, std::uint8_t* missed) const;

private:
  /// Functions of a point (x, y, q) at depth 1/q, one row of sixteen triangles for each
  /// coefficient.
  struct alignas(64) Block
  {
    enum Row
    {
      Side = 0,       ///< a x + b y + c, negative beyond the side; three times
      Plane = 9,      ///< a x + b y + c - d q
      Tolerance = 13, ///< of the plane: a + b q
      Behind = 15,    ///< q of the deepest corner, 1/m
      Before = 16,    ///< q of the nearest corner, 1/m
      Rows = 17
    };
    float rows[Rows][Lanes];
  };
  static void planesOf(const Corners& corners, const BeamPlaneMap& beam, double most, Block* blocks,
    std::size_t count);
  static void codesOf(const Block* blocks, std::size_t count, const Point& point,
    const std::uint8_t* closed, std::uint8_t* codes);
  static void siftAll(const Block* blocks, std::size_t count, const Point& pointOne,
    const Point& pointTwo, std::uint8_t* missed);

  BeamFrame Frame;
  double LeastDepth = 0.0; ///< m: points nearer than that are not told from triangles
  std::size_t Count = 0;
  std::vector<Block> Blocks;
};
}

#endif
