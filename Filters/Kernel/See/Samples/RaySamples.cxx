// SPDX-License-Identifier: BSD-3-Clause
#include "RaySamples.h"

#include "BeamTracer.h"
#include "Multiversion.h"
#include "RangeLanes.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Largest number of surfaces that are found one by one. More surfaces are sorted by triangle.
constexpr std::size_t MostListed = 24;

/// Find cosines of incidence.
AVIANLIDAR_MULTIVERSION void cosinesOf(const Vec3& surfaceNormal, const double* dx,
  const double* dy, const double* dz, double* cosines, std::size_t count)
{
  const Vec3 normal = surfaceNormal;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double c = -((normal.x * dx[i] + normal.y * dy[i]) + normal.z * dz[i]);
    const double positive = c > 0.0 ? c : 0.0;
    cosines[i] = positive < 1.0 ? positive : 1.0;
  }
}

/// True if all samples lie on the plane of the first sample.
bool areCoplanar(const BeamSamples& samples, const SampleGeometry& geometry)
{
  const std::vector<SampleGeometry::Surface>& surfaces = geometry.surfaces;
  if (surfaces.size() < 2)
  {
    return true;
  }
  const Vec3& normal = surfaces[0].normal;
  for (const SampleGeometry::Surface& surface : surfaces)
  {
    if (!(glm::dot(surface.normal, normal) > 1.0 - 1e-12))
    {
      return false;
    }
  }
  const Vec3 first = samples.range[0] * geometry.direction(0);
  const double margin = surfaceMargin(samples.range[0]);
  for (std::size_t i = samples.surfaces[0].end; i < samples.size(); ++i)
  {
    const Vec3 point = samples.range[i] * geometry.direction(i);
    if (!(std::fabs(glm::dot(normal, point - first)) <= margin))
    {
      return false;
    }
  }
  return true;
}

/// Append a surface, and set the normals of its samples [begin, end).
void addSurface(const SeenTriangle& seen, std::uint32_t triangle, std::size_t begin,
  std::size_t end, SampleGeometry& geometry)
{
  const auto number = static_cast<std::uint32_t>(geometry.surfaces.size());
  geometry.surfaces.push_back({ triangle, seen.normal, seen.height });
  std::fill(geometry.nx.begin() + begin, geometry.nx.begin() + end, seen.normal.x);
  std::fill(geometry.ny.begin() + begin, geometry.ny.begin() + end, seen.normal.y);
  std::fill(geometry.nz.begin() + begin, geometry.nz.begin() + end, seen.normal.z);
  std::fill(geometry.surface.begin() + begin, geometry.surface.begin() + end, number);
}
}

const SeenTriangle& RaySamples::see(std::uint32_t triangle, const Vec3& apex)
{
  if (this->Scene.isMoved(triangle))
  {
    this->Moved = seeTriangle(this->Scene, triangle, apex);
    return this->Moved;
  }
  this->Triangles.resize(Places);
  Known& known = this->Triangles[triangle % Places];
  if (known.triangle != triangle || known.apex != apex)
  {
    known = { triangle, apex, seeTriangle(this->Scene, triangle, apex) };
  }
  return known.seen;
}

/// Set the rays and surfaces of the samples. Surfaces come in the order of their first rays. Each
/// pass takes the rays of one surface out of the rays that are left, without a branch.
void RaySamples::sortBySurface(const std::vector<std::uint32_t>& triangles, BeamSamples& samples)
{
  const std::size_t rays = triangles.size();
  this->Left.resize(rays + 1);
  this->Sorted.resize(rays + 1);
  std::uint32_t* const left = this->Left.data();
  std::size_t count = 0;
  for (std::size_t n = 0; n < rays; ++n)
  {
    left[count] = static_cast<std::uint32_t>(n);
    count += triangles[n] != NoTriangle ? 1 : 0;
  }
  this->Surfaces.clear();
  std::uint32_t* sorted = this->Sorted.data();
  for (std::size_t rest = count; rest > 0;)
  {
    if (this->Surfaces.size() == MostListed)
    {
      return this->sortByTriangle(triangles, samples);
    }
    const std::uint32_t triangle = triangles[left[0]];
    std::size_t others = 0;
    for (std::size_t i = 0; i < rest; ++i)
    {
      const std::uint32_t ray = left[i];
      const bool here = triangles[ray] == triangle;
      *sorted = ray;
      sorted += here ? 1 : 0;
      left[others] = ray;
      others += here ? 0 : 1;
    }
    rest = others;
    this->Surfaces.push_back({ triangle, static_cast<std::uint32_t>(count - rest) });
  }
  samples.ray.assign(this->Sorted.begin(), this->Sorted.begin() + count);
  samples.surfaces.assign(this->Surfaces.begin(), this->Surfaces.end());
}

