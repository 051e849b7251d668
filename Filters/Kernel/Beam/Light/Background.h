// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Background.h
 * @brief Daylight in a beam, from the sky and from surfaces lit by sky and sun.
 *
 * The part of the beam that no surface fills has the radiance L of the sky. A surface has the
 * radiance rho (L + E max(0, cos)/pi). Here rho = kd + ks is the reflectance of the surface, E the
 * spectral irradiance of the sun, and cos the cosine between the sun and the normal on the side
 * that the beam sees. Each part of the beam counts with the part's share of the pulse's energy. A
 * beam of a sensor without sunlight (E = 0) receives L and is not passed to radianceSeen().
 *
 * Source: radiance of a Lambertian surface under a uniform sky and a sun.
 * Differs: the paper has one rate of noise photons for all beams. Shadows are not searched for: a
 * surface that faces the sun counts as lit, and a vertical surface gets as much sky as a horizontal
 * one.
 * Valid: matt surfaces; the sun's image in a mirror is not modelled. Faint polygons count, because
 * polygons are not dropped with sunlight (PolygonQuadrature.h).
 * Test: TestBackground.cxx.
 */
#ifndef avianlidar_Background_h
#define avianlidar_Background_h

#include "BeamSamples.h"
#include "ScanSetup.h"
#include "SceneTriangles.h"

namespace avianlidar
{
/// Mean radiance in a beam, W/(m2 sr nm). @param origin apex of the beam, m
double radianceSeen(const ScanSetup& setup, const SceneTriangles& scene, const BeamSamples& samples,
  const Vec3& origin);
}

#endif
