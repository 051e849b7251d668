// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PlanePanels.h
 * @brief Panels for the quadrature of a plane: intervals of angles of incidence within which the
 * integrand is smooth, each with its rule.
 *
 * Panels end where a pulse begins to enter a range unit or to leave it, where the specular lobe has
 * fallen by a factor of e^6, near the grazing direction, and where the cone just misses the normal.
 *
 * Source: none; the rules are those of GaussKronrod.h.
 * Valid: a beam that would meet more than MostUnitBorders borders of range units does not fit.
 * Test: TestPlaneQuadrature.cxx, TestPlaneIntegration.cxx.
 */
#ifndef avianlidar_PlanePanels_h
#define avianlidar_PlanePanels_h

#include "GaussKronrod.h"
#include "PlaneArcs.h"
#include "ScanSetup.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Beams that would meet more borders of range units are sampled.
constexpr std::size_t MostUnitBorders = 1024;

/// Triangles of a patch with the same plane and material.
struct PatchSurface
{
  std::uint32_t triangle; ///< one of them
  std::uint8_t plane;     ///< number of the plane in the patch
  Material material;
};

/// An interval with a quadrature rule.
struct PlanePanel
{
  double lower, upper; ///< in the interval's variable
  const GaussKronrodRule* rule;
  int halvings;
};

/// Exponent from which on a lobe counts as zero.
constexpr double NoLobe = 42.0;

/// Panels of one plane. Reusable without allocation; one per thread. The setup must outlive it.
class PlanePanels
{
public:
  explicit PlanePanels(const ScanSetup& setup);

  /// False if a footprint of this length, m, may meet more than MostUnitBorders.
  bool mayFit(double footprint) const;

  /// Least number of panels for a footprint of this length, m.
  double fewestPanels(double footprint) const;

  /// True if the ranges of a disc do not, and are below MaximumGateUnits range units.
  bool fits(const PlaneDisc& disc) const;

  /// True if a border of range units lies between two ranges, m.
  bool isParted(double from, double to) const;

  /// Begin a plane. The surfaces must outlive it.
  void set(const PlaneDisc& disc, const std::vector<PatchSurface>& surfaces);

  /// Append the panels of one of its intervals.
  void add(const PlaneArcs& arcs, const PlaneInterval& interval, std::vector<PlanePanel>& panels);

private:
  double bordersOf(double footprint) const;
  void addUnitBorders();
  void addLobeBorders(const Material& material);
  void addPoleBorders();
  const GaussKronrodRule& ruleFor(double width, double from, double to) const;

  const ScanSetup& Setup;
  double UnitLength; ///< m
  double Offsets[2]; ///< ranges at which a pulse begins or ends at a border, in units
  int NumberOfOffsets;
  PlaneDisc Disc{};
  const std::vector<PatchSurface>* Surfaces = nullptr;
  std::vector<double> Borders; ///< b, rad, ascending
  std::vector<double> Places;  ///< borders of an interval, in its variable
  std::vector<double> Ranges;
};
}

#endif
