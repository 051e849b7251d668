// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PolygonRule.h
 * @brief Weighted samples of one visible polygon that give its direct echo in each range unit.
 *
 * On a plane at the distance h from the apex, the range is r = sqrt(1 + t^2 rho^2)/w and the cosine
 * of incidence is h/r. Here w is the affine function 1/z (BeamTriangles.h), rho the distance from
 * the axis in half-beamwidths, and t = tan(theta0.5).
 *
 * 1. A polygon is cut across the gradient of w where a pulse begins to enter or to leave a range
 * unit. Between two cuts the unit's share of the pulse is linear in r. Further cuts lie where the
 * range changes by MostStretch, or where the exponent of the specular lobe changes by MostFall.
 * 2. A part becomes one sample at its mean w and mean rho^2, two samples at its mean w plus and
 * minus the standard deviation, or four samples with two values of rho^2. Together the samples have
 * the exact solid angle of the part (DiscPolygon.h).
 * 3. In wide or Gaussian beams, and where a lobe is not much wider than the beam, a part takes a
 * product of Gauss-Legendre rules instead of these samples. The nodes of these rules are dense only
 * within narrow lobes.
 *
 * Source: paper, Eq. 4-9; Gauss-Legendre quadrature.
 * Differs: the paper samples all beams with rays.
 * Valid: the relative error of a unit's energy is below ErrorOfUnit, with two exceptions. First,
 * curved lines of equal range and rounded corners may move energy across borders of units. Each
 * node's `uncertain` bounds this energy. Second, faint polygons have an error of 1e-3 of their
 * energy. A polygon has no rule if lines of equal range are curved by more than MostCurved range
 * units in the polygon.
 * Test: TestEchoClosedForms.cxx, TestPolygonUnits.cxx.
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
/// Largest relative error of a unit's energy, except for energy that crosses the unit's borders.
constexpr double ErrorOfUnit = 2e-6;

/// Largest difference, in range units, between ranges on a straight line of equal z.
constexpr double MostCurved = 0.1;

/// Largest relative change of the range within a part of a faint polygon. The relative error of a
/// unit's energy is a twelfth of this change, because energy and range are correlated within a
/// part.
constexpr double MostFaintStretch = 1e-2;

/// Largest estimated number of samples of a beam. Specular lobes add samples to the estimate.
constexpr double MostNodes = 2e4;

/// Samples of a beam, and bounds of their errors.
struct PolygonNodes
{
  BeamSamples samples;
  std::vector<double> uncertain; ///< share of each node's energy that may lie in another unit
  double misplaced = 0.0;        ///< bound of the energy that may miss its surface, J
  double error = ErrorOfUnit;    ///< relative error of a unit's energy otherwise
};

/// Places the samples of one polygon after the other. Each thread needs its own object. The setup
/// must outlive the object.
class PolygonRule
{
public:
  PolygonRule(const ScanSetup& setup, double parts);

  double unitLength() const { return this->Setup.sensor.rangeUnitLength(); } ///< range unit, m
  double pulseLength() const { return this->PulseLength; } ///< length of the pulse in range, m
  double tangent2() const { return this->Tangent2; }       ///< tan(theta0.5)^2

  /// Share of the pulse per area at the centre of the disc, with a uniform profile.
  double shareOfArea() const { return this->ShareOfArea; }

  /// Largest density of the profile, divided by the density of a uniform profile.
  double mostDensity() const { return this->Shape.mostDensity(); }

  /// Bounds of 1/z over a polygon.
  struct Extent
  {
    double leastInverse, mostInverse; ///< bounds, 1/m, at most 1/height
  };

  /// Bounds of the part of a surface within a ring.
  static Extent extentOf(const PlaneSurface& surface, const PlaneRing& ring);

  /// False if a beam that sees these polygons cannot be integrated. @param most largest number of
  /// samples
  bool fits(const VisiblePolygons& seen, double most = MostNodes) const;

  /// Begin a polygon of a surface. @param triangle triangle of the surface, which gives the
  /// material
  /// @param faint true if one sample per part suffices, because no range unit receives much energy
  void set(const PlaneSurface& surface, std::uint32_t triangle, const Extent& extent, bool faint);

  /// Estimated number of samples of a polygon without a lobe; infinity if it has no rule.
  /// @param height distance of the polygon's plane from the apex, m
  double count(double height, const Extent& extent) const;

  /// Append the samples of the surface's part within a ring.
  void place(const PlaneSurface& surface, const PlaneRing& ring, PolygonNodes& nodes);

private:
  /// The current polygon.
  struct Current
  {
    std::uint32_t triangle;
    Material material;
    double height, leastInverse; ///< distance of the plane, m; lower bound of 1/z, 1/m
    double base, slope;          ///< coefficients of w = base + slope p
    double inverseSlope;
    double width2;  ///< lobeWidth2(), rad2; 0: the lobe does not matter
    double curved;  ///< curvatureOf(), m
    double rounded; ///< roundingOf(), m
    bool plain;     ///< whether every range unit is short compared with the range
    bool byRules;   ///< whether parts take products of rules
    bool faint;     ///< whether no range unit receives much energy
    double inverse(double p) const;
  };
  struct Piece
  {
    double from, to;
    bool lobe; ///< whether the lobe lies in the piece
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
  const BeamShape Shape;    ///< shape of a round beam
  const double UnitLength;  ///< length of a range unit, or of a part of it (partsOfUnit()), m
  const double PulseLength; ///< length of the pulse in range, m
  const double LastBorder;  ///< range beyond which nothing is received, m
  double Offsets[2];        ///< ranges at which a pulse begins or ends at a border, units modulo 1
  int NumberOfOffsets;
  double Tangent2 = 0.0; ///< tan(theta0.5)^2
  double ShareOfArea = 0.0;
  PolygonNodes* Nodes = nullptr;
  Current Now{};
  DiscPolygon Disc;
  std::vector<double> Ranges;
  std::vector<double> Borders; ///< values of p at the borders of parts, ascending
  std::vector<double> OfUnits; ///< 1 for each border of a range unit, else 0
  std::vector<Piece> Along, Across;
  PartMoments Parts;
};
}

#endif
