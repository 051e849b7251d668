// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSamples.h
 * @brief What looks into a beam: weighted samples of the surfaces that it sees, surface by surface.
 *
 * Rays of the beam, rays of small targets and nodes of an integral are all of this kind, and all
 * that follows (energies, range units, labels, paths over two reflections) knows nothing else.
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
/// Margin, m, within which a point at `range` from the apex is not told from the surface it lies
/// on.
constexpr double surfaceMargin(double range)
{
  return 1e-9 * range;
}

/// Marks a path that does not end at a sample.
constexpr std::uint32_t NoSample = 0xffffffffu;

/// 28 bytes a sample, 8 a surface.
struct BeamSamples
{
  /// Samples [end of the surface before, end) lie on a triangle.
  struct Surface
  {
    std::uint32_t triangle;
    std::uint32_t end;
  };
  std::vector<Surface> surfaces; ///< in the order of the samples; nodes may come back to a triangle
  std::vector<std::uint32_t> ray; ///< number of the ray, or of the node
  std::vector<double> range;      ///< m, see rangeOf()
  std::vector<double> cosine;     ///< of incidence, in [0, 1]
  std::vector<double> weight;     ///< share of the pulse's energy that arrives there

  std::uint32_t rays = 0; ///< N of the beam, with and without hit
  /// Rays of small targets, numbered from N on: they are not connected. None where no ray met a
  /// target.
  std::uint32_t extraRays = 0;
  /// Paths over two reflections go on from each pathStep-th of the N rays, from pathPhase on, with
  /// so many times the weight; 0: from none.
  std::uint32_t pathStep = 1;
  std::uint32_t pathPhase = 0;
  bool coplanar = false;                                    ///< all lie on one plane
  double nearest = std::numeric_limits<double>::infinity(); ///< m
  double farthest = 0.0;                                    ///< m

  std::size_t size() const { return this->ray.size(); }
  std::uint32_t allRays() const { return this->rays + this->extraRays; }

  /// f(triangle, begin, end) for each surface.
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

  /// Share of the pulse's energy with which the sample's paths over two reflections start.
  double pathWeight(std::size_t sample) const
  {
    const bool all = this->pathStep == 1 || this->ray[sample] >= this->rays;
    const bool has =
      all || (this->pathStep > 0 && this->ray[sample] % this->pathStep == this->pathPhase);
    return has ? this->weight[sample] * (all ? 1.0 : this->pathStep) : 0.0;
  }

  /// One plane fills the whole beam: no edge can hide between its rays.
  bool onOnePlane() const
  {
    return this->coplanar && this->size() == this->rays && this->extraRays == 0;
  }

  std::size_t bytes() const
  {
    return sizeof(BeamSamples) + sizeof(Surface) * this->surfaces.capacity() +
      sizeof(std::uint32_t) * this->ray.capacity() +
      sizeof(double) * (this->range.capacity() + this->cosine.capacity() + this->weight.capacity());
  }
};

/// Directions and normals of samples, in their order: needed only to find paths that go on.
struct SampleGeometry
{
  struct Surface
  {
    std::uint32_t triangle;
    Vec3 normal;   ///< unit, towards the apex
    double height; ///< distance of its plane from the apex, m
  };
  std::vector<double> dx, dy, dz; ///< unit directions
  std::vector<double> nx, ny, nz; ///< normals of the surfaces
  std::vector<std::uint32_t> surface;
  std::vector<Surface> surfaces; ///< those of the samples
  std::uint32_t triangle(std::size_t i) const { return this->surfaces[this->surface[i]].triangle; }
  Vec3 normal(std::size_t i) const { return { this->nx[i], this->ny[i], this->nz[i] }; }
  Vec3 direction(std::size_t i) const { return { this->dx[i], this->dy[i], this->dz[i] }; }
};
}

#endif
