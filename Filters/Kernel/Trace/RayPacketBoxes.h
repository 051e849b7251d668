// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayPacketBoxes.h
 * @brief The rays of a packet against the eight boxes of a wide node, in single precision, in
 * vectors (RayLanes.h).
 *
 * The rays lie between four planes through the apex, each along one of the two axes that are not
 * the dominant one of the directions. Eight boxes are tested against these planes in one loop, then
 * groups of sixteen rays against each box that is left (slabs) or, where few rays are left, each
 * ray against eight boxes.
 *
 * Source: frustum of Reshetov, Soupikov and Hurley, 2005 (see RayPacket.h).
 * Differs: its planes go along coordinate axes, and are tested against eight boxes at a time.
 * Valid: conservative, with the margins of WideRay (WideTree.h). PacketView::set() fails where the
 * rays lie too far apart.
 * Test: TestRayPacket.cxx.
 */
#ifndef avianlidar_RayPacketBoxes_h
#define avianlidar_RayPacketBoxes_h

#include "PacketOrder.h"
#include "TriangleTest.h"
#include "WideTree.h"

#include <cstdint>

namespace avianlidar
{
constexpr int PacketWidth = 64;

/// A set of rays of a packet, one bit each.
using RayBits = std::uint64_t;

/// Number of rays, rounded up to whole groups.
constexpr int padded(int count)
{
  return (count + PacketGroup - 1) / PacketGroup * PacketGroup;
}

/// A packet as the tests of boxes and triangles need it. Points along a ray are given by their
/// range over |D|, with D the direction that stands here.
struct alignas(64) PacketView
{
  float direction[3][PacketWidth]; ///< D = axis + tan(theta0.5) (x e1 + y e2) of the ray's beam
  float inverse[3][PacketWidth];   ///< inverse of the direction's components
  float far[PacketWidth];          ///< no hit beyond this range over |D| counts for the ray, m
  float farthest[PacketWidth / PacketGroup]; ///< largest `far` of each group; 0 without rays
  float apex[3];                             ///< apex relative to the tree's reference, m
  float widening;                            ///< widening of every box, m
  float spread;                              ///< half-width of the rays, rad
  int axes[3];                               ///< the dominant coordinate axis, and the two others
  float sign;                                ///< sign of the directions along the dominant axis
  float lowU, highU, lowV, highV;            ///< slopes of the directions
  float shortening; ///< factor from depth along the dominant axis to a lower bound of range/|D|

  /// Set what follows from `count` directions; lanes that pad the last group repeat one of them.
  /// @param longest largest length of a direction
  /// @return false if the rays lie too far apart for one packet
  bool set(int count, double longest);
};

/// A child of a node that some rays meet.
struct PacketChild
{
  std::uint32_t lane;
  RayBits rays;
  float nearest; ///< lower bound of the range, m
};

/// Children of a node that some of `rays` meet. @return number of children
int meetChildren(const PacketView& view, const WideNode& node, RayBits rays, PacketChild* children);
}

#endif
