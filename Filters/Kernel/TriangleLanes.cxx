// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleLanes.h"

#include "Multiversion.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
/// Edge vector of TriangleTest.h and its image in the beam's plane, as scalars.
struct EdgeImage
{
  double x, y, z, spread;
};

AVIANLIDAR_ALWAYS_INLINE EdgeImage edgeImage(const BeamPlaneMap& m, double ax, double ay, double az,
  double bx, double by, double bz, double px, double py, double pz, double& determinant)
{
  const double dx = ax - bx;
  const double dy = ay - by;
  const double dz = az - bz;
  const double sx = ax + bx;
  const double sy = ay + by;
  const double sz = az + bz;
  const double plusX = dy * sz;
  const double plusY = dz * sx;
  const double plusZ = dx * sy;
  const double minusX = dz * sy;
  const double minusY = dx * sz;
  const double minusZ = dy * sx;
  const double ex = plusX - minusX;
  const double ey = plusY - minusY;
  const double ez = plusZ - minusZ;
  const double spread =
    ((std::fabs(plusX) + std::fabs(minusX)) + (std::fabs(plusY) + std::fabs(minusY))) +
    (std::fabs(plusZ) + std::fabs(minusZ));
  determinant = (px * ex + py * ey) + pz * ez;
  return { (ex * m.e1.x + ey * m.e1.y) + ez * m.e1.z, (ex * m.e2.x + ey * m.e2.y) + ez * m.e2.z,
    (ex * m.axis.x + ey * m.axis.y) + ez * m.axis.z, spread };
}

AVIANLIDAR_ALWAYS_INLINE void store(const EdgeImage& e, double sign, double spreadFactor, float& x,
  float& y, float& z, float& tolerance)
{
  const double sizeX = std::fabs(e.x);
  const double sizeY = std::fabs(e.y);
  const double sizeZ = std::fabs(e.z);
  const double sizeYZ = sizeY > sizeZ ? sizeY : sizeZ;
  const double scale = inversePowerOfTwo(sizeX > sizeYZ ? sizeX : sizeYZ);
  tolerance = static_cast<float>(
    1.0001 * scale * (4.0 * RoundOffSingle * ((sizeX + sizeY) + sizeZ) + spreadFactor * e.spread));
  const double factor = sign * scale;
  x = static_cast<float>(factor * e.x);
  y = static_cast<float>(factor * e.y);
  z = static_cast<float>(factor * e.z);
}

AVIANLIDAR_ALWAYS_INLINE void store(const EdgeImage& e, double sign, double spreadFactor, double& x,
  double& y, double& z, double& tolerance)
{
  const double size = (std::fabs(e.x) + std::fabs(e.y)) + std::fabs(e.z);
  x = sign * e.x;
  y = sign * e.y;
  z = sign * e.z;
  tolerance = 4.0 * RoundOffDouble * size + spreadFactor * e.spread;
}

/// BeamTriangle::missesCone() for one edge.
template <typename Real>
AVIANLIDAR_ALWAYS_INLINE int misses(Real x, Real y, Real z, Real tolerance)
{
  const Real reach = std::sqrt(x * x + y * y);
  const Real size = std::fabs(z) + reach;
  return z + reach + Real(2) * tolerance + Real(1e-5) * size < Real(0);
}

template <typename Real>
AVIANLIDAR_ALWAYS_INLINE void prepareLanes(TriangleLanes<Real>& t, const BeamPlaneMap& m)
{
#pragma omp simd
  for (int i = 0; i < TriangleLanes<Real>::Width; ++i)
  {
    double det, unused;
    const EdgeImage ab = edgeImage(
      m, t.ax[i], t.ay[i], t.az[i], t.bx[i], t.by[i], t.bz[i], t.cx[i], t.cy[i], t.cz[i], det);
    const EdgeImage bc =
      edgeImage(m, t.bx[i], t.by[i], t.bz[i], t.cx[i], t.cy[i], t.cz[i], 0.0, 0.0, 0.0, unused);
    const EdgeImage ca =
      edgeImage(m, t.cx[i], t.cy[i], t.cz[i], t.ax[i], t.ay[i], t.az[i], 0.0, 0.0, 0.0, unused);
    const double sign = det > 0.0 ? 1.0 : -1.0;
    store(ab, sign, m.spreadFactor, t.x[0][i], t.y[0][i], t.z[0][i], t.tolerance[0][i]);
    store(bc, sign, m.spreadFactor, t.x[1][i], t.y[1][i], t.z[1][i], t.tolerance[1][i]);
    store(ca, sign, m.spreadFactor, t.x[2][i], t.y[2][i], t.z[2][i], t.tolerance[2][i]);
    const int missed = misses(t.x[0][i], t.y[0][i], t.z[0][i], t.tolerance[0][i]) |
      misses(t.x[1][i], t.y[1][i], t.z[1][i], t.tolerance[1][i]) |
      misses(t.x[2][i], t.y[2][i], t.z[2][i], t.tolerance[2][i]);
    t.candidate[i] = (det != 0.0) & !missed;
  }
}

