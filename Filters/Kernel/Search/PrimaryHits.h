// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PrimaryHits.h
 * @brief The rays of a beam that hit something: where, and at which angle. All that direct light
 * needs to know of geometry, so that a scan lit again neither draws a ray nor looks at a triangle.
 *
 * Ranges and cosines follow from triangle and ray in double precision, whatever found the hit.
 * Rays are taken surface by surface, in loops over lanes: about 10 ns a ray and 0.2 us a surface.
 */
#ifndef avianlidar_PrimaryHits_h
#define avianlidar_PrimaryHits_h

#include "BeamFrame.h"
#include "BeamRays.h"
#include "TriangleMesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
struct SeenTriangle;

/// Margin, m, within which a point at `range` from the apex is not told from the surface it lies
/// on.
constexpr double surfaceMargin(double range)
{
  return 1e-9 * range;
}

/// Stands for a hit that is none.
constexpr std::uint32_t NoHit = 0xffffffffu;

/// In the order of the rays; 24 bytes a hit, 32 with shares.
struct PrimaryHits
{
  std::vector<std::uint32_t> ray;
  std::vector<std::uint32_t> triangle;
  std::vector<double> range;  ///< m, the very number that BeamTracer::trace() reports
  std::vector<double> cosine; ///< of incidence, in [0, 1]
  /// Of the pulse energy, what the direct echo and the mirror path of each hit start with; empty:
  /// 1/rays each. Diffuse connections are not weighed by it.
  std::vector<double> share;
  std::uint32_t rays = 0; ///< N of the beam, with and without hit
  /// Of small targets, numbered from N on: they have shares, and are not connected. None where no
  /// ray met a target.
  std::uint32_t extraRays = 0;
  /// Paths over two reflections go on from each pathStep-th of the N rays, from pathPhase on, with
  /// so many times the weight.
  std::uint32_t pathStep = 1;
  std::uint32_t pathPhase = 0;
  bool coplanar = false; ///< all hits lie on one plane
  double farthest = 0.0; ///< m

  std::size_t size() const { return this->ray.size(); }
  std::uint32_t allRays() const { return this->rays + this->extraRays; }
  /// Hits of the N rays, which come first.
  std::size_t ordinary() const
  {
    return this->extraRays == 0
      ? this->size()
      : std::lower_bound(this->ray.begin(), this->ray.end(), this->rays) - this->ray.begin();
  }
  /// Energy of the hit's direct echo, as a multiple of that of one of N equal rays.
  double weight(std::size_t hit) const
  {
    return this->share.empty() ? 1.0 : this->share[hit] * this->rays;
  }
  /// The same of its mirror path; 0: no path goes on from it.
  double pathWeight(std::size_t hit) const
  {
    const bool all = this->pathStep == 1 || this->ray[hit] >= this->rays;
    const bool has = all || this->ray[hit] % this->pathStep == this->pathPhase;
    return has ? this->weight(hit) * (all ? 1.0 : this->pathStep) : 0.0;
  }
  /// One plane fills the whole beam: no edge can hide between its rays.
  bool onOnePlane() const
  {
    return this->coplanar && this->size() == this->rays && this->share.empty();
  }
  std::size_t bytes() const;
};

/// Directions and surfaces of hits, in their order: needed only to find paths that go on from them.
struct HitGeometry
{
  struct Surface
  {
    std::uint32_t triangle;
    Vec3 normal;   ///< unit, towards the apex
    double height; ///< distance of its plane from the apex, m
  };
  std::vector<double> dx, dy, dz; ///< unit directions
  std::vector<double> nx, ny, nz; ///< normals of the surfaces hit
  std::vector<std::uint32_t> surface;
  std::vector<Surface> surfaces; ///< each triangle once
  Vec3 normal(std::size_t hit) const { return { this->nx[hit], this->ny[hit], this->nz[hit] }; }
  Vec3 direction(std::size_t hit) const { return { this->dx[hit], this->dy[hit], this->dz[hit] }; }
};

/// Reusable without allocation; one per thread.
class HitFinder
{
public:
  /// @param triangles of each ray, NoTriangle where it hit none
  void find(const TriangleMesh& mesh, const BeamFrame& frame, const BeamRays& rays,
    const std::vector<std::uint32_t>& triangles, PrimaryHits& hits, HitGeometry& geometry);

  /// The geometry of hits that are known.
  void findAgain(const TriangleMesh& mesh, const BeamFrame& frame, const BeamRays& rays,
    const PrimaryHits& hits, HitGeometry& geometry);

private:
  void sortBySurface(const PrimaryHits& hits, HitGeometry& geometry);
  void makeRoom(PrimaryHits& hits, HitGeometry& geometry);
  void findDirections(const BeamFrame& frame, const BeamRays& rays, const PrimaryHits& hits);
  void findOnSurface(
    const BeamFrame& frame, const SeenTriangle& seen, std::size_t begin, std::size_t end);
  void store(std::size_t begin, std::size_t end, const Vec3& normal, PrimaryHits& hits,
    HitGeometry& geometry) const;
  bool areCoplanar(const HitGeometry& geometry) const;

  std::vector<std::uint32_t> Order;                      ///< hits surface by surface
  std::vector<std::uint32_t> Starts;                     ///< of the surfaces in it
  std::vector<double> X, Y, Dx, Dy, Dz, Ranges, Cosines; ///< in that order
  std::vector<int> Kinds;
};
}

#endif
