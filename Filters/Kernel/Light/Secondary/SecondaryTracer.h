// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryTracer.h
 * @brief Where the paths on from the hits of a beam lead (see SecondaryReflection.h): mirror paths
 * are followed to the surface that they meet, and connections are looked along.
 *
 * What is found is geometry and goes to the beam's trace. Only paths that may be as strong as the
 * caller needs are traced, and not those that are known to meet nothing (PathSpace.h).
 */
#ifndef avianlidar_SecondaryTracer_h
#define avianlidar_SecondaryTracer_h

#include "PathSpace.h"
#include "ScanSetup.h"
#include "SecondaryBeam.h"

#include <vector>

namespace avianlidar
{
/// One per thread.
class SecondaryTracer
{
public:
  explicit SecondaryTracer(const ScanSetup& setup);

  /// Before anything is traced of another beam.
  void beginBeam() { this->Space.beginBeam(); }

  /// Trace the mirror paths that are not known yet and may have a throughput of `least`. @param
  /// throughputs bounds, by sample
  void traceMirrors(
    const SecondaryBeam& beam, const std::vector<double>& throughputs, double least);

  /// Look which connections whose throughput is `least` are blocked, as far as it is not known.
  /// @param throughputs by connection: if it is not blocked
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
