// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Windows.h
 * @brief Range windows in which errors are measured: the strongest range unit of every return that
 * one seed sees, and what arrives there in truth, from many more rays.
 */
#ifndef avianlidar_Windows_h
#define avianlidar_Windows_h

#include "AccuracyScenes.h"

namespace accuracy
{
struct Window
{
  std::size_t beam = 0;    ///< of the scene
  std::int64_t unit = 0;   ///< range unit m
  double truth = 0.0;      ///< J, Qrec of the reference
  double truthError = 0.0; ///< J, its standard error
  double covered = 0.0;    ///< share of the beam's energy whose direct pulse reaches into the unit
  double secondary = 0.0;  ///< share of the truth that came over two reflections
};

/// What a beam received in each range unit.
struct UnitEcho
{
  std::size_t beam;
  std::int64_t unit;
  avianlidar::Echo echo;
};

/// Every range unit above `limit` J of every beam. @param cache empty; gets what was traced
/// @param threads 0: all
std::vector<UnitEcho> unitEchoes(avianlidar::ScanSetup setup, const avianlidar::ScanBeams& beams,
  avianlidar::EchoSettings settings, double limit, avianlidar::TraceCache& cache, int threads = 0);

/// Seed of the windows that are measured.
constexpr int SeedOfWindows = 1000;

/// Below so many Qlow selection is what is measured.
constexpr double LeastTruth = 2.0; // Qlow

/// Windows of `settings` (their rays, sampling, ... and seed) with a truth of at least LeastTruth.
/// @param rays of the reference
std::vector<Window> findWindows(
  const AccuracyScene& scene, const avianlidar::EchoSettings& settings, int rays);

/// Beams `chosen` of all.
avianlidar::ScanBeams beamsOf(
  const avianlidar::ScanBeams& beams, const std::vector<std::size_t>& chosen);

/// The different beams of the windows, ascending.
std::vector<std::size_t> beamsOf(const std::vector<Window>& windows);
}

#endif
