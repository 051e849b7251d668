// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryTracer.h
 * @brief Traces the paths on from the hits of a beam (SecondaryReflection.h): where mirror paths
 * end, and whether anything stands in the way of connections.
 *
 * The results are geometry and go to the beam's trace. Only paths that may be as strong as the
 * caller needs are traced, and not those known to meet nothing (PathSpace.h).
 *
 * Source: paper, Sec. 3.4.
 * Differs: see SecondaryReflection.h.
 * Valid: the same results as a descent of the tree for each path.
 * Test: TestSecondaryPaths.cxx, TestSecondaryReflection.cxx, TestSecondaryConstraints.cxx.
 */
#ifndef avianlidar_SecondaryTracer_h
#define avianlidar_SecondaryTracer_h

#include "PathSpace.h"
#include "ScanSetup.h"
#include "SecondaryBeam.h"

#include <vector>

namespace avianlidar
{
/// Traces the paths of one beam after the other. One per thread.
class SecondaryTracer
{
public:
  explicit SecondaryTracer(const ScanSetup& setup);

  /// Before anything is traced of another beam.
  void beginBeam() { this->Space.beginBeam(); }

  /// Trace the mirror paths that are not known yet and may have a throughput of at least `least`.
  /// @param throughputs bounds, by sample
  void traceMirrors(
    const SecondaryBeam& beam, const std::vector<double>& throughputs, double least);

  /// Find which connections of at least the throughput `least` are blocked, if not known yet.
  /// @param throughputs by connection, if it is not blocked
  void traceConnections(
    const SecondaryBeam& beam, const std::vector<double>& throughputs, double least);

private:
  void traceMirror(const SecondaryBeam& beam, const SecondaryScene& scene, std::uint32_t hit,
    const PathSpace::Candidates* candidates);
  Hit mirrorEnd(const SecondaryBeam& beam, const SecondaryScene& scene, std::uint32_t hit,
    const Vec3& direction, const PathSpace::Candidates* candidates) const;
  bool isBlocked(const SecondaryBeam& beam, const SecondaryScene& scene, std::size_t connection);

  const ScanSetup& Setup;
  PathSpace Space;
};
}

#endif
