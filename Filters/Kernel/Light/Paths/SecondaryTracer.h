// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryTracer.h
 * @brief Traces paths with two reflections from the hits of a beam (SecondaryReflection.h): finds
 * where mirror paths and short paths end, and which connections are blocked.
 *
 * The results are geometry and are stored in the beam's trace. Paths whose throughput lies below
 * the caller's threshold are not traced. Mirror paths from surfaces without pairs (MirrorPairs.h)
 * are not traced either.
 *
 * Source: paper, Sec. 3.4.
 * Differs: see SecondaryReflection.h.
 * Valid: as BeamTracer.h.
 * Test: TestSecondaryPaths.cxx, TestSecondaryReflection.cxx, TestSecondaryConstraints.cxx.
 */
#ifndef avianlidar_SecondaryTracer_h
#define avianlidar_SecondaryTracer_h

#include "ConnectionFinder.h"
#include "MirrorPairs.h"
#include "ScanSetup.h"
#include "SecondaryBeam.h"

#include <vector>

namespace avianlidar
{
/// Trace the mirror paths that are not yet traced and may have a throughput of at least `least`.
/// With an aperture, paths may end where only the mirror sees the second point.
/// @param throughputs upper bounds of throughputs, by sample @param pairs pairs of the beam, set
/// here; with the beam constraint, no path from surfaces without pairs is traced
void traceMirrors(const ScanSetup& setup, const SecondaryBeam& beam,
  const std::vector<double>& throughputs, double least, MirrorPairs& pairs);

/// Follow mirror paths from the starts that MirrorRegions::spread() appended from number `first`
/// on. Paths remain that do not end where the apex sees the end, but whose mirror's lobe has light
/// that the apex sees, at its end or in the mirror.
void traceBeyond(const ScanSetup& setup, const SecondaryBeam& beam, std::vector<MirrorPath>& paths,
  std::size_t first);

/// Find which mirror paths of MirrorRegions.h with a throughput of at least `least` are blocked,
/// and the matt ends of the others. No path is tested twice. @param throughputs throughput of each
/// path, as if not blocked
void traceMirrorPaths(const ScanSetup& setup, const SecondaryBeam& beam,
  const std::vector<double>& throughputs, double least);

/// Find the short paths of the samples, unless the trace already holds these paths.
void traceShortPaths(const ScanSetup& setup, const SecondaryBeam& beam, ConnectionFinder& finder);

/// Find which connections with a throughput of at least `least` are blocked. No connection is
/// tested twice.
/// @param throughputs throughput of each connection, as if not blocked
void traceConnections(
  const SecondaryBeam& beam, const std::vector<double>& throughputs, double least);
}

#endif
