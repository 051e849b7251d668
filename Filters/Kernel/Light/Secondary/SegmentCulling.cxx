// SPDX-License-Identifier: BSD-3-Clause
#include "SegmentCulling.h"

#include "Multiversion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Points farther from the axis than so many radii of the beam have q = 0.
constexpr double Widest = 1.5;

/// So have points nearer than this, over the distance of the farthest start of a segment.
constexpr double Nearest = 1e-4;

/// Rounding of the weighted mean of an edge function, relative to the weights: 4 u from products
/// and sums (u = 2^-24), four times over.
constexpr float WeightNoise = 16.0f * static_cast<float>(RoundOffSingle);

/// Rounding of an evaluation, with that of its inputs.
constexpr double EvaluationNoise = 8.0 * RoundOffSingle;

/// True if one of the bytes of a block is zero.
AVIANLIDAR_ALWAYS_INLINE bool anyOpen(const std::uint8_t* bytes)
{
  static_assert(SegmentCulling::Lanes == 16, "two times eight");
  return anyZero(eightOf(bytes)) || anyZero(eightOf(bytes + 8));
}

AVIANLIDAR_ALWAYS_INLINE double sumOf(double x, double y, double z)
{
  return (std::fabs(x) + std::fabs(y)) + std::fabs(z);
}

AVIANLIDAR_ALWAYS_INLINE double noiseOf(double x, double y, double z)
{
  return EvaluationNoise * ((Widest * std::fabs(x) + Widest * std::fabs(y)) + std::fabs(z));
}

/// The inverse of the largest of three, or 1 if they are zero.
AVIANLIDAR_ALWAYS_INLINE double scaleFor(double x, double y, double z)
{
  const double ax = std::fabs(x);
  const double ay = std::fabs(y);
  const double az = std::fabs(z);
  const double xy = ax > ay ? ax : ay;
  const double largest = xy > az ? xy : az;
  return 1.0 / (largest > 0.0 ? largest : 1.0);
}

/// edgeVector() of TriangleTest.h in one lane.
AVIANLIDAR_ALWAYS_INLINE void edgeOf(double ax, double ay, double az, double bx, double by,
  double bz, double& ex, double& ey, double& ez, double& spread)
{
  const double dx = ax - bx;
  const double dy = ay - by;
  const double dz = az - bz;
  const double mx = ax + bx;
  const double my = ay + by;
  const double mz = az + bz;
  ex = dy * mz - dz * my;
  ey = dz * mx - dx * mz;
  ez = dx * my - dy * mx;
  spread = sumOf(dy * mz, dz * mx, dx * my) + sumOf(dz * my, dx * mz, dy * mx);
}

/// Values shared by the coefficients of all triangles of a beam.
struct PlaneMaker
{
  double e1x, e1y, e1z, e2x, e2y, e2z, wx, wy, wz; ///< e1 and e2 times tan(theta0.5), and the axis
  double spreadNoise;
  double most; ///< 1/m, of q

  /// Coefficients of the plane through the apex and a side, moved outwards.
  AVIANLIDAR_ALWAYS_INLINE void side(double sign, double ex, double ey, double ez, double spread,
    double reach, double& a, double& b, double& c) const
  {
    const double x = (ex * this->e1x + ey * this->e1y) + ez * this->e1z;
    const double y = (ex * this->e2x + ey * this->e2y) + ez * this->e2z;
    const double z = (ex * this->wx + ey * this->wy) + ez * this->wz;
    const double scale = scaleFor(x, y, z);
    const double off = 4.0 * HitMargin * reach;
    // The sign is that of a determinant: where its rounding decides, that is added.
    const double tolerance = (noiseOf(x, y, z) + this->spreadNoise * spread) +
      this->most * (sumOf(ex, ey, ez) * off + 64.0 * RoundOffDouble * spread * reach);
    a = sign * scale * x;
    b = sign * scale * y;
    c = scale * (sign * z + 1.0001 * tolerance);
  }
};
}

