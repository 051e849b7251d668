// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RaySamples.h
 * @brief Samples from rays: range and angle of incidence of each ray on the triangle that the ray
 * hits.
 *
 * Rays are processed surface by surface, in SIMD loops, in about 10 ns per ray and 0.2 us per
 * surface.
 *
 * Source: paper, Eq. 18.
 * Differs: see TriangleTest.h.
 * Valid: ranges and cosines follow from triangle and ray in double precision, and do not depend on
 * how the hit was found.
 * Test: TestEchoClosedForms.cxx, TestScan.cxx.
 */
#ifndef avianlidar_RaySamples_h
#define avianlidar_RaySamples_h

#include "BeamFrame.h"
#include "BeamRays.h"
#include "BeamSamples.h"
#include "BeamTracer.h"
#include "TriangleMesh.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Finds the samples of one beam after the other, without allocation for each beam. Each thread
/// needs its own object. The scene must outlive the object.
class RaySamples
{
public:
  explicit RaySamples(const SceneTriangles& scene)
    : Scene(scene)
  {
  }

  /// Find the samples of N rays, each of weight 1/N.
  /// @param triangles triangle that each ray hits, or NoTriangle
  void find(const BeamFrame& frame, const BeamRays& rays,
    const std::vector<std::uint32_t>& triangles, BeamSamples& samples, SampleGeometry& geometry);

  /// Find the geometry of samples that were found before. @param rays all rays, in the order of
  /// their numbers
  void findAgain(const BeamFrame& frame, const BeamRays& rays, const BeamSamples& samples,
    SampleGeometry& geometry);

private:
  const SeenTriangle& see(std::uint32_t triangle, const Vec3& apex);
  void sortBySurface(const std::vector<std::uint32_t>& triangles, BeamSamples& samples);
  void sortByTriangle(const std::vector<std::uint32_t>& triangles, BeamSamples& samples);
  void findDirections(const BeamFrame& frame, const BeamRays& rays, const BeamSamples& samples,
    SampleGeometry& geometry);
  void findOnSurface(const BeamFrame& frame, const SeenTriangle& seen, std::size_t begin,
    std::size_t end, const SampleGeometry& geometry, BeamSamples& samples);

  const SceneTriangles& Scene;
  std::vector<std::uint32_t> Left, Sorted; ///< numbers of rays
  std::vector<BeamSamples::Surface> Surfaces;
  /// Cache of triangles, by number modulo Places. Neighbouring beams meet the same triangles.
  struct Known
  {
    std::uint32_t triangle = NoTriangle;
    Vec3 apex{ 0.0 };
    SeenTriangle seen;
  };
  static constexpr std::size_t Places = 256;
  std::vector<Known> Triangles;
  SeenTriangle Moved; ///< last triangle of a mover
  std::vector<double> X, Y;
  std::vector<int> Kinds;
};
}

#endif
