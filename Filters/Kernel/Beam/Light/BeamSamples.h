// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSamples.h
 * @brief Weighted samples of the surfaces that a beam sees, surface by surface. Energies, range
 * units, labels and paths with two reflections follow only from the samples.
 *
 * Samples are rays of the beam, nodes of an integral over visible polygons, or strips of cells.
 *
 * Source: none.
 * Valid: weights are shares of the pulse's energy. Cosines lie in [0, 1]. Range, cosine and weight
 * have one entry per sample.
 * Test: TestEchoClosedForms.cxx, TestPolygonUnits.cxx.
 */
#ifndef avianlidar_BeamSamples_h
#define avianlidar_BeamSamples_h

#include "Vector.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace avianlidar
{
/// Distance from a surface, m, below which a point at the distance `range` from the apex counts as
/// lying on the surface.
constexpr double surfaceMargin(double range)
{
  return 1e-9 * range;
}

/// Marker of a path that does not end at a sample.
constexpr std::uint32_t NoSample = 0xffffffffu;

/// Samples of a beam, with 28 bytes per sample and 8 bytes per surface.
struct BeamSamples
{
  /// Samples on a triangle, from the end of the previous Surface up to `end`.
  struct Surface
  {
    std::uint32_t triangle;
    std::uint32_t end;
  };
  std::vector<Surface> surfaces;  ///< surfaces, in the order of samples; triangles may recur
  std::vector<std::uint32_t> ray; ///< number of the ray; empty unless the samples are rays
  std::vector<double> range;      ///< range, m
  std::vector<double> cosine;     ///< cosine of incidence, in [0, 1]
  std::vector<double> weight;     ///< share of the pulse's energy that arrives at the sample

  /// Bits of the columns of air in which a sample's rays lie (BeamAir.h); empty: all columns.
  std::vector<std::uint64_t> columns;

  std::uint32_t rays = 0; ///< number of traced rays, with or without a hit
  bool coplanar = false;  ///< whether all samples lie on one plane
  double nearest = std::numeric_limits<double>::infinity(); ///< least range, m
  double farthest = 0.0;                                    ///< largest range, m

  std::size_t size() const { return this->weight.size(); }

  /// Call f(triangle, begin, end) for each surface.
  template <class F>
  void forEachSurface(F f) const
  {
    std::uint32_t begin = 0;
    for (const Surface& surface : this->surfaces)
    {
      f(surface.triangle, begin, surface.end);
      begin = surface.end;
    }
  }

  /// True if all rays of the beam hit one plane.
  bool onOnePlane() const { return this->coplanar && this->size() == this->rays; }

  std::size_t bytes() const
  {
    return sizeof(BeamSamples) + sizeof(Surface) * this->surfaces.capacity() +
      sizeof(std::uint32_t) * this->ray.capacity() +
      sizeof(std::uint64_t) * this->columns.capacity() +
      sizeof(double) * (this->range.capacity() + this->cosine.capacity() + this->weight.capacity());
  }
};

/// Directions and normals of samples, in the order of the samples. Only paths with two reflections
/// need this geometry.
struct SampleGeometry
{
  struct Surface
  {
    std::uint32_t triangle;
    Vec3 normal;   ///< unit normal, towards the apex
    double height; ///< distance of the plane from the apex, m
  };
  std::vector<double> dx, dy, dz;     ///< unit directions from the apex
  std::vector<double> nx, ny, nz;     ///< normals of the surfaces at the samples
  std::vector<std::uint32_t> surface; ///< place in `surfaces` of each sample's surface
  std::vector<Surface> surfaces;
  std::uint32_t triangle(std::size_t i) const { return this->surfaces[this->surface[i]].triangle; }
  Vec3 normal(std::size_t i) const { return { this->nx[i], this->ny[i], this->nz[i] }; }
  Vec3 direction(std::size_t i) const { return { this->dx[i], this->dy[i], this->dz[i] }; }
};
}

#endif
