// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamVolumeTest.h
 * @brief Tests of a beam's cone and of a single ray against boxes and spheres.
 *
 * A box is tested by separating axes. Two planes in space are tested first, because they separate
 * most boxes: the plane that touches the cone on the side of the box's centre, and the plane
 * through the apex across the axis. Then the projections of cone and box on the three planes of the
 * box's axes are compared. The test of a sphere is exact. A ray is tested against the three slabs
 * of a box, and as a thin cone against a sphere.
 *
 * Source: paper, Sec. 3.2, Fig. 6 and 7; slabs: Kay and Kajiya, "Ray Tracing Complex Scenes",
 * SIGGRAPH 1986.
 * Differs: the projected wedge is wider (BeamCone.h), and the two planes in space are added.
 * Valid: conservative, rounding included: if TriangleTest.h finds a hit of the ray, or of any ray
 * of the beam, on a triangle, no volume that holds the triangle is rejected. For this purpose, cone
 * and ray are widened by HitMarginBeam tan(theta0.5) + HitMargin. Volumes are widened by HitMargin
 * times their farthest coordinate from the apex. False positives are possible.
 * Test: TestBeamVolumeTest.cxx, TestGeometryProperties.cxx.
 */
#ifndef avianlidar_BeamVolumeTest_h
#define avianlidar_BeamVolumeTest_h

#include "BeamFrame.h"
#include "BoundingVolume.h"

namespace avianlidar
{
/// Test of the cone of one beam.
class BeamVolumeTest
{
public:
  /// @param frame half-beamwidth in (0, pi/3]
  explicit BeamVolumeTest(const BeamFrame& frame);

  /// @return false if no ray of the beam hits a triangle in `volume`, which must not be empty
  /// @param nearest receives a lower bound of the range of hits in `volume`, m
  bool meets(const AlignedBox& volume, double& nearest) const;
  bool meets(const OBB& volume, double& nearest) const;
  bool meets(const BoundingSphere& volume, double& nearest) const;

  /// The paper's test: three projections, without the two planes in space. @param axis axis of the
  /// cone in the box's frame
  /// @param center,half centre and half extents of the widened box, relative to the cone's apex, m
  bool projectionsMeet(const Vec3& axis, const Vec3& center, const Vec3& half) const;

private:
  template <class Box>
  bool meetsBox(const Box& volume, double& nearest) const;
  bool separated(const Vec3& axis, const Vec3& center, const Vec3& half) const;

  Vec3 Apex;
  Vec3 Axis;
  double Sine, Cosine; ///< sine and cosine of the widened half-angle
};

/// Test of one ray.
class RayVolumeTest
{
public:
  /// @param apex apex in scene coordinates, m @param origin relative to the apex, m
  /// @param direction unit vector @param angularMargin half-width of the ray, rad, to which
  /// HitMargin is added @param size bound of sizeFrom() of all volumes, m
  RayVolumeTest(
    const Vec3& apex, const Vec3& origin, const Vec3& direction, double angularMargin, double size);

  /// See BeamVolumeTest::meets(). `nearest` receives the range at which the ray enters the volume.
  bool meets(const AlignedBox& volume, double& nearest) const;
  bool meets(const OBB& volume, double& nearest) const;
  bool meets(const BoundingSphere& volume, double& nearest) const;

private:
  static bool meetsSlabs(
    const Vec3& center, const Vec3& half, const Vec3& inverse, double& nearest);

  Vec3 Apex;
  Vec3 Origin; ///< start of the ray relative to the apex, m
  Vec3 Direction;
  Vec3 Inverse;  ///< inverse coordinates of `Direction`
  double Margin; ///< length by which volumes are widened, m
};

/// Bound of the coordinates of a volume's points relative to the apex, m.
double sizeFrom(const Vec3& apex, const OBB& volume);
double sizeFrom(const Vec3& apex, const BoundingSphere& volume);
}

#endif
