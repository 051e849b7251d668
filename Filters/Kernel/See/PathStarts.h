// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PathStarts.h
 * @brief The hits of a beam's rays, as samples and as starts of paths with two reflections.
 *
 * Source: paper, Algorithm 2.
 * Differs: in an integrated beam, paths start where rays meet the visible polygons. No ray is
 * traced.
 * Valid: hits depend only on the beam and the inputs of traceKey() (TraceCache.h).
 * Test: TestScan.cxx, TestScanAgain.cxx.
 */
#ifndef avianlidar_PathStarts_h
#define avianlidar_PathStarts_h

#include "BeamView.h"
#include "DrawnRays.h"
#include "RaySamples.h"
#include "ScanSetup.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Where paths with two reflections start: nowhere, or at hits of rays. Valid as long as the view,
/// the drawn rays and the geometry do not change.
struct PathStarts
{
  const BeamSamples& hits;
  const BeamRays& rays;           ///< rays of the beam; empty without hits
  const SampleGeometry& geometry; ///< directions and surfaces of `hits`

  static PathStarts nowhere();
};

/// Finds the hits of one beam after the other. Each thread needs its own object. The constructor's
/// arguments must outlive the object.
class HitFinder
{
public:
  HitFinder(const ScanSetup& setup, const SceneTriangles& scene);

  /// Samples of the rays that hit a triangle. @param triangles nearest triangle of each ray, or
  /// NoTriangle
  std::unique_ptr<BeamSamples> hitsOf(const BeamFrame& frame, const BeamRays& rays,
    const std::vector<std::uint32_t>& triangles, SampleGeometry& geometry);

  /// Hits from which paths of a beam start, or nowhere if the settings or the view exclude such
  /// paths. The hits of an integrated beam are added to its view: one hit for each ray that meets a
  /// visible polygon. @param geometry geometry of the hits, set unless `known` is true
  PathStarts startsOf(std::size_t beam, const BeamFrame& frame, DrawnRays& rays, BeamView& view,
    SampleGeometry& geometry, bool known);

private:
  bool mayStartIn(const BeamView& view) const;

  const ScanSetup& Setup;
  RaySamples Samples;
  std::vector<std::uint32_t> Met; ///< triangles that the rays of an integrated beam meet
};
}

#endif
