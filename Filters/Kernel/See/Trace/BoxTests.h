// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BoxTests.h
 * @brief Tests rays of a packet, or cones of a group of beams, from one apex against the eight
 * boxes of a wide node, in vectors of single precision (RayLanes.h).
 *
 * All directions lie between four planes through the apex. The dominant axis is the coordinate axis
 * nearest to the directions. Each plane is parallel to one of the two other axes. Eight boxes are
 * tested against these planes in one loop. Each box that is left is tested by slabs against groups
 * of sixteen rays. If few rays are left, each ray is tested against eight boxes at once. Cones are
 * tested sixteen at a time: by their own four planes, by the plane that touches the cone on the
 * side of the box's centre, and by the plane through the apex across the cone's axis.
 *
 * Source: frustum of Reshetov, Soupikov and Hurley, 2005 (see RayPacket.h); the tangent plane and
 * the plane across the axis as in BeamVolumeTest.h.
 * Differs: the planes of the frustum are parallel to coordinate axes, and are tested against eight
 * boxes at a time.
 * Valid: conservative, rounding included, with the margins of WideTree.h. Cones are widened as in
 * BeamCone.h. setFrustum() fails if the directions do not all point along one coordinate axis, or
 * if scene or apex lies outside the range of single precision (wideningFor()).
 * Test: TestRayPacket.cxx, TestBeamGroup.cxx.
 */
#ifndef avianlidar_BoxTests_h
#define avianlidar_BoxTests_h

#include "PacketOrder.h"
#include "TriangleTest.h"
#include "WideTree.h"

#include <cstddef>
#include <cstdint>

namespace avianlidar
{
constexpr int PacketWidth = 64;

/// A set of rays of a packet, one bit each.
using RayBits = std::uint64_t;

/// Number of rays, rounded up to a multiple of PacketGroup.
constexpr int padded(int count)
{
  return (count + PacketGroup - 1) / PacketGroup * PacketGroup;
}

/// Four planes about directions from one apex.
struct Frustum
{
  int axes[3];                    ///< dominant coordinate axis, then the two other axes
  float sign;                     ///< sign of the directions along the dominant axis
  float lowU, highU, lowV, highV; ///< slopes of the directions
  float apex[3];                  ///< apex relative to the tree's reference, m
  float widening;                 ///< widening of every box, m
  float spread = 0.0f;            ///< half-width of each ray, rad
  /// Factor from depth along the dominant axis to a lower bound of the range.
  float shortening = 1.0f - WideRounding;

  /// Set the apex. @return false if the scene or the apex lies outside single precision
  /// (wideningFor())
  bool setApex(const WideTree& tree, const Vec3& at);
  void setAxes(const Vec3& direction);
};

/// A packet for the tests of boxes and triangles. All ranges along a ray, including ranges by
/// Frustum::shortening, are divided by |D|, with D the ray's `direction`.
struct alignas(64) PacketView
{
  float direction[3][PacketWidth]; ///< D = axis + tan(theta0.5) (x e1 + y e2) of the ray's beam
  float inverse[3][PacketWidth];   ///< inverses of the components of D
  float far[PacketWidth];          ///< range / |D| beyond which no hit counts for the ray, m
  float farthest[PacketWidth / PacketGroup]; ///< largest `far` of each group; 0 without rays
  Frustum frustum;

  /// Set the members that follow from `count` directions. Lanes that pad the last group repeat a
  /// direction.
  /// @param longest largest length of a direction @return false if the rays lie too far apart
  bool set(int count, double longest);
};

/// A child of a node, and the rays that meet the child.
struct PacketChild
{
  std::uint32_t lane;
  RayBits rays;
  float nearest; ///< lower bound of range / |D|, m
};

/// Find the children of a node that any of `rays` meets. @return number of children
int meetChildren(const PacketView& view, const WideNode& node, RayBits rays, PacketChild* children);

/// Up to sixteen cones from one apex.
struct alignas(64) ConeLanes
{
  static constexpr int Width = 16;
  float axis[3][Width];
  float sine[Width], cosine[Width]; ///< sine and cosine of half-angles, rounding included
  float lowU[Width], highU[Width], lowV[Width], highV[Width]; ///< slopes, set by setFrustum()
  int count = 0;
  Frustum frustum;     ///< planes about all cones
  double widest = 0.0; ///< tangent of the widest half-angle

  /// Add the cone of a beam, or one cone about several beams, widened as in BeamCone.h.
  void add(const BeamFrame* frames, const std::uint32_t* beams, std::size_t number);
  /// Fill the lanes beyond the last cone with copies of this cone.
  void close();
  /// Set the planes. @return false if the cones are too wide, are too far apart, do not all point
  /// along one coordinate axis, or lie outside the range of single precision (wideningFor())
  bool setFrustum(const WideTree& tree, const Vec3& apex);
};

/// A child of a node, and the cones that meet the child.
struct ConeChild
{
  std::uint32_t lane;
  std::uint32_t cones; ///< cones that meet the child, one bit each
  float nearest;       ///< lower bound of the distance, m
  float size;          ///< half diagonal / distance of the box
};

/// Find the children of a node that any cone in `some` may meet. @return number of children
int meetChildren(
  const ConeLanes& cones, const WideNode& node, std::uint32_t some, ConeChild* children);
}

#endif
