// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Tracker.h
 * @brief Tracks of targets from clusters, scan by scan.
 *
 * A Kalman filter (MotionFilter.h) gives the squared distance d2 between each track and each
 * cluster, and the covariance S of their difference. Pairs within the gate are assigned one to one
 * (Assignment.h) so that the sum of d2 + ln det S is least. Up to a constant, this sum is minus
 * twice the log likelihood. A track without a cluster costs the gate plus the largest ln det S of
 * the scan, so that no pair costs more. Unassigned clusters begin tracks.
 *
 * Source: global nearest neighbour tracking with M of N confirmation: S. Blackman and R. Popoli,
 * "Design and Analysis of Modern Tracking Systems", 1999 (as cited by other authors).
 * Differs: the cost of a track without a cluster is as above. The usual cost requires probabilities
 * of detection and densities of clutter.
 * Valid: each update is a whole scan, later than the scan before.
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
  double halfBeamwidth = 0.0; ///< half-beamwidth, rad
  double targetExtent = 0.0;  ///< rms offset of echoes from the target's middle along each axis, m
  MotionModel motion;
  double gate = 0.0;              ///< largest squared distance of a pair, in standard deviations
  int confirmHits = 1;            ///< M: number of hits in the last N scans that confirm a track
  int confirmScans = 1;           ///< N: number of scans for a confirmation, at most 32
  double minimumSpeed = 0.0;      ///< least speed that confirms a track, m/s
  int maximumMisses = 1;          ///< number of misses in a row that end a confirmed track
  double maximumPause = Infinity; ///< longest time without a cluster, s
  std::size_t historyLength = 1;  ///< number of positions that are kept for a track
  double keepTime = 0.0;          ///< time for which ended tracks are kept, s
};

struct TrackPosition
{
  double time; ///< time, s
  Vec3 position;
  Vec3 velocity;
  std::array<double, 6> covariance; ///< covariance of the position, m2: xx, yy, zz, xy, yz, xz
  int echoes;
};

struct Track
{
  int id = 0;
  bool confirmed = false;
  bool ended = false;
  int hits = 0;
  int misses = 0;           ///< number of misses in a row
  std::uint32_t recent = 0; ///< bits of the last scans, the lowest bit for the latest scan; 1: hit
  double endTime = 0.0;     ///< time at which the track ended, s
  MotionState state;        ///< state at the time of the last position
  std::vector<TrackPosition> positions; ///< the last historyLength positions
};

/// Covariance of a cluster's centre as the position of a target, m2.
glm::dmat3 positionError(
  const Cluster& cluster, const Vec3& sensor, double halfBeamwidth, double targetExtent);

class Tracker
{
public:
  /// Updates the tracks with one more scan. @param time time of the scan, s
  /// @param goOn function called repeatedly; WorkStopped is thrown if it returns false; may be
  /// empty
  /// @return id of each cluster's track
  std::vector<int> update(const std::vector<Cluster>& clusters, const Vec3& sensor, double time,
    const TrackerSettings& settings, const KeepGoing& goOn = {});

  /// All tracks, sorted by id. Tracks that ended are included as long as they are kept.
  const std::vector<Track>& tracks() const { return this->Tracks; }

private:
  std::vector<Track> Tracks;
  int NextId = 0;
};
}

#endif
