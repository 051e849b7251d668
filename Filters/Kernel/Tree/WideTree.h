// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file WideTree.h
 * @brief Collision tree with eight children per node and axis-aligned boxes in single precision,
 * tests of cones and rays against the boxes, and entry points at which rays begin their descent.
 *
 * Eight boxes are tested in one loop over lanes. Boxes are relative to the middle of the scene, and
 * tests widen them by the rounding of single precision.
 *
 * Source: Wald, Benthin and Boulos, "Getting Rid of Packets", IEEE RT 2008; the tests follow
 * BeamVolumeTest.h.
 * Differs: packets of rays and groups of beams descend the tree, too.
 * Valid: the tests are conservative. All boxes count as met if scene and apex are within
 * LeastWideExtent, or if scene or apex is beyond LargestWideExtent.
 * Test: TestWideTree.cxx, TestBeamGroup.cxx and TestBeamTracer.cxx (entry points).
 */
#ifndef avianlidar_WideTree_h
#define avianlidar_WideTree_h

#include "BeamFrame.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
struct alignas(64) WideNode
{
  static constexpr int Width = 8;
  float x[Width], y[Width], z[Width];             ///< centres relative to WideTree::reference, m
  float halfX[Width], halfY[Width], halfZ[Width]; ///< half extents, rounded up, m
  std::uint32_t first[Width]; ///< number of an inner child, place in the order of the first
                              ///< triangle of a leaf, or NoChild
  std::uint32_t count[Width]; ///< number of triangles of a leaf; 0 for an inner child

  /// Remove all children.
  void clear();
};

constexpr std::uint32_t NoChild = 0xffffffffu;

/// Largest extent of a scene, and largest distance of an apex, m: products of larger numbers
/// may overflow in single precision.
constexpr double LargestWideExtent = 1e15;

/// Least extent, m: squares of smaller coordinates may not be normal numbers in single precision.
constexpr double LeastWideExtent = 1e-12;

struct WideTree
{
  std::vector<WideNode> nodes; ///< nodes, root first; empty without a root
  Vec3 reference{ 0.0 };       ///< origin of the boxes, m
  double extent = 0.0;         ///< largest coordinate relative to the reference, m
  std::uint32_t depth = 0;     ///< number of levels below the root
};

/// Several times the bound of the relative rounding of the single-precision tests.
constexpr float WideRounding = 2e-6f;

/// Find the widening of boxes, m, that single precision requires for an apex at `offset` from the
/// reference.
/// @return false if the scene or the offset is too large, or both are too small
bool wideningFor(const WideTree& tree, const Vec3& offset, float& widening);

/// Boxes at which the rays of a beam enter the wide tree, front to back except for overlaps.
struct EntryPoints
{
  std::vector<WideNode> nodes;
  std::vector<float> nearest; ///< lower bound of the ranges in each node, m

  void clear();
  void add(const WideNode& node, int lane, float distance);
  /// Add a leaf with a box that every ray meets.
  void addLeaf(std::uint32_t first, std::uint32_t count);

private:
  int nextLane(float distance);

  int Filled = WideNode::Width; ///< number of lanes in use in the last node
};

/// Test of a beam's cone against eight boxes.
struct WideCone
{
  float apexX, apexY, apexZ; ///< apex relative to the reference, m
  float axisX, axisY, axisZ;
  float sine, cosine; ///< sine and cosine of the widened half-beamwidth
  float widening;     ///< widening of every box, m
  /// Edges of the projections on the planes yz, zx, xy (BeamCone.h); 0 for a whole plane.
  float leftX[3], leftY[3], rightX[3], rightY[3];

  bool everywhere; ///< true if single precision does not suffice: all boxes are met

  WideCone(const WideTree& tree, const BeamFrame& frame);

  /// Lower bounds of distances, m, of boxes that the cone may meet; infinity for other boxes.
  void distances(const WideNode& node, float* nearest) const;
};

/// Test of one ray against eight boxes.
struct WideRay
{
  float originX, originY, originZ;    ///< origin relative to the reference, m
  float inverseX, inverseY, inverseZ; ///< inverse components of the unit direction
  float widening;
  float spread; ///< half-width of the ray, rad

  bool everywhere; ///< true if single precision does not suffice: all boxes are met

  /// @param origin relative to the apex, m @param direction unit vector @param angularMargin
  /// half-width of the ray, rad
  WideRay(const WideTree& tree, const Vec3& apex, const Vec3& origin, const Vec3& direction,
    double angularMargin);
  void distances(const WideNode& node, float* nearest) const;
};
}

#endif
