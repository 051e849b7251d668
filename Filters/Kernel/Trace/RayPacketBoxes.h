// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayPacketBoxes.h
 * @brief The rays of a packet against the eight boxes of a node, in single precision, in vectors
 * (RayLanes.h).
 *
 * The rays lie between four planes through the apex, each along one of the two axes that are
 * not the dominant one of the directions: eight boxes are tested against these in one loop, then
 * groups of sixteen rays against each box that is left (slabs), or, where few rays are left, each
 * ray against eight boxes. Margins are those of WideRay.
 */
#ifndef avianlidar_RayPacketBoxes_h
#define avianlidar_RayPacketBoxes_h

#include "TriangleTest.h"
#include "WideTree.h"

#include <cstdint>

namespace avianlidar
{
constexpr int PacketWidth = 64;

/// Rays are looked at in groups of sixteen; the last one is padded.
constexpr int PacketGroup = 16;

/// A set of rays of a packet, one bit each.
using RayBits = std::uint64_t;

/// Rays of a packet in whole groups.
constexpr int padded(int count)
{
  return (count + PacketGroup - 1) / PacketGroup * PacketGroup;
}

/// What boxes and triangles need to know of a packet. Along a ray, places are given by their range
/// over |D|, with D the direction as it stands here.
struct alignas(64) PacketView
{
  float direction[3][PacketWidth]; ///< D = axis + tan(theta0.5) (x e1 + y e2) of the ray's beam
  float inverse[3][PacketWidth];   ///< of the directions
  float far[PacketWidth];          ///< no hit beyond this range over |D| counts for the ray, m
  float farthest[PacketWidth / PacketGroup]; ///< `far` of a group at most; 0 without rays
  float apex[3];                             ///< relative to the tree's reference, m
  float widening;                            ///< of every box, m
  float spread;                              ///< half-width of the rays, rad
  int axes[3];                               ///< the dominant one, and the two others
  float sign;                                ///< of the directions along the dominant axis
  float lowU, highU, lowV, highV;            ///< of the directions, dominant component 1
  float shortening; ///< depth along the dominant axis to a lower bound of the range over |D|

  /// All that follows from `count` directions; lanes that pad the last group repeat one of them.
  /// @param longest of the directions
  /// @return false if the rays lie too far apart to be looked at as one
  bool set(int count, double longest);
};

/// A child of a node that some rays meet.
struct PacketChild
{
  std::uint32_t lane;
  RayBits rays;
  float nearest; ///< lower bound of the range, m
};

/// @param rays those of interest
/// @return number of children met
int meetChildren(const PacketView& view, const WideNode& node, RayBits rays, PacketChild* children);
}

#endif
