// SPDX-License-Identifier: BSD-3-Clause
#include "BoxTests.h"

#include <algorithm>
#include <cmath>
#include <limits>

// This file is compiled once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "BoxTests.cxx"
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

/// Set the inverse directions, and the four planes about the rays.
bool surroundRays(PacketView& view, int count, float longest)
{
  const RayTag lanes;
  Frustum& f = view.frustum;
  const auto& d = view.direction;
  f.setAxes({ d[0][0], d[1][0], d[2][0] });
  const Rays sign = everywhere(f.sign);
  const Rays infinity = everywhere(std::numeric_limits<float>::infinity());
  // Least and largest depth along the dominant axis, and slopes.
  Rays low[3] = { infinity, infinity, infinity };
  Rays high[3] = { hn::Neg(infinity), hn::Neg(infinity), hn::Neg(infinity) };
  for (int lane = 0; lane < count; lane += RayLanes)
  {
    Rays along[3], inverse[3];
    for (int k = 0; k < 3; ++k)
    {
      constexpr float Smallest = 1e-20f;
      along[k] = hn::Load(lanes, d[f.axes[k]] + lane);
      const auto tiny = hn::Lt(hn::Abs(along[k]), everywhere(Smallest));
      inverse[k] = hn::Div(everywhere(1.0f),
        hn::IfThenElse(tiny, hn::CopySign(everywhere(Smallest), along[k]), along[k]));
      hn::Store(inverse[k], lanes, view.inverse[f.axes[k]] + lane);
    }
    const Rays perDepth = hn::Mul(sign, inverse[0]);
    const Rays values[3] = { hn::Mul(sign, along[0]), hn::Mul(along[1], perDepth),
      hn::Mul(along[2], perDepth) };
    for (int k = 0; k < 3; ++k)
    {
      low[k] = hn::Min(low[k], values[k]);
      high[k] = hn::Max(high[k], values[k]);
    }
  }
  f.lowU = lowest(low[1]);
  f.highU = highest(high[1]);
  f.lowV = lowest(low[2]);
  f.highV = highest(high[2]);
  f.shortening = (1.0f - WideRounding) / highest(high[0]);
  return lowest(low[0]) >= 0.25f * longest && f.highU - f.lowU <= 1.0f && f.highV - f.lowV <= 1.0f;
}

/// Eight boxes relative to the apex, widened.
struct alignas(64) NearBoxes
{
  float center[3][Children];
  float half[3][Children];
};

