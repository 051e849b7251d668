// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Tracker.h
 * @brief Tracks of targets from clusters, scan by scan.
 *
 * Of each track and cluster a Kalman filter says how far apart they are (MotionFilter.h). Pairs
 * within the gate are assigned one to one (Assignment.h) so that the sum of d2 + ln det S is least:
 * minus twice the log likelihood but for a constant. A track without a cluster costs the gate and
 * the largest ln det S of the scan, so that no pair costs more. What is left over begins tracks.
 *
 * Source: global nearest neighbour tracking with M of N confirmation: S. Blackman and R. Popoli,
 * "Design and Analysis of Modern Tracking Systems", 1999 (second-hand).
 * Differs: the price of a track without a cluster, for which probabilities of detection and
 * densities of clutter would have to be known.
 * Valid: each update is a whole scan, later than the one before.
 * Test: TestTracker.cxx, TestTracker.py.
 */
#ifndef avianlidar_Tracker_h
#define avianlidar_Tracker_h

#include "Clusters.h"
#include "MotionFilter.h"
#include "ParallelLoop.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
struct TrackerSettings
{
  double halfBeamwidth = 0.0; ///< rad
  double targetExtent = 0.0;  ///< m, of echoes about their target's middle, rms along each axis
  MotionModel motion;
  double gate = 0.0;              ///< largest square of the distance in standard deviations
  int confirmHits = 1;            ///< of the last confirmScans scans
  int confirmScans = 1;           ///< at most 32
  double minimumSpeed = 0.0;      ///< m/s, of a track that is confirmed
  int maximumMisses = 1;          ///< in a row, of a confirmed track
  double maximumPause = Infinity; ///< s, without a cluster
  std::size_t historyLength = 1;
  double keepTime = 0.0; ///< s
};

struct TrackPosition
{
  double time; ///< s
  Vec3 position;
  Vec3 velocity;
  std::array<double, 6> covariance; ///< m2: xx, yy, zz, xy, yz, xz
  int echoes;
};

struct Track
{
  int id = 0;
  bool confirmed = false;
  bool ended = false;
  int hits = 0;
  int misses = 0; ///< in a row
  std::uint32_t recent =
    0;                  ///< a bit for each of the last scans, the lowest of the last: was it hit
  double endTime = 0.0; ///< s
  MotionState state;    ///< at the time of the last position
  std::vector<TrackPosition> positions; ///< the last ones
};

/// The covariance (m2) of a cluster's centre as the position of a target.
glm::dmat3 positionError(
  const Cluster& cluster, const Vec3& sensor, double halfBeamwidth, double targetExtent);

class Tracker
{
public:
  /// One scan more. @param time s, of the scan @param goOn asked now and then; if it is false,
  /// WorkStopped is thrown @return the id of each cluster's track
  std::vector<int> update(const std::vector<Cluster>& clusters, const Vec3& sensor, double time,
    const TrackerSettings& settings, const KeepGoing& goOn = {});

  /// By id; those that ended, too, as long as they are kept.
  const std::vector<Track>& tracks() const { return this->Tracks; }

private:
  std::vector<Track> Tracks;
  int NextId = 0;
};
}

#endif
