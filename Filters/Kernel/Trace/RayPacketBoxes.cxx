// SPDX-License-Identifier: BSD-3-Clause
#include "RayPacketBoxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

// This file is compiled once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "RayPacketBoxes.cxx"
#include <hwy/foreach_target.h>

#include "RayLanes.h"

HWY_BEFORE_NAMESPACE();
namespace avianlidar::HWY_NAMESPACE
{
namespace
{
constexpr int Children = WideNode::Width;

HWY_INLINE float lowest(Rays v)
{
  return hn::GetLane(hn::MinOfLanes(RayTag(), v));
}

HWY_INLINE float highest(Rays v)
{
  return hn::GetLane(hn::MaxOfLanes(RayTag(), v));
}

/// Smallest and largest of many numbers.
struct Interval
{
  Rays low, high;

  HWY_INLINE Interval()
    : low(everywhere(std::numeric_limits<float>::infinity()))
    , high(everywhere(-std::numeric_limits<float>::infinity()))
  {
  }
  HWY_INLINE void add(Rays v)
  {
    this->low = hn::Min(this->low, v);
    this->high = hn::Max(this->high, v);
  }
};

/// Inverse directions, and the four planes about them.
bool surroundRays(PacketView& view, int count, float longest)
{
  const RayTag lanes;
  const auto& d = view.direction;
  const float x = std::fabs(d[0][0]);
  const float y = std::fabs(d[1][0]);
  const float z = std::fabs(d[2][0]);
  const int k = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
  const int i = (k + 1) % 3;
  const int j = (k + 2) % 3;
  view.axes[0] = k;
  view.axes[1] = i;
  view.axes[2] = j;
  view.sign = d[k][0] < 0.0f ? -1.0f : 1.0f;
  const Rays sign = everywhere(view.sign);
  Interval depth, u, v;
  for (int lane = 0; lane < count; lane += RayLanes)
  {
    Rays inverse = hn::Zero(lanes);
    for (const int axis : { i, j, k })
    {
      constexpr float Smallest = 1e-20f;
      const Rays along = hn::Load(lanes, d[axis] + lane);
      const auto tiny = hn::Lt(hn::Abs(along), everywhere(Smallest));
      inverse = hn::Div(
        everywhere(1.0f), hn::IfThenElse(tiny, hn::CopySign(everywhere(Smallest), along), along));
      hn::Store(inverse, lanes, view.inverse[axis] + lane);
    }
    inverse = hn::Mul(sign, inverse);
    depth.add(hn::Mul(sign, hn::Load(lanes, d[k] + lane)));
    u.add(hn::Mul(hn::Load(lanes, d[i] + lane), inverse));
    v.add(hn::Mul(hn::Load(lanes, d[j] + lane), inverse));
  }
  view.lowU = lowest(u.low);
  view.highU = highest(u.high);
  view.lowV = lowest(v.low);
  view.highV = highest(v.high);
  view.shortening = (1.0f - WideRounding) / highest(depth.high);
  return lowest(depth.low) >= 0.25f * longest && view.highU - view.lowU <= 1.0f &&
    view.highV - view.lowV <= 1.0f;
}

/// Eight boxes relative to the apex, widened.
struct alignas(64) NearBoxes
{
  float center[3][Children];
  float half[3][Children];
};

HWY_INLINE void moveToApex(const PacketView& view, const WideNode& node, NearBoxes& boxes)
{
  const BoxTag lanes;
  const Boxes widening = hn::Set(lanes, view.widening);
  const Boxes relative = hn::Set(lanes, WideRounding + view.spread);
  for (int i = 0; i < Children; i += BoxLanes)
  {
    const Boxes x = hn::Sub(hn::Load(lanes, node.x + i), hn::Set(lanes, view.apex[0]));
    const Boxes y = hn::Sub(hn::Load(lanes, node.y + i), hn::Set(lanes, view.apex[1]));
    const Boxes z = hn::Sub(hn::Load(lanes, node.z + i), hn::Set(lanes, view.apex[2]));
    const Boxes hx = hn::Load(lanes, node.halfX + i);
    const Boxes hy = hn::Load(lanes, node.halfY + i);
    const Boxes hz = hn::Load(lanes, node.halfZ + i);
    // Summed in pairs to shorten the chain of dependent steps.
    const Boxes size =
      hn::Add(hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Add(hn::Abs(z), hx)), hn::Add(hy, hz));
    const Boxes margin = hn::MulAdd(relative, size, widening);
    hn::Store(x, lanes, boxes.center[0] + i);
    hn::Store(y, lanes, boxes.center[1] + i);
    hn::Store(z, lanes, boxes.center[2] + i);
    hn::Store(hn::Add(hx, margin), lanes, boxes.half[0] + i);
    hn::Store(hn::Add(hy, margin), lanes, boxes.half[1] + i);
    hn::Store(hn::Add(hz, margin), lanes, boxes.half[2] + i);
  }
}

HWY_INLINE hn::Mask<BoxTag> areChildren(const WideNode& node, int begin)
{
  const hn::RebindToUnsigned<BoxTag> numbers;
  return hn::RebindMask(
    BoxTag(), hn::Ne(hn::Load(numbers, node.first + begin), hn::Set(numbers, NoChild)));
}

/// Boxes that the four planes let through, one bit each, and lower bounds of their ranges.
HWY_INLINE std::uint32_t meetFrustum(
  const PacketView& view, const WideNode& node, const NearBoxes& boxes, float* nearest)
{
  const BoxTag lanes;
  const int* const axes = view.axes;
  const Boxes sign = hn::Set(lanes, view.sign);
  const Boxes lowU = hn::Set(lanes, view.lowU);
  const Boxes highU = hn::Set(lanes, view.highU);
  const Boxes lowV = hn::Set(lanes, view.lowV);
  const Boxes highV = hn::Set(lanes, view.highV);
  std::uint32_t met = 0;
  for (int b = 0; b < Children; b += BoxLanes)
  {
    const Boxes depth = hn::Mul(sign, hn::Load(lanes, boxes.center[axes[0]] + b));
    const Boxes half = hn::Load(lanes, boxes.half[axes[0]] + b);
    const Boxes far = hn::Add(depth, half);
    const Boxes near = hn::Max(hn::Sub(depth, half), hn::Zero(lanes));
    const Boxes ic = hn::Load(lanes, boxes.center[axes[1]] + b);
    const Boxes ih = hn::Load(lanes, boxes.half[axes[1]] + b);
    const Boxes jc = hn::Load(lanes, boxes.center[axes[2]] + b);
    const Boxes jh = hn::Load(lanes, boxes.half[axes[2]] + b);
    const auto left = hn::Le(hn::Sub(ic, ih), hn::Max(hn::Mul(highU, near), hn::Mul(highU, far)));
    const auto right = hn::Ge(hn::Add(ic, ih), hn::Min(hn::Mul(lowU, near), hn::Mul(lowU, far)));
    const auto below = hn::Le(hn::Sub(jc, jh), hn::Max(hn::Mul(highV, near), hn::Mul(highV, far)));
    const auto above = hn::Ge(hn::Add(jc, jh), hn::Min(hn::Mul(lowV, near), hn::Mul(lowV, far)));
    const auto between = hn::And(hn::And(left, right), hn::And(below, above));
    const auto inFront = hn::And(hn::Ge(far, hn::Zero(lanes)), areChildren(node, b));
    hn::Store(hn::Mul(near, hn::Set(lanes, view.shortening)), lanes, nearest + b);
    met |= static_cast<std::uint32_t>(bitsOf(lanes, hn::And(between, inFront))) << b;
  }
  return met;
}

/// Slabs: the part of a ray within a box, as ranges over |D|.
template <class V>
struct Passage
{
  V from, to;

