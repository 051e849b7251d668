// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PlaneArcs.h
 * @brief Divides the angles of incidence of a plane into intervals within which the circles meet
 * the same surfaces in the same order, and gives the share of the beam's energy on each surface.
 *
 * The variable v removes the roots of phi_m at both ends of the arcs: b = |a-t| + 2 min(a,t) sin^2
 * v, v in [0, pi/2]; on whole circles v = b. An interval that begins or ends where a border touches
 * a circle has roots of its own: there v = from + (to - from) sin^2 y, and y is the variable.
 *
 * Source: none; derived in Documentation/plane-integration.md.
 * Valid: uncertain() bounds the share of the beam where borders do not fit together; set() fails
 * where that is not negligible.
 * Test: TestPlaneSurfaces.cxx, TestPlaneQuadrature.cxx, TestSeveralPlanes.cxx.
 */
#ifndef avianlidar_PlaneArcs_h
#define avianlidar_PlaneArcs_h

#include "PatchBorders.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// An interval of angles of incidence.
struct PlaneInterval
{
  bool circles;                        ///< the circles are whole
  bool roots;                          ///< the variable is y, not v
  double from, to;                     ///< v
  std::uint32_t crossings[2], arcs[2]; ///< begin and end in the lists of PlaneArcs

  double lower() const { return this->roots ? 0.0 : this->from; } ///< limits of the variable
  double upper() const { return this->roots ? 0.5 * Pi : this->to; }
};

/// The nodes of an interval. All arrays but the shares have the same length.
struct ArcNodes
{
  std::vector<double> variable, weight; ///< given
  std::vector<double> range, cosine;
  std::vector<double>
    shares; ///< of the pulse's energy: all nodes of the first arc, of the second, ...
  std::size_t size() const { return this->variable.size(); }
  void clear()
  {
    this->variable.clear();
    this->weight.clear();
  }

  std::vector<double> sine, sinAhead, cosAhead, first, factor, turns; ///< workspace
};

/// The intervals of one plane. Reusable without allocation; one per thread.
class PlaneArcs
{
public:
  /// Begin a plane. All arguments must outlive it. @return false if borders do not fit together in
  /// more than a negligible part of the beam
  bool set(const PlaneDisc& disc, PatchBorders& borders);

  const PlaneDisc& disc() const { return this->Disc; }
  const std::vector<PlaneInterval>& intervals() const { return this->Intervals; }
  const PatchArc& arc(std::size_t k) const { return this->Arcs[k]; }

  /// Bound of the share of the beam where borders do not fit together.
  double uncertain() const { return this->Uncertain; }

  /// Angle b of the variable v.
  double incidence(bool circles, double v) const;

  /// The variable (v or y) of angles of incidence within an interval, ascending.
  void placesOf(
    const PlaneInterval& interval, const double* angles, double* places, std::size_t count) const;

  /// Set ranges, cosines and shares of the nodes of an interval.
  void place(const PlaneInterval& interval, bool gaussian, ArcNodes& nodes) const;

private:
  void addIntervals(bool circles, double from, double to);
  bool addInterval(bool circles, double from, double to, bool roots);
  double variableOf(bool circles, double ahead) const;
  IncidenceCircle circleOf(bool circles, double v) const;

  PlaneDisc Disc{};
  PatchBorders* Borders = nullptr;
  bool Fits = true;
  double Uncertain = 0.0;
  std::vector<PatchEvent> Events;
  std::vector<PlaneInterval> Intervals;
  std::vector<PatchCrossing> Crossings;
  std::vector<PatchArc> Arcs;
};
}

#endif
