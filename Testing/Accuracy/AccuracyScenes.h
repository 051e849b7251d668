// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AccuracyScenes.h
 * @brief The scenes on which errors are measured, each with sensor, settings and beams.
 */
#ifndef avianlidar_AccuracyScenes_h
#define avianlidar_AccuracyScenes_h

#include "Scan.h"

#include <functional>
#include <string>
#include <vector>

namespace accuracy
{
/// A scan. Noise is off: at the paper's values it is 1e-12 of Qlow.
struct AccuracyScene
{
  std::string name;
  avianlidar::ScanSetup setup;
  avianlidar::ScanBeams beams; ///< none where the scene's data are absent
};

/// @c make: every stride-th column of the scan (every stride-th beam of edges and glints).
struct AccuracySceneEntry
{
  std::string name;
  std::function<AccuracyScene(std::int64_t stride)> make;
  bool shipped = false;           ///< needs nothing but the source tree
  std::int64_t checkStride = 1;   ///< for seconds
  std::int64_t stride = 1;        ///< for minutes
  bool everyNumberOfRays = false; ///< 16 and 1000, too
  bool everyTarget = false;       ///< target errors are measured here
  int reference = 1;              ///< so many times as many rays tell the truth
};

std::vector<AccuracySceneEntry> accuracyScenes();

/// 960 beams, each with a small target (a plate every way turned, or a box) of 0.2 to 8 % of its
/// solid angle: in turn alone, before a wall that fills the beam, on such a wall, across the rim of
/// the beam, half hidden by the edge of another wall. Qlow is low.
AccuracyScene makeSmallTargets(std::int64_t stride);

/// 960 beams with three plates of 0.2 to 8 m near the axis of each, every way turned, 40 to 300 m
/// away: hardly a beam meets no edge.
AccuracyScene makeEdges(std::int64_t stride);

/// 960 beams, each filled by a plate of its own that mirrors it back to within 1.2 half-beamwidths;
/// glass of the exponents given in turn. At 112 the lobe is eight times as wide as the beam, at 1e6
/// a twelfth of it.
AccuracyScene makeGlints(
  const std::string& name, const std::vector<double>& exponents, std::int64_t stride);

/// 960 beams, each filled by two plates of glass (exponent 1e6) that meet on its axis, each tilted
/// by up to 1.2 half-beamwidths of its own: a glint met on one says nothing of the other's.
AccuracyScene makeTwoGlints(std::int64_t stride);
}

#endif
