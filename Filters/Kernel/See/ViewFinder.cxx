// SPDX-License-Identifier: BSD-3-Clause
#include "ViewFinder.h"

#include <algorithm>

namespace avianlidar
{
ViewFinder::ViewFinder(const ScanSetup& setup, const SceneTriangles& scene, BeamTracer& tracer)
  : Setup(setup)
  , Tracer(tracer)
  , Polygons(scene,
      BeamShape(setup.sensor).width().isRound ? mostTrianglesIntegrated(setup.settings) : 0,
      MostTrianglesOfCells)
  , Rule(setup, partsOfUnit(setup))
  , Cells(setup, scene)
{
}

SeenSurfaces ViewFinder::find(std::uint64_t beam, const BeamFrame& frame,
  const std::vector<std::uint32_t>& candidates, TraceCounters& cost)
{
  this->Polygons.begin(frame);
  this->Polygons.add(candidates.data(), candidates.size());
  std::unique_ptr<VisiblePolygons> polygons;
  const SeenByBeam seen = this->Polygons.find(polygons);
  if (seen == SeenByBeam::Nothing)
  {
    return NothingSeen{};
  }
  if (seen == SeenByBeam::Polygons && !this->meetsBorders(frame) && this->Rule.fits(*polygons))
  {
    return SeenSurfaces(std::move(polygons));
  }
  const std::vector<const BeamSurface*>& entering = this->Polygons.candidates();
  std::unique_ptr<CellSamples> cells = entering.empty() ? this->findCrowded(beam, frame, cost)
                                                        : this->Cells.find(beam, frame, entering);
  return cells ? SeenSurfaces(std::move(cells)) : SeenSurfaces(SeenByRays{});
}

/// Cells of a beam that meets too many triangles for lists. @return null if there are too many
/// strips
std::unique_ptr<CellSamples> ViewFinder::findCrowded(
  std::uint64_t beam, const BeamFrame& frame, TraceCounters& cost)
{
  this->Numbers.clear();
  this->Polygons.entering().appendNumbers(this->Numbers);
  const BeamRays& rays = this->Cells.place(beam, frame, this->Numbers);
  DrawnRays given(&rays);
  const TracedBeams block{ &frame, 1, static_cast<std::uint32_t>(rays.size()), &given, nullptr,
    true };
  const TracedHits& found = this->Tracer.traceBeams(block, this->Setup.settings.traceMode);
  addCounters(found.counters[0], cost);
  const std::uint32_t* const triangles = found.triangles[0];
  std::unique_ptr<CellSamples> cells =
    triangles ? this->Cells.find(triangles) : std::make_unique<CellSamples>();
  if (cells)
  {
    cells->isCrowded = true;
  }
  return cells;
}

/// True if leaves, or the border of a medium, may lie in a beam. Such a beam cannot be integrated,
/// because samples of polygons have no place in the beam. A moving medium may be anywhere.
bool ViewFinder::meetsBorders(const BeamFrame& frame) const
{
  const std::vector<PlacedMedium>& media = this->Setup.media;
  return std::any_of(media.begin(), media.end(),
    [&](const PlacedMedium& placed)
    {
      const double gate = this->Setup.sensor.rangeGate;
      return placed.volume.velocity != Vec3(0.0) || mayMeetBorder(placed.volume, frame, gate) ||
        (placed.medium.sharesGaps && mayMeet(placed.volume, frame, gate, 0.0));
    });
}
}
