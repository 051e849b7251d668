// SPDX-License-Identifier: BSD-3-Clause
#include "CellLanes.h"

#include <algorithm>

// This file is compiled once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "CellLanes.cxx"
#include <hwy/foreach_target.h>

#include "RayLanes.h"

HWY_BEFORE_NAMESPACE();
namespace avianlidar::HWY_NAMESPACE
{
namespace
{
/// Bound of the rounding of sides, half-beamwidths.
constexpr float SideMargin = 1e-6f;

/// Factor that is less than 1 by more than rounding.
constexpr float Unhidden = 1.0f - 1e-6f;

/// Value of an affine function, without fused products.
HWY_INLINE Rays affine(const float* f, Rays x, Rays y)
{
  return hn::Add(
    hn::Add(hn::Mul(everywhere(f[0]), x), hn::Mul(everywhere(f[1]), y)), everywhere(f[2]));
}

/// Middles of the children from number `first` on.
struct Middles
{
  Rays x, y;
};
HWY_INLINE Middles middlesOf(const CellChildren& children, int first)
{
  alignas(64) float x[CellLanes];
  alignas(64) float y[CellLanes];
  for (int i = 0; i < RayLanes; ++i)
  {
    x[i] = children.x + children.width * (static_cast<float>((first + i) % 4) + 0.5f);
    y[i] = children.y + children.width * (static_cast<float>((first + i) / 4) + 0.5f);
  }
  return { hn::Load(RayTag(), x), hn::Load(RayTag(), y) };
}

HWY_INLINE float leastOf(const Rays* all, int groups)
{
  Rays least = all[0];
  for (int g = 1; g < groups; ++g)
  {
    least = hn::Min(least, all[g]);
  }
  return hn::GetLane(hn::MinOfLanes(RayTag(), least));
}

void distributeLanes(const CellSurface* surfaces, const std::uint32_t* list, std::uint32_t count,
  CellChildren& children)
{
  constexpr int groups = CellLanes / RayLanes;
  const RayTag lanes;
  Middles middles[groups];
  Rays occluders[groups];
  for (int g = 0; g < groups; ++g)
  {
    middles[g] = middlesOf(children, g * RayLanes);
    occluders[g] = hn::LoadU(lanes, children.occluders + g * RayLanes);
  }
  const float half = 0.5f * children.width;
  const Rays zero = hn::Zero(lanes);
  // Few children keep a surface, as a rule. Four children at once need no branch for each child.
  constexpr int atOnce = 4;
  std::uint32_t nowhere[atOnce];
  std::uint32_t* ends[CellLanes + 1];
  std::copy(children.lists, children.lists + CellLanes, ends);
  for (std::uint32_t k = 0; k < count; ++k)
  {
    const std::uint32_t number = list[k];
    const CellSurface& s = surfaces[number];
    if (k % 8 == 7 && s.most < leastOf(occluders, groups))
    {
      break; // surfaces are sorted by range, so all further surfaces are hidden everywhere
    }
    std::uint32_t bits = 0;
    for (int g = 0; g < groups; ++g)
    {
      const Middles& m = middles[g];
      const Rays middle = affine(s.inverse, m.x, m.y);
      const float reach = half * s.inverseSlope + s.slack;
      const Rays near = hn::Min(hn::Add(middle, everywhere(reach)), everywhere(s.most));
      const Rays far = hn::Sub(middle, everywhere(reach));
      auto kept = hn::And(hn::Gt(near, zero), hn::Ge(near, occluders[g]));
      if (hn::AllFalse(lanes, kept))
      {
        continue;
      }
      auto covered = hn::Gt(far, zero);
      for (int side = 0; side < 4; ++side)
      {
        const Rays value = affine(s.lines[side], m.x, m.y);
        const float edge = half * s.slopes[side] + SideMargin;
        kept = hn::And(kept, hn::Gt(value, everywhere(-edge)));
        covered = hn::And(covered, hn::Ge(value, everywhere(edge)));
      }
      covered = hn::And(covered, kept);
      // Rounding must not hide a surface behind itself.
      const Rays farthest = hn::Mul(everywhere(Unhidden), hn::Min(far, near));
      occluders[g] = hn::IfThenElse(covered, hn::Max(occluders[g], farthest), occluders[g]);
      bits |= static_cast<std::uint32_t>(bitsOf(lanes, kept)) << (g * RayLanes);
    }
    while (bits != 0)
    {
      ends[CellLanes] = nowhere;
      for (int n = 0; n < atOnce; ++n)
      {
        *ends[__builtin_ctz(bits | 1u << CellLanes)]++ = number;
        bits &= bits - 1;
      }
    }
  }
  for (int i = 0; i < CellLanes; ++i)
  {
    children.counts[i] = static_cast<std::uint32_t>(ends[i] - children.lists[i]);
  }
  for (int g = 0; g < groups; ++g)
  {
    hn::StoreU(occluders[g], lanes, children.occluders + g * RayLanes);
  }
}

void seeLanes(
  const CellSurface* surfaces, const std::uint32_t* list, std::uint32_t count, CellRays& rays)
{
  constexpr int groups = CellLanes / RayLanes;
  const RayTag lanes;
  const hn::RebindToSigned<RayTag> numbers;
  using Numbers = hn::Vec<decltype(numbers)>;
  const Rays zero = hn::Zero(lanes);
  Rays x[groups], y[groups], nearest[groups];
  Numbers seen[groups];
  for (int g = 0; g < groups; ++g)
  {
    x[g] = hn::LoadU(lanes, rays.x + g * RayLanes);
    y[g] = hn::LoadU(lanes, rays.y + g * RayLanes);
    nearest[g] = zero;
    seen[g] = hn::Set(numbers, -1);
  }
  for (std::uint32_t k = 0; k < count; ++k)
  {
    const CellSurface& s = surfaces[list[k]];
    if (k % 4 == 3 && s.most < leastOf(nearest, groups))
    {
      break; // surfaces are sorted by range, so no ray sees a further surface
    }
    for (int g = 0; g < groups; ++g)
    {
      const Rays inverse = affine(s.inverse, x[g], y[g]);
      auto inside = hn::Gt(inverse, nearest[g]);
      for (int side = 0; side < 4; ++side)
      {
        inside = hn::And(inside, hn::Ge(affine(s.lines[side], x[g], y[g]), zero));
      }
      nearest[g] = hn::IfThenElse(inside, inverse, nearest[g]);
      seen[g] = hn::IfThenElse(hn::RebindMask(numbers, inside),
        hn::Set(numbers, static_cast<std::int32_t>(list[k])), seen[g]);
    }
  }
  for (int g = 0; g < groups; ++g)
  {
    hn::StoreU(seen[g], numbers, rays.seen + g * RayLanes);
  }
}
}
}
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace avianlidar
{
HWY_EXPORT(distributeLanes);
HWY_EXPORT(seeLanes);

void distribute(const CellSurface* surfaces, const std::uint32_t* list, std::uint32_t count,
  CellChildren& children)
{
  HWY_DYNAMIC_DISPATCH(distributeLanes)(surfaces, list, count, children);
}

void see(
  const CellSurface* surfaces, const std::uint32_t* list, std::uint32_t count, CellRays& rays)
{
  HWY_DYNAMIC_DISPATCH(seeLanes)(surfaces, list, count, rays);
}
}
#endif
