// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TraceCache.h
 * @brief What a scan knows from earlier runs, and what that depends on.
 */
#ifndef avianlidar_TraceCache_h
#define avianlidar_TraceCache_h

#include "BeamSimulator.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// By which a beam is known again in another set of beams: its id, and a hash of where it starts
/// and points.
struct BeamKey
{
  std::uint64_t id;
  std::uint64_t geometry;
  bool operator==(const BeamKey& other) const
  {
    return this->id == other.id && this->geometry == other.geometry;
  }
};

/// What earlier runs found out about the geometry. Valid for one key; an aborted run leaves it
/// empty.
struct TraceCache
{
  std::uint64_t key = 0;  ///< traceKey()
  std::uint64_t scan = 0; ///< checksumOf() the beams
  std::vector<BeamTrace> beams;
  std::vector<BeamKey> keys; ///< of `beams`
  /// Known beams that the present scan lacks, as those do that a sweep has not come to: kept as
  /// long as each scan has some beam in common with what is known, and all has room.
  std::vector<BeamTrace> absent;
  std::vector<BeamKey> absentKeys;
  Shading shading; ///< of the run before

  /// Go on to another setup or other beams: keep what remains valid. @param maximumBytes for beams
  /// that are absent, what the others hold included
  void follow(const ScanSetup& setup, const ScanBeams& scanned, std::size_t maximumBytes);

  std::size_t bytes() const;
  void clear();

private:
  void take(const ScanBeams& scanned);
};

/// Hash of ids, origins and directions. Who keeps beams from one scan to the next can keep it with
/// them.
std::uint64_t checksumOf(const ScanBeams& beams);

/// Hash of all that a beam's geometry depends on besides the beam: mesh, beamwidth, profile,
/// sampling, N, seed, integration of planes, objects that may be small (which of them deserve rays
/// of their own is told beam by beam).
std::uint64_t traceKey(const ScanSetup& setup);
}

#endif
