// SPDX-License-Identifier: BSD-3-Clause
// The cones of a group of beams against one box.
#include "BeamPyramid.h"

#include <algorithm>

// This file is compiled once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "BeamPyramidCones.cxx"
#include <hwy/foreach_target.h>

#include "RayLanes.h"

HWY_BEFORE_NAMESPACE();
namespace avianlidar::HWY_NAMESPACE
{
namespace
{
HWY_INLINE Rays dot(Rays ax, Rays ay, Rays az, Rays bx, Rays by, Rays bz)
{
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz)));
}

/// Cones that meet box i, one bit each: the slopes, then for those that are left the tangent plane
/// on the side of the box's centre, and the plane across the axis (see BeamVolumeTest.cxx).
std::uint32_t meetAll(const ConeLanes& cones, const Pyramid& pyramid, const NearBoxes& boxes, int i)
{
  const RayTag lanes;
  const float error = boxes.error[i];
  const int k = pyramid.axes[0];
  const int u = pyramid.axes[1];
  const int v = pyramid.axes[2];
  const float depth = pyramid.sign * boxes.center[k][i];
  const Rays far = everywhere(depth + boxes.half[k][i] + error);
  const Rays near = everywhere(std::max(depth - boxes.half[k][i] - error, 0.0f));
  const Rays lowU = everywhere(boxes.center[u][i] - boxes.half[u][i] - error);
  const Rays highU = everywhere(boxes.center[u][i] + boxes.half[u][i] + error);
  const Rays lowV = everywhere(boxes.center[v][i] - boxes.half[v][i] - error);
  const Rays highV = everywhere(boxes.center[v][i] + boxes.half[v][i] + error);
  const Rays x = everywhere(boxes.center[0][i]);
  const Rays y = everywhere(boxes.center[1][i]);
  const Rays z = everywhere(boxes.center[2][i]);
  const Rays hx = everywhere(boxes.half[0][i]);
  const Rays hy = everywhere(boxes.half[1][i]);
  const Rays hz = everywhere(boxes.half[2][i]);
  const Rays uncertain = everywhere(error);
  std::uint32_t met = 0;
  for (int b = 0; b < ConeLanes::Width; b += RayLanes)
  {
    const auto slope = [&](const float* slopes, Rays at) HWY_ATTR
    { return hn::Mul(hn::Load(lanes, slopes + b), at); };
    const auto withinU =
      hn::And(hn::Le(lowU, hn::Max(slope(cones.highU, near), slope(cones.highU, far))),
        hn::Ge(highU, hn::Min(slope(cones.lowU, near), slope(cones.lowU, far))));
    const auto withinV =
      hn::And(hn::Le(lowV, hn::Max(slope(cones.highV, near), slope(cones.highV, far))),
        hn::Ge(highV, hn::Min(slope(cones.lowV, near), slope(cones.lowV, far))));
    const auto within = hn::And(withinU, withinV);
    if (hn::AllFalse(lanes, within))
    {
      continue;
    }
    const Rays ax = hn::Load(lanes, cones.x + b);
    const Rays ay = hn::Load(lanes, cones.y + b);
    const Rays az = hn::Load(lanes, cones.z + b);
    const Rays sine = hn::Load(lanes, cones.sine + b);
    const Rays cosine = hn::Load(lanes, cones.cosine + b);
    const Rays along = dot(x, y, z, ax, ay, az);
    // Twice, so that what is left is across the axis to the last bits.
    Rays rx = hn::NegMulAdd(along, ax, x);
    Rays ry = hn::NegMulAdd(along, ay, y);
    Rays rz = hn::NegMulAdd(along, az, z);
    const Rays rest = dot(rx, ry, rz, ax, ay, az);
    rx = hn::NegMulAdd(rest, ax, rx);
    ry = hn::NegMulAdd(rest, ay, ry);
    rz = hn::NegMulAdd(rest, az, rz);
    const Rays radius = hn::Sqrt(dot(rx, ry, rz, rx, ry, rz));
    const Rays scale = hn::Div(cosine, radius);
    const Rays nx = hn::MulSub(scale, rx, hn::Mul(sine, ax));
    const Rays ny = hn::MulSub(scale, ry, hn::Mul(sine, ay));
    const Rays nz = hn::MulSub(scale, rz, hn::Mul(sine, az));
    const Rays beyond = dot(nx, ny, nz, x, y, z);
    const Rays reach = dot(hn::Abs(nx), hn::Abs(ny), hn::Abs(nz), hx, hy, hz);
    const auto outside = hn::Gt(hn::Mul(cosine, radius), hn::Mul(along, sine));
    const auto separated = hn::And(outside, hn::Gt(beyond, hn::Add(reach, uncertain)));
    const Rays size = dot(hn::Abs(ax), hn::Abs(ay), hn::Abs(az), hx, hy, hz);
    const auto behind = hn::Lt(hn::Add(hn::Add(along, size), uncertain), hn::Zero(lanes));
    met |= static_cast<std::uint32_t>(bitsOf(lanes, hn::AndNot(hn::Or(separated, behind), within)))
      << b;
  }
  return met;
}
}
}
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace avianlidar
{
HWY_EXPORT(meetAll);

std::uint32_t meetCones(
  const ConeLanes& cones, const Pyramid& pyramid, const NearBoxes& boxes, int i)
{
  return HWY_DYNAMIC_DISPATCH(meetAll)(cones, pyramid, boxes, i);
}
}
#endif
