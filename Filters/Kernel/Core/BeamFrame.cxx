// SPDX-License-Identifier: BSD-3-Clause
#include "BeamFrame.h"

namespace avianlidar
{
BeamFrame makeBeamFrame(const Vec3& origin, const Vec3& direction, const BeamWidth& width)
{
  BeamFrame frame;
  frame.origin = origin;
  // Twice: the second step takes away the rounding of the first.
  frame.axis = unitVector(unitVector(direction));
  const Vec3& n = frame.axis;
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  const double b = n.x * n.y * a;
  frame.e1 = { 1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x };
  frame.e2 = { b, sign + n.y * n.y * a, -n.y };
  frame.halfBeamwidth = width.half;
  frame.tanHalf = width.tangent;
  frame.sinHalf = width.sine;
  frame.cosHalf = width.cosine;
  return frame;
}
}
