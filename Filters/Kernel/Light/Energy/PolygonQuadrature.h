// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PolygonQuadrature.h
 * @brief Integrates the direct echo of a beam over the visible polygons, instead of sampling the
 * beam with rays.
 *
 * Each polygon has the samples of its rule (PolygonRule.h), if the beam needs at most MostNodes
 * samples. Ground at a grazing angle spreads little energy over hundreds of range units. With
 * EchoSettings::lightEnergyConstraint, the faintest of the polygons that extend over more than
 * FewUnits range units are dropped, as long as no unit loses more than half the tolerance of the
 * constraint.
 *
 * Source: paper, Eq. 4-9, and the light-energy constraint of Sec. 3.4.
 * Differs: the paper samples all beams with rays.
 * Valid: boundOfNodes() bounds the error of a unit's energy. The bound is the sum of three parts:
 * ErrorOfUnit times the energy, the energy that rules may put beyond borders of units, and the
 * energy that VisiblePolygons::lost may hide. Beyond the range gate, energies of single range units
 * are not valid. A beam does not fit if one of its polygons has no rule, or if it needs more than
 * MostNodes samples. Whether a beam fits depends only on geometry, not on materials or limits.
 * Test: TestEchoClosedForms.cxx, TestPolygonUnits.cxx, TestPolygonEdges.cxx,
 * TestPolygonLimits.cxx, TestPolygonPaths.cxx.
 */
#ifndef avianlidar_PolygonQuadrature_h
#define avianlidar_PolygonQuadrature_h

#include "BeamFrame.h"
#include "PolygonRule.h"
#include "RangeShares.h"
#include "VisiblePolygons.h"

#include <utility>
#include <vector>

namespace avianlidar
{
/// Number of range units up to which a polygon is never dropped.
constexpr double FewUnits = 16.0;

/// Relative error of a unit's energy where an aperture gathers all light that a surface returns.
constexpr double ErrorOfGathered = 1e-2;

/// Extent and bounds of an integrated beam, found without placing nodes.
struct PolygonBounds
{
  double nearest = 0.0;    ///< lower bound of ranges, m
  double farthest = 0.0;   ///< upper bound of ranges, m
  double returned = 0.0;   ///< upper bound of the energy that returns, J
  double mostInUnit = 0.0; ///< upper bound of the energy that returns in one range unit, J
  double mostAlbedo = 0.0; ///< largest albedo of the visible surfaces
  double dropped = 0.0;    ///< bound of the energy that a unit loses by dropped polygons, J
  bool gathers = false;    ///< whether the aperture gathers nearly all light that returns

  /// Bounds of one polygon.
  struct One
  {
    PolygonRule::Extent extent;
    double returned; ///< largest share of the arriving energy that returns
    double share;    ///< largest share of the pulse that arrives
    double inUnit;   ///< largest energy that returns in one range unit, J
    bool dropped;
    bool faint; ///< whether one sample per part suffices
  };
  std::vector<One> polygons; ///< in the order of VisiblePolygons::forEach()
};

/// Integrates one beam after the other. Each thread needs its own object. The setup must outlive
/// the object.
class PolygonQuadrature
{
public:
  /// @param parts number of parts of a range unit (partsOfUnit())
  PolygonQuadrature(const ScanSetup& setup, double parts);

  /// Find the bounds of a beam that sees these polygons, and which polygons are dropped.
  void bound(const VisiblePolygons& seen, PolygonBounds& bounds);

  /// Place the nodes of a beam that fits (PolygonRule::fits()).
  void place(const BeamFrame& frame, const VisiblePolygons& seen, const PolygonBounds& bounds,
    PolygonNodes& nodes);

private:
  PolygonBounds::One boundsOf(const PlaneSurface& surface, const PlaneRing& ring) const;
  double mostReturnedBy(std::uint32_t triangle, double height, double mostInverse) const;
  void drop(PolygonBounds& bounds);
  template <class F>
  void forEachPart(const VisiblePolygons& seen, const PolygonBounds& all, F f) const;

  const ScanSetup& Setup;
  PolygonRule Rule;
  /// Energy in a range unit, J, and number, for each faint polygon.
  std::vector<std::pair<double, std::uint32_t>> Faint;
};

/// Bound of the error, J, of the energy that the nodes of a beam put into some range units. @param
/// energies energies of the nodes, J
double boundOfNodes(
  const PolygonNodes& nodes, const RangeShares& shares, const std::vector<double>& energies);
}

#endif
