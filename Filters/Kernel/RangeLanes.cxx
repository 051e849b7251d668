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
}
