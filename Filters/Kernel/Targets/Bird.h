// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Bird.h
 * @brief A bird as closed surfaces: a body and two wings.
 *
 * The body represents an ellipsoid of revolution, whose length is 0.65 of the bird's length. The
 * frontal area of the body is S_b = 0.0129 M^0.614 m^2 for passerines and 0.00813 M^0.666 m^2 for
 * other birds, with the mass M in kg. The wings are flat plates with an angle of attack of 6
 * degrees. Both wings together have 0.85 of the wing area. The thickness of a wing is 0.001 of its
 * chord. Wings are hinged at the sides of the body, midway along the body. The angle of a flapping
 * wing is a sine of time with an amplitude of 35 degrees. In a glide, wings are held 5 degrees up.
 *
 * The body is a polyhedron of 48 triangles that has the effective area of the ellipsoid (silhouette
 * weighted by the cosine of incidence) from every direction. For any convex body with a centre of
 * symmetry this area is half a quadratic form of the direction, so a fit of two values suffices.
 * The wings have 24 triangles. With 72 triangles in all, a beam that meets a bird is still
 * integrated over polygons.
 *
 * Frame of a bird: x right, y forward, z up. The bird is turned by the bank (to the right) first,
 * and then by the heading (clockwise from north).
 *
 * Source: S_b: A. Hedenstrom and M. Rosen, J. Avian Biol. 34 (2003); C. J. Pennycuick et al., J.
 * Exp. Biol. 135 (1988). Wingbeats: C. J. Pennycuick, J. Exp. Biol. 199 (1996).
 * Differs: the bird has no head, neck, tail or legs. Shares, angles and thickness are assumed.
 * Valid: the effective area of the body is exact. The effective area of the wings is within 1 % of
 * the effective area of flat plates. The body is some per cent longer than the ellipsoid.
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
  double mass = 0.0;     ///< mass, kg, 1e-3 to 100
  double length = 0.0;   ///< length from bill to tail, m, 0.01 to 10
  double span = 0.0;     ///< wingspan, m, 0.01 to 10, more than the width of the body
  double wingArea = 0.0; ///< area of both wings and the body between them, m^2, 1e-5 to 10
  bool passerine = false;
  double airspeed = 0.0; ///< airspeed, m/s, 0.1 to 100
};

enum class BirdPart
{
  Body = 0,
  LeftWing = 1,
  RightWing = 2
};

/// Dimensions of a species.
struct BirdShape
{
  explicit BirdShape(const BirdSpecies& species);
  double bodyDiameter;  ///< diameter of the body, m
  double bodyLength;    ///< length of the body, m
  double wingLength;    ///< length of one wing, m
  double wingChord;     ///< chord of a wing, m
  double wingThickness; ///< thickness of a wing, m

  /// Returns a shape with all lengths multiplied by a factor.
  BirdShape scaled(double factor) const;
};

/// Angle of the wings above the body's plane, rad. @param phase phase in wingbeats; no effect in a
/// glide
double wingAngle(double phase, bool gliding);

/// Frequency of wingbeats in level flight, Hz.
double wingbeatFrequency(const BirdSpecies& species);

/// A part in the bird's frame: closed, with triangles counterclockwise as seen from outside.
/// @param angle angle of the wings, rad
TriangleMesh birdPart(const BirdShape& shape, BirdPart part, double angle);

/// All parts of a bird in one mesh.
TriangleMesh wholeBird(const BirdShape& shape, double angle);

/// Index of the first species with this name. Throws std::runtime_error ("is 'dodo', expected one
/// of ...") if no species has the name.
std::size_t findSpecies(const std::vector<BirdSpecies>& all, const std::string& name);
}

#endif