void SegmentCulling::set(
  const BeamFrame& frame, double farthest, const Corners& corners, std::size_t count)
{
  this->Frame = frame;
  this->LeastDepth = Nearest * farthest;
  this->Count = count;
  const std::size_t blocks = (count + Lanes - 1) / Lanes;
  if (this->Blocks.size() < blocks)
  {
    this->Blocks.resize(blocks);
  }
  planesOf(corners, BeamPlaneMap(frame), 1.0 / this->LeastDepth, this->Blocks.data(), blocks);
}

AVIANLIDAR_MULTIVERSION void SegmentCulling::planesOf(
  const Corners& corners, const BeamPlaneMap& beam, double most, Block* blocks, std::size_t count)
{
  const Corners t = corners;
  const PlaneMaker make{ beam.e1.x, beam.e1.y, beam.e1.z, beam.e2.x, beam.e2.y, beam.e2.z,
    beam.axis.x, beam.axis.y, beam.axis.z, 2.0 * beam.spreadFactor, most };
  for (std::size_t k = 0; k < count; ++k)
  {
    Block& block = blocks[k];
    // In double precision first: one width of lanes in a loop.
    double out[Block::Rows][Lanes];
#pragma omp simd
    for (std::size_t i = 0; i < Lanes; ++i)
    {
      const std::size_t n = k * Lanes + i;
      const double reach = t.reach[n];
      const double ax = t.c[0][n];
      const double ay = t.c[1][n];
      const double az = t.c[2][n];
      const double bx = t.c[3][n];
      const double by = t.c[4][n];
      const double bz = t.c[5][n];
      const double cx = t.c[6][n];
      const double cy = t.c[7][n];
      const double cz = t.c[8][n];
      double ex, ey, ez, spread;
      edgeOf(ax, ay, az, bx, by, bz, ex, ey, ez, spread);
      const double sign = (cx * ex + cy * ey) + cz * ez < 0.0 ? -1.0 : 1.0;
      double u, v, w;
      make.side(sign, ex, ey, ez, spread, reach, u, v, w);
      out[Block::Side][i] = u;
      out[Block::Side + 1][i] = v;
      out[Block::Side + 2][i] = w;
      edgeOf(bx, by, bz, cx, cy, cz, ex, ey, ez, spread);
      make.side(sign, ex, ey, ez, spread, reach, u, v, w);
      out[Block::Side + 3][i] = u;
      out[Block::Side + 4][i] = v;
      out[Block::Side + 5][i] = w;
      edgeOf(cx, cy, cz, ax, ay, az, ex, ey, ez, spread);
      make.side(sign, ex, ey, ez, spread, reach, u, v, w);
      out[Block::Side + 6][i] = u;
      out[Block::Side + 7][i] = v;
      out[Block::Side + 8][i] = w;
    }
#pragma omp simd
    for (std::size_t i = 0; i < Lanes; ++i)
    {
      const std::size_t n = k * Lanes + i;
      const double reach = t.reach[n];
      const double off = 4.0 * HitMargin * reach;
      const double ax = t.c[0][n];
      const double ay = t.c[1][n];
      const double az = t.c[2][n];
      const double ux = t.c[3][n] - ax;
      const double uy = t.c[4][n] - ay;
      const double uz = t.c[5][n] - az;
      const double vx = t.c[6][n] - ax;
      const double vy = t.c[7][n] - ay;
      const double vz = t.c[8][n] - az;
      const double nx = uy * vz - uz * vy;
      const double ny = uz * vx - ux * vz;
      const double nz = ux * vy - uy * vx;
      const double x = (nx * make.e1x + ny * make.e1y) + nz * make.e1z;
      const double y = (nx * make.e2x + ny * make.e2y) + nz * make.e2z;
      const double z = (nx * make.wx + ny * make.wy) + nz * make.wz;
      const double height = (nx * ax + ny * ay) + nz * az;
      const double scale = scaleFor(x, y, z);
      out[Block::Plane][i] = scale * x;
      out[Block::Plane + 1][i] = scale * y;
      out[Block::Plane + 2][i] = scale * z;
      out[Block::Plane + 3][i] = scale * height;
      out[Block::Tolerance][i] = 1.0001 * scale *
        (noiseOf(x, y, z) +
          make.most *
            (sumOf(nx, ny, nz) * off +
              64.0 * RoundOffDouble * sumOf(ux, uy, uz) * sumOf(vx, vy, vz) * reach));
      out[Block::Tolerance + 1][i] = 1.0001 * scale * EvaluationNoise * std::fabs(height);
      const double za = (ax * make.wx + ay * make.wy) + az * make.wz;
      const double du = (ux * make.wx + uy * make.wy) + uz * make.wz;
      const double dv = (vx * make.wx + vy * make.wy) + vz * make.wz;
      const double deep = du > dv ? du : dv;
      const double near = du < dv ? du : dv;
      const double behind = (za + (deep > 0.0 ? deep : 0.0)) + off;
      const double before = (za + (near < 0.0 ? near : 0.0)) - off;
      constexpr double none = std::numeric_limits<double>::infinity();
      out[Block::Behind][i] = behind > 0.0 ? (1.0 - 1e-6) / behind : none;
      out[Block::Before][i] = before > 0.0 ? (1.0 + 1e-6) / before : none;
    }
    for (int row = 0; row < Block::Rows; ++row)
    {
      for (std::size_t i = 0; i < Lanes; ++i)
      {
        block.rows[row][i] = static_cast<float>(out[row][i]);
      }
    }
  }
}

