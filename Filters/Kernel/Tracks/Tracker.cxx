// SPDX-License-Identifier: BSD-3-Clause
#include "Tracker.h"

#include "Assignment.h"

#include <algorithm>
#include <bitset>

namespace avianlidar
{
namespace
{
using Row = std::vector<AllowedPair>;

struct Measured
{
  const std::vector<Cluster>& clusters; ///< clusters, sorted by x
  std::vector<glm::dmat3> errors;
  double largestError = 0.0; ///< square root of the largest trace, m
  double lastTime = -Infinity;
};

Measured measure(const std::vector<Cluster>& clusters, const Vec3& sensor, const TrackerSettings& s)
{
  Measured measured{ clusters, {} };
  for (const Cluster& cluster : clusters)
  {
    const glm::dmat3 error = positionError(cluster, sensor, s.halfBeamwidth, s.targetExtent);
    measured.errors.push_back(error);
    measured.largestError =
      std::max(measured.largestError, std::sqrt(error[0][0] + error[1][1] + error[2][2]));
    measured.lastTime = std::max(measured.lastTime, cluster.time);
  }
  return measured;
}

/// Upper bound of the distance from a track's last position to the end of its gate, m. Standard
/// deviations of sums are not above the sums of standard deviations.
double reachOf(const Track& track, const Measured& measured, const TrackerSettings& s)
{
  const double seconds = std::max(0.0, measured.lastTime - track.positions.back().time);
  const auto root = [&](std::size_t i)
  {
    const auto& c = track.state.covariance;
    return std::sqrt(c[i][i] + c[i + 1][i + 1] + c[i + 2][i + 2]);
  };
  const double speed = safeLength(track.state.velocity());
  const double turn = std::sqrt(track.state.covariance[6][6]);
  const double noise = std::sqrt(s.motion.accelerationDensity * seconds) * seconds;
  return speed * seconds +
    std::sqrt(s.gate) * (1.0 + 1e-6) *
    (root(0) + root(3) * seconds + 0.5 * turn * speed * seconds * seconds + noise +
      measured.largestError);
}

/// Pairs of a track within the gate, with their costs. @param largest ln det S so far, updated
Row pairsOf(const Track& track, const Measured& measured, const TrackerSettings& s, double& largest)
{
  Row pairs;
  const TrackPosition& last = track.positions.back();
  const double reach = reachOf(track, measured, s);
  const auto begin = measured.clusters.begin();
  auto next = std::lower_bound(begin, measured.clusters.end(), last.position.x - reach,
    [](const Cluster& cluster, double x) { return cluster.center.x < x; });
  MotionState state;
  double stateTime = -Infinity; // without timestamps, all clusters have the same time
  for (; next != measured.clusters.end() && next->center.x <= last.position.x + reach; ++next)
  {
    const Vec3 apart = next->center - last.position;
    if (next->time < last.time || !(glm::dot(apart, apart) <= reach * reach))
    {
      continue;
    }
    if (next->time != stateTime)
    {
      stateTime = next->time;
      state = predicted(track.state, stateTime - last.time, s.motion);
    }
    const auto cluster = static_cast<std::size_t>(next - begin);
    const Innovation innovation = innovationOf(state, next->center, measured.errors[cluster]);
    if (innovation.distanceSquare <= s.gate)
    {
      largest = std::max(largest, innovation.logDeterminant);
      pairs.push_back({ cluster, innovation.distanceSquare + innovation.logDeterminant });
    }
  }
  return pairs;
}

void confirm(Track& track, const TrackerSettings& s)
{
  const std::uint32_t window = ~std::uint32_t{ 0 } >> (32 - s.confirmScans);
  const auto hits = static_cast<int>(std::bitset<32>(track.recent & window).count());
  track.confirmed = track.confirmed ||
    (hits >= s.confirmHits && safeLength(track.state.velocity()) >= s.minimumSpeed);
}

void hit(Track& track, const MotionState& state, const Cluster& cluster, const TrackerSettings& s)
{
  track.state = state;
  track.recent = track.recent << 1 | 1u;
  track.misses = 0;
  ++track.hits;
  const auto& c = state.covariance;
  track.positions.push_back({ cluster.time, state.position(), state.velocity(),
    { c[0][0], c[1][1], c[2][2], c[0][1], c[1][2], c[0][2] }, cluster.points });
  if (track.positions.size() > s.historyLength)
  {
    track.positions.erase(track.positions.begin(),
      track.positions.end() - static_cast<std::ptrdiff_t>(s.historyLength));
  }
  confirm(track, s);
}

void miss(Track& track, double time, const TrackerSettings& s)
{
  track.recent <<= 1;
  ++track.misses;
  track.ended =
    track.misses >= (track.confirmed ? s.maximumMisses : s.confirmScans - s.confirmHits + 1);
  track.endTime = time;
}
}

glm::dmat3 positionError(
  const Cluster& cluster, const Vec3& sensor, double halfBeamwidth, double targetExtent)
{
  const Vec3 line = cluster.center - sensor;
  const double range = safeLength(line);
  // Each coordinate of a point anywhere in a disc of radius a has the variance a^2 / 4.
  const double radius = range * halfBeamwidth;
  const double across = 0.25 * radius * radius;
  const Vec3 u = range > 0.0 ? unitVector(line) : Vec3(0.0);
  const glm::dmat3 sum = glm::dmat3(across + targetExtent * targetExtent) +
    (cluster.rangeVariance - across) * glm::outerProduct(u, u);
  return sum / static_cast<double>(cluster.points);
}

std::vector<int> Tracker::update(const std::vector<Cluster>& clusters, const Vec3& sensor,
  double time, const TrackerSettings& s, const KeepGoing& goOn)
{
  const auto drop = [this](const auto& isOver)
  {
    this->Tracks.erase(
      std::remove_if(this->Tracks.begin(), this->Tracks.end(), isOver), this->Tracks.end());
  };
  // An echo after a pause belongs to another bird. No state is predicted that far.
  for (Track& track : this->Tracks)
  {
    if (!track.ended && time - track.positions.back().time > s.maximumPause)
    {
      track.ended = true;
      track.endTime = time;
    }
  }
  drop([&](const Track& track)
    { return track.ended && (!track.confirmed || time - track.endTime > s.keepTime); });
  const Measured measured = measure(clusters, sensor, s);
  std::vector<Row> rows(this->Tracks.size());
  double largest = -Infinity;
  constexpr std::size_t interval = 64; // tracks between checks, each compared with many clusters
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    if (goOn && i % interval == 0 &&
      !goOn(static_cast<double>(i) / static_cast<double>(rows.size())))
    {
      throw WorkStopped();
    }
    if (!this->Tracks[i].ended)
    {
      rows[i] = pairsOf(this->Tracks[i], measured, s, largest);
    }
  }
  const double without = largest > -Infinity ? s.gate + largest : 0.0;
  const std::vector<std::size_t> clusterOf = assign(rows, clusters.size(), without);
  std::vector<int> ids(clusters.size(), -1);
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    Track& track = this->Tracks[i];
    const std::size_t cluster = clusterOf[i];
    if (cluster != Unassigned)
    {
      const Cluster& own = clusters[cluster];
      const double seconds = own.time - track.positions.back().time;
      const MotionState before = predicted(track.state, seconds, s.motion);
      hit(track, updated(before, own.center, measured.errors[cluster]), own, s);
      ids[cluster] = track.id;
    }
    else if (!track.ended)
    {
      miss(track, time, s);
    }
  }
  drop([](const Track& track) { return track.ended && !track.confirmed; });
  for (std::size_t i = 0; i < clusters.size(); ++i)
  {
    if (ids[i] < 0)
    {
      ids[i] = this->NextId++;
      this->Tracks.emplace_back();
      this->Tracks.back().id = ids[i];
      hit(this->Tracks.back(), startMotion(clusters[i].center, measured.errors[i], s.motion),
        clusters[i], s);
    }
  }
  return ids;
}
}
