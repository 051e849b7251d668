// SPDX-License-Identifier: BSD-3-Clause
#include "RayPacketTriangles.h"

#include "Multiversion.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
constexpr int Group = PacketGroup;
constexpr int Triangles = PacketTriangles::Width;
constexpr float Infinity = std::numeric_limits<float>::infinity();

AVIANLIDAR_ALWAYS_INLINE float least(float a, float b)
{
  return a < b ? a : b;
}

AVIANLIDAR_ALWAYS_INLINE float most(float a, float b)
{
  return a > b ? a : b;
}

struct PlaneAxes
{
  double px, py, pz, qx, qy, qz, cx, cy, cz;
};

AVIANLIDAR_ALWAYS_INLINE double most(double a, double b)
{
  return a > b ? a : b;
}

AVIANLIDAR_ALWAYS_INLINE double sum(double a, double b, double c)
{
  return std::fabs(a) + std::fabs(b) + std::fabs(c);
}

/// What is worth double precision.
template <typename Real>
struct MovedTriangles
{
  Real edge[3][3][Triangles]; ///< edge; along sigma p, sigma q, c; over `farthest` squared
  Real w[3][Triangles];
  Real slope[Triangles];    ///< error of n . d over |n . a|
  Real farthest[Triangles]; ///< coordinates of a corner at most, m
};

/// A corner relative to the apex, along p, q, c.
struct Moved
{
  double x, y, z;
};

AVIANLIDAR_ALWAYS_INLINE Moved moveCorner(const PlaneAxes& m, double x, double y, double z)
{
  return { x * m.px + y * m.py + z * m.pz, x * m.qx + y * m.qy + z * m.qz,
    x * m.cx + y * m.cy + z * m.cz };
}

AVIANLIDAR_ALWAYS_INLINE void move(
  const PacketPlane& plane, const PacketTriangles& t, MovedTriangles<double>& moved)
{
  const PlaneAxes m{ plane.p.x, plane.p.y, plane.p.z, plane.q.x, plane.q.y, plane.q.z, plane.c.x,
    plane.c.y, plane.c.z };
  const double apexX = plane.apex.x;
  const double apexY = plane.apex.y;
  const double apexZ = plane.apex.z;
  const double sigma = plane.sigma;
#pragma omp simd
  for (int i = 0; i < Triangles; ++i)
  {
    const Moved a = moveCorner(
      m, t.corner[0][0][i] - apexX, t.corner[0][1][i] - apexY, t.corner[0][2][i] - apexZ);
    const Moved b = moveCorner(
      m, t.corner[1][0][i] - apexX, t.corner[1][1][i] - apexY, t.corner[1][2][i] - apexZ);
    const Moved c = moveCorner(
      m, t.corner[2][0][i] - apexX, t.corner[2][1][i] - apexY, t.corner[2][2][i] - apexZ);
    const double farthest = most(sum(a.x, a.y, a.z), most(sum(b.x, b.y, b.z), sum(c.x, c.y, c.z)));
    const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
    const double vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
    const double sx = c.x - b.x, sy = c.y - b.y, sz = c.z - b.z;
    const double longest = most(
      ux * ux + uy * uy + uz * uz, most(vx * vx + vy * vy + vz * vz, sx * sx + sy * sy + sz * sz));
    const double nx = uy * vz - uz * vy;
    const double ny = uz * vx - ux * vz;
    const double nz = ux * vy - uy * vx;
    const double height = nx * a.x + ny * a.y + nz * a.z;
    const double inverse = 1.0 / height;
    const double size = std::fabs(inverse);
    moved.w[0][i] = nx * inverse * sigma;
    moved.w[1][i] = ny * inverse * sigma;
    moved.w[2][i] = nz * inverse;
    moved.slope[i] = 128.0 * RoundOffDouble * std::sqrt(longest) * (farthest * size);
    moved.farthest[i] = farthest;
    const double scale = 1.0 / (farthest * farthest);
    const double turn = height > 0.0 ? scale : -scale;
    const double turnSigma = turn * sigma;
    moved.edge[0][0][i] = (a.y * b.z - a.z * b.y) * turnSigma;
    moved.edge[0][1][i] = (a.z * b.x - a.x * b.z) * turnSigma;
    moved.edge[0][2][i] = (a.x * b.y - a.y * b.x) * turn;
    moved.edge[1][0][i] = (b.y * c.z - b.z * c.y) * turnSigma;
    moved.edge[1][1][i] = (b.z * c.x - b.x * c.z) * turnSigma;
    moved.edge[1][2][i] = (b.x * c.y - b.y * c.x) * turn;
    moved.edge[2][0][i] = (c.y * a.z - c.z * a.y) * turnSigma;
    moved.edge[2][1][i] = (c.z * a.x - c.x * a.z) * turnSigma;
    moved.edge[2][2][i] = (c.x * a.y - c.y * a.x) * turn;
  }
}