HWY_INLINE void moveToApex(const Frustum& frustum, const WideNode& node, NearBoxes& boxes)
{
  const BoxTag lanes;
  const Boxes widening = hn::Set(lanes, frustum.widening);
  const Boxes relative = hn::Set(lanes, WideRounding + frustum.spread);
  for (int i = 0; i < Children; i += BoxLanes)
  {
    const Boxes x = hn::Sub(hn::Load(lanes, node.x + i), hn::Set(lanes, frustum.apex[0]));
    const Boxes y = hn::Sub(hn::Load(lanes, node.y + i), hn::Set(lanes, frustum.apex[1]));
    const Boxes z = hn::Sub(hn::Load(lanes, node.z + i), hn::Set(lanes, frustum.apex[2]));
    const Boxes hx = hn::Load(lanes, node.halfX + i);
    const Boxes hy = hn::Load(lanes, node.halfY + i);
    const Boxes hz = hn::Load(lanes, node.halfZ + i);
    // Pairs are summed first, to shorten the chain of dependent steps.
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

/// Boxes between the four planes, one bit each. @param nearest out: lower bounds of ranges
HWY_INLINE std::uint32_t meetFrustum(
  const Frustum& frustum, const WideNode& node, const NearBoxes& boxes, float* nearest)
{
  const BoxTag lanes;
  const int* const axes = frustum.axes;
  const Boxes sign = hn::Set(lanes, frustum.sign);
  const Boxes lowU = hn::Set(lanes, frustum.lowU);
  const Boxes highU = hn::Set(lanes, frustum.highU);
  const Boxes lowV = hn::Set(lanes, frustum.lowV);
  const Boxes highV = hn::Set(lanes, frustum.highV);
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
    hn::Store(hn::Mul(near, hn::Set(lanes, frustum.shortening)), lanes, nearest + b);
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

/// Centre and half-lengths of one box, in every lane.
struct BoxInLanes
{
  Rays x, y, z, hx, hy, hz;

  HWY_INLINE BoxInLanes(const NearBoxes& boxes, int box)
    : x(everywhere(boxes.center[0][box]))
    , y(everywhere(boxes.center[1][box]))
    , z(everywhere(boxes.center[2][box]))
    , hx(everywhere(boxes.half[0][box]))
    , hy(everywhere(boxes.half[1][box]))
    , hz(everywhere(boxes.half[2][box]))
  {
  }
};

/// The rays that meet a box before their nearest hit so far.
HWY_INLINE RayBits raysThatMeet(
  const PacketView& view, const NearBoxes& boxes, int box, RayBits rays)
{
  const RayTag lanes;
  const BoxInLanes at(boxes, box);
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
      const Passage<Rays> way(at.x, at.y, at.z, at.hx, at.hy, at.hz,
        hn::Load(lanes, view.inverse[0] + i), hn::Load(lanes, view.inverse[1] + i),
        hn::Load(lanes, view.inverse[2] + i));
      const auto meets = hn::And(hn::Le(way.from, way.to),
        hn::Le(hn::Mul(way.from, shortening), hn::Load(lanes, view.far + i)));
      bits |= bitsOf(lanes, meets) << i;
    }
  }
  return bits & rays;
}

/// Test few rays, each against all boxes.
HWY_INLINE int meetOneByOne(const PacketView& view, const WideNode& node, const NearBoxes& boxes,
  RayBits rays, PacketChild* children)
{
  const BoxTag lanes;
  alignas(64) float nearest[Children];
  RayBits bits[Children] = {};
  std::fill(nearest, nearest + Children, std::numeric_limits<float>::infinity());
  for (; rays != 0; rays &= rays - 1)
  {
    const int ray = __builtin_ctzll(rays);
    for (int b = 0; b < Children; b += BoxLanes)
    {
      const auto box = [&](const float(*of)[Children], int axis) HWY_ATTR
      { return hn::Load(lanes, of[axis] + b); };
      const auto inverse = [&](int axis) HWY_ATTR
      { return hn::Set(lanes, view.inverse[axis][ray]); };
      const Passage<Boxes> way(box(boxes.center, 0), box(boxes.center, 1), box(boxes.center, 2),
        box(boxes.half, 0), box(boxes.half, 1), box(boxes.half, 2), inverse(0), inverse(1),
        inverse(2));
      const Boxes entry = hn::Mul(way.from, hn::Set(lanes, 1.0f - WideRounding));
      const auto meets =
        hn::And(hn::And(hn::Le(way.from, way.to), hn::Le(entry, hn::Set(lanes, view.far[ray]))),
          areChildren(node, b));
      const Boxes before = hn::Load(lanes, nearest + b);
      hn::Store(hn::IfThenElse(meets, hn::Min(entry, before), before), lanes, nearest + b);
      for (std::uint64_t met = bitsOf(lanes, meets); met != 0; met &= met - 1)
      {
        bits[b + __builtin_ctzll(met)] |= RayBits(1) << ray;
      }
    }
  }
  int count = 0;
  for (std::uint32_t b = 0; b < Children; ++b)
  {
    children[count] = { b, bits[b], nearest[b] };
    count += bits[b] != 0;
  }
  return count;
}

int meetRays(const PacketView& view, const WideNode& node, RayBits rays, PacketChild* children)
{
  NearBoxes boxes;
  moveToApex(view.frustum, node, boxes);
  constexpr int Few = 6;
  if (__builtin_popcountll(rays) <= Few)
  {
    return meetOneByOne(view, node, boxes, rays, children);
  }
  alignas(64) float nearest[Children];
  int count = 0;
  for (std::uint32_t met = meetFrustum(view.frustum, node, boxes, nearest); met != 0;
       met &= met - 1)
  {
    const int b = __builtin_ctz(met);
    const RayBits some = raysThatMeet(view, boxes, b, rays);
    children[count] = { static_cast<std::uint32_t>(b), some, nearest[b] };
    count += some != 0;
  }
  return count;
}

HWY_INLINE Rays dot(Rays ax, Rays ay, Rays az, Rays bx, Rays by, Rays bz)
{
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz)));
}

