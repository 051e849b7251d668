// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanRunner.h
 * @brief The whole method without VTK, simulateScan(), on a scene of the benchmarks.
 */
#ifndef avianlidar_ScanRunner_h
#define avianlidar_ScanRunner_h

#include "BenchmarkScene.h"
#include "SameEchoes.h"
#include "Scan.h"

namespace benchmarks
{
/// The project's defaults, but every beam is sampled.
avianlidar::ScanSetup makeSetup(
  const Scene& scene, std::shared_ptr<const avianlidar::CollisionTree> tree);

/// Tree of the paper: k-D, boxes, leaves of one triangle (Sec. 5.1, Algorithm 1).
constexpr avianlidar::TreeOptions PaperTree{ avianlidar::SplitRule::Median,
  avianlidar::BoundingVolumeType::AABB, 1 };

/// Settings that add nothing to the paper: independent random rays, all beams sampled alike, one
/// point a range unit, one descent per beam, the light-energy constraint with the paper's
/// threshold.
avianlidar::ScanSetup makePaperSetup(
  const Scene& scene, std::shared_ptr<const avianlidar::CollisionTree> tree);

/// The beams of the scene's scan, every `stride`-th column of it.
avianlidar::ScanBeams makeBeams(const Scene& scene, std::int64_t stride = 1);

/// A scan of which nothing is known. @return number of echoes
std::size_t freshScan(
  const avianlidar::ScanSetup& setup, const avianlidar::ScanBeams& beams, int threads);

using echotest::sameEchoes;
}

#endif
