// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RaySamples.h
 * @brief Samples from rays: where each meets its triangle, and at which angle.
 *
 * Ranges and cosines follow from triangle and ray in double precision, whatever found the hit.
 * Rays are taken surface by surface, in loops over lanes: about 10 ns a ray and 0.2 us a surface.
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
/// Reusable without allocation; one per thread.
class RaySamples
{
public:
  /// Samples of N rays, each of weight 1/N. @param triangles of each ray, NoTriangle where it hit
  /// none
  void find(const TriangleMesh& mesh, const BeamFrame& frame, const BeamRays& rays,
    const std::vector<std::uint32_t>& triangles, BeamSamples& samples, SampleGeometry& geometry);

  /// The geometry of samples that are known. @param rays all of them, in the order of their numbers
  void findAgain(const TriangleMesh& mesh, const BeamFrame& frame, const BeamRays& rays,
    const BeamSamples& samples, SampleGeometry& geometry);

private:
  const SeenTriangle& see(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& apex);
  void sortBySurface(const std::vector<std::uint32_t>& triangles, BeamSamples& samples);
  void sortByTriangle(const std::vector<std::uint32_t>& triangles, BeamSamples& samples);
  void findDirections(const BeamFrame& frame, const BeamRays& rays, const BeamSamples& samples,
    SampleGeometry& geometry);
  void findOnSurface(const BeamFrame& frame, const SeenTriangle& seen, std::size_t begin,
    std::size_t end, const SampleGeometry& geometry, BeamSamples& samples);

  std::vector<std::uint32_t> Left, Sorted; ///< rays
  std::vector<BeamSamples::Surface> Surfaces;
  /// Triangles seen last: neighbouring beams meet the same. Each has one place.
  struct Known
  {
    std::uint32_t triangle = NoTriangle;
    const TriangleMesh* mesh = nullptr;
    Vec3 apex{ 0.0 };
    SeenTriangle seen;
  };
  static constexpr std::size_t Places = 256;
  std::vector<Known> Triangles;
  std::vector<double> X, Y;
  std::vector<int> Kinds;
};
}

#endif
