// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSight.h
 * @brief What one beam sees: the triangles, their shares of its solid angle, and the energy that it
 * receives of each.
 *
 * The beam goes through the stages of a scan (BeamSimulator.h), without noise and limits, and its
 * samples are summed by triangle. Movers are met where they are at the beam's time. Of a Gaussian
 * beam shares are those of a uniform one with the same outline. Energies are those of direct echoes
 * from all ranges; paths over two reflections and what the air returns are not among them.
 *
 * Source: none.
 * Valid: shares are of the solid angle for round beams, of the area of the beam's plane for others
 * (BeamShape.h); as exact as the samples are: few triangles are integrated, more are sampled.
 * Test: Testing/Python/TestBeamView.py.
 */
#ifndef avianlidar_BeamSight_h
#define avianlidar_BeamSight_h

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
  /// Scene coordinates, m: of a triangle, or of two with consecutive numbers that are one
  /// quadrilateral (BeamTriangles.h).
  std::vector<Vec3> corners;
  int objectId = 0;
  int materialId = 0;
  double share = 0.0;   ///< of the beam's solid angle
  double weight = 0.0;  ///< of the pulse's energy, that arrives there
  double energy = 0.0;  ///< J, received
  double range = 0.0;   ///< m, mean over the energy that arrives
  double cosine = 0.0;  ///< of incidence, likewise
  double nearest = 0.0; ///< m
  double farthest = 0.0;
};

/// What beam `beam` sees, in the order of the triangles. Throws WorkStopped.
/// @param setup planned (planModel()) @param wanted called now and then; if it returns false, the
/// work stops
std::vector<SeenSurface> sightAlong(const ScanSetup& setup, const ScanBeams& beams,
  std::size_t beam, const std::function<bool()>& wanted = {});

/// Directions along the outline of a beam, not normalised: their component along the axis is 1. A
/// round or elliptic outline has 64.
std::vector<Vec3> outlineOf(const BeamFrame& frame);

/// The part of a surface within an outline (above) and between its nearest and farthest range,
/// relative to the apex, m; empty if there is none.
std::vector<Vec3> partWithin(
  const BeamFrame& frame, const std::vector<Vec3>& outline, const SeenSurface& surface);
}

#endif
