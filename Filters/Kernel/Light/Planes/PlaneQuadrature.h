// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PlaneQuadrature.h
 * @brief Integrates the direct echo of a beam that a few planes fill, instead of sampling it.
 *
 * What a point of a plane returns (Eq. 4-9), and when, depends on its surface and its angle of
 * incidence b alone: its range is h/cos b, h the plane's distance. So for each surface the beam is
 * an integral over b of (turns on the surface) sin b / (4 pi sin^2(t/2)), t the half-beamwidth
 * (uniform profile; for the Gaussian profile with its integral along the arc, ten points of Gauss's
 * rule). PlaneArcs.h gives the turns. Where a beam meets several planes, each is integrated over
 * its own angles of incidence.
 *
 * The interval is divided at the borders of surfaces (PatchBorders.h) and into the panels of
 * PlanePanels.h; between the borders of range units the share of the pulse is linear in the range.
 * Each panel takes a pair of Gauss-Kronrod rules of 5 to 15 points, and is halved where the two
 * differ by more than 3e-6 of its value. Their points become samples (BeamSamples.h). SIMD loops
 * (LaneMath.h); about 20 ns a node, and 10 ns more for every border that its circle crosses.
 *
 * Source: paper, Eq. 4-9; Gauss-Kronrod quadrature (GaussKronrod.h).
 * Differs: the paper samples all beams with rays.
 * Valid: boundOf() bounds the error: the difference of the two rules, summed over panels in
 * magnitude, which exceeds the error of the better one by far, and what rounding and the tolerances
 * of VisiblePatch.h can add. The same bits for every instruction set.
 * Test: TestPlaneQuadrature.cxx, TestPlaneSurfaces.cxx, TestPlaneIntegration.cxx,
 * TestPlaneIntegrationEdges.cxx, TestSeveralPlanes.cxx.
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
/// Time of an integrated beam in units of a ray's (80 ns): for search and receiver, for each node,
/// and for borders of surfaces, if there are any.
constexpr double RaysLikeAnIntegral = 25.0;
constexpr double RaysLikeANode = 1.0;
constexpr double RaysLikeBorders = 75.0;

/// Nodes of a beam as samples, and bounds of their errors.
struct BeamNodes
{
  BeamSamples samples;             ///< one surface per panel; `rays` is the number of nodes
  std::vector<double> errorWeight; ///< (Kronrod's weight - Gauss's)/Kronrod's
  double shift = 0.0;              ///< bound of the rounding of ranges, m; 0: moves no energy
  double misplaced = 0.0; ///< bound of the share of the pulse that may meet another surface or none
};

/// Integrates one beam after the other. Reusable without allocation; one per thread. The setup must
/// outlive it.
class PlaneQuadrature
{
public:
  explicit PlaneQuadrature(const ScanSetup& setup);

  /// False if the beam needs rays: where borders of surfaces do not fit together, where light may
  /// go from plane to plane and two reflections are asked for, where the receiver is so near that
  /// its aperture gathers everything, and where N rays take less time than the nodes.
  bool fits(const BeamFrame& frame, const VisiblePatch& patch);

  /// Length in range, m, of the footprint on a plane; infinite or NaN beyond the horizon.
  static double footprintOf(const BeamFrame& frame, const PatchPlane& plane);

  /// Most planes that a beam may meet and still fit.
  std::size_t mostPlanes() const;

  /// False if a beam cannot fit, judged by the range units that its footprint meets and by the
  /// surfaces that some rays hit; mostRaysOff() rays may be wrong. @param footprint of a plane, m;
  /// negative: there are several @param triangles hit by the rays, at least one; NoTriangle: none
  bool mayFit(double footprint, const std::uint32_t* triangles, std::size_t count) const;

  /// The nodes of a beam that fits. Valid until the next call.
  const BeamNodes& place(const BeamFrame& frame, const VisiblePatch& patch);

  /// Extent and bound of a beam, found without its nodes.
  struct Extent
  {
    double nearest;      ///< m
    double farthest;     ///< m
    double mostReturned; ///< upper bound of the share of the pulse's energy that comes back
  };
  Extent extentOf(const BeamFrame& frame, const VisiblePatch& patch) const;

  /// Bound of the error, J, of the energy that the nodes placed last put into some range units.
  /// @param energies of the nodes, J @param most upper bound of the energy that the pulse returns,
  /// J
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

  // The current patch.
  std::vector<PatchSurface> Surfaces;  ///< surfaces of all planes
  std::vector<std::uint8_t> SurfaceOf; ///< of each triangle of the patch

  // Its current plane.
  std::vector<PatchSurface> PlaneSurfaces;
  std::vector<std::uint8_t> PlaneSurfaceOf; ///< of each triangle of the patch; Elsewhere
  PlaneDisc Disc{};
  PatchBorders Sides;
  PlaneArcs Arcs;

  std::vector<PlanePanel> Panels; ///< panels to place
  std::vector<PlanePanel> Coarse; ///< panels to place again in halves
  ArcNodes Placed;
  double NodeThroughputs[GaussKronrodRule::MostPoints];
};
}

#endif