AVIANLIDAR_MULTIVERSION void prepareAll(TriangleLanes<float>& t, const BeamPlaneMap& m)
{
  prepareLanes(t, m);
}

AVIANLIDAR_MULTIVERSION void prepareAll(TriangleLanes<double>& t, const BeamPlaneMap& m)
{
  prepareLanes(t, m);
}

template <typename Real>
AVIANLIDAR_ALWAYS_INLINE Real slackOf(
  const BeamEdge<Real>* e, const Real* x, const Real* y, Real* slack, std::size_t n)
{
  const BeamEdge<Real> e0 = e[0];
  const BeamEdge<Real> e1 = e[1];
  const BeamEdge<Real> e2 = e[2];
  Real most = Real(-1);
#pragma omp simd reduction(max : most)
  for (std::size_t i = 0; i < n; ++i)
  {
    const Real s0 = e0.slack(x[i], y[i]);
    const Real s1 = e1.slack(x[i], y[i]);
    const Real s2 = e2.slack(x[i], y[i]);
    const Real s01 = s0 < s1 ? s0 : s1;
    const Real least = s01 < s2 ? s01 : s2;
    slack[i] = least;
    most = least > most ? least : most; // a NaN of the padding is never more
  }
  return most;
}

AVIANLIDAR_MULTIVERSION float slackOfAll(
  const BeamEdge<float>* e, const float* x, const float* y, float* slack, std::size_t n)
{
  return slackOf(e, x, y, slack, n);
}

AVIANLIDAR_MULTIVERSION double slackOfAll(
  const BeamEdge<double>* e, const double* x, const double* y, double* slack, std::size_t n)
{
  return slackOf(e, x, y, slack, n);
}

/// Ranges on a plane, kept where they are accepted and the nearest so far.
struct GroupResult
{
  std::int64_t gained = 0;  ///< rays that had no hit
  std::int64_t changed = 0; ///< rays with a new nearest hit
  std::int64_t slivers = 0; ///< accepted rays that need a second look; not kept
};

template <PlaneView View, typename Real>
AVIANLIDAR_ALWAYS_INLINE GroupResult keepRanges(const Corners& corners, const TrianglePlane& plane,
  std::uint64_t triangle, const Real* slack, const double* dx, const double* dy, const double* dz,
  double* nearest, std::uint64_t* nearestTriangle, double* second, std::size_t n)
{
  const Corners t = corners;
  const TrianglePlane p = plane;
  std::int64_t gained = 0;
  std::int64_t changed = 0;
  std::int64_t slivers = 0;
#pragma omp simd reduction(+ : gained, changed, slivers)
  for (std::size_t i = 0; i < n; ++i)
  {
    const PlaneRange found = rangeOnPlane<View>(t, p, dx[i], dy[i], dz[i]);
    const bool accepted = slack[i] >= Real(0);
    const double before = nearest[i];
    const std::uint64_t owner = nearestTriangle[i];
    const bool better = accepted & (found.kind == 1) &
      ((found.range < before) | ((found.range == before) & (triangle < owner)));
    const bool sliver = accepted & (found.kind == 2);
    gained += better & (before == std::numeric_limits<double>::infinity());
    changed += better;
    slivers += sliver;
    nearest[i] = better ? found.range : before;
    nearestTriangle[i] = better ? triangle : owner;
    second[i] = sliver ? found.range : NoRange;
  }
  return { gained, changed, slivers };
}

