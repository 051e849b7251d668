// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamVolumeTest.h
 * @brief Test of a beam's cone, or of a single ray as a thin cone, against boxes and spheres.
 *
 * Boxes are tested by separating axes, first by two planes in space that separate most boxes: the
 * plane that touches the cone on the side of the box's centre, and the plane through the apex
 * across the axis. Then the projections of cone and box on the three planes of the box's axes are
 * compared. A sphere is tested exactly.
 *
 * Source: paper, Sec. 3.2, Fig. 6 and 7.
 * Differs: the wedge is that of BeamCone.h. The two planes in space are added.
 * Valid: conservative, rounding included: no volume is rejected that holds a triangle which
 * TriangleTest.h lets some ray of the beam (or the ray) hit. For this, cone and ray are widened by
 * HitMarginBeam tan(theta0.5) + HitMargin, volumes by HitMargin times their farthest coordinate
 * from the apex. False positives are possible.
 * Test: TestBeamVolumeTest.cxx, TestGeometryProperties.cxx.
 */
#ifndef avianlidar_BeamVolumeTest_h
#define avianlidar_BeamVolumeTest_h

#include "BeamCone.h"
#include "BoundingVolume.h"

namespace avianlidar
{
class BeamVolumeTest
{
public:
  /// The cone of one beam. Half-beamwidth in (0, pi/3].
  explicit BeamVolumeTest(const BeamFrame& frame);

  /// One ray. @param apex scene coordinates, m; @param origin relative to the apex, m
  /// @param direction unit vector @param angularMargin half-width of the ray, rad, to which
  /// HitMargin is added
  BeamVolumeTest(const Vec3& apex, const Vec3& origin, const Vec3& direction, double angularMargin);

  /// False if no ray of the beam hits a triangle in `volume` (which must not be empty). Else
  /// `nearest` is a lower bound of the range of such hits, m.
  bool meets(const OBB& volume, double& nearest) const;
  bool meets(const BoundingSphere& volume, double& nearest) const;

  /// The paper's test alone, three projections, of a box with centre and half extents relative to
  /// the cone's apex (already widened); `axis` is the cone's axis in the box's frame.
  bool projectionsMeet(const Vec3& axis, const Vec3& center, const Vec3& half) const;

private:
  bool separated(const Vec3& axis, const Vec3& center, const Vec3& half) const;

  Vec3 Apex;
  Vec3 Origin{ 0.0 }; ///< where the cone begins, relative to the apex, m
  Vec3 Axis;
  double Sine, Cosine; ///< sine and cosine of the widened half-angle
};
}

#endif