AVIANLIDAR_MULTIVERSION void SegmentCulling::codesOf(const Block* blocks, std::size_t count,
  const Point& point, const std::uint8_t* closed, std::uint8_t* codes)
{
  const float x = point.x;
  const float y = point.y;
  const float q = point.q;
  for (std::size_t k = 0; k < count; ++k)
  {
    if (!anyOpen(closed + k * Lanes))
    {
      continue;
    }
    const Block& b = blocks[k];
    std::uint8_t* const out = codes + k * Lanes;
    std::int32_t code[Lanes];
#pragma omp simd
    for (std::size_t i = 0; i < Lanes; ++i)
    {
      const float side0 =
        (b.rows[Block::Side][i] * x + b.rows[Block::Side + 1][i] * y) + b.rows[Block::Side + 2][i];
      const float side1 = (b.rows[Block::Side + 3][i] * x + b.rows[Block::Side + 4][i] * y) +
        b.rows[Block::Side + 5][i];
      const float side2 = (b.rows[Block::Side + 6][i] * x + b.rows[Block::Side + 7][i] * y) +
        b.rows[Block::Side + 8][i];
      const float height = (b.rows[Block::Plane][i] * x + b.rows[Block::Plane + 1][i] * y) +
        (b.rows[Block::Plane + 2][i] - b.rows[Block::Plane + 3][i] * q);
      const float tolerance = b.rows[Block::Tolerance][i] + b.rows[Block::Tolerance + 1][i] * q;
      const int sides = (side0 < 0.0f ? 1 : 0) | (side1 < 0.0f ? 2 : 0) | (side2 < 0.0f ? 4 : 0);
      const int plane = (height > tolerance ? 8 : 0) | (height < -tolerance ? 16 : 0);
      const int depth =
        (q < b.rows[Block::Behind][i] ? 32 : 0) | (q > b.rows[Block::Before][i] ? 64 : 0);
      code[i] = sides | plane | depth;
    }
    for (std::size_t i = 0; i < Lanes; ++i)
    {
      out[i] = static_cast<std::uint8_t>(code[i]);
    }
  }
}

