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
};

std::vector<AccuracySceneEntry> accuracyScenes();
}

#endif
