// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSurfaces.h
 * @brief Finds the triangles that one beam sees, their shares of its solid angle, and their
 * energies.
 *
 * The beam passes the stages of a scan (BeamSimulator.h), without noise and limits. The samples of
 * the beam are then summed by triangle. Movers are placed at their poses at the beam's time. A
 * Gaussian beam has the shares of a uniform beam with the same outline. Energies are sums of direct
 * echoes from all ranges, without paths with two reflections and without light from the air.
 *
 * Source: none.
 * Valid: shares of a round beam are shares of its solid angle. Shares of other beams are shares of
 * the area of the beam's plane (BeamShape.h). Shares are as exact as the samples: a beam that few
 * triangles enter is integrated, and other beams are sampled.
 * Test: Testing/Python/TestBeamView.py.
 */
#ifndef avianlidar_BeamSurfaces_h
#define avianlidar_BeamSurfaces_h

#include "BeamFrame.h"
#include "ScanBeams.h"
#include "ScanSetup.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace avianlidar
{
struct SeenSurface
{
  /// Corners of a triangle, or of a quadrilateral of two triangles with consecutive numbers
  /// (BeamTriangles.h), in scene coordinates, m.
  std::vector<Vec3> corners;
  int objectId = 0;
  int materialId = 0;
  double share = 0.0;    ///< share of the beam's solid angle
  double weight = 0.0;   ///< share of the pulse's energy that reaches the surface
  double energy = 0.0;   ///< energy received, J
  double range = 0.0;    ///< mean range, weighted with the energy at the surface, m
  double cosine = 0.0;   ///< mean cosine of incidence, weighted with the energy at the surface
  double nearest = 0.0;  ///< least range, m
  double farthest = 0.0; ///< largest range, m
};

/// Surfaces that beam `beam` sees, in the order of the triangles. @param setup setup planned by
/// planModel() @param wanted function called during the work; WorkStopped is thrown if it returns
/// false
std::vector<SeenSurface> surfacesAlong(const ScanSetup& setup, const ScanBeams& beams,
  std::size_t beam, const std::function<bool()>& wanted = {});

/// Directions along the outline of a beam, not normalised: the component along the axis is 1. A
/// round or elliptic outline has 64 directions.
std::vector<Vec3> outlineOf(const BeamFrame& frame);

/// The part of a surface within an outline (outlineOf()) and between the surface's nearest and
/// farthest range, as corners relative to the apex, m; empty if the outline contains no such part.
std::vector<Vec3> partWithin(
  const BeamFrame& frame, const std::vector<Vec3>& outline, const SeenSurface& surface);
}

#endif
