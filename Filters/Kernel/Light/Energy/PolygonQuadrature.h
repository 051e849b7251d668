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
 * Valid: boundOf() bounds the error of a unit's energy. The bound is the sum of three parts:
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
#include "RangeUnits.h"
#include "VisiblePolygons.h"

#include <utility>
#include <vector>

namespace avianlidar
{
/// Number of range units up to which a polygon is never dropped.
constexpr double FewUnits = 16.0;

/// Relative error of a unit's energy where an aperture gathers all light that a surface returns.
constexpr double ErrorOfGathered = 1e-2;

/// Integrates one beam after the other. Each thread needs its own object. The setup must outlive
/// the object.
class PolygonQuadrature
{
public:
  explicit PolygonQuadrature(const ScanSetup& setup);

  /// Begin a beam. The caller must keep the polygons until the next call of begin().
  void begin(const BeamFrame& frame, const VisiblePolygons& seen);

  /// Extent and bounds of a beam, found without placing nodes.
  struct Extent
  {
    double nearest;     ///< lower bound of ranges, m
    double farthest;    ///< upper bound of ranges, m
    double returnBound; ///< upper bound of the energy that returns, J
    double mostInUnit;  ///< upper bound of the energy that returns in one range unit, J
    double mostAlbedo;  ///< largest albedo of the visible surfaces
  };
  const Extent& extent() const { return this->Whole; }

  /// The nodes of a beam that fits. The nodes are valid until the next call.
  const PolygonNodes& place();

  /// Bound of the energy, J, that a range unit loses by dropped and faint polygons.
  double dropped() const { return this->Dropped; }

  /// Bound of the error, J, of the energy that the nodes placed last put into some range units.
  /// @param energies energies of the nodes, J
  double boundOf(const RangeShares& shares, const std::vector<double>& energies) const;

private:
  /// Bounds of a polygon, found before it is integrated.
  struct Bounds
  {
    PolygonRule::Extent extent;
    double returned; ///< largest share of the arriving energy that returns
    double share;    ///< largest share of the pulse that arrives
    double inUnit;   ///< largest energy that returns in one range unit, J
    bool dropped;
    bool faint; ///< whether one sample per part suffices
  };
  Bounds boundsOf(const PlaneSurface& surface, const PlaneRing& ring) const;
  double mostReturnedBy(std::uint32_t triangle, double height, double mostInverse) const;
  void drop();
  template <class F>
  void forEachPart(F f);

  const ScanSetup& Setup;
  PolygonRule Rule;
  std::vector<Bounds> Polygons;
  /// Energy in a range unit, J, and number, for each faint polygon.
  std::vector<std::pair<double, std::uint32_t>> Faint;
  PolygonNodes Nodes;

  // The current beam.
  BeamFrame Frame;
  const VisiblePolygons* Seen = nullptr;
  Extent Whole{};
  double Misplaced = 0.0; ///< bound of the share of the pulse that may miss its surface
  double Dropped = 0.0;   ///< result of dropped(), J
  bool Gathers = false;   ///< whether the aperture gathers nearly all light that returns
};
}

#endif