AVIANLIDAR_ALWAYS_INLINE void round(const MovedTriangles<double>& from, MovedTriangles<float>& to)
{
  constexpr std::size_t Numbers = sizeof to / sizeof(float);
  static_assert(sizeof from == Numbers * sizeof(double));
  const double* const d = &from.edge[0][0][0];
  float* const f = &to.edge[0][0][0];
#pragma omp simd
  for (std::size_t i = 0; i < Numbers; ++i)
  {
    f[i] = static_cast<float>(d[i]);
  }
}

/// Triangles as the packet sees them, see the file comment of the header.
struct SeenTriangles
{
  float edge[3][3][Triangles]; ///< edge; x, y, z
  float w[3][Triangles];
  float error[Triangles];   ///< of w
  float inside[Triangles];  ///< e at least: surely inside
  float outside[Triangles]; ///< e below: surely outside
};

AVIANLIDAR_ALWAYS_INLINE float sum(float a, float b, float c)
{
  return std::fabs(a) + std::fabs(b) + std::fabs(c);
}

/// An edge function divided by its size, and its largest value for any ray.
struct SeenEdge
{
  float x, y, z, most, scale;
};

AVIANLIDAR_ALWAYS_INLINE SeenEdge seeEdge(float x, float y, float z)
{
  const float scale = 1.0f / sum(x, y, z);
  return { x * scale, y * scale, z * scale, (z + (std::fabs(x) + std::fabs(y))) * scale, scale };
}

/// @return triangles that some ray may hit, one bit each
AVIANLIDAR_ALWAYS_INLINE std::uint32_t see(
  const PacketPlane& plane, const MovedTriangles<float>& moved, SeenTriangles& seen)
{
  constexpr auto U = static_cast<float>(RoundOffSingle);
  constexpr auto D = static_cast<float>(RoundOffDouble);
  constexpr float Up = 1.0f + 16.0f * U;
  const auto gain = static_cast<float>(plane.gain) * U * Up;
  const auto exactSpread =
    static_cast<float>(128.0 / plane.leastCosine + 12.0 * plane.exactSpread) * D;
  std::uint32_t candidates = 0;
#pragma omp simd reduction(| : candidates)
  for (int i = 0; i < Triangles; ++i)
  {
    const float wx = moved.w[0][i], wy = moved.w[1][i], wz = moved.w[2][i];
    const float reach = sum(wx, wy, wz);
    const float far = moved.farthest[i];
    const float slope = moved.slope[i];
    const float relative = slope * far + 64.0f * D * far * reach;
    const float error = Up * ((8.0f * U + 2.0f * relative) * reach + slope);
    const SeenEdge ab = seeEdge(moved.edge[0][0][i], moved.edge[0][1][i], moved.edge[0][2][i]);
    const SeenEdge bc = seeEdge(moved.edge[1][0][i], moved.edge[1][1][i], moved.edge[1][2][i]);
    const SeenEdge ca = seeEdge(moved.edge[2][0][i], moved.edge[2][1][i], moved.edge[2][2][i]);
    seen.edge[0][0][i] = ab.x;
    seen.edge[0][1][i] = ab.y;
    seen.edge[0][2][i] = ab.z;
    seen.edge[1][0][i] = bc.x;
    seen.edge[1][1][i] = bc.y;
    seen.edge[1][2][i] = bc.z;
    seen.edge[2][0][i] = ca.x;
    seen.edge[2][1][i] = ca.y;
    seen.edge[2][2][i] = ca.z;
    const float noise = exactSpread * most(ab.scale, most(bc.scale, ca.scale));
    const float beside = least(ab.most, least(bc.most, ca.most));
    // False for what is not a number, too: the exact functions decide.
    const bool regular = (relative < 1e-6f) & (reach > 1e-33f) & (reach < 1e33f) & (noise < 1e-2f);
    const float inside = Up * (16.0f * gain + noise);
    const float outside = Up * (24.0f * gain + noise);
    seen.w[0][i] = regular ? wx : 0.0f;
    seen.w[1][i] = regular ? wy : 0.0f;
    seen.w[2][i] = regular ? wz : 0.0f;
    seen.error[i] = regular ? error : Infinity;
    seen.inside[i] = inside;
    seen.outside[i] = regular ? outside : Infinity;
    candidates |= regular & (beside < -outside) ? 0u : 1u << i;
  }
  return candidates;
}

