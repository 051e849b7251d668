// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamTrace.h
 * @brief Data kept for one beam: the geometry of its rays and paths, independent of energies, and
 * the energies of the beam (LitBeam.h).
 *
 * Each part of the data is computed when first needed. A scan with other coefficients, limits,
 * noise or attenuation does not trace kept parts again. The memory is 72 bytes for a beam without
 * hits, 37 bytes for each hit, and 81 bytes for each connection of two hits.
 *
 * Source: none.
 * Valid: geometry for one traceKey() (TraceCache.h), `lit` for one lightKey().
 * Test: TestScanAgain.cxx.
 */
#ifndef avianlidar_BeamTrace_h
#define avianlidar_BeamTrace_h

#include "BeamReport.h"
#include "BeamSamples.h"
#include "BeamTracer.h"
#include "LitBeam.h"
#include "RangeStrips.h"
#include "ScanBeams.h"
#include "SecondaryTrace.h"
#include "VisiblePolygons.h"

#include <cstddef>
#include <memory>
#include <variant>

namespace avianlidar
{
/// View of a beam whose rays are its samples.
struct RayView
{
};
/// View of a beam that no surface enters within the range gate.
struct EmptyView
{
  bool isBehindGate = false; ///< whether a surface enters the beam behind the gate
};

/// The view of a beam, with alternatives in the order of DirectEcho and pointers that are not null.
using BeamView = std::variant<std::monostate, EmptyView, std::unique_ptr<VisiblePolygons>,
  std::unique_ptr<CellSamples>, RayView>;

struct BeamTrace
{
  BeamView view;
  /// Hits of the beam's rays, from which paths with two reflections start. Null if no ray hits a
  /// triangle, and in an integrated beam until first needed.
  std::unique_ptr<BeamSamples> hits;
  std::unique_ptr<SecondaryTrace> secondary; ///< geometry of paths; null until first needed
  std::unique_ptr<LitBeam> lit;              ///< energies; null unless kept (LitBeam.h)
  TraceCounters counters;                    ///< cost of all tracing so far
  std::size_t held = 0;                      ///< heldBytes() when the beam was last lit, bytes

  DirectEcho direct() const { return static_cast<DirectEcho>(this->view.index()); }
  /// Visible polygons of an integrated beam; null for other beams.
  const VisiblePolygons* polygons() const { return this->part<VisiblePolygons>(); }
  /// True if the beam meets surfaces, all of them behind the range gate.
  bool isBehindGate() const
  {
    const auto* const empty = std::get_if<EmptyView>(&this->view);
    return empty && empty->isBehindGate;
  }
  /// Samples of a beam divided into cells; null for other beams.
  const CellSamples* cells() const { return this->part<CellSamples>(); }

  /// Memory of all parts, bytes.
  std::size_t heldBytes() const
  {
    const auto bytes = [](const auto& part) { return part ? part->bytes() : 0; };
    return bytes(this->polygons()) + bytes(this->cells()) + bytes(this->hits) +
      bytes(this->secondary) + bytes(this->lit);
  }

private:
  template <class Part>
  const Part* part() const
  {
    const auto* const found = std::get_if<std::unique_ptr<Part>>(&this->view);
    return found ? found->get() : nullptr;
  }
};
static_assert(sizeof(void*) != 8 || sizeof(BeamTrace) == 72, "as said above");
}

#endif
