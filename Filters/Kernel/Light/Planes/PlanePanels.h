// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PlanePanels.h
 * @brief Panels for the quadrature of a plane: intervals of angles of incidence parted so that all
 * that is integrated is smooth in each, and the rule that it takes.
 *
 * Borders lie where a pulse begins to enter a range unit or to leave it; so that the specular lobe
 * falls by e^6 at most in a panel; near the grazing direction, and where the cone just misses the
 * normal.
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
/// Beams that would meet more borders of range units are left to their rays.
constexpr std::size_t MostUnitBorders = 1024;

/// What is alike within a patch.
struct PatchSurface
{
  std::uint32_t triangle; ///< one of it
  std::uint8_t plane;     ///< of the patch
  Material material;
};

struct PlanePanel
{
  double lower, upper; ///< in the interval's variable
  const GaussKronrodRule* rule;
  int halvings;
};

/// Exponent at which a lobe is nothing.
constexpr double NoLobe = 42.0;

/// Reusable without allocation; one per thread. The setup must outlive it.
class PlanePanels
{
public:
  explicit PlanePanels(const ScanSetup& setup);

  /// False if a footprint of this length, m, may go over more than MostUnitBorders.
  bool mayFit(double footprint) const;

  /// At least so many panels are needed for one.
  double fewestPanels(double footprint) const;

  /// True if the ranges of a disc do not, and whole numbers of units tell them apart.
  bool fits(const PlaneDisc& disc) const;

  /// True if a border lies between two ranges.
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
  double Offsets[2]; ///< of the ranges at which a pulse begins or ends at a border, in units
  int NumberOfOffsets;
  PlaneDisc Disc{};
  const std::vector<PatchSurface>* Surfaces = nullptr;
  std::vector<double> Borders; ///< b, rad, ascending
  std::vector<double> Places;  ///< of the borders of an interval, in its variable
  std::vector<double> Ranges;
};
}

#endif
