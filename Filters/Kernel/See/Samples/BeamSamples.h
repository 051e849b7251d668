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

#include <algorithm>
#include <array>
#include <cmath>
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

/// Place of a sample in the beam's plane. Sums are weighted with shares of the pulse.
struct SamplePlace
{
  std::uint64_t columns = 0; ///< bits of the columns of air in which the rays lie (ScanAir.h)
  double x = 0.0, y = 0.0;   ///< sums of coordinates
  double xx = 0.0, yy = 0.0; ///< sums of squared coordinates

  /// Add a point, or an evenly lit square. @param half half the side of the square
  void add(std::uint64_t bits, double weight, double atX, double atY, double half = 0.0)
  {
    this->columns |= bits;
    this->x += weight * atX;
    this->y += weight * atY;
    this->xx += weight * (atX * atX + half * half / 3.0);
    this->yy += weight * (atY * atY + half * half / 3.0);
  }

  /// Middle and half widths of an evenly lit ellipse with the same sums.
  void spread(double weight, std::array<double, 2>& middle, std::array<double, 2>& half) const
  {
    middle = { this->x / weight, this->y / weight };
    half = { 2.0 * std::sqrt(std::max(0.0, this->xx / weight - middle[0] * middle[0])),
      2.0 * std::sqrt(std::max(0.0, this->yy / weight - middle[1] * middle[1])) };
  }
};

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

  std::vector<SamplePlace> places; ///< places of samples; empty if the place in the beam is unknown

  /// Bits of the columns of a sample; 0: all columns.
  std::uint64_t columnsOf(std::size_t sample) const
  {
    return this->places.empty() ? 0 : this->places[sample].columns;
  }

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
      sizeof(std::uint32_t) * this->ray.capacity() + sizeof(SamplePlace) * this->places.capacity() +
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
