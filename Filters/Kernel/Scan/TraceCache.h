// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TraceCache.h
 * @brief What a scan keeps from earlier runs, and the key that says when it is valid.
 *
 * Source: none.
 * Valid: hits belong to one traceKey(), lit beams to one LightKey. Echoes do not depend on what is
 * kept. An aborted run leaves the cache empty.
 * Test: TestScanAgain.cxx, TestScanSweep.cxx.
 */
#ifndef avianlidar_TraceCache_h
#define avianlidar_TraceCache_h

#include "BeamSimulator.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Identifies a beam in another set of beams: its id, and a hash of its origin and direction.
struct BeamKey
{
  std::uint64_t id;
  std::uint64_t geometry;
  bool operator==(const BeamKey& other) const
  {
    return this->id == other.id && this->geometry == other.geometry;
  }
};

/// Beams kept from earlier runs.
struct TraceCache
{
  std::uint64_t key = 0;  ///< traceKey()
  std::uint64_t scan = 0; ///< checksumOf() of the beams
  bool stays = false;     ///< beams are those of the run before
  std::vector<BeamTrace> beams;
  std::vector<BeamKey> keys; ///< of `beams`
  /// Beams that the present scan lacks, such as those of another part of a sweep. They are kept as
  /// long as each scan has a beam in common with what is kept, and memory allows.
  std::vector<BeamTrace> absent;
  std::vector<BeamKey> absentKeys;
  std::vector<std::unique_ptr<BeamSampler>> samplers; ///< one per thread
  LightKey light;                                     ///< of the last run

  /// Go on to another setup or other beams, and keep what remains valid. @param maximumBytes of all
  /// beams; if they hold more, absent ones are removed
  void follow(const ScanSetup& setup, const ScanBeams& scanned, std::size_t maximumBytes);

  std::size_t bytes() const;
  void clear();

private:
  void take(const ScanBeams& scanned);
  void forgetLight();
};

/// Hash of ids, origins and directions. It can be kept with the beams (ScanBeams::checksum).
std::uint64_t checksumOf(const ScanBeams& beams);

/// Hash of all that a beam's geometry depends on besides the beam: mesh, beamwidth, profile, source
/// and sampling of its samples, N, seed; where beams may be integrated or divided into cells also
/// range units, gate, and which triangles are one object.
std::uint64_t traceKey(const ScanSetup& setup);
}

#endif
