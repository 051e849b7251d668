// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamCone.h
 * @brief The widened cone of one beam, and its projections on the three coordinate planes.
 *
 * Source: paper, Sec. 3.2, Fig. 6 and 7.
 * Differs: the paper projects the cone to a wedge of half-angle theta0.5. The true half-angle phi
 * is larger: sin(phi) = sin(theta0.5) / sin(psi), with psi the angle between the axis and the
 * plane's normal. The projection is the whole plane where psi <= theta0.5 or psi >= pi - theta0.5.
 * Valid: half-beamwidths in (0, pi/3]. Widened by HitMarginBeam tan(theta0.5) + HitMargin, the cone
 * holds every ray for which TriangleTest.h finds a hit.
 * Test: TestBeamVolumeTest.cxx, TestGeometryProperties.cxx.
 */
#ifndef avianlidar_BeamCone_h
#define avianlidar_BeamCone_h

#include "BeamFrame.h"

namespace avianlidar
{
/// Projection of a cone on a plane through its apex.
struct ConeWedge
{
  bool wholePlane = true;
  double leftX = 0.0, leftY = 0.0;   ///< direction of the left edge
  double rightX = 0.0, rightY = 0.0; ///< direction of the right edge

  ConeWedge() = default;
  /// @param sine sine of the cone's half-angle @param axisX,axisY components of the cone's unit
  /// axis in the plane
  ConeWedge(double sine, double axisX, double axisY);
};

struct BeamCone
{
  explicit BeamCone(const BeamFrame& frame);

  Vec3 apex;
  Vec3 axis;
  double sine; ///< sine of the widened half-angle
  double cosine;
  ConeWedge wedges[3]; ///< projections on the planes yz, zx, xy
};
}

#endif
