// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Workload.h
 * @brief The beams and rays that everyone traces: made once, before any time is taken.
 */
#ifndef avianlidar_Workload_h
#define avianlidar_Workload_h

#include "BeamFrame.h"
#include "BeamRays.h"
#include "BeamTracer.h"
#include "BenchmarkScene.h"

#include <functional>
#include <string>
#include <vector>

namespace benchmarks
{
/// One cell of the matrix, apart from scene and threads.
struct BeamAxes
{
  int raysPerBeam = 100;
  double halfBeamwidth = 5.6e-3; ///< rad
  int channels = 0;              ///< 16 or 32 of the airport scan; 0: the scene's own scan
  std::size_t mostRays =
    0; ///< take every k-th column of the scan so that there are at most so many; 0: all
};

/// Rays of a scan, twice: as ours wants them, and as unit vectors in single precision in the same
/// order, which is compact: beam after beam, stratum after stratum.
struct Workload
{
  std::size_t raysPerBeam = 0;
  std::vector<avianlidar::BeamFrame> frames;
  std::vector<avianlidar::BeamRays> rays;
  std::vector<float> x, y, z; ///< one per ray, and 15 more, so that sixteen can be read anywhere

  std::size_t beams() const { return this->frames.size(); }
  std::size_t size() const { return this->beams() * this->raysPerBeam; }
  Vec3 direction(std::size_t ray) const
  {
    const std::size_t beam = ray / this->raysPerBeam;
    const std::size_t n = ray % this->raysPerBeam;
    return glm::normalize(
      this->frames[beam].direction(this->rays[beam].x[n], this->rays[beam].y[n]));
  }
  /// Beams handed to a thread at once: whole packets of sixteen rays.
  std::size_t beamsPerBlock() const;
};

Workload makeWorkload(const Scene& scene, const BeamAxes& axes);

/// Takes the hits of the rays [first, first + count), where they stand until it returns; called
/// from many threads. Empty: the rays are traced, and nothing else.
using Consumer =
  std::function<void(std::size_t first, const avianlidar::Hit* hits, std::size_t count)>;

/// Traces all rays of a workload with so many threads.
using Tracer = std::function<void(const Workload&, int threads, const Consumer&)>;

struct NamedTracer
{
  std::string name;
  Tracer trace;
};

/// All hits of a tracer, in the order of the rays.
std::vector<avianlidar::Hit> allHits(const Tracer& tracer, const Workload& workload, int threads);
}

#endif
