// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Workload.h
 * @brief What is measured of a scene, made before any time is taken: beams with their rays, which
 * everyone traces, and whole scans without VTK, simulateScan().
 */
#ifndef avianlidar_Workload_h
#define avianlidar_Workload_h

#include "BeamFrame.h"
#include "BeamRays.h"
#include "BeamTracer.h"
#include "EchoTestScene.h"
#include "SameEchoes.h"
#include "Scenes.h"

namespace benchmarks
{
using echotest::runScan;
using echotest::sameEchoes;

/// One cell of the matrix, apart from scene and threads.
struct BeamAxes
{
  int raysPerBeam = 100;
  double halfBeamwidth = 5.6e-3; ///< rad
  int channels = 0;              ///< 16 or 32 of the airport scan; 0: the scene's own scan
  /// Take every k-th column of the scan so that there are at most so many; 0: all.
  std::size_t mostRays = 0;
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
  Vec3 direction(std::size_t ray) const;
  /// Beams handed to a thread at once: whole packets of sixteen rays.
  std::size_t beamsPerBlock() const;
};

Workload makeWorkload(const Scene& scene, const BeamAxes& axes);

/// The project's defaults, but every beam is sampled.
avianlidar::ScanSetup makeSetup(
  const Scene& scene, std::shared_ptr<const avianlidar::CollisionTree> tree);

/// The beams of the scene's scan with the time of each, every `stride`-th column of it.
avianlidar::ScanBeams makeBeams(const Scene& scene, std::int64_t stride = 1);
}

#endif
