// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamView.h
 * @brief What one beam sees: nothing, visible polygons, strips of cells, or the hits of its rays.
 *
 * A view is kept from scan to scan.
 *
 * Source: none.
 * Valid: for one traceKey() (TraceCache.h), and in a crowded beam for one crowdKey().
 * Test: TestScanAgain.cxx.
 */
#ifndef avianlidar_BeamView_h
#define avianlidar_BeamView_h

#include "BeamSamples.h"
#include "RangeStrips.h"
#include "VisiblePolygons.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <variant>

namespace avianlidar
{
/// Method that gives the direct echo of a beam.
enum class DirectEcho : std::uint8_t
{
  Unknown = 0,  ///< the beam has not been traced yet
  Nothing = 1,  ///< no surface enters the beam within the range gate
  Polygons = 2, ///< integral over the polygons that the beam sees
  Cells = 3,    ///< sum over the strips of the beam's cells
  Rays = 4      ///< sum over the beam's N rays
};

/// A beam whose rays are its samples.
struct SeenByRays
{
};
/// A beam that no surface enters within the range gate.
struct NothingSeen
{
  bool isBehindGate = false; ///< whether a surface enters the beam behind the gate
};

/// What a beam sees, with alternatives in the order of DirectEcho and pointers that are not null.
using SeenSurfaces = std::variant<std::monostate, NothingSeen, std::unique_ptr<VisiblePolygons>,
  std::unique_ptr<CellSamples>, SeenByRays>;

struct BeamView
{
  SeenSurfaces seen;
  /// Hits of the beam's rays, from which paths with two reflections start. Null if a beam by rays
  /// hits nothing, and in integrated beams until first needed. Empty if no ray of a beam in cells
  /// hits a triangle.
  std::unique_ptr<BeamSamples> hits;

  DirectEcho direct() const { return static_cast<DirectEcho>(this->seen.index()); }
  /// Visible polygons of an integrated beam; null for other beams.
  const VisiblePolygons* polygons() const { return this->part<VisiblePolygons>(); }
  /// Samples of a beam divided into cells; null for other beams.
  const CellSamples* cells() const { return this->part<CellSamples>(); }
  /// Surfaces between which mirror paths are found by regions (MirrorRegions.h), with hidden parts
  /// if the beam is in cells. Null if mirror paths start from rays: in beams by rays, and in beams
  /// that see more than 1,024 polygons.
  const VisiblePolygons* surfacesOfMirrors() const
  {
    constexpr std::size_t most = 1024;
    const VisiblePolygons* const surfaces =
      this->cells() ? this->cells()->surfaces.get() : this->polygons();
    return surfaces && surfaces->polygons.size() <= most ? surfaces : nullptr;
  }
  /// True if the beam meets surfaces, all of them behind the range gate.
  bool isBehindGate() const
  {
    const auto* const nothing = std::get_if<NothingSeen>(&this->seen);
    return nothing && nothing->isBehindGate;
  }
  /// True if the direct echo has samples.
  bool meetsSurfaces() const
  {
    const BeamSamples* const samples = this->cells() ? &this->cells()->samples : this->hits.get();
    return this->polygons() || (samples && samples->size() > 0);
  }

  /// Memory of all parts, bytes.
  std::size_t bytes() const
  {
    const auto of = [](const auto& part) { return part ? part->bytes() : 0; };
    return of(this->polygons()) + of(this->cells()) + of(this->hits);
  }

private:
  template <class Part>
  const Part* part() const
  {
    const auto* const found = std::get_if<std::unique_ptr<Part>>(&this->seen);
    return found ? found->get() : nullptr;
  }
};
}

#endif