/// sortBySurface() for many surfaces. The surfaces come in the order of their triangle numbers.
void RaySamples::sortByTriangle(const std::vector<std::uint32_t>& triangles, BeamSamples& samples)
{
  samples.surfaces.clear();
  samples.ray.clear();
  for (std::size_t n = 0; n < triangles.size(); ++n)
  {
    if (triangles[n] != NoTriangle)
    {
      samples.ray.push_back(static_cast<std::uint32_t>(n));
    }
  }
  std::stable_sort(samples.ray.begin(), samples.ray.end(),
    [&](std::uint32_t a, std::uint32_t b) { return triangles[a] < triangles[b]; });
  for (std::size_t i = 0; i < samples.ray.size(); ++i)
  {
    const std::uint32_t triangle = triangles[samples.ray[i]];
    if (samples.surfaces.empty() || samples.surfaces.back().triangle != triangle)
    {
      samples.surfaces.push_back({ triangle, 0 });
    }
    samples.surfaces.back().end = static_cast<std::uint32_t>(i + 1);
  }
}

void RaySamples::findDirections(const BeamFrame& frame, const BeamRays& rays,
  const BeamSamples& samples, SampleGeometry& geometry)
{
  const std::size_t count = samples.size();
  for (std::vector<double>* v : { &this->X, &this->Y, &geometry.dx, &geometry.dy, &geometry.dz,
         &geometry.nx, &geometry.ny, &geometry.nz })
  {
    v->resize(count);
  }
  geometry.surface.resize(count);
  geometry.surfaces.clear();
  for (std::size_t i = 0; i < count; ++i)
  {
    this->X[i] = rays.x[samples.ray[i]];
    this->Y[i] = rays.y[samples.ray[i]];
  }
  unitDirections(frame, this->X.data(), this->Y.data(), geometry.dx.data(), geometry.dy.data(),
    geometry.dz.data(), count);
}

/// Set the ranges and cosines of the samples [begin, end) on one surface.
void RaySamples::findOnSurface(const BeamFrame& frame, const SeenTriangle& seen, std::size_t begin,
  std::size_t end, const SampleGeometry& geometry, BeamSamples& samples)
{
  const PlaneView view = viewOfCone(seen.plane, frame.axis, frame.sinHalf, frame.cosHalf);
  const double* const dx = geometry.dx.data() + begin;
  const double* const dy = geometry.dy.data() + begin;
  const double* const dz = geometry.dz.data() + begin;
  planeRanges(view, seen.corners, seen.plane, dx, dy, dz, samples.range.data() + begin,
    this->Kinds.data() + begin, end - begin);
  cosinesOf(seen.normal, dx, dy, dz, samples.cosine.data() + begin, end - begin);
  for (std::size_t i = begin; i < end; ++i)
  {
    if (this->Kinds[i] != 1)
    {
      samples.range[i] = rangeOnTriangle(seen, frame, geometry.direction(i));
    }
    samples.nearest = std::min(samples.nearest, samples.range[i]);
    samples.farthest = std::max(samples.farthest, samples.range[i]);
  }
}

void RaySamples::find(const BeamFrame& frame, const BeamRays& rays,
  const std::vector<std::uint32_t>& triangles, BeamSamples& samples, SampleGeometry& geometry)
{
  samples = BeamSamples{};
  samples.rays = static_cast<std::uint32_t>(triangles.size());
  this->sortBySurface(triangles, samples);
  const std::size_t count = samples.ray.size();
  samples.range.resize(count);
  samples.cosine.resize(count);
  samples.weight.assign(count, 1.0 / samples.rays);
  samples.places.clear();
  this->Kinds.resize(count);
  this->findDirections(frame, rays, samples, geometry);
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      const SeenTriangle& seen = this->see(triangle, frame.origin);
      this->findOnSurface(frame, seen, begin, end, geometry, samples);
      addSurface(seen, triangle, begin, end, geometry);
    });
  samples.coplanar = areCoplanar(samples, geometry);
}

void RaySamples::findAgain(const BeamFrame& frame, const BeamRays& rays, const BeamSamples& samples,
  SampleGeometry& geometry)
{
  this->findDirections(frame, rays, samples, geometry);
  samples.forEachSurface([&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    { addSurface(this->see(triangle, frame.origin), triangle, begin, end, geometry); });
}
}