/// What became of a group of rays at one triangle, one bit each: low half the new nearest, high
/// half undecided.
AVIANLIDAR_ALWAYS_INLINE std::uint32_t testRays(const PacketPlane& plane, const SeenTriangles& t,
  int k, std::uint32_t id, int begin, const PacketBest& best, PacketBest& better)
{
  const float x0 = t.edge[0][0][k], y0 = t.edge[0][1][k], z0 = t.edge[0][2][k];
  const float x1 = t.edge[1][0][k], y1 = t.edge[1][1][k], z1 = t.edge[1][2][k];
  const float x2 = t.edge[2][0][k], y2 = t.edge[2][1][k], z2 = t.edge[2][2][k];
  const float wx = t.w[0][k], wy = t.w[1][k], wz = t.w[2][k];
  const float error = t.error[k];
  const float inside = t.inside[k];
  const float outside = -t.outside[k];
  const float* const u16 = plane.u + begin;
  const float* const v16 = plane.v + begin;
  const float* const bestLow = best.low + begin;
  const float* const bestHigh = best.high + begin;
  const std::uint32_t* const bestTriangle = best.triangle + begin;
  float* const betterLow = better.low + begin;
  float* const betterHigh = better.high + begin;
  std::uint32_t* const betterTriangle = better.triangle + begin;
  std::uint32_t bits = 0;
#pragma omp simd reduction(| : bits)
  for (int i = 0; i < Group; ++i)
  {
    const float u = u16[i];
    const float v = v16[i];
    const float e0 = (x0 * u + y0 * v) + z0;
    const float e1 = (x1 * u + y1 * v) + z1;
    const float e2 = (x2 * u + y2 * v) + z2;
    const float w = (wx * u + wy * v) + wz;
    const float low = w - error;
    const float high = w + error;
    const float edge = least(least(e0, e1), e2);
    const bool sure = (edge >= inside) & (low > bestHigh[i]);
    // Of a ray that may be accepted beside the triangle, the range is that of a corner: the plane's
    // depth where it passes says nothing.
    const bool possible = (edge >= outside) & ((high >= bestLow[i]) | (edge < inside));
    betterLow[i] = sure ? low : bestLow[i];
    betterHigh[i] = sure ? high : bestHigh[i];
    betterTriangle[i] = sure ? id : bestTriangle[i];
    bits |= sure ? 1u << i : possible ? 0x10000u << i : 0u;
  }
  return bits;
}

AVIANLIDAR_MULTIVERSION RayBits testAll(const PacketPlane& plane, int count,
  PacketTriangles& triangles, PacketBest& best, bool& anyUnsure)
{
  alignas(64) MovedTriangles<double> precise;
  move(plane, triangles, precise);
  alignas(64) MovedTriangles<float> moved;
  round(precise, moved);
  alignas(64) SeenTriangles seen;
  RayBits changed = 0;
  RayBits unsure = 0;
  triangles.candidates = see(plane, moved, seen) & ((1u << count) - 1u);
  for (std::uint32_t rest = triangles.candidates; rest != 0; rest &= rest - 1)
  {
    const int k = __builtin_ctz(rest);
    RayBits own = 0;
    for (int begin = 0; begin < PacketWidth; begin += Group)
    {
      if ((triangles.rays[k] >> begin & 0xffffu) != 0)
      {
        const RayBits found = testRays(plane, seen, k, triangles.id[k], begin, best, best);
        changed |= (found & 0xffffu) << begin;
        own |= (found >> 16) << begin;
      }
    }
    triangles.unsure[k] = own;
    unsure |= own;
  }
  anyUnsure = unsure != 0;
  return changed;
}

