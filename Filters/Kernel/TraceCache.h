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
/// What earlier runs found out about the geometry. Valid for one key; an aborted run leaves it
/// empty.
struct TraceCache
{
  std::uint64_t key = 0;
  std::vector<BeamTrace> beams;
  ShadingChange shading;
  ScanMemory memory; ///< of the run before
  std::size_t bytes() const;
  void clear();
};

/// Hash of ids, origins and directions. Who keeps beams from one scan to the next can keep it with
/// them.
std::uint64_t checksumOf(const ScanBeams& beams);

/// Hash of all that a beam's geometry depends on: mesh, beams, beamwidth, profile, sampling, N,
/// seed, precision, integration of planes, objects that may be small (which of them deserve rays of
/// their own is told beam by beam).
std::uint64_t traceKey(const ScanSetup& setup, const ScanBeams& beams);
}

#endif
