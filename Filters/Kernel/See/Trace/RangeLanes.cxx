// SPDX-License-Identifier: BSD-3-Clause
#include "RangeLanes.h"

#include "Multiversion.h"

namespace avianlidar
{
namespace
{
template <PlaneView View>
AVIANLIDAR_ALWAYS_INLINE void rangesOf(const Corners& corners, const TrianglePlane& plane,
  const double* dx, const double* dy, const double* dz, double* ranges, int* kinds, std::size_t n)
{
  const Corners t = corners;
  const TrianglePlane p = plane;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i)
  {
    const PlaneRange found = rangeOnPlane<View>(t, p, dx[i], dy[i], dz[i]);
    ranges[i] = found.range;
    kinds[i] = found.kind;
  }
}
}

AVIANLIDAR_MULTIVERSION void unitDirections(const BeamFrame& frame, const double* x,
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

AVIANLIDAR_MULTIVERSION void planeRanges(PlaneView view, const Corners& t, const TrianglePlane& p,
  const double* dx, const double* dy, const double* dz, double* ranges, int* kinds, std::size_t n)
{
  switch (view)
  {
    case PlaneView::WellShaped:
      return rangesOf<PlaneView::WellShaped>(t, p, dx, dy, dz, ranges, kinds, n);
    case PlaneView::Inside:
      return rangesOf<PlaneView::Inside>(t, p, dx, dy, dz, ranges, kinds, n);
    case PlaneView::Any:
      return rangesOf<PlaneView::Any>(t, p, dx, dy, dz, ranges, kinds, n);
  }
}
}
