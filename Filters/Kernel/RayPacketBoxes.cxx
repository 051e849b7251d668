// SPDX-License-Identifier: BSD-3-Clause
#include "RayPacketBoxes.h"

#include "Multiversion.h"

#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
constexpr int Group = PacketGroup;
constexpr int Boxes = WideNode::Width;
constexpr float Infinity = std::numeric_limits<float>::infinity();

AVIANLIDAR_ALWAYS_INLINE float least(float a, float b)
{
  return a < b ? a : b;
}

AVIANLIDAR_ALWAYS_INLINE float most(float a, float b)
{
  return a > b ? a : b;
}

/// Smallest and largest of the ratios of two components.
struct Interval
{
  float low, high;
};

AVIANLIDAR_ALWAYS_INLINE Interval slopes(
  const float* across, const float* along, float sign, int count)
{
  float low = Infinity;
  float high = -Infinity;
#pragma omp simd reduction(min : low) reduction(max : high)
  for (int i = 0; i < count; ++i)
  {
    const float ratio = across[i] / (sign * along[i]);
    low = ratio < low ? ratio : low;
    high = ratio > high ? ratio : high;
  }
  return { low, high };
}

AVIANLIDAR_MULTIVERSION bool setView(
  PacketView& view, const PacketDirections& rays, const double* range)
{
  const int count = rays.padded();
  alignas(64) float d[3][PacketWidth];
#pragma omp simd
  for (int i = 0; i < count; ++i)
  {
    d[0][i] = static_cast<float>(rays.x[i]);
    d[1][i] = static_cast<float>(rays.y[i]);
    d[2][i] = static_cast<float>(rays.z[i]);
    view.far[i] = static_cast<float>(range[i]) * (1.0f + 4.0f * static_cast<float>(RoundOffSingle));
  }
  for (int axis = 0; axis < 3; ++axis)
  {
#pragma omp simd
    for (int i = 0; i < count; ++i)
    {
      constexpr float Smallest = 1e-20f;
      const float v = d[axis][i];
      view.inverse[axis][i] = 1.0f / (std::fabs(v) < Smallest ? std::copysign(Smallest, v) : v);
    }
  }
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
  float shallowest = 1.0f;
  float deepest = 0.0f;
#pragma omp simd reduction(min : shallowest) reduction(max : deepest)
  for (int lane = 0; lane < count; ++lane)
  {
    const float depth = view.sign * d[k][lane];
    shallowest = depth < shallowest ? depth : shallowest;
    deepest = depth > deepest ? depth : deepest;
  }
  if (!(shallowest >= 0.25f))
  {
    return false;
  }
  const Interval u = slopes(d[i], d[k], view.sign, count);
  const Interval v = slopes(d[j], d[k], view.sign, count);
  view.lowU = u.low;
  view.highU = u.high;
  view.lowV = v.low;
  view.highV = v.high;
  view.shortening = (1.0f - WideRounding) / deepest;
  return u.high - u.low <= 1.0f && v.high - v.low <= 1.0f;
}

/// Eight boxes relative to the apex, widened.
struct alignas(64) NearBoxes
{
  float center[3][Boxes];
  float half[3][Boxes];
};

AVIANLIDAR_ALWAYS_INLINE void moveToApex(
  const PacketView& view, const WideNode& node, NearBoxes& boxes)
{
  const float apexX = view.apex[0];
  const float apexY = view.apex[1];
  const float apexZ = view.apex[2];
  const float widening = view.widening;
  const float relative = WideRounding + view.spread;
#pragma omp simd
  for (int i = 0; i < Boxes; ++i)
  {
    const float x = node.x[i] - apexX;
    const float y = node.y[i] - apexY;
    const float z = node.z[i] - apexZ;
    // Summed in pairs: what follows waits for it.
    const float size = ((std::fabs(x) + std::fabs(y)) + (std::fabs(z) + node.halfX[i])) +
      (node.halfY[i] + node.halfZ[i]);
    const float margin = widening + relative * size;
    boxes.center[0][i] = x;
    boxes.center[1][i] = y;
    boxes.center[2][i] = z;
    boxes.half[0][i] = node.halfX[i] + margin;
    boxes.half[1][i] = node.halfY[i] + margin;
    boxes.half[2][i] = node.halfZ[i] + margin;
  }
}

/// Boxes that the four planes let through, one bit each, and lower bounds of their ranges.
AVIANLIDAR_ALWAYS_INLINE std::uint32_t meetFrustum(
  const PacketView& view, const WideNode& node, const NearBoxes& boxes, float* nearest)
{
  const float* const kc = boxes.center[view.axes[0]];
  const float* const kh = boxes.half[view.axes[0]];
  const float* const ic = boxes.center[view.axes[1]];
  const float* const ih = boxes.half[view.axes[1]];
  const float* const jc = boxes.center[view.axes[2]];
  const float* const jh = boxes.half[view.axes[2]];
  const float sign = view.sign;
  const float lowU = view.lowU;
  const float highU = view.highU;
  const float lowV = view.lowV;
  const float highV = view.highV;
  const float shortening = view.shortening;
  std::uint32_t met = 0;
#pragma omp simd reduction(| : met)
  for (int b = 0; b < Boxes; ++b)
  {
    const float far = sign * kc[b] + kh[b];
    const float near = most(sign * kc[b] - kh[b], 0.0f);
    const bool between = (ic[b] - ih[b] <= most(highU * near, highU * far)) &
      (ic[b] + ih[b] >= least(lowU * near, lowU * far)) &
      (jc[b] - jh[b] <= most(highV * near, highV * far)) &
      (jc[b] + jh[b] >= least(lowV * near, lowV * far));
    const bool inFront = (far >= 0.0f) & (node.first[b] != NoChild);
    nearest[b] = near * shortening;
    met |= between & inFront ? 1u << b : 0u;
  }
  return met;
}

