// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TraceCache.h
 * @brief Beams kept from earlier runs of a scan, and the keys for which they are valid.
 *
 * Source: none.
 * Valid: hits belong to one traceKey(), those of crowded beams also to one crowdKey(), and lit
 * beams to one lightKey(). Echoes do not depend on the cache. An aborted run leaves it empty.
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

struct TraceCache
{
  std::uint64_t key = 0;  ///< traceKey() of the setup
  std::uint64_t scan = 0; ///< checksumOf() of the beams
  bool stays = false;     ///< whether the beams are the same as in the run before
  std::vector<KeptBeam> beams;
  std::vector<BeamKey> keys; ///< keys of `beams`
  /// Kept beams that are not in the present scan, such as beams of another part of a sweep. Absent
  /// beams are kept while each scan has a beam in common with the cache, and while memory allows.
  std::vector<KeptBeam> absent;
  std::vector<BeamKey> absentKeys;
  std::vector<std::unique_ptr<BeamSampler>> samplers; ///< sampler of each thread
  std::uint64_t light = 0;                            ///< lightKey() of the last run
  std::uint64_t crowd = 0;                            ///< crowdKey() of the last run

  /// Set setup and beams, and keep the beams that remain valid. Absent beams are removed if all
  /// beams take more than `maximumBytes`. @param maximumBytes largest memory for all beams, bytes
  void follow(const ScanSetup& setup, const ScanBeams& scanned, std::size_t maximumBytes);

  std::size_t bytes() const;
  void clear();

private:
  void take(const ScanBeams& scanned);
  void forgetLight();
  void forgetCrowds();
};

/// Hash of ids, origins and directions, for ScanBeams::checksum.
std::uint64_t checksumOf(const ScanBeams& beams);

/// Hash of everything besides the beam on which the hits of a beam depend: mesh, beam shape,
/// borders of media, all settings of rays (such as N and the sampling), and the seed. If beams may
/// be integrated or divided into cells, the hash includes range units, gate and object ids.
std::uint64_t traceKey(const ScanSetup& setup);

/// Hash of what decides how many rays the objects in crowded beams have (BeamCells::place()), and
/// whether surfaces behind the gate matter; 0 if no beam is divided into cells.
std::uint64_t crowdKey(const ScanSetup& setup);
}

#endif
