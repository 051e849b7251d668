// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PolygonRule.h
 * @brief Weighted samples of one visible polygon that stand for its direct echo in each range unit.
 *
 * On a plane the range r is sqrt(1 + t^2 rho^2)/w, w the affine 1/z, rho the distance from the axis
 * in half-beamwidths and t = tan(theta0.5), and the cosine of incidence h/r, h the distance of the
 * plane. So a polygon is cut, across the gradient of w, where a pulse begins to enter a range unit
 * or to leave it; in between the unit's share of the pulse is linear in r. Further cuts follow
 * where the range changes by MostStretch or the specular lobe by MostFall. A part becomes one
 * sample at its mean w and mean rho^2, or two at its mean w plus and minus its standard deviation,
 * or four, with rho^2 likewise, all with the exact solid angle (DiscPolygon.h). Where beams are
 * wide or Gaussian, or a lobe is not much wider than the beam, a part takes a product of Gauss's
 * rules instead. They are dense where a narrow lobe is, and not elsewhere.
 *
 * Source: paper, Eq. 4-9; Gauss-Legendre quadrature.
 * Differs: the paper samples all beams with rays.
 * Valid: relative error of a unit's energy below ErrorOfUnit, but for what curved lines of equal
 * range and the rounding of corners may move across borders of units, which each node's
 * `uncertain` bounds, and 1e-3 of the energy of faint polygons. Polygons over which lines of equal
 * range are curved by more than MostCurved range units have no rule.
 * Test: TestPolygonQuadrature.cxx, TestPolygonUnits.cxx, TestPolygonShares.cxx.
 */
#ifndef avianlidar_PolygonRule_h
#define avianlidar_PolygonRule_h

#include "BeamSamples.h"
#include "BeamShape.h"
#include "DiscPolygon.h"
#include "ScanSetup.h"
#include "VisiblePolygons.h"

#include <vector>

namespace avianlidar
{
/// Largest error of a unit's energy, relative, but for what crosses its borders.
constexpr double ErrorOfUnit = 2e-6;

/// Most difference, in range units, between the ranges of a straight line of equal z.
constexpr double MostCurved = 0.1;

/// Most change of the range within a part of a faint polygon, relative. What is wrong in a unit
/// then is a smaller part of its energy: energy and place of a part are correlated by a twelfth of
/// the change.
constexpr double MostFaintStretch = 1e-2;

/// Samples of a beam, and bounds of their errors.
struct PolygonNodes
{
  BeamSamples samples;
  std::vector<double> uncertain; ///< share of the node's energy that may lie beyond a border
};

/// Places the samples of one polygon after the other. One per thread; the setup must outlive it.
class PolygonRule
{
public:
  explicit PolygonRule(const ScanSetup& setup);

  double unitLength() const { return this->UnitLength; }   ///< of a range unit, m
  double pulseLength() const { return this->PulseLength; } ///< of range, m
  double tangent2() const { return this->Tangent2; }       ///< tan(theta0.5)^2

  /// Share of the pulse that falls onto an area at the centre of the disc, of a uniform profile.
  double shareOfArea() const { return this->ShareOfArea; }

  /// Most density of the profile, over that of a uniform one.
  double mostDensity() const { return this->Shape.mostDensity(); }

  /// What bounds a polygon.
  struct Extent
  {
    double leastInverse, mostInverse; ///< of 1/z, 1/m; at most 1/height
  };

  /// Begin a polygon of a surface. @param triangle of the surface, for its material
  /// @param faint one sample a part will do: the polygon puts little into any range unit
  void set(const PlaneSurface& surface, std::uint32_t triangle, const Extent& extent, bool faint);

  /// Estimate of the number of samples of a plane at a height, m, without a lobe; infinite if there
  /// is no rule.
  double count(double height, const Extent& extent) const;

  /// Append the samples of the surface's part within a ring.
  void place(const PlaneSurface& surface, const PlaneRing& ring, PolygonNodes& nodes);

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
  struct Piece
  {
    double from, to;
    bool lobe; ///< where the lobe is
  };
  void setLobe(double mostInverse);
  void divideAtLobe(double from, double to, double centre, std::vector<Piece>& pieces) const;
  double curvatureOf(const Extent& extent) const;
  double roundingOf(double height, const Extent& extent) const;
  bool takesRules() const;
  double fallAt(double inverse) const;
  double fallOfDisc(bool lobe) const;
  double rangeAt(double p, double radius2) const;
  double placeOf(double range) const;
  void findBorders();
  void addUnitBorders();
  void addSmoothBorders(double from, double to);
  void placePlain();
  void placeNodes(std::size_t part, double uncertain);
  void placeRules(double from, double to, double uncertain);
  void addNode(double range, double inverse, double weight, double uncertain);
  double shareOf(double area, double radius2) const;
  double uncertainty(double from, double to) const;

  const ScanSetup& Setup;
  const BeamShape Shape;    ///< round
  const double UnitLength;  ///< m
  const double PulseLength; ///< m of range
  const double LastBorder;  ///< m: nothing beyond is received
  double Offsets[2];        ///< ranges at which a pulse begins or ends at a border, in units
  int NumberOfOffsets;
  double Tangent2 = 0.0; ///< t^2
  double ShareOfArea = 0.0;
  PolygonNodes* Nodes = nullptr;
  Current Now{};
  DiscPolygon Disc;
  std::vector<double> Ranges;
  std::vector<double> Borders; ///< p, ascending
  std::vector<double> OfUnits; ///< 1 for each that is a border of units, otherwise 0
  std::vector<Piece> Along, Across;
  PartMoments Parts;
};
}

#endif