/// Cones that meet a box, one bit each. The tests use the planes of the cones, the tangent plane on
/// the side of the box's centre and the plane across the axis (see BeamVolumeTest.cxx).
HWY_INLINE std::uint32_t conesThatMeet(const ConeLanes& cones, const NearBoxes& boxes, int box)
{
  const RayTag lanes;
  const auto center = [&](int axis) { return boxes.center[cones.frustum.axes[axis]][box]; };
  const auto half = [&](int axis) { return boxes.half[cones.frustum.axes[axis]][box]; };
  const float depth = cones.frustum.sign * center(0);
  const Rays far = everywhere(depth + half(0));
  const Rays near = everywhere(std::max(depth - half(0), 0.0f));
  const Rays lowU = everywhere(center(1) - half(1));
  const Rays highU = everywhere(center(1) + half(1));
  const Rays lowV = everywhere(center(2) - half(2));
  const Rays highV = everywhere(center(2) + half(2));
  const BoxInLanes in(boxes, box);
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
    const Rays ax = hn::Load(lanes, cones.axis[0] + b);
    const Rays ay = hn::Load(lanes, cones.axis[1] + b);
    const Rays az = hn::Load(lanes, cones.axis[2] + b);
    const Rays sine = hn::Load(lanes, cones.sine + b);
    const Rays cosine = hn::Load(lanes, cones.cosine + b);
    const Rays along = dot(in.x, in.y, in.z, ax, ay, az);
    // The projection is repeated, so that the rest is across the axis to the last bits.
    Rays rx = hn::NegMulAdd(along, ax, in.x);
    Rays ry = hn::NegMulAdd(along, ay, in.y);
    Rays rz = hn::NegMulAdd(along, az, in.z);
    const Rays rest = dot(rx, ry, rz, ax, ay, az);
    rx = hn::NegMulAdd(rest, ax, rx);
    ry = hn::NegMulAdd(rest, ay, ry);
    rz = hn::NegMulAdd(rest, az, rz);
    const Rays radius = hn::Sqrt(dot(rx, ry, rz, rx, ry, rz));
    const Rays scale = hn::Div(cosine, radius);
    const Rays nx = hn::MulSub(scale, rx, hn::Mul(sine, ax));
    const Rays ny = hn::MulSub(scale, ry, hn::Mul(sine, ay));
    const Rays nz = hn::MulSub(scale, rz, hn::Mul(sine, az));
    const Rays beyond = dot(nx, ny, nz, in.x, in.y, in.z);
    const Rays reach = dot(hn::Abs(nx), hn::Abs(ny), hn::Abs(nz), in.hx, in.hy, in.hz);
    const auto outside = hn::Gt(hn::Mul(cosine, radius), hn::Mul(along, sine));
    const auto separated = hn::And(outside, hn::Gt(beyond, reach));
    const Rays size = dot(hn::Abs(ax), hn::Abs(ay), hn::Abs(az), in.hx, in.hy, in.hz);
    const auto behind = hn::Lt(hn::Add(along, size), hn::Zero(lanes));
    met |= static_cast<std::uint32_t>(bitsOf(lanes, hn::AndNot(hn::Or(separated, behind), within)))
      << b;
  }
  return met;
}

