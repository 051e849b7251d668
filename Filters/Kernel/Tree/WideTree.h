// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file WideTree.h
 * @brief A collision tree of axis-aligned boxes with eight children a node, in single precision,
 * for speed; its cone and ray tests; and the entry points from which rays go on down it.
 *
 * Eight boxes are tested in one loop over lanes. Boxes are relative to the middle of the scene and
 * are widened by the rounding of that.
 *
 * Source: Wald, Benthin and Boulos, "Getting Rid of Packets", IEEE RT 2008; tests as in
 * BeamVolumeTest.h of the other volumes.
 * Differs: single rays are one of several users; packets and groups of beams descend it, too.
 * Valid: conservative. Below LeastWideExtent and beyond LargestWideExtent all boxes are met.
 * Test: TestWideTree.cxx, TestBeamGroup.cxx and TestBeamTracer.cxx (entry points).
 */
#ifndef avianlidar_WideTree_h
#define avianlidar_WideTree_h

#include "BeamCone.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
struct alignas(64) WideNode
{
  static constexpr int Width = 8;
  float x[Width], y[Width], z[Width];             ///< centres relative to WideTree::reference, m
  float halfX[Width], halfY[Width], halfZ[Width]; ///< half extents, rounded up, m
  std::uint32_t
    first[Width]; ///< inner child: its node; leaf: first entry of the tree's order; NoChild
  std::uint32_t count[Width]; ///< triangles of a leaf; 0: inner

  /// No children.
  void clear();
};

constexpr std::uint32_t NoChild = 0xffffffffu;

/// Larger scenes, and apexes farther away, are too large for products in single precision, m.
constexpr double LargestWideExtent = 1e15;

/// Squares of smaller coordinates, m, are not normal numbers in single precision.
constexpr double LeastWideExtent = 1e-12;

struct WideTree
{
  std::vector<WideNode> nodes; ///< root first; empty if there is none
  Vec3 reference{ 0.0 };
  double extent = 0.0;     ///< largest coordinate relative to the reference, m
  std::uint32_t depth = 0; ///< levels below the root
};

/// Relative rounding of the single-precision tests, several times over.
constexpr float WideRounding = 2e-6f;

/// What boxes must be widened by when they are moved to `offset` (of an apex from the reference) in
/// single precision, m; false if the scene or the offset is too large, or both are too small.
bool wideningFor(const WideTree& tree, const Vec3& offset, float& widening);

/// Boxes from which the rays of one beam go on down the wide tree: eight at a time, front to back
/// except for overlaps.
struct EntryPoints
{
  std::vector<WideNode> nodes;
  std::vector<float> nearest; ///< lower bound of the ranges in each node, m

  void clear();
  void add(const WideNode& node, int lane, float distance);
  /// A leaf whose volume is not known as a box.
  void addLeaf(std::uint32_t first, std::uint32_t count);

private:
  int nextLane(float distance);

  int Filled = WideNode::Width; ///< lanes of the last node
};

/// The cone of a beam against eight boxes.
struct WideCone
{
  float apexX, apexY, apexZ; ///< relative to the reference
  float axisX, axisY, axisZ;
  float sine, cosine; ///< of the widened half-beamwidth
  float widening;     ///< of every box, m
  /// Edges of the cone's projections on the planes yz, zx, xy (see BeamCone.h); 0 for a whole
  /// plane.
  float leftX[3], leftY[3], rightX[3], rightY[3];

  bool everywhere; ///< too large, small or far for single precision: meets all boxes

  WideCone(const WideTree& tree, const BeamFrame& frame);

  /// Lower bounds of the distances of the boxes that the cone may meet; infinity for the others.
  void distances(const WideNode& node, float* nearest) const;
};

/// One ray against eight boxes.
struct WideRay
{
  float originX, originY, originZ;    ///< relative to the reference
  float inverseX, inverseY, inverseZ; ///< of the unit direction
  float widening;
  float spread; ///< half-width of the ray, rad

  bool everywhere; ///< as of WideCone

  /// @param origin relative to the apex
  WideRay(const WideTree& tree, const Vec3& apex, const Vec3& origin, const Vec3& direction,
    double angularMargin);
  void distances(const WideNode& node, float* nearest) const;
};
}

#endif
