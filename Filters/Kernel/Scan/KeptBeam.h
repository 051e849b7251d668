// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file KeptBeam.h
 * @brief What is kept of one beam from scan to scan: its view, the geometry of its paths, and the
 * light that arrives.
 *
 * Each part is computed when first needed. A scan with other coefficients, limits, noise or
 * attenuation does not trace kept parts again. The memory is 72 bytes for a beam without hits, 37
 * bytes for each hit, and 81 bytes for each connection of two hits.
 *
 * Source: none.
 * Valid: geometry for one traceKey() (TraceCache.h), `lit` for one lightKey().
 * Test: TestScanAgain.cxx.
 */
#ifndef avianlidar_KeptBeam_h
#define avianlidar_KeptBeam_h

#include "BeamTracer.h"
#include "BeamView.h"
#include "LitBeam.h"
#include "SecondaryTrace.h"

#include <cstddef>
#include <memory>

namespace avianlidar
{
struct KeptBeam
{
  BeamView view;
  std::unique_ptr<SecondaryTrace> paths; ///< geometry of paths; null until first needed
  std::unique_ptr<LitBeam> lit;          ///< light; null unless kept
  TraceCounters counters;                ///< cost of all tracing so far
  std::size_t held = 0;                  ///< heldBytes() when the beam was last lit, bytes

  /// Memory of all parts, bytes.
  std::size_t heldBytes() const
  {
    return this->view.bytes() + (this->paths ? this->paths->bytes() : 0) +
      (this->lit ? this->lit->bytes() : 0);
  }
};
static_assert(sizeof(void*) != 8 || sizeof(KeptBeam) == 72, "as said above");
}

#endif
