// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Background.h
 * @brief Daylight in a beam, from the sky and from surfaces lit by sky and sun.
 *
 * The part of the beam that no surface fills has the radiance L of the sky. A surface has the
 * radiance rho (L + E max(0, cos)/pi). Here rho = kd + ks is the reflectance of the surface, E the
 * spectral irradiance of the sun, and cos the cosine of the angle between the sun and the normal on
 * the side that the beam sees. The weight of each part of the beam is the part's share of the
 * pulse's energy. Without sunlight (E = 0), every beam receives the radiance L, and radianceSeen()
 * is not called.
 *
 * Source: radiance of a Lambertian surface under a uniform sky and a sun.
 * Differs: the paper has one rate of noise photons for all beams. Shadows are not modelled. A
 * surface that faces the sun counts as lit. A vertical surface receives as much light from the sky
 * as a horizontal surface.
 * Valid: matt surfaces. The sun's image in a mirror is not modelled. Faint polygons are included,
 * because no polygon is dropped with sunlight (PolygonQuadrature.h).
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
