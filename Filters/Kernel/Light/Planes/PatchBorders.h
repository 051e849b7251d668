// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PatchBorders.h
 * @brief The borders between the surfaces of a plane in a beam: which surfaces the directions of
 * one angle of incidence meet, and between which turns.
 *
 * A border is a side that two triangles of different surfaces share. Its edge function E = alpha x
 * + beta y + gamma in the axes of PlaneDisc.h, alpha^2 + beta^2 = 1, is on the circle of incidence
 * b, up to a positive factor,
 *
 *   A + B sin phi + C 2 sin^2(phi/2),  A = alpha sin(b-a) + gamma tan t cos(b-a),  B = beta sin b,
 *   C = -(alpha cos a + gamma tan t sin a) sin b,
 *
 * so that u = tan(phi/2) solves (A + 2C) u^2 + 2B u + A = 0. At the root with + sqrt(B^2 - A(A+2C))
 * E rises with phi, at the other it falls.
 *
 * The order in which a circle crosses borders changes only at events: where a border ends, where it
 * leaves the disc, where it touches a circle, and where it crosses a whole circle at phi = pi.
 * Between events all turns are smooth in b, but for square roots at the points of contact.
 *
 * Source: none; derived in Documentation/plane-integration.md.
 * Valid: along a circle the surface left at a crossing must be the one met at the crossing before;
 * where rounding breaks this, follow() fails. rounding() bounds the share of the beam that rounding
 * of the borders may move.
 * Test: TestPlaneSurfaces.cxx, TestSeveralPlanes.cxx.
 */
#ifndef avianlidar_PatchBorders_h
#define avianlidar_PatchBorders_h

#include "PlaneDisc.h"
#include "TriangleTest.h"
#include "VisiblePatch.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Marks a surface that does not belong to the plane.
constexpr std::uint8_t Elsewhere = 255;

/// A side between two surfaces.
struct PatchBorder
{
  double alpha, beta, gamma; ///< gamma times tan t
  double from, to;           ///< ends of the side along (-beta, alpha); infinite beyond the disc
  std::uint8_t inside;       ///< surface where its edge function is positive
  std::uint8_t outside;
};

/// An angle at which the order of the crossings changes.
struct PatchEvent
{
  double ahead; ///< b - a, rad
  bool root;    ///< turns behave like square roots there
};

/// A crossing of circles and a border.
struct PatchCrossing
{
  std::uint32_t border;
  bool rising; ///< from its outside to its inside
};

/// Part of a circle on one surface, between two crossings; `Rim` stands for an end of the circle's
/// arc.
struct PatchArc
{
  static constexpr std::uint32_t Rim = 0xffffffffu; ///< marks an end of the arc
  std::uint8_t surface;
  std::uint32_t from, to;
};

/// The borders of one plane of a patch. Reusable without allocation; one per thread.
class PatchBorders
{
public:
  /// Begin a plane. @param surfaces of each triangle of the patch, Elsewhere for those of other
  /// planes. All arguments must outlive it
  void set(const TriangleMesh& mesh, const BeamFrame& frame, const VisiblePatch& patch,
    const std::vector<std::uint8_t>& surfaces, const PlaneDisc& disc);

  bool empty() const { return this->Borders.empty(); }
  const PatchBorder& operator[](std::size_t border) const { return this->Borders[border]; }

  /// Bound of the share of the beam's solid angle that rounding of the borders may move.
  double rounding() const { return this->Rounding; }

  /// Append the events between two angles, in any order. @param circles the circles there are whole
  void addEvents(bool circles, double from, double to, std::vector<PatchEvent>& events) const;

  /// Append crossings and arcs of a circle, from its rim on. @return false if they do not fit
  /// together
  bool follow(const IncidenceCircle& circle, std::vector<PatchCrossing>& crossings,
    std::vector<PatchArc>& arcs);

  /// The surface at phi = 0; certain only where no border is near.
  std::uint8_t surfaceAhead(const IncidenceCircle& circle);

private:
  struct Found
  {
    double turn;
    PatchCrossing crossing;
  };
  Corners cornersOf(std::size_t triangle) const;
  void add(const PatchSeam& seam);
  bool contains(const PatchBorder& border, double x, double y, double margin) const;
  void findCrossings(const IncidenceCircle& circle);
  double placeOn(const PatchBorder& border, const IncidenceCircle& circle, double turn) const;

  const TriangleMesh* Mesh = nullptr;
  const BeamFrame* Frame = nullptr;
  const VisiblePatch* Patch = nullptr;
  const std::vector<std::uint8_t>* Surfaces = nullptr;
  PlaneDisc Disc{};
  double Rounding = 0.0;
  std::vector<PatchBorder> Borders;
  std::vector<Found> Crossings;
};

/// The line of a border, as turnOf() needs it.
struct BorderLine
{
  double alpha, beta, gamma; ///< gamma times tan t
  double bend;               ///< 2 (alpha cos a + gamma tan t sin a)
  bool rising;
};
inline BorderLine lineOf(const PatchBorder& border, const PlaneDisc& disc, bool rising)
{
  return { border.alpha, border.beta, border.gamma,
    2.0 * (border.alpha * disc.cosTilt + border.gamma * disc.sineTilt), rising };
}

/// B^2 - A (A + 2C): negative if the circle does not meet the line.
AVIANLIDAR_ALWAYS_INLINE double discriminantOf(
  const BorderLine& line, double sine, double sinAhead, double cosAhead)
{
  const double a = line.alpha * sinAhead + line.gamma * cosAhead;
  const double b = line.beta * sine;
  return b * b - a * (a - line.bend * sine);
}

/// Turn at which a circle crosses the line of a border; in (-pi, pi).
AVIANLIDAR_ALWAYS_INLINE double turnOf(
  const BorderLine& line, double sine, double sinAhead, double cosAhead)
{
  const double a = line.alpha * sinAhead + line.gamma * cosAhead;
  const double b = line.beta * sine;
  const double c = a - line.bend * sine;
  const double inside = b * b - a * c;
  const double root = std::sqrt(inside > 0.0 ? inside : 0.0);
  const bool negative = b < 0.0;
  const double q = (negative ? -b : b) + root;
  // u = num/den, each a sum without cancellation.
  const bool first = line.rising == negative;
  const double sign = line.rising ? 1.0 : -1.0;
  const double numerator = first ? sign * q : -sign * a;
  const double denominator = first ? c : q;
  const double up = numerator < 0.0 ? -numerator : numerator;
  const double down = denominator < 0.0 ? -denominator : denominator;
  constexpr double least = 1e-300; // for a line through the foot: any turn will do
  const double angle = 2.0 * lanes::angleOf(down + least, up);
  return (numerator < 0.0) == (denominator < 0.0) ? angle : -angle;
}
}

#endif
