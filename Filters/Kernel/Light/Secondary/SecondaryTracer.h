// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryTracer.h
 * @brief Traces the paths on from the hits of a beam (SecondaryReflection.h): where mirror paths
 * and short paths end, and whether anything stands in the way of connections.
 *
 * The results are geometry and go to the beam's trace. Only paths that may be as strong as the
 * caller needs are traced.
 *
 * Source: paper, Sec. 3.4.
 * Differs: see SecondaryReflection.h.
 * Valid: as BeamTracer.h.
 * Test: TestSecondaryPaths.cxx, TestSecondaryReflection.cxx, TestSecondaryConstraints.cxx.
 */
#ifndef avianlidar_SecondaryTracer_h
#define avianlidar_SecondaryTracer_h

#include "ConnectionFinder.h"
#include "ScanSetup.h"
#include "SecondaryBeam.h"

#include <vector>

namespace avianlidar
{
/// Trace the mirror paths that are not known yet and may have a throughput of at least `least`.
/// @param throughputs bounds, by sample
void traceMirrors(const ScanSetup& setup, const SecondaryBeam& beam,
  const std::vector<double>& throughputs, double least);

/// Find which mirror paths by regions (MirrorRegions.h) of at least the throughput `least` are
/// blocked, if not known yet. @param throughputs by path, if it is not blocked
void traceRegions(const SecondaryBeam& beam, const std::vector<double>& throughputs, double least);

/// Find the short paths of the samples, if not known yet.
void traceShortPaths(const ScanSetup& setup, const SecondaryBeam& beam, ConnectionFinder& finder);

/// Find which connections of at least the throughput `least` are blocked, if not known yet.
/// @param throughputs by connection, if it is not blocked
void traceConnections(
  const SecondaryBeam& beam, const std::vector<double>& throughputs, double least);
}

#endif