AVIANLIDAR_MULTIVERSION float shortenAll(
  const PacketPlane& plane, const PacketBest& best, int padded, PacketView& view)
{
  float farthest = 0.0f;
#pragma omp simd reduction(max : farthest)
  for (int i = 0; i < padded; ++i)
  {
    const float low = best.low[i];
    const float range = (1.0f + 1e-6f) / (low * plane.cosine[i]);
    const float far = low > 0.0f ? range : Infinity;
    view.far[i] = far;
    farthest = far > farthest ? far : farthest;
  }
  return farthest;
}

/// TriangleTest.cxx: a b - c d to one and a half units in the last place.
AVIANLIDAR_ALWAYS_INLINE double difference(double a, double b, double c, double d)
{
  const double cd = c * d;
  const double error = std::fma(-c, d, cd);
  return std::fma(a, b, -cd) + error;
}

AVIANLIDAR_MULTIVERSION void rangesOnAll(
  const PacketCorners& t, const PacketDirections& rays, double* range)
{
  const int padded = rays.padded();
#pragma omp simd
  for (int i = 0; i < padded; ++i)
  {
    const double ax = t.corner[0][0][i], ay = t.corner[0][1][i], az = t.corner[0][2][i];
    const double bx = t.corner[1][0][i], by = t.corner[1][1][i], bz = t.corner[1][2][i];
    const double cx = t.corner[2][0][i], cy = t.corner[2][1][i], cz = t.corner[2][2][i];
    const double ux = bx - ax, uy = by - ay, uz = bz - az;
    const double vx = cx - ax, vy = cy - ay, vz = cz - az;
    const double sx = cx - bx, sy = cy - by, sz = cz - bz;
    const double nx = difference(uy, vz, uz, vy);
    const double ny = difference(uz, vx, ux, vz);
    const double nz = difference(ux, vy, uy, vx);
    const double longest = most((ux * ux + uy * uy) + uz * uz,
      most((vx * vx + vy * vy) + vz * vz, (sx * sx + sy * sy) + sz * sz));
    const double dx = rays.x[i], dy = rays.y[i], dz = rays.z[i];
    const double height = (nx * ax + ny * ay) + nz * az;
    const double slope = (nx * dx + ny * dy) + nz * dz;
    const double plain = height / slope;
    const double za = (ax * dx + ay * dy) + az * dz;
    const double zb = (bx * dx + by * dy) + bz * dz;
    const double zc = (cx * dx + cy * dy) + cz * dz;
    const double lower = za < zb ? (za < zc ? za : zc) : (zb < zc ? zb : zc);
    const double upper = za > zb ? (za > zc ? za : zc) : (zb > zc ? zb : zc);
    const double raised = plain < lower ? lower : plain;
    const double clamped = raised > upper ? upper : raised;
    const bool well = std::fabs(slope) >= WellShaped * longest;
    range[i] = well ? clamped : plain;
  }
}

/// Two unit vectors across the unit vector c (see makeBeamFrame()).
void makeAxes(const Vec3& c, Vec3& p, Vec3& q)
{
  const double sign = std::copysign(1.0, c.z);
  const double a = -1.0 / (sign + c.z);
  const double b = c.x * c.y * a;
  p = Vec3(1.0 + sign * c.x * c.x * a, sign * b, -sign * c.x);
  q = Vec3(b, sign + c.y * c.y * a, -c.y);
}

/// Rays in the plane, not yet divided by sigma.
struct alignas(64) PlaneRays
{
  double u[PacketWidth], v[PacketWidth];
  int padded;
  double leastCosine, reach;
};

AVIANLIDAR_MULTIVERSION void project(
  PacketPlane& plane, const PacketDirections& rays, PlaneRays& out)
{
  const PlaneAxes m{ plane.p.x, plane.p.y, plane.p.z, plane.q.x, plane.q.y, plane.q.z, plane.c.x,
    plane.c.y, plane.c.z };
  double leastCosine = 1.0;
  double reach = 0.0;
  const int padded = rays.padded();
#pragma omp simd reduction(min : leastCosine) reduction(max : reach)
  for (int i = 0; i < padded; ++i)
  {
    const double cosine = rays.x[i] * m.cx + rays.y[i] * m.cy + rays.z[i] * m.cz;
    const double inverse = 1.0 / cosine;
    const double u = (rays.x[i] * m.px + rays.y[i] * m.py + rays.z[i] * m.pz) * inverse;
    const double v = (rays.x[i] * m.qx + rays.y[i] * m.qy + rays.z[i] * m.qz) * inverse;
    plane.cosine[i] = static_cast<float>(cosine);
    out.u[i] = u;
    out.v[i] = v;
    const double absU = std::fabs(u);
    const double absV = std::fabs(v);
    const double size = absU > absV ? absU : absV;
    leastCosine = cosine < leastCosine ? cosine : leastCosine;
    reach = size > reach ? size : reach;
  }
  out.padded = padded;
  out.leastCosine = leastCosine;
  out.reach = reach;
}

