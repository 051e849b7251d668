// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ViewFinder.h
 * @brief Finds the view of a beam: which of its candidates (Candidates.h) the beam sees.
 *
 * A beam that few triangles enter is integrated over the polygons that it sees (VisiblePolygons.h,
 * PolygonQuadrature.h). A beam that more triangles enter is divided into cells (BeamCells.h). If
 * more than MostTrianglesOfCells triangles enter, the beam is crowded: each ray of the cells
 * descends the collision tree. If the cells have too many strips, the rays of the beam are the
 * samples.
 *
 * Source: see the headers named above.
 * Differs: the paper draws N rays for every beam.
 * Valid: a view depends only on the beam, the triangles that enter the beam, the inputs of
 * traceKey() and, if the beam is crowded, the inputs of crowdKey(). A view does not depend on
 * attenuation or the number of reflections.
 * Test: TestScan.cxx, TestScanAgain.cxx, TestBeamCells.cxx.
 */
#ifndef avianlidar_ViewFinder_h
#define avianlidar_ViewFinder_h

#include "BeamCells.h"
#include "BeamTracer.h"
#include "BeamView.h"
#include "PolygonRule.h"
#include "ScanSetup.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Finds the view of one beam after the other. Each thread needs its own object. The constructor's
/// arguments must outlive the object.
class ViewFinder
{
public:
  ViewFinder(const ScanSetup& setup, const SceneTriangles& scene, BeamTracer& tracer);

  /// @param candidates all triangles that may enter the beam in the ranges that matter, each once,
  /// in any order
  /// @param cost counters, increased by the cost of traced rays
  SeenSurfaces find(std::uint64_t beam, const BeamFrame& frame,
    const std::vector<std::uint32_t>& candidates, TraceCounters& cost);

private:
  std::unique_ptr<CellSamples> findCrowded(
    std::uint64_t beam, const BeamFrame& frame, TraceCounters& cost);
  bool meetsBorders(const BeamFrame& frame) const;

  const ScanSetup& Setup;
  BeamTracer& Tracer;
  PolygonFinder Polygons;
  PolygonRule Rule;
  BeamCells Cells;
  std::vector<std::uint32_t> Numbers; ///< triangles that may enter a crowded beam
};
}

#endif
