// SPDX-License-Identifier: BSD-3-Clause
#include "PrimaryHits.h"

#include "BeamTracer.h"
#include "Multiversion.h"
#include "RangeLanes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace avianlidar
{
namespace
{
/// Up to so many surfaces of a beam are told apart by looking at each, more by sorting.
constexpr std::size_t FewSurfaces = 24;

template <PlaneView View>
AVIANLIDAR_ALWAYS_INLINE void rangesOf(const SeenTriangle& seen, const double* dx, const double* dy,
  const double* dz, double* ranges, double* cosines, int* kinds, std::size_t count)
{
  const Corners corners = seen.corners;
  const TrianglePlane plane = seen.plane;
  const Vec3 normal = seen.normal;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const PlaneRange found = rangeOnPlane<View>(corners, plane, dx[i], dy[i], dz[i]);
    ranges[i] = found.range;
    kinds[i] = found.kind;
    const double c = -((normal.x * dx[i] + normal.y * dy[i]) + normal.z * dz[i]);
    const double positive = c > 0.0 ? c : 0.0;
    cosines[i] = positive < 1.0 ? positive : 1.0;
  }
}

AVIANLIDAR_MULTIVERSION void rangesOfAll(PlaneView view, const SeenTriangle& seen, const double* dx,
  const double* dy, const double* dz, double* ranges, double* cosines, int* kinds,
  std::size_t count)
{
  switch (view)
  {
    case PlaneView::WellShaped:
      return rangesOf<PlaneView::WellShaped>(seen, dx, dy, dz, ranges, cosines, kinds, count);
    case PlaneView::Inside:
      return rangesOf<PlaneView::Inside>(seen, dx, dy, dz, ranges, cosines, kinds, count);
    case PlaneView::Any:
      return rangesOf<PlaneView::Any>(seen, dx, dy, dz, ranges, cosines, kinds, count);
  }
}

/// Rays and triangles of all hits, and nothing else.
void listHits(const std::vector<std::uint32_t>& triangles, PrimaryHits& hits)
{
  hits = PrimaryHits{};
  hits.rays = static_cast<std::uint32_t>(triangles.size());
  const std::size_t count =
    triangles.size() - std::count(triangles.begin(), triangles.end(), NoTriangle);
  hits.ray.reserve(count);
  hits.triangle.reserve(count);
  for (std::uint32_t n = 0; n < hits.rays; ++n)
  {
    if (triangles[n] != NoTriangle)
    {
      hits.ray.push_back(n);
      hits.triangle.push_back(triangles[n]);
    }
  }
}
}

std::size_t PrimaryHits::bytes() const
{
  return sizeof(PrimaryHits) +
    sizeof(std::uint32_t) * (this->ray.capacity() + this->triangle.capacity()) +
    sizeof(double) * (this->range.capacity() + this->cosine.capacity() + this->share.capacity());
}

/// Fills Order, Starts, and of the geometry the surfaces' triangles and the surface of each hit.
void HitFinder::sortBySurface(const PrimaryHits& hits, HitGeometry& geometry)
{
  const std::size_t count = hits.size();
  geometry.surfaces.clear();
  geometry.surface.resize(count);
  this->Order.resize(count);
  const auto begin = [&](std::uint32_t triangle) {
    geometry.surfaces.push_back({ triangle, Vec3(0.0), 0.0 });
  };
  std::size_t last = 0;
  std::size_t i = 0;
  for (; i < count && geometry.surfaces.size() <= FewSurfaces; ++i)
  {
    const std::uint32_t triangle = hits.triangle[i];
    const auto& known = geometry.surfaces;
    if (known.empty() || known[last].triangle != triangle)
    {
      last = std::find_if(known.begin(), known.end(),
               [triangle](const auto& s) { return s.triangle == triangle; }) -
        known.begin();
      if (last == known.size())
      {
        begin(triangle);
      }
    }
    geometry.surface[i] = static_cast<std::uint32_t>(last);
  }
  if (i < count || geometry.surfaces.size() > FewSurfaces)
  {
    geometry.surfaces.clear();
    std::iota(this->Order.begin(), this->Order.end(), 0u);
    std::stable_sort(this->Order.begin(), this->Order.end(),
      [&hits](std::uint32_t a, std::uint32_t b) { return hits.triangle[a] < hits.triangle[b]; });
    for (const std::uint32_t hit : this->Order)
    {
      if (geometry.surfaces.empty() || geometry.surfaces.back().triangle != hits.triangle[hit])
      {
        begin(hits.triangle[hit]);
      }
      geometry.surface[hit] = static_cast<std::uint32_t>(geometry.surfaces.size() - 1);
    }
  }
  this->Starts.assign(geometry.surfaces.size() + 2, 0);
  for (const std::uint32_t surface : geometry.surface)
  {
    ++this->Starts[surface + 2];
  }
  std::partial_sum(this->Starts.begin(), this->Starts.end(), this->Starts.begin());
  for (std::uint32_t hit = 0; hit < count; ++hit)
  {
    this->Order[this->Starts[geometry.surface[hit] + 1]++] = hit;
  }
}