template <typename Real>
AVIANLIDAR_ALWAYS_INLINE GroupResult keepRangesIn(PlaneView view, const Corners& c,
  const TrianglePlane& p, std::uint64_t triangle, const Real* slack, const double* dx,
  const double* dy, const double* dz, double* nearest, std::uint64_t* owner, double* second,
  std::size_t n)
{
  switch (view)
  {
    case PlaneView::WellShaped:
      return keepRanges<PlaneView::WellShaped>(
        c, p, triangle, slack, dx, dy, dz, nearest, owner, second, n);
    case PlaneView::Inside:
      return keepRanges<PlaneView::Inside>(
        c, p, triangle, slack, dx, dy, dz, nearest, owner, second, n);
    case PlaneView::Any:
      break;
  }
  return keepRanges<PlaneView::Any>(c, p, triangle, slack, dx, dy, dz, nearest, owner, second, n);
}

AVIANLIDAR_MULTIVERSION GroupResult keepAll(PlaneView view, const Corners& c,
  const TrianglePlane& p, std::uint64_t triangle, const float* slack, const double* dx,
  const double* dy, const double* dz, double* nearest, std::uint64_t* owner, double* second,
  std::size_t n)
{
  return keepRangesIn(view, c, p, triangle, slack, dx, dy, dz, nearest, owner, second, n);
}

AVIANLIDAR_MULTIVERSION GroupResult keepAll(PlaneView view, const Corners& c,
  const TrianglePlane& p, std::uint64_t triangle, const double* slack, const double* dx,
  const double* dy, const double* dz, double* nearest, std::uint64_t* owner, double* second,
  std::size_t n)
{
  return keepRangesIn(view, c, p, triangle, slack, dx, dy, dz, nearest, owner, second, n);
}

/// unitDirection(frame.direction(x, y)) of consecutive rays.
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
    const double ax = std::fabs(vx);
    const double ay = std::fabs(vy);
    const double az = std::fabs(vz);
    const double ayz = ay > az ? ay : az;
    const double scale = inversePowerOfTwo(ax > ayz ? ax : ayz);
    const double sx = vx * scale;
    const double sy = vy * scale;
    const double sz = vz * scale;
    const double length = std::sqrt((sx * sx + sy * sy) + sz * sz);
    dx[i] = sx / length;
    dy[i] = sy / length;
    dz[i] = sz / length;
  }
}

AVIANLIDAR_MULTIVERSION double largestOf(const double* values, std::size_t n)
{
  double most = 0.0;
#pragma omp simd reduction(max : most)
  for (std::size_t i = 0; i < n; ++i)
  {
    most = most > values[i] ? most : values[i];
  }
  return most;
}
}

template <typename Real>
void RayLanes<Real>::set(
  const BeamFrame& frame, const double* rayX, const double* rayY, std::size_t rays)
{
  this->count = rays;
  this->padded = (rays + Group - 1) / Group * Group;
  for (std::vector<double>* v : { &this->dx, &this->dy, &this->dz, &this->range, &this->second })
  {
    v->resize(this->padded);
  }
  // Padding lies outside every edge: NaN is never accepted.
  this->x.assign(this->padded, std::numeric_limits<Real>::quiet_NaN());
  this->y.assign(this->padded, std::numeric_limits<Real>::quiet_NaN());
  this->slack.resize(this->padded);
  std::copy(rayX, rayX + rays, this->x.begin());
  std::copy(rayY, rayY + rays, this->y.begin());
  unitDirections(frame, rayX, rayY, this->dx.data(), this->dy.data(), this->dz.data(), rays);
  std::fill(this->range.begin(), this->range.end(), std::numeric_limits<double>::infinity());
  this->triangle.assign(this->padded, NoTriangle);
}

template <typename Real>
double RayLanes<Real>::farthest(std::size_t begin, std::size_t end) const
{
  return largestOf(this->range.data() + begin, std::min(end, this->count) - begin);
}