/// Slabs: the rays of a group that meet one box before they hit something.
AVIANLIDAR_ALWAYS_INLINE std::uint32_t groupThatMeets(
  const PacketView& view, const NearBoxes& boxes, int box, int begin)
{
  const float cx = boxes.center[0][box];
  const float cy = boxes.center[1][box];
  const float cz = boxes.center[2][box];
  const float hx = boxes.half[0][box];
  const float hy = boxes.half[1][box];
  const float hz = boxes.half[2][box];
  const float* const ix = view.inverse[0] + begin;
  const float* const iy = view.inverse[1] + begin;
  const float* const iz = view.inverse[2] + begin;
  const float* const far = view.far + begin;
  std::uint32_t bits = 0;
#pragma omp simd reduction(| : bits)
  for (int i = 0; i < Group; ++i)
  {
    const float mx = cx * ix[i];
    const float my = cy * iy[i];
    const float mz = cz * iz[i];
    const float wx = hx * std::fabs(ix[i]);
    const float wy = hy * std::fabs(iy[i]);
    const float wz = hz * std::fabs(iz[i]);
    const float from = most(most(mx - wx, my - wy), mz - wz);
    const float to = least(least(mx + wx, my + wy), mz + wz);
    const float entry = most(from, 0.0f);
    const bool meets = (entry <= to) & (entry * (1.0f - WideRounding) <= far[i]);
    bits |= meets ? 1u << i : 0u;
  }
  return bits;
}

AVIANLIDAR_ALWAYS_INLINE RayBits raysThatMeet(
  const PacketView& view, const NearBoxes& boxes, int box, RayBits rays)
{
  RayBits bits = 0;
  for (int begin = 0; begin < PacketWidth; begin += Group)
  {
    if ((rays >> begin & 0xffffu) != 0)
    {
      bits |= static_cast<RayBits>(groupThatMeets(view, boxes, box, begin)) << begin;
    }
  }
  return bits & rays;
}

/// Slabs: the boxes that one ray meets, one bit each, and their lower bounds.
AVIANLIDAR_ALWAYS_INLINE std::uint32_t boxesThatMeet(
  const PacketView& view, const WideNode& node, const NearBoxes& boxes, int ray, float* nearest)
{
  const float ix = view.inverse[0][ray];
  const float iy = view.inverse[1][ray];
  const float iz = view.inverse[2][ray];
  const float far = view.far[ray];
  std::uint32_t met = 0;
#pragma omp simd reduction(| : met)
  for (int b = 0; b < Boxes; ++b)
  {
    const float mx = boxes.center[0][b] * ix;
    const float my = boxes.center[1][b] * iy;
    const float mz = boxes.center[2][b] * iz;
    const float wx = boxes.half[0][b] * std::fabs(ix);
    const float wy = boxes.half[1][b] * std::fabs(iy);
    const float wz = boxes.half[2][b] * std::fabs(iz);
    const float from = most(most(mx - wx, my - wy), mz - wz);
    const float to = least(least(mx + wx, my + wy), mz + wz);
    const float start = most(from, 0.0f);
    const float entry = start * (1.0f - WideRounding);
    const bool meets = (start <= to) & (entry <= far) & (node.first[b] != NoChild);
    nearest[b] = meets & (entry < nearest[b]) ? entry : nearest[b];
    met |= meets ? 1u << b : 0u;
  }
  return met;
}

/// Few rays, each against all boxes.
AVIANLIDAR_ALWAYS_INLINE int meetOneByOne(const PacketView& view, const WideNode& node,
  const NearBoxes& boxes, RayBits rays, PacketChild* children)
{
  alignas(64) float nearest[Boxes];
  RayBits bits[Boxes];
  for (int b = 0; b < Boxes; ++b)
  {
    nearest[b] = Infinity;
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

AVIANLIDAR_MULTIVERSION int meetAll(
  const PacketView& view, const WideNode& node, RayBits rays, PacketChild* children)
{
  NearBoxes boxes;
  moveToApex(view, node, boxes);
  constexpr int Few = 6;
  if (__builtin_popcountll(rays) <= Few)
  {
    return meetOneByOne(view, node, boxes, rays, children);
  }
  alignas(64) float nearest[Boxes];
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

bool PacketView::setRays(const PacketDirections& rays, const double* range)
{
  return setView(*this, rays, range);
}

int meetChildren(const PacketView& view, const WideNode& node, RayBits rays, PacketChild* children)
{
  return meetAll(view, node, rays, children);
}
}