int meetCones(const ConeLanes& cones, const WideNode& node, std::uint32_t some, ConeChild* children)
{
  NearBoxes boxes;
  moveToApex(cones.frustum, node, boxes);
  alignas(64) float nearest[Children];
  int count = 0;
  for (std::uint32_t met = meetFrustum(cones.frustum, node, boxes, nearest); met != 0;
       met &= met - 1)
  {
    const int b = __builtin_ctz(met);
    const std::uint32_t own = some & conesThatMeet(cones, boxes, b);
    float squared = 0.0f;
    float diagonal = 0.0f;
    for (int axis = 0; axis < 3; ++axis)
    {
      const float half = boxes.half[axis][b];
      const float outside = std::max(std::fabs(boxes.center[axis][b]) - half, 0.0f);
      squared += outside * outside;
      diagonal += half * half;
    }
    const float distance = std::sqrt(squared) * (1.0f - WideRounding);
    children[count] = { static_cast<std::uint32_t>(b), own, distance,
      std::sqrt(diagonal) / distance };
    count += own != 0;
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
HWY_EXPORT(meetRays);
HWY_EXPORT(meetCones);

bool Frustum::setApex(const WideTree& tree, const Vec3& at)
{
  const Vec3 offset = at - tree.reference;
  for (int k = 0; k < 3; ++k)
  {
    this->apex[k] = static_cast<float>(offset[k]);
  }
  return wideningFor(tree, offset, this->widening);
}

void Frustum::setAxes(const Vec3& direction)
{
  const Vec3 size = glm::abs(direction);
  const int k = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  this->axes[0] = k;
  this->axes[1] = (k + 1) % 3;
  this->axes[2] = (k + 2) % 3;
  this->sign = direction[k] < 0.0 ? -1.0f : 1.0f;
}

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
  return HWY_DYNAMIC_DISPATCH(meetRays)(view, node, rays, children);
}

void ConeLanes::add(const BeamFrame* frames, const std::uint32_t* beams, std::size_t number)
{
  Vec3 middle = frames[beams[0]].axis;
  double apart = 0.0;
  if (number > 1)
  {
    for (std::size_t k = 1; k < number; ++k)
    {
      middle += frames[beams[k]].axis;
    }
    const double length = std::sqrt(glm::dot(middle, middle));
    middle = length > 0.0 ? middle / length : frames[beams[0]].axis;
    for (std::size_t k = 0; k < number; ++k)
    {
      const Vec3 off = frames[beams[k]].axis - middle;
      apart = std::max(apart, glm::dot(off, off));
    }
  }
  const int i = this->count++;
  for (int k = 0; k < 3; ++k)
  {
    this->axis[k][i] = static_cast<float>(middle[k]);
  }
  // The sine of a sum is at most the sum of the sines. A chord is longer than the sine of its
  // angle. The summand 1e-6 covers the rounding of the axis.
  const double wide = std::sqrt(apart) + frames[beams[0]].sinHalf * (1.0 + 2.0 * HitMarginBeam) +
    2.0 * HitMargin + 1e-6;
  const double widened = std::min(wide, 0.999);
  this->sine[i] = static_cast<float>(widened);
  this->cosine[i] = static_cast<float>(std::sqrt((1.0 - widened) * (1.0 + widened)));
}

void ConeLanes::close()
{
  for (float* lanes : { this->axis[0], this->axis[1], this->axis[2], this->sine, this->cosine })
  {
    std::fill(lanes + this->count, lanes + Width, lanes[this->count - 1]);
  }
}

bool ConeLanes::setFrustum(const WideTree& tree, const Vec3& apex)
{
  Frustum& f = this->frustum;
  Vec3 middle(0.0);
  for (int i = 0; i < this->count; ++i)
  {
    middle += Vec3(this->axis[0][i], this->axis[1][i], this->axis[2][i]);
  }
  f.setAxes(middle);
  f.lowU = f.lowV = FloatInfinity;
  f.highU = f.highV = -FloatInfinity;
  this->widest = 0.0;
  for (int i = 0; i < Width; ++i)
  {
    const float depth = f.sign * this->axis[f.axes[0]][i];
    const float u = this->axis[f.axes[1]][i] / depth;
    const float v = this->axis[f.axes[2]][i] / depth;
    // On the plane at depth 1 the cone reaches at most tan(alpha + beta) - tan(alpha) from its
    // axis. alpha is the angle between axis and normal. beta is the half-angle. a and b are their
    // tangents.
    const float a = std::sqrt(u * u + v * v);
    const float b = this->sine[i] / this->cosine[i];
    constexpr float widestSine = 0.99f;
    if (!(depth > 0.25f) || !(a * b < 0.5f) || !(this->sine[i] < widestSine))
    {
      return false;
    }
    const float reach = (1.0f + 1e-5f) * b * (1.0f + a * a) / (1.0f - a * b) + 1e-6f;
    this->lowU[i] = u - reach;
    this->highU[i] = u + reach;
    this->lowV[i] = v - reach;
    this->highV[i] = v + reach;
    f.lowU = std::min(f.lowU, this->lowU[i]);
    f.highU = std::max(f.highU, this->highU[i]);
    f.lowV = std::min(f.lowV, this->lowV[i]);
    f.highV = std::max(f.highV, this->highV[i]);
    this->widest = std::max<double>(this->widest, b);
  }
  return f.setApex(tree, apex);
}

int meetChildren(
  const ConeLanes& cones, const WideNode& node, std::uint32_t some, ConeChild* children)
{
  return HWY_DYNAMIC_DISPATCH(meetCones)(cones, node, some, children);
}
}
#endif
