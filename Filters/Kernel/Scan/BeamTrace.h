// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamTrace.h
 * @brief What is kept of one beam: the geometric facts that do not depend on energies (where its
 * rays hit and at which angle, where mirror paths end, which pairs of hit points see each other),
 * and what its paths bring back without air.
 *
 * They are found when first needed and kept, so that a scan with other coefficients, limits, noise
 * or attenuation traces nothing that is already known, and does not look at triangles again. A beam
 * that meets nothing costs 112 bytes, a hit 37, a connection of two hits 85, and 36 more if it
 * arrives.
 */
#ifndef avianlidar_BeamTrace_h
#define avianlidar_BeamTrace_h

#include "BeamSamples.h"
#include "BeamTracer.h"
#include "SecondaryTrace.h"
#include "SmallTargets.h"
#include "Throughput.h"
#include "VisiblePatch.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
struct BeamTrace
{
  std::uint32_t rays = 0;              ///< N of this beam; 0: no rays traced yet
  std::uint32_t targetsLeftOut = 0;    ///< small ones without rays of their own, being too many
  std::unique_ptr<TargetRays> targets; ///< rays of each small one that has its own; null: none
  double smallestTarget = -1.0;        ///< of the needs that they were chosen for
  bool preTested = false;              ///< it is known whether planes fill it
  /// m, in range; planes (negative: several) may fill the beam, but are of several surfaces, or go
  /// over so many range units, that rays take less time, and this was not looked into. 0: it was,
  /// or it need not be.
  double footprint = 0.0;
  std::unique_ptr<VisiblePatch> patch;       ///< the planes that fill it; null if none do
  std::unique_ptr<BeamSamples> hits;         ///< null if no ray hit anything
  std::unique_ptr<SecondaryTrace> secondary; ///< null before the first need
  std::unique_ptr<Throughput> throughput;    ///< null before the first need
  std::unique_ptr<BeamSamples> pilot;        ///< of the pilot's rays, if a target error is set
  TraceCounters counters;                    ///< cost of all tracing so far
  std::size_t held = 0;                      ///< heldBytes() when it was lit last

  bool meetsSomething() const { return this->hits || this->patch; }

  /// What it holds besides itself.
  std::size_t heldBytes() const
  {
    return (this->hits ? this->hits->bytes() : 0) +
      (this->throughput ? this->throughput->bytes() : 0) +
      (this->secondary ? this->secondary->bytes() : 0) + (this->pilot ? this->pilot->bytes() : 0) +
      (this->patch ? this->patch->bytes() : 0) +
      (this->targets ? sizeof(TargetRays) + this->targets->capacity() * sizeof(std::uint32_t) : 0);
  }
};
static_assert(sizeof(void*) != 8 || sizeof(BeamTrace) == 112, "as said above");
}

#endif
