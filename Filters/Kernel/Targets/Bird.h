// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Bird.h
 * @brief A bird as closed surfaces: a body and two wings.
 *
 * The body is an ellipsoid of revolution, 0.65 of the bird's length, with the frontal area S_b =
 * 0.0129 m^0.614 m^2 of passerines or 0.00813 m^0.666 m^2 of others, m the mass in kg. The wings
 * are flat plates, together 0.85 of the wing area, hinged at the sides of the body at its middle,
 * with an angle of attack of 6 degrees; they flap by 35 degrees as a sine, or are held 5 degrees up
 * in a glide. Their thickness is 0.001 of their chord.
 *
 * The body is a polyhedron of 48 triangles with the effective area of the ellipsoid (silhouette
 * weighted by the cosine of incidence) from every direction: half a quadratic form of the direction
 * for any convex body with a centre, whose two values are fitted. With 24 triangles of the wings a
 * beam with a bird in it is still integrated.
 *
 * Frame of a bird: x right, y forward, z up. Turned by heading (clockwise from north) after bank
 * (to the right).
 *
 * Source: S_b: A. Hedenstrom and M. Rosen, J. Avian Biol. 34 (2003); C. J. Pennycuick et al., J.
 * Exp. Biol. 135 (1988). Wingbeats: C. J. Pennycuick, J. Exp. Biol. 199 (1996).
 * Differs: no head, neck, tail or legs. Shares, angles and thickness are assumed.
 * Valid: the effective area of the body alone is exact, that of the wings within 1 % of plates; the
 * body is longer than the ellipsoid by some per cent.
 * Test: TestBird.cxx.
 */
#ifndef avianlidar_Bird_h
#define avianlidar_Bird_h

#include "TriangleMesh.h"

#include <string>
#include <vector>

namespace avianlidar
{
struct BirdSpecies
{
  std::string name;
  double mass = 0.0;     ///< kg, 1e-3 to 100
  double length = 0.0;   ///< from bill to tail, m, 0.01 to 10
  double span = 0.0;     ///< m, 0.01 to 10, more than the body is wide
  double wingArea = 0.0; ///< of both wings and what lies between, m^2, 1e-5 to 10
  bool passerine = false;
  double airspeed = 0.0; ///< m/s, 0.1 to 100
};

enum class BirdPart
{
  Body = 0,
  LeftWing = 1,
  RightWing = 2
};

/// What a species measures.
struct BirdShape
{
  explicit BirdShape(const BirdSpecies& species);
  double bodyDiameter;  ///< m
  double bodyLength;    ///< m
  double wingLength;    ///< of one wing, m
  double wingChord;     ///< m
  double wingThickness; ///< m

  /// All lengths times a factor.
  BirdShape scaled(double factor) const;
};

/// Angle of the wings above the body's plane, rad. @param phase of the wingbeat, 1 is a whole one
double wingAngle(double phase, bool gliding);

/// Wingbeats per second in level flight, Hz.
double wingbeatFrequency(const BirdSpecies& species);

/// A part in the bird's frame, closed, its triangles counterclockwise seen from outside.
/// @param angle of the wings, rad
TriangleMesh birdPart(const BirdShape& shape, BirdPart part, double angle);

/// All parts together.
TriangleMesh wholeBird(const BirdShape& shape, double angle);

/// A table of species: a header as in Filters/Birds/species.csv, lines that begin with # are
/// comments. Throws std::runtime_error naming file, line and column. @param file for messages
std::vector<BirdSpecies> readSpecies(const std::string& text, const std::string& file);

/// Index of the first species of that name. Throws std::runtime_error, "is 'dodo', expected one of
/// ...", if there is none.
std::size_t findSpecies(const std::vector<BirdSpecies>& all, const std::string& name);
}

#endif