/// A place in all arrays for each hit.
void HitFinder::makeRoom(PrimaryHits& hits, HitGeometry& geometry)
{
  for (std::vector<double>* v : { &this->X, &this->Y, &this->Dx, &this->Dy, &this->Dz,
         &this->Ranges, &this->Cosines, &geometry.dx, &geometry.dy, &geometry.dz, &geometry.nx,
         &geometry.ny, &geometry.nz, &hits.range, &hits.cosine })
  {
    v->resize(hits.size());
  }
  this->Kinds.resize(hits.size());
}

/// Directions of the hits' rays, surface by surface.
void HitFinder::findDirections(
  const BeamFrame& frame, const BeamRays& rays, const PrimaryHits& hits)
{
  const std::size_t count = hits.size();
  for (std::size_t i = 0; i < count; ++i)
  {
    this->X[i] = rays.x[hits.ray[this->Order[i]]];
    this->Y[i] = rays.y[hits.ray[this->Order[i]]];
  }
  unitDirections(frame, this->X.data(), this->Y.data(), this->Dx.data(), this->Dy.data(),
    this->Dz.data(), count);
}

/// Ranges and cosines of the hits on one surface.
void HitFinder::findOnSurface(
  const BeamFrame& frame, const SeenTriangle& seen, std::size_t begin, std::size_t end)
{
  const PlaneView view = viewOfCone(seen.plane, frame.axis, frame.sinHalf, frame.cosHalf);
  rangesOfAll(view, seen, this->Dx.data() + begin, this->Dy.data() + begin, this->Dz.data() + begin,
    this->Ranges.data() + begin, this->Cosines.data() + begin, this->Kinds.data() + begin,
    end - begin);
  for (std::size_t i = begin; i < end; ++i)
  {
    if (this->Kinds[i] != 1)
    {
      const Vec3 direction(this->Dx[i], this->Dy[i], this->Dz[i]);
      this->Ranges[i] = rangeOnTriangle(seen, frame, direction);
    }
  }
}

/// From the order of surfaces to that of rays.
void HitFinder::store(std::size_t begin, std::size_t end, const Vec3& normal, PrimaryHits& hits,
  HitGeometry& geometry) const
{
  for (std::size_t i = begin; i < end; ++i)
  {
    const std::uint32_t hit = this->Order[i];
    hits.range[hit] = this->Ranges[i];
    hits.cosine[hit] = this->Cosines[i];
    hits.farthest = std::max(hits.farthest, this->Ranges[i]);
    geometry.dx[hit] = this->Dx[i];
    geometry.dy[hit] = this->Dy[i];
    geometry.dz[hit] = this->Dz[i];
    geometry.nx[hit] = normal.x;
    geometry.ny[hit] = normal.y;
    geometry.nz[hit] = normal.z;
  }
}

/// Whether all hits lie on the plane of the first.
bool HitFinder::areCoplanar(const HitGeometry& geometry) const
{
  const std::vector<HitGeometry::Surface>& surfaces = geometry.surfaces;
  if (surfaces.size() < 2)
  {
    return true;
  }
  const Vec3& normal = surfaces[0].normal;
  for (std::size_t s = 1; s < surfaces.size(); ++s)
  {
    if (!(glm::dot(surfaces[s].normal, normal) > 1.0 - 1e-12))
    {
      return false;
    }
  }
  const auto point = [this](std::size_t i)
  { return this->Ranges[i] * Vec3(this->Dx[i], this->Dy[i], this->Dz[i]); };
  const Vec3 first = point(0);
  const double margin = surfaceMargin(this->Ranges[0]);
  for (std::size_t i = this->Starts[1]; i < this->Order.size(); ++i)
  {
    if (!(std::fabs(glm::dot(normal, point(i) - first)) <= margin))
    {
      return false;
    }
  }
  return true;
}

void HitFinder::find(const TriangleMesh& mesh, const BeamFrame& frame, const BeamRays& rays,
  const std::vector<std::uint32_t>& triangles, PrimaryHits& hits, HitGeometry& geometry)
{
  listHits(triangles, hits);
  this->sortBySurface(hits, geometry);
  this->makeRoom(hits, geometry);
  this->findDirections(frame, rays, hits);
  for (std::size_t s = 0; s < geometry.surfaces.size(); ++s)
  {
    HitGeometry::Surface& surface = geometry.surfaces[s];
    const SeenTriangle seen = seeTriangle(mesh, surface.triangle, frame.origin);
    surface.normal = seen.normal;
    surface.height = -glm::dot(seen.normal, seen.corners.a);
    this->findOnSurface(frame, seen, this->Starts[s], this->Starts[s + 1]);
    this->store(this->Starts[s], this->Starts[s + 1], seen.normal, hits, geometry);
  }
  hits.coplanar = this->areCoplanar(geometry);
}

void HitFinder::findAgain(const TriangleMesh& mesh, const BeamFrame& frame, const BeamRays& rays,
  const PrimaryHits& hits, HitGeometry& geometry)
{
  std::vector<std::uint32_t> triangles(hits.allRays(), NoTriangle);
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    triangles[hits.ray[i]] = hits.triangle[i];
  }
  PrimaryHits same;
  this->find(mesh, frame, rays, triangles, same, geometry);
}
}
