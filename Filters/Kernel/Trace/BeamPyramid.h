// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamPyramid.h
 * @brief A pyramid about sixteen cones of one apex, and the cones themselves, against eight boxes
 * in single precision.
 *
 * The pyramid rejects a box that lies beyond one of its four sides, behind the apex, or beside the
 * slopes of all directions along one of the two coordinate axes that are not the dominant one (this
 * separates flat ground from beams that look up). A cone rejects a box by its own slopes, by the
 * plane that touches the cone on the side of the box's centre, and by the plane through the apex
 * across its axis.
 *
 * Source: none; the tangent plane and the plane across the axis are those of BeamVolumeTest.h.
 * Valid: conservative, rounding included: cones are widened as in BeamCone.h, boxes as in
 * WideTree.h. Pyramid::set() fails for a cone whose half-angle has a sine above 0.99, for axes more
 * than 60 degrees off the middle of the group, and where the cones do not all lie along one
 * coordinate axis.
 * Test: TestBeamGroup.cxx.
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
  float sine[Width], cosine[Width];   ///< sine and cosine of the half-angles, rounding included
  float lowU[Width], highU[Width], lowV[Width], highV[Width]; ///< slopes, set by Pyramid::set()
  int count = 0;

  /// The cone of a beam, or one about several, widened as BeamCone.
  void add(const BeamFrame* frames, const std::uint32_t* beams, std::size_t number);
  /// Fill the lanes beyond the last cone with copies of it.
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
  int axes[3]; ///< the dominant coordinate axis, and the two others
  float sign;  ///< sign of the directions along the dominant axis
  Slopes slopes;
  float apexX, apexY, apexZ;                ///< apex relative to the tree's reference, m
  float normalX[4], normalY[4], normalZ[4]; ///< outward unit normals of its sides
  float axisX, axisY, axisZ;
  float widening; ///< widening of every box, m
  double widest;  ///< tangent of the widest cone's half-angle

  /// False if the cones are too wide, or too far apart, or do not all lie along one coordinate
  /// axis, or where single precision ends (wideningFor()). Fills the slopes of the cones.
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

/// Test the boxes of a node. @param boxes out: the boxes, which of them the pyramid meets, and
/// their sizes over distance
void meetPyramid(const Pyramid& pyramid, const WideNode& node, NearBoxes& boxes);

/// Cones that box i may meet, one bit each.
std::uint32_t meetCones(
  const ConeLanes& cones, const Pyramid& pyramid, const NearBoxes& boxes, int i);
}

#endif
