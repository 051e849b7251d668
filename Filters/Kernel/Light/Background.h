// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Background.h
 * @brief Daylight that a beam looks at: the sky, and surfaces in sky and sun.
 *
 * A receiver sees the part of its beam that no surface fills as bright as the sky, L, and a surface
 * as bright as its reflectance kd + ks makes it: rho (L + E max(0, cos)/pi), E the sun's spectral
 * irradiance and cos that between the sun and the normal of the side that the beam sees. All parts
 * count with their share of the pulse's energy. Where the sensor's sunlight E is 0, every beam sees
 * L.
 *
 * Source: radiance of a Lambertian surface under a uniform sky and a sun.
 * Differs: the paper has one rate of noise photons. Shadows are not searched for: a surface that
 * faces the sun counts as lit, and one that looks sideways sees as much sky as one that looks up.
 * Valid: for matt surfaces; a mirror shows the sun where it is.
 * Faint polygons are not dropped with sunlight (PolygonQuadrature.h): they count here.
 * Test: TestBackground.cxx.
 */
#ifndef avianlidar_Background_h
#define avianlidar_Background_h

#include "BeamSamples.h"
#include "ScanSetup.h"
#include "SceneTriangles.h"

namespace avianlidar
{
/// Mean radiance in a beam, W/(m2 sr nm). @param origin of the beam, m
double radianceSeen(const ScanSetup& setup, const SceneTriangles& scene, const BeamSamples& samples,
  const Vec3& origin);
}

#endif
