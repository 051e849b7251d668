// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PolygonQuadrature.h
 * @brief Integrates the direct echo of a beam over its visible polygons, instead of sampling it.
 *
 * Each polygon gets the samples of its rule (PolygonRule.h), as long as a beam needs few enough.
 * Ground seen at a grazing angle spreads little energy over hundreds of units. Where paths that
 * cannot matter are dropped (EchoSettings::lightEnergyConstraint), so are such polygons, as long as
 * no unit loses more than half the tolerance of that constraint.
 *
 * Source: paper, Eq. 4-9, and the light-energy constraint of Sec. 3.4.
 * Differs: the paper samples all beams with rays.
 * Valid: boundOf() bounds the error: ErrorOfUnit of the unit's energy, what the rules may put
 * beyond borders of units, and what VisiblePolygons::lost may hide. Beyond the range gate units are
 * not told apart. Beams with a polygon that has no rule, or that need more samples than MostNodes
 * allow, do not fit. Geometry alone decides that: neither materials nor limits do.
 * Test: TestPolygonQuadrature.cxx, TestPolygonUnits.cxx, TestPolygonShares.cxx,
 * TestPolygonEdges.cxx, TestPolygonScan.cxx, TestPolygonLimits.cxx, TestPolygonPaths.cxx,
 * TestPolygonReports.cxx.
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
/// Polygons over more range units may be dropped.
constexpr double FewUnits = 16.0;

/// Most samples of a beam. They are counted by an estimate without specular lobes; those add
/// theirs.
constexpr double MostNodes = 2e4;

/// Error of a unit's energy, relative, where an aperture gathers all that comes back from a part of
/// a surface.
constexpr double ErrorOfGathered = 1e-2;

/// Integrates one beam after the other. One per thread; the setup must outlive it.
class PolygonQuadrature
{
public:
  explicit PolygonQuadrature(const ScanSetup& setup);

  /// False if a beam that sees these polygons cannot be integrated. @param most samples that it may
  /// take
  bool fits(const VisiblePolygons& seen, double most = MostNodes) const;

  /// Begin a beam. Frame and polygons must outlive its use.
  void begin(const BeamFrame& frame, const VisiblePolygons& seen);

  /// Extent and bounds of a beam, known without its nodes.
  struct Extent
  {
    double nearest;      ///< m
    double farthest;     ///< m
    double mostReturned; ///< J, upper bound of the energy that comes back
    double mostInUnit;   ///< the same of what comes back in one range unit
    double mostAlbedo;   ///< of what it sees
  };
  const Extent& extent() const { return this->Whole; }

  /// The nodes of a beam that fits. Valid until the next call.
  const PolygonNodes& place();

  /// J, bound of what a range unit lacks for dropped and faint polygons.
  double dropped() const { return this->Dropped; }

  /// Bound of the error, J, of the energy that the nodes placed last put into some range units.
  /// @param energies of the nodes, J
  double boundOf(const RangeShares& shares, const std::vector<double>& energies) const;

private:
  /// What is known of a polygon before it is integrated.
  struct Bounds
  {
    PolygonRule::Extent extent;
    double returned; ///< most of the energy that arrives that comes back
    double share;    ///< most of the pulse that arrives
    double inUnit;   ///< J, most that comes back in one range unit
    bool dropped;
    bool faint; ///< one sample a part will do
  };
  Bounds boundsOf(const PlaneSurface& surface, const PlaneRing& ring) const;
  double mostReturnedBy(std::uint32_t triangle, double height, double mostInverse) const;
  void drop();
  template <class F>
  void forEachPart(F f);

  const ScanSetup& Setup;
  PolygonRule Rule;
  std::vector<Bounds> Polygons;
  std::vector<std::pair<double, std::uint32_t>> Faint; ///< energy in a unit, J; polygon
  PolygonNodes Nodes;

  // The beam.
  BeamFrame Frame;
  const VisiblePolygons* Seen = nullptr;
  Extent Whole{};
  double Misplaced = 0.0; ///< bound of the share of the pulse that may meet another surface or none
  double Dropped = 0.0;   ///< J
  bool Gathers = false;   ///< the aperture gathers nearly all
};
}

#endif
