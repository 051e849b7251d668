// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PlaneQuadrature.h
 * @brief The direct echo of a beam that a few planes fill, integrated instead of sampled.
 *
 * In the paper's radiometry all that a point of a plane returns (Eq. 4-9), and when, depends on its
 * surface and its angle of incidence b alone: its range is h/cos b, h the plane's distance. So the
 * beam is an integral over b of (turns on a surface) sin b / (4 pi sin^2(t/2)), t the
 * half-beamwidth, for each surface (uniform profile; for the Gaussian one with the integral of the
 * profile along the arc, ten points of Gauss's rule). Which turns those are: PlaneArcs.h. Where a
 * beam sees several planes, each is integrated in its own angles of incidence.
 *
 * The interval is parted where something changes: where borders of surfaces do (PatchBorders.h),
 * where a pulse begins to enter a range unit or to leave it (in between its share is linear in the
 * range), and by the width of the specular lobe, near a grazing direction, and where the cone just
 * misses the normal. Every panel takes a pair of Gauss-Kronrod rules (GaussKronrod.h) of 5 to 15
 * points, and is halved where the two differ by more than 3e-6 of what it holds. Their points
 * become samples as rays are (BeamSamples.h).
 *
 * Bound: the difference of the two rules, summed over panels in magnitude, which exceeds the error
 * of the better one by far, and what rounding and the tolerances of VisiblePatch.h can add.
 *
 * Loops over lanes (LaneMath.h): the same bits for every instruction set. Time: about 20 ns a node,
 * and 10 ns more for every border that its circle crosses.
 */
#ifndef avianlidar_PlaneQuadrature_h
#define avianlidar_PlaneQuadrature_h

#include "BeamFrame.h"
#include "BeamSamples.h"
#include "PlanePanels.h"
#include "RangeUnits.h"
#include "ScanSetup.h"
#include "VisiblePatch.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Time of an integrated beam, in that of rays (80 ns each): of its search and its receiver, of
/// each of its nodes, and of the borders of surfaces, if there are any.
constexpr double RaysLikeAnIntegral = 25.0;
constexpr double RaysLikeANode = 1.0;
constexpr double RaysLikeBorders = 75.0;

/// Where the energy of a beam arrives.
struct BeamNodes
{
  BeamSamples samples;             ///< a surface for each panel; `rays` is how many nodes there are
  std::vector<double> errorWeight; ///< (Kronrod's weight - Gauss's)/Kronrod's
  double shift = 0.0; ///< m, bound of what rounding adds to ranges; 0: it moves nothing
  double misplaced =
    0.0; ///< bound of the share of the pulse that may meet another surface, or none
};

/// Reusable without allocation; one per thread. The setup must outlive it.
class PlaneQuadrature
{
public:
  explicit PlaneQuadrature(const ScanSetup& setup);

  /// False if the beam needs rays: borders of surfaces that do not fit together, planes between
  /// which light may go, if two reflections are asked for, a receiver so near that its aperture
  /// gathers all, or so many nodes that N rays take less time.
  bool fits(const BeamFrame& frame, const VisiblePatch& patch);

  /// Length in range, m, of what the beam sees of a plane; infinite or NaN beyond the horizon.
  static double footprintOf(const BeamFrame& frame, const PatchPlane& plane);

  /// Planes that a beam may see and still fit.
  std::size_t mostPlanes() const;

  /// Of a beam some rays of which hit these triangles (at least one; NoTriangle: none): false if it
  /// does not fit, by the range units that its footprint goes over and by its surfaces, of which
  /// mostRaysOff() of the rays may tell wrongly. @param footprint of a plane that the beam sees, m;
  /// negative: it sees several
  bool mayFit(double footprint, const std::uint32_t* triangles, std::size_t count) const;

  /// Of a beam that fits. They stand until the next call.
  const BeamNodes& place(const BeamFrame& frame, const VisiblePatch& patch);

  /// What is known of a beam without its nodes.
  struct Extent
  {
    double nearest;      ///< m
    double farthest;     ///< m
    double mostReturned; ///< upper bound of the share of the pulse's energy that comes back
  };
  Extent extentOf(const BeamFrame& frame, const VisiblePatch& patch) const;

  /// Bound of the error, J, of what the nodes placed last put into some range units.
  /// @param energies J, of the nodes @param most J, what all of the pulse would bring back at most
  double boundOf(const RangeShares& shares, const std::vector<double>& energies, double most) const;

private:
  void findSurfaces(const VisiblePatch& patch);
  bool isAlike(std::uint32_t one, std::uint32_t two) const;
  bool beginPlane(const BeamFrame& frame, const VisiblePatch& patch, std::size_t plane);
  bool isSeen(const PlaneInterval& interval) const;
  double countNodes(double most);
  bool reachesAperture(const PatchSurface& surface) const;
  double mostNodes(bool borders) const;
  bool isOneSurface(const std::uint32_t* triangles, std::size_t count) const;
  bool takesLess(const BeamFrame& frame, const VisiblePatch& patch);
  void addInterval(const PlaneInterval& interval);
  void placePanels(const PlaneInterval& interval);
  bool isFine(const PlaneInterval& interval, const PlanePanel& panel, std::size_t first);
  void keep(const PlaneInterval& interval, const PlanePanel& panel, std::size_t first);
  void refine(const PlanePanel& panel);
  void findThroughputs(const Material& material, std::size_t first, int count);
  double shiftOf(const VisiblePatch& patch, const PatchPlane& plane) const;
  double shiftedOf(const RangeShares& shares, const std::vector<double>& energies) const;

  const ScanSetup& Setup;
  PlanePanels Ranges;
  BeamNodes Nodes;

  // The patch at hand.
  std::vector<PatchSurface> Surfaces;  ///< of all planes
  std::vector<std::uint8_t> SurfaceOf; ///< of each triangle of the patch

  // Its plane at hand.
  std::vector<PatchSurface> PlaneSurfaces;
  std::vector<std::uint8_t> PlaneSurfaceOf; ///< of each triangle of the patch; Elsewhere
  PlaneDisc Disc{};
  PatchBorders Sides;
  PlaneArcs Arcs;

  std::vector<PlanePanel> Panels; ///< to be placed
  std::vector<PlanePanel> Coarse; ///< placed, and to be placed again in halves
  ArcNodes Placed;
  double NodeThroughputs[GaussKronrodRule::MostPoints];
};
}

#endif
