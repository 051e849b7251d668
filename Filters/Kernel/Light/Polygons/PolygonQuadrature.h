// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PolygonQuadrature.h
 * @brief Integrates the direct echo of a beam over its visible polygons, instead of sampling it.
 *
 * On a plane the range r is sqrt(1 + t^2 rho^2)/w, w the affine 1/z, rho the distance from the axis
 * in half-beamwidths and t = tan(theta0.5), and the cosine of incidence h/r, h the distance of the
 * plane. So each polygon is cut, across the gradient of w, where a pulse begins to enter a range
 * unit or to leave it; in between the unit's share of the pulse is linear in r. Further cuts follow
 * where the range changes by MostStretch or the specular lobe by MostFall. A part becomes one
 * sample at its mean w and mean rho^2, or two at its mean w plus and minus its standard deviation,
 * or four, with rho^2 likewise, all with the exact solid angle (DiscPolygon.h). Where beams are
 * wide or Gaussian, or a lobe is not much wider than the beam, a part takes a product of Gauss's
 * rules instead.
 *
 * Ground seen at a grazing angle spreads little energy over hundreds of units. Where paths that
 * cannot matter are dropped (EchoSettings::lightEnergyConstraint), so are such polygons, as long as
 * no unit loses more than half the tolerance of that constraint.
 *
 * Source: paper, Eq. 4-9; Gauss-Legendre quadrature.
 * Differs: the paper samples all beams with rays.
 * Valid: boundOf() bounds the error: ErrorOfUnit of the unit's energy, what curved lines of equal
 * range and the rounding of corners may move across borders of units, 1e-3 of the energy of faint
 * polygons, and what VisiblePolygons::lost may hide. Beyond the range gate units are not told
 * apart. Beams in which that curvature exceeds MostCurved range units, that need more samples than
 * MostNodes allow, or in which the aperture gathers everything, do not fit.
 * Test: TestPolygonQuadrature.cxx, TestPolygonUnits.cxx, TestPolygonShares.cxx,
 * TestPolygonEdges.cxx.
 */
#ifndef avianlidar_PolygonQuadrature_h
#define avianlidar_PolygonQuadrature_h

#include "BeamFrame.h"
#include "BeamSamples.h"
#include "DiscPolygon.h"
#include "RangeUnits.h"
#include "ScanSetup.h"
#include "VisiblePolygons.h"

#include <utility>
#include <vector>

namespace avianlidar
{
/// Largest error of a unit's energy, relative, but for what crosses its borders.
constexpr double ErrorOfUnit = 2e-6;

/// Most difference, in range units, between the ranges of a straight line of equal z.
constexpr double MostCurved = 0.1;

/// Polygons over more range units may be dropped.
constexpr double FewUnits = 16.0;

/// Most samples of a beam: so many in any case, and so many for each of its N rays.
constexpr double MostNodes = 3000.0;
constexpr double MostNodesPerRay = 5.0;

/// Most samples of polygons that are dropped, where nothing may be.
constexpr double MostNodesDropped = 1e5;

/// Samples of a beam, and bounds of their errors.
struct PolygonNodes
{
  BeamSamples samples;           ///< `rays` is the number of nodes
  std::vector<double> uncertain; ///< share of the node's energy that may lie beyond a border
  double misplaced = 0.0; ///< bound of the share of the pulse that may meet another surface or none
  double dropped = 0.0;   ///< J, bound of what a unit lacks for dropped and faint polygons
};

/// Integrates one beam after the other. One per thread; the setup must outlive it.
class PolygonQuadrature
{
public:
  explicit PolygonQuadrature(const ScanSetup& setup);

  /// Begin a beam. Frame and polygons must outlive its use.
  void begin(const BeamFrame& frame, const VisiblePolygons& seen);

  /// False if the beam needs rays.
  bool fits();

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

  /// Bound of the error, J, of the energy that the nodes placed last put into some range units.
  /// @param energies of the nodes, J @param most upper bound of the energy that the pulse returns
  double boundOf(const RangeShares& shares, const std::vector<double>& energies, double most) const;

private:
  /// The polygon at hand.
  struct Current
  {
    std::uint32_t triangle;
    Material material;
    double height, leastInverse; ///< m, 1/m
    double base, slope;          ///< w = base + slope p
    double inverseSlope;
    double width2;  ///< of the specular lobe; 0: none that matters
    double curved;  ///< m, see MostCurved
    double rounded; ///< m, error of ranges
    bool plain;     ///< no range unit is long against the range
    bool byRules;   ///< product of rules
    bool faint;     ///< puts little into any unit
    double inverse(double p) const;
  };
  /// What is known of a polygon before it is integrated.
  struct Bounds
  {
    double leastInverse, mostInverse; ///< of 1/z, 1/m; at most 1/height
    double returned;                  ///< most of the energy that arrives that comes back
    double share;                     ///< most of the pulse that arrives
    double inUnit;                    ///< J, most that comes back in one range unit
    bool dropped;
    bool faint; ///< one sample a part will do
  };
  Bounds boundsOf(const PolygonSurface& surface, const PlaneRing& ring) const;
  void drop();
  void setSurface(const PolygonSurface& surface, std::uint32_t triangle, const Bounds& bounds);
  void setLobe(double mostInverse);
  double fallAt(double inverse) const;
  double rangeAt(double p, double radius2) const;
  double placeOf(double range) const;
  void findBorders();
  void addUnitBorders();
  void addSmoothBorders(double from, double to);
  double countNodes(const Bounds& bounds) const;
  template <class F>
  void forEachPart(bool drops, F f);
  void placePolygon();
  double fallOfDisc() const;
  void placePlain();
  void placeNodes(std::size_t part, double uncertain);
  void placeRules(double from, double to, double uncertain);
  void addNode(double range, double inverse, double weight, double uncertain);
  double shareOf(double area, double radius2) const;
  double uncertainty(double from, double to) const;
  double mostReturnedBy(std::uint32_t triangle, double height, double mostInverse) const;

  const ScanSetup& Setup;
  const double UnitLength;  ///< m
  const double PulseLength; ///< m of range
  const double LastBorder;  ///< m: nothing beyond is received
  double Offsets[2];        ///< ranges at which a pulse begins or ends at a border, in units
  int NumberOfOffsets;
  double Tangent2 = 0.0; ///< t^2
  double ShareOfArea = 0.0;
  std::vector<Bounds> Polygons;
  std::vector<std::pair<double, std::uint32_t>> Faint; ///< energy in a unit, J; polygon
  PolygonNodes Nodes;

  // The beam.
  BeamFrame Frame;
  const VisiblePolygons* Seen = nullptr;
  Extent Whole{};
  bool Drops = false;   ///< faint polygons may be dropped
  bool Gathers = false; ///< the aperture gathers nearly all
  Current Now{};
  DiscPolygon Disc;
  std::vector<double> Ranges;
  std::vector<double> Borders; ///< p, ascending
  std::vector<double> OfUnits; ///< 1 for each that is a border of units, otherwise 0
  PartMoments Parts;
};
}

#endif