  HWY_INLINE Passage(V cx, V cy, V cz, V hx, V hy, V hz, V ix, V iy, V iz)
  {
    const V mx = hn::Mul(cx, ix);
    const V my = hn::Mul(cy, iy);
    const V mz = hn::Mul(cz, iz);
    const V wx = hn::Mul(hx, hn::Abs(ix));
    const V wy = hn::Mul(hy, hn::Abs(iy));
    const V wz = hn::Mul(hz, hn::Abs(iz));
    const V start = hn::Max(hn::Max(hn::Sub(mx, wx), hn::Sub(my, wy)), hn::Sub(mz, wz));
    this->from = hn::Max(start, hn::Zero(hn::DFromV<V>()));
    this->to = hn::Min(hn::Min(hn::Add(mx, wx), hn::Add(my, wy)), hn::Add(mz, wz));
  }
};

/// The rays that meet one box before they hit something.
HWY_INLINE RayBits raysThatMeet(
  const PacketView& view, const NearBoxes& boxes, int box, RayBits rays)
{
  const RayTag lanes;
  const Rays cx = everywhere(boxes.center[0][box]);
  const Rays cy = everywhere(boxes.center[1][box]);
  const Rays cz = everywhere(boxes.center[2][box]);
  const Rays hx = everywhere(boxes.half[0][box]);
  const Rays hy = everywhere(boxes.half[1][box]);
  const Rays hz = everywhere(boxes.half[2][box]);
  const Rays shortening = everywhere(1.0f - WideRounding);
  RayBits bits = 0;
  for (int group = 0; group < PacketWidth; group += PacketGroup)
  {
    if ((rays >> group & 0xffffu) == 0)
    {
      continue;
    }
    for (int i = group; i < group + PacketGroup; i += RayLanes)
    {
      const Passage<Rays> way(cx, cy, cz, hx, hy, hz, hn::Load(lanes, view.inverse[0] + i),
        hn::Load(lanes, view.inverse[1] + i), hn::Load(lanes, view.inverse[2] + i));
      const auto meets = hn::And(hn::Le(way.from, way.to),
        hn::Le(hn::Mul(way.from, shortening), hn::Load(lanes, view.far + i)));
      bits |= bitsOf(lanes, meets) << i;
    }
  }
  return bits & rays;
}

/// The boxes that one ray meets, one bit each, and their lower bounds.
HWY_INLINE std::uint32_t boxesThatMeet(
  const PacketView& view, const WideNode& node, const NearBoxes& boxes, int ray, float* nearest)
{
  const BoxTag lanes;
  const Boxes ix = hn::Set(lanes, view.inverse[0][ray]);
  const Boxes iy = hn::Set(lanes, view.inverse[1][ray]);
  const Boxes iz = hn::Set(lanes, view.inverse[2][ray]);
  const Boxes far = hn::Set(lanes, view.far[ray]);
  std::uint32_t met = 0;
  for (int b = 0; b < Children; b += BoxLanes)
  {
    const Passage<Boxes> way(hn::Load(lanes, boxes.center[0] + b),
      hn::Load(lanes, boxes.center[1] + b), hn::Load(lanes, boxes.center[2] + b),
      hn::Load(lanes, boxes.half[0] + b), hn::Load(lanes, boxes.half[1] + b),
      hn::Load(lanes, boxes.half[2] + b), ix, iy, iz);
    const Boxes entry = hn::Mul(way.from, hn::Set(lanes, 1.0f - WideRounding));
    const auto meets =
      hn::And(hn::And(hn::Le(way.from, way.to), hn::Le(entry, far)), areChildren(node, b));
    const Boxes before = hn::Load(lanes, nearest + b);
    hn::Store(hn::IfThenElse(meets, hn::Min(entry, before), before), lanes, nearest + b);
    met |= static_cast<std::uint32_t>(bitsOf(lanes, meets)) << b;
  }
  return met;
}

/// Few rays, each against all boxes.
HWY_INLINE int meetOneByOne(const PacketView& view, const WideNode& node, const NearBoxes& boxes,
  RayBits rays, PacketChild* children)
{
  alignas(64) float nearest[Children];
  RayBits bits[Children];
  for (int b = 0; b < Children; ++b)
  {
    nearest[b] = std::numeric_limits<float>::infinity();
    bits[b] = 0;
  }
  std::uint32_t met = 0;
  for (; rays != 0; rays &= rays - 1)
  {
    const int ray = __builtin_ctzll(rays);
    const std::uint32_t own = boxesThatMeet(view, node, boxes, ray, nearest);
    met |= own;
    for (std::uint32_t rest = own; rest != 0; rest &= rest - 1)
    {
      bits[__builtin_ctz(rest)] |= RayBits(1) << ray;
    }
  }
  int count = 0;
  for (; met != 0; met &= met - 1)
  {
    const int b = __builtin_ctz(met);
    children[count++] = { static_cast<std::uint32_t>(b), bits[b], nearest[b] };
  }
  return count;
}

int meetAll(const PacketView& view, const WideNode& node, RayBits rays, PacketChild* children)
{
  NearBoxes boxes;
  moveToApex(view, node, boxes);
  constexpr int Few = 6;
  if (__builtin_popcountll(rays) <= Few)
  {
    return meetOneByOne(view, node, boxes, rays, children);
  }
  alignas(64) float nearest[Children];
  int count = 0;
  for (std::uint32_t met = meetFrustum(view, node, boxes, nearest); met != 0; met &= met - 1)
  {
    const int b = __builtin_ctz(met);
    const RayBits some = raysThatMeet(view, boxes, b, rays);
    children[count] = { static_cast<std::uint32_t>(b), some, nearest[b] };
    count += some != 0;
  }
  return count;
}
}
}
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace avianlidar
{
HWY_EXPORT(surroundRays);
HWY_EXPORT(meetAll);

bool PacketView::set(int count, double longest)
{
  const int end = padded(count);
  std::fill(this->far, this->far + end, FloatInfinity);
  for (int group = 0; group < PacketWidth / PacketGroup; ++group)
  {
    this->farthest[group] = group * PacketGroup < end ? FloatInfinity : 0.0f;
  }
  return HWY_DYNAMIC_DISPATCH(surroundRays)(*this, end, static_cast<float>(longest));
}

int meetChildren(const PacketView& view, const WideNode& node, RayBits rays, PacketChild* children)
{
  return HWY_DYNAMIC_DISPATCH(meetAll)(view, node, rays, children);
}
}
#endif
