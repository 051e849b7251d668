// SPDX-License-Identifier: BSD-3-Clause
#include "RangeLanes.h"

#include "Multiversion.h"

namespace avianlidar
{
namespace
{
AVIANLIDAR_MULTIVERSION void directionLanes(const BeamFrame& frame, const double* x,
  const double* y, double* dx, double* dy, double* dz, std::size_t n)
{
  const Vec3 e1 = frame.e1;
  const Vec3 e2 = frame.e2;
  const Vec3 axis = frame.axis;
  const double t = frame.tanHalf;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i)
  {
    const double vx = axis.x + t * (x[i] * e1.x + y[i] * e2.x);
    const double vy = axis.y + t * (x[i] * e1.y + y[i] * e2.y);
    const double vz = axis.z + t * (x[i] * e1.z + y[i] * e2.z);
    unitDirectionOf(vx, vy, vz, dx[i], dy[i], dz[i]);
  }
}

template <PlaneView View>
AVIANLIDAR_ALWAYS_INLINE std::uint32_t hitsIn(const Corners& corners, const TrianglePlane& plane,
  std::uint32_t rays, const std::uint32_t* owner, std::uint32_t triangle, const double* dx,
  const double* dy, const double* dz, std::uint32_t* hit, double* range)
{
  const Corners t = corners;
  const TrianglePlane p = plane;
  std::uint32_t mine = 0;
#pragma omp simd reduction(| : mine)
  for (int i = 0; i < 16; ++i)
  {
    const std::uint32_t bit = 1u << i;
    const bool own = (owner[i] == triangle) & ((rays & bit) != 0);
    hit[i] = own ? triangle : hit[i];
    mine |= own ? bit : 0u;
  }
#pragma omp simd
  for (int i = 0; i < 16; ++i)
  {
    const double found = rangeOnPlane<View>(t, p, dx[i], dy[i], dz[i]).range;
    range[i] = (mine & (1u << i)) != 0 ? found : range[i];
  }
  return mine;
}

AVIANLIDAR_MULTIVERSION std::uint32_t hitsOfView(PlaneView view, const Corners& corners,
  const TrianglePlane& plane, std::uint32_t rays, const std::uint32_t* owner,
  std::uint32_t triangle, const double* dx, const double* dy, const double* dz, std::uint32_t* hit,
  double* range)
{
  switch (view)
  {
    case PlaneView::WellShaped:
      return hitsIn<PlaneView::WellShaped>(
        corners, plane, rays, owner, triangle, dx, dy, dz, hit, range);
    case PlaneView::Inside:
      return hitsIn<PlaneView::Inside>(
        corners, plane, rays, owner, triangle, dx, dy, dz, hit, range);
    case PlaneView::Any:
      break;
  }
  return hitsIn<PlaneView::Any>(corners, plane, rays, owner, triangle, dx, dy, dz, hit, range);
}
AVIANLIDAR_ALWAYS_INLINE double most(double a, double b)
{
  return a > b ? a : b;
}

/// TriangleTest.cxx: a b - c d to one and a half units in the last place.
AVIANLIDAR_ALWAYS_INLINE double difference(double a, double b, double c, double d)
{
  const double cd = c * d;
  const double error = std::fma(-c, d, cd);
  return std::fma(a, b, -cd) + error;
}

AVIANLIDAR_MULTIVERSION void rangesOnAll(
  const CornerLanes& t, int count, const double* x, const double* y, const double* z, double* range)
{
#pragma omp simd
  for (int i = 0; i < count; ++i)
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
    const double dx = x[i], dy = y[i], dz = z[i];
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
}

void unitDirections(const BeamFrame& frame, const double* x, const double* y, double* dx,
  double* dy, double* dz, std::size_t n)
{
  directionLanes(frame, x, y, dx, dy, dz, n);
}

std::uint32_t planeHits(PlaneView view, const Corners& corners, const TrianglePlane& plane,
  std::uint32_t rays, const std::uint32_t* owner, std::uint32_t triangle, const double* dx,
  const double* dy, const double* dz, std::uint32_t* hit, double* range)
{
  return hitsOfView(view, corners, plane, rays, owner, triangle, dx, dy, dz, hit, range);
}

void rangesOnTriangles(const CornerLanes& corners, int count, const double* dx, const double* dy,
  const double* dz, double* range)
{
  rangesOnAll(corners, count, dx, dy, dz, range);
}
}