// Let h1 and h2 be the exact heights of the ends, t1 and t2 the tolerances there. A segment that
// hits the triangle has a point A p + B r, A and B >= 0, in which no edge function, moved outwards,
// is negative and whose height is within its tolerance: |A h1 + B h2| <= A t1 + B t2, as height and
// tolerance are linear along the segment. The heights worked out, g1 >= g2 say, are off by t1 and
// t2 at most, so |A g1 + B g2| <= 2 (A t1 + B t2). Then there is a factor k >= 0 for which k A is
// within 2 t2 of the weight max(0, -g2), and k B within 2 t1 of the weight max(0, g1). The mean of
// an edge function s with the weights is therefore not below -2 (t2 |s1| + t1 |s2|), its mean with
// k A and k B not being negative. The third tolerance stands for the rounding of all this.
AVIANLIDAR_MULTIVERSION void SegmentCulling::cullAll(const Block* blocks, std::size_t count,
  const Point& pointOne, const Point& pointTwo, std::uint8_t* missed)
{
  const Point p = pointOne;
  const Point r = pointTwo;
  for (std::size_t k = 0; k < count; ++k)
  {
    std::uint8_t* const out = missed + k * Lanes;
    if (!anyOpen(out))
    {
      continue;
    }
    const Block& b = blocks[k];
    std::int32_t misses[Lanes];
#pragma omp simd
    for (std::size_t i = 0; i < Lanes; ++i)
    {
      const float height1 = (b.rows[Block::Plane][i] * p.x + b.rows[Block::Plane + 1][i] * p.y) +
        (b.rows[Block::Plane + 2][i] - b.rows[Block::Plane + 3][i] * p.q);
      const float height2 = (b.rows[Block::Plane][i] * r.x + b.rows[Block::Plane + 1][i] * r.y) +
        (b.rows[Block::Plane + 2][i] - b.rows[Block::Plane + 3][i] * r.q);
      // Heights of the ends have opposite signs, but for rounding.
      const float turned1 = height1 < height2 ? -height1 : height1;
      const float turned2 = height1 < height2 ? height2 : -height2;
      const float weight2 = turned1 > 0.0f ? turned1 : 0.0f;
      const float weight1 = turned2 > 0.0f ? turned2 : 0.0f;
      const float noise2 =
        3.0f * (b.rows[Block::Tolerance][i] + b.rows[Block::Tolerance + 1][i] * p.q) +
        WeightNoise * weight2;
      const float noise1 =
        3.0f * (b.rows[Block::Tolerance][i] + b.rows[Block::Tolerance + 1][i] * r.q) +
        WeightNoise * weight1;
      std::int32_t miss = 0;
      for (int s = 0; s < 3; ++s)
      {
        const float side1 =
          (b.rows[Block::Side + 3 * s][i] * p.x + b.rows[Block::Side + 3 * s + 1][i] * p.y) +
          b.rows[Block::Side + 3 * s + 2][i];
        const float side2 =
          (b.rows[Block::Side + 3 * s][i] * r.x + b.rows[Block::Side + 3 * s + 1][i] * r.y) +
          b.rows[Block::Side + 3 * s + 2][i];
        const float mean = (weight1 * side1 + weight2 * side2) +
          (noise1 * std::fabs(side1) + noise2 * std::fabs(side2));
        miss |= mean < 0.0f ? 0xff : 0;
      }
      misses[i] = miss;
    }
    for (std::size_t i = 0; i < Lanes; ++i)
    {
      out[i] = static_cast<std::uint8_t>(out[i] | misses[i]);
    }
  }
}

SegmentCulling::Point SegmentCulling::project(const Vec3& point) const
{
  const Vec3 p = this->Frame.toPlane(point);
  const double most = Widest * p.z;
  const bool valid = p.z > this->LeastDepth && std::fabs(p.x) < most && std::fabs(p.y) < most &&
    p.z < std::numeric_limits<double>::infinity();
  return valid ? Point{ static_cast<float>(p.x / p.z), static_cast<float>(p.y / p.z),
    static_cast<float>(1.0 / p.z) }
               : Point{ 0.0f, 0.0f, 0.0f };
}

void SegmentCulling::code(const Point& point, const std::uint8_t* closed, std::uint8_t* codes) const
{
  if (point.q > 0.0f)
  {
    codesOf(this->Blocks.data(), this->stride() / Lanes, point, closed, codes);
  }
  else
  {
    std::fill(codes, codes + this->stride(), std::uint8_t{ 0 });
  }
}

void SegmentCulling::cull(const Point& one, const Point& two, std::uint8_t* missed) const
{
  if (one.q > 0.0f && two.q > 0.0f)
  {
    cullAll(this->Blocks.data(), this->stride() / Lanes, one, two, missed);
  }
}
}