/// Rays in the plane of their beam.
AVIANLIDAR_MULTIVERSION void ownPlane(
  PacketPlane& plane, const double* x, const double* y, double tangent, int padded)
{
#pragma omp simd
  for (int i = 0; i < padded; ++i)
  {
    const auto u = static_cast<float>(x[i]);
    const auto v = static_cast<float>(y[i]);
    const auto t = static_cast<float>(tangent);
    plane.u[i] = u;
    plane.v[i] = v;
    plane.cosine[i] = 1.0f / std::sqrt(1.0f + (t * t) * (u * u + v * v));
  }
}

AVIANLIDAR_MULTIVERSION void scaleRays(PacketPlane& plane, const PlaneRays& rays, double scale)
{
  const int padded = rays.padded;
#pragma omp simd
  for (int i = 0; i < padded; ++i)
  {
    plane.u[i] = static_cast<float>(rays.u[i] * scale);
    plane.v[i] = static_cast<float>(rays.v[i] * scale);
  }
}
}

void PacketPlane::set(
  const PacketView& view, const PacketDirections& rays, const BeamFrame* const* frames)
{
  Vec3 middle;
  middle[view.axes[0]] = view.sign;
  middle[view.axes[1]] = 0.5 * view.lowU + 0.5 * view.highU;
  middle[view.axes[2]] = 0.5 * view.lowV + 0.5 * view.highV;
  this->apex = frames[0]->origin;
  this->c = middle / std::sqrt(glm::dot(middle, middle));
  makeAxes(this->c, this->p, this->q);
  PlaneRays projected;
  project(*this, rays, projected);
  this->leastCosine = projected.leastCosine * (1.0 - 1e-6);
  // In the plane of a beam, e1, e2 and axis of the beam become at most tan(theta0.5) sqrt(2) and
  // the axis along p, q and c; the ray there is at least as long as the unit vector.
  double reach = projected.reach;
  double widest = 0.0;
  const BeamFrame* before = nullptr;
  for (int i = 0; i < rays.count; ++i)
  {
    const BeamFrame* const frame = frames[i];
    if (frame != before)
    {
      const double along = std::max(
        std::fabs(glm::dot(frame->axis, this->p)), std::fabs(glm::dot(frame->axis, this->q)));
      reach = std::max(reach, (1.4143 * frame->tanHalf + along) / this->leastCosine);
      widest = std::max(widest, frame->tanHalf);
      before = frame;
    }
  }
  const double sigma = reach * (1.0 + 1e-9);
  this->gain = (1.0 + 1.4143 * widest) / this->leastCosine;
  this->exactSpread = 8.0 + 14.0 * widest;
  this->sigma = sigma;
  scaleRays(*this, projected, 1.0 / sigma);
}

void PacketPlane::set(const BeamFrame& beam, const double* x, const double* y, int padded)
{
  this->apex = beam.origin;
  this->c = beam.axis;
  this->p = beam.e1;
  this->q = beam.e2;
  this->sigma = beam.tanHalf;
  this->leastCosine = beam.cosHalf * (1.0 - 1e-6);
  this->gain = (1.0 + 1.4143 * beam.tanHalf) / this->leastCosine;
  this->exactSpread = 8.0 + 14.0 * beam.tanHalf;
  ownPlane(*this, x, y, beam.tanHalf, padded);
}

RayBits testTriangles(const PacketPlane& plane, int count, PacketTriangles& triangles,
  PacketBest& best, bool& anyUnsure)
{
  return testAll(plane, count, triangles, best, anyUnsure);
}

float shortenRays(const PacketPlane& plane, const PacketBest& best, int padded, PacketView& view)
{
  return shortenAll(plane, best, padded, view);
}

void rangesOnTriangles(const PacketCorners& corners, const PacketDirections& rays, double* range)
{
  rangesOnAll(corners, rays, range);
}
}