template <typename Real>
void TriangleLanes<Real>::put(int lane, std::uint32_t triangle, const Corners& corners)
{
  this->id[lane] = triangle;
  this->ax[lane] = corners.a.x;
  this->ay[lane] = corners.a.y;
  this->az[lane] = corners.a.z;
  this->bx[lane] = corners.b.x;
  this->by[lane] = corners.b.y;
  this->bz[lane] = corners.b.z;
  this->cx[lane] = corners.c.x;
  this->cy[lane] = corners.c.y;
  this->cz[lane] = corners.c.z;
}

template <typename Real>
void TriangleLanes<Real>::prepare(const BeamPlaneMap& map)
{
  prepareAll(*this, map);
}

template <typename Real>
bool testRays(
  const TriangleLanes<Real>& t, int lane, RayLanes<Real>& rays, std::size_t begin, std::size_t end)
{
  BeamEdge<Real> edges[3];
  for (int e = 0; e < 3; ++e)
  {
    edges[e] = { t.x[e][lane], t.y[e][lane], t.z[e][lane], t.tolerance[e][lane] };
  }
  return slackOfAll(edges, rays.x.data() + begin, rays.y.data() + begin, rays.slack.data() + begin,
           end - begin) >= Real(0);
}

namespace
{
template <typename Real>
bool anyAccepted(const Real* slack)
{
  int accepted = 0;
#pragma omp simd reduction(| : accepted)
  for (std::size_t i = 0; i < RayLanes<Real>::Group; ++i)
  {
    accepted |= slack[i] >= Real(0);
  }
  return accepted != 0;
}
}

template <typename Real>
std::size_t takeRanges(const Corners& corners, std::uint32_t triangle, const RayBundle& bundle,
  RayLanes<Real>& rays, bool& changed)
{
  const TrianglePlane plane = planeOf(corners);
  const PlaneView view = viewOfCone(plane, bundle.axis, bundle.sine, bundle.cosine);
  std::size_t first = bundle.end;
  std::size_t last = bundle.begin;
  GroupResult found;
  std::size_t b = bundle.begin;
  while (b < bundle.end)
  {
    // Runs of groups with an accepted ray.
    std::size_t e = b;
    while (e < bundle.end && anyAccepted(rays.slack.data() + e))
    {
      e += RayLanes<Real>::Group;
    }
    if (e > b)
    {
      const GroupResult run = keepAll(view, corners, plane, triangle, rays.slack.data() + b,
        rays.dx.data() + b, rays.dy.data() + b, rays.dz.data() + b, rays.range.data() + b,
        rays.triangle.data() + b, rays.second.data() + b, e - b);
      found.gained += run.gained;
      found.changed += run.changed;
      found.slivers += run.slivers;
      first = std::min(first, b);
      last = e;
    }
    b = e + RayLanes<Real>::Group;
  }
  std::size_t gained = static_cast<std::size_t>(found.gained);
  changed = changed || found.changed > 0;
  if (found.slivers == 0)
  {
    return gained;
  }
  for (std::size_t i = first; i < std::min(last, rays.count); ++i)
  {
    if (rays.second[i] == NoRange || !(rays.slack[i] >= Real(0)))
    {
      continue;
    }
    const double range = rangeOnSliver(
      corners, Vec3(rays.dx[i], rays.dy[i], rays.dz[i]), rays.second[i], bundle.angularMargin);
    const double before = rays.range[i];
    if (range > 0.0 && (range < before || (range == before && triangle < rays.triangle[i])))
    {
      gained += before == std::numeric_limits<double>::infinity();
      rays.range[i] = range;
      rays.triangle[i] = triangle;
      changed = true;
    }
  }
  return gained;
}

template struct RayLanes<float>;
template struct RayLanes<double>;
template struct TriangleLanes<float>;
template struct TriangleLanes<double>;
template bool testRays<float>(
  const TriangleLanes<float>&, int, RayLanes<float>&, std::size_t, std::size_t);
template bool testRays<double>(
  const TriangleLanes<double>&, int, RayLanes<double>&, std::size_t, std::size_t);
template std::size_t takeRanges<float>(
  const Corners&, std::uint32_t, const RayBundle&, RayLanes<float>&, bool&);
template std::size_t takeRanges<double>(
  const Corners&, std::uint32_t, const RayBundle&, RayLanes<double>&, bool&);
}
