// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamTrace.h
 * @brief What is kept of one beam: the geometry of its rays and paths, which does not depend on
 * energies, and the throughputs of its paths without air.
 *
 * Each part is found when it is first needed. A scan with other coefficients, limits, noise or
 * attenuation traces nothing that is kept. A beam that meets nothing takes 120 bytes, a hit 37, a
 * connection of two hits 85, and 40 more if it arrives.
 *
 * Source: none.
 * Valid: hits for one traceKey() (TraceCache.h), throughputs for one Shading (Throughput.h),
 * `lit` for one LightKey.
 * Test: TestScanAgain.cxx, TestScanAgainTowns.cxx, TestScanAgainPlates.cxx.
 */
#ifndef avianlidar_BeamTrace_h
#define avianlidar_BeamTrace_h

#include "BeamCells.h"
#include "BeamSamples.h"
#include "BeamTracer.h"
#include "LitBeam.h"
#include "SecondaryTrace.h"
#include "SmallTargets.h"
#include "Throughput.h"
#include "VisiblePolygons.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
struct BeamTrace
{
  std::uint32_t rays = 0;           ///< N of this beam; 0: not traced, and `hits` are path starts
  std::uint32_t targetsLeftOut = 0; ///< small targets beyond MaximumTargets, without rays
  std::unique_ptr<TargetRays> targets;       ///< rays of each small target; null: none
  double smallestTarget = -1.0;              ///< ModelNeeds::smallestTarget that they belong to
  SeenByBeam seen = SeenByBeam::Unknown;     ///< what the search for polygons has found
  std::unique_ptr<VisiblePolygons> polygons; ///< null if it has found none
  std::unique_ptr<CellSamples> cells;        ///< null if it is not divided into cells
  std::unique_ptr<BeamSamples> hits;         ///< null if no ray hit anything
  std::unique_ptr<SecondaryTrace> secondary; ///< null until first needed
  std::unique_ptr<Throughput> throughput;    ///< null until first needed
  std::unique_ptr<BeamSamples> pilot;        ///< of the pilot's rays, if it has a pilot
  std::unique_ptr<LitBeam> lit;              ///< null until it is lit, see LitBeam.h
  TraceCounters counters;                    ///< cost of all tracing so far
  std::size_t held = 0;                      ///< heldBytes() after it was last lit

  /// Bytes that it holds besides itself.
  std::size_t heldBytes() const
  {
    return (this->hits ? this->hits->bytes() : 0) +
      (this->throughput ? this->throughput->bytes() : 0) +
      (this->secondary ? this->secondary->bytes() : 0) + (this->pilot ? this->pilot->bytes() : 0) +
      (this->polygons ? this->polygons->bytes() : 0) + (this->cells ? this->cells->bytes() : 0) +
      (this->lit ? this->lit->bytes() : 0) +
      (this->targets ? sizeof(TargetRays) + this->targets->capacity() * sizeof(std::uint32_t) : 0);
  }
};
static_assert(sizeof(void*) != 8 || sizeof(BeamTrace) == 120, "as said above");
}

#endif
