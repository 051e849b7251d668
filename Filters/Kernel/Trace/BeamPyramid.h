// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamPyramid.h
 * @brief A pyramid about sixteen cones of one apex, and the cones themselves, against eight boxes,
 * in single precision: loops over lanes.
 *
 * All tests are conservative, rounding included: cones are widened as in BeamVolumeTest.h, boxes as
 * in WideTree.h. A box is left out by the pyramid if it lies beyond one of its four sides, behind
 * the apex, or, along one of the two coordinate axes that are not the dominant one, above or below
 * all slopes of the directions (that tells flat ground from beams that look up); by a cone, for the
 * slopes alike, the plane that touches it on the side of the box's centre, and the plane across its
 * axis.
 */
#ifndef avianlidar_BeamPyramid_h
#define avianlidar_BeamPyramid_h

#include "BeamFrame.h"
#include "WideTree.h"

#include <cstddef>
#include <cstdint>

namespace avianlidar
{
/// Up to sixteen cones from one apex, in single precision.
struct alignas(64) ConeLanes
{
  static constexpr int Width = 16;
  float x[Width], y[Width], z[Width]; ///< axes
  float sine[Width], cosine[Width];   ///< of the half-angles, rounding included
  float lowU[Width], highU[Width], lowV[Width], highV[Width]; ///< found by Pyramid::set()
  int count = 0;

  /// The cone of a beam, or one about several, widened as in BeamVolumeTest.
  void add(const BeamFrame* frames, const std::uint32_t* beams, std::size_t count);
  /// Lanes beyond the last one repeat it.
  void close();
};

/// Slopes of the directions of a cone or pyramid along two coordinate axes over the dominant one.
struct Slopes
{
  float lowU, highU, lowV, highV;
};

/// A pyramid about all cones of a group.
struct Pyramid
{
  int axes[3]; ///< the dominant one, and the two others
  float sign;  ///< of the directions along the dominant axis
  Slopes slopes;
  float apexX, apexY, apexZ;                ///< relative to the tree's reference
  float normalX[4], normalY[4], normalZ[4]; ///< outward unit normals of its sides
  float axisX, axisY, axisZ;
  float widening; ///< of every box, m
  double widest;  ///< tangent of the widest cone's half-angle

  /// False if the cones are too wide, or too far apart, or do not all lie along one coordinate
  /// axis, or the apex is too far away for single precision. Fills the slopes of the cones.
  bool set(const WideTree& tree, const Vec3& apex, ConeLanes& cones);

private:
  bool setSlopes(const Vec3& middle, ConeLanes& cones);
};

/// Eight boxes relative to the apex, widened.
struct alignas(64) NearBoxes
{
  float center[3][8], half[3][8], error[8];
  float nearest[8]; ///< lower bound of the distance, infinite if the pyramid does not meet the box
  float size[8];    ///< half diagonal over the distance
};

/// @param boxes found: the node's boxes, which of them the pyramid meets, and how large they look
void meetPyramid(const Pyramid& pyramid, const WideNode& node, NearBoxes& boxes);

/// Cones that meet box i, one bit each.
std::uint32_t meetCones(
  const ConeLanes& cones, const Pyramid& pyramid, const NearBoxes& boxes, int i);
}

#endif
