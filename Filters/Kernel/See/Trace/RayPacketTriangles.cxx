// SPDX-License-Identifier: BSD-3-Clause
#include "RayPacketTriangles.h"

#include <limits>

// This file is compiled once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "RayPacketTriangles.cxx"
#include <hwy/foreach_target.h>

#include "RayLanes.h"

HWY_BEFORE_NAMESPACE();
namespace avianlidar::HWY_NAMESPACE
{
namespace
{
/// One triangle in all lanes.
struct TriangleLanes
{
  Rays edge[3][3], w[3], error, inside;

  HWY_INLINE explicit TriangleLanes(const ApexTriangle& t)
    : error(everywhere(t.error))
    , inside(everywhere(t.inside))
  {
    for (int k = 0; k < 3; ++k)
    {
      this->w[k] = everywhere(t.w[k]);
      for (int e = 0; e < 3; ++e)
      {
        this->edge[e][k] = everywhere(t.edge[e][k]);
      }
    }
  }
};

HWY_INLINE Rays dot(const Rays* a, Rays x, Rays y, Rays z)
{
  return hn::MulAdd(a[0], x, hn::MulAdd(a[1], y, hn::Mul(a[2], z)));
}

/// Results of the rays at one triangle, one bit each.
struct Outcome
{
  RayBits nearest = 0, level = 0, unsure = 0;
};

/// Test a group of sixteen rays against one triangle.
HWY_INLINE void testRays(const PacketView& view, const TriangleLanes& t, std::uint32_t id,
  int group, PacketBest& best, Outcome& outcome)
{
  const RayTag lanes;
  const hn::RebindToUnsigned<RayTag> numbers;
  const Rays minusOne = everywhere(-1.0f);
  for (int i = group; i < group + PacketGroup; i += RayLanes)
  {
    const Rays x = hn::Load(lanes, view.direction[0] + i);
    const Rays y = hn::Load(lanes, view.direction[1] + i);
    const Rays z = hn::Load(lanes, view.direction[2] + i);
    const Rays edge =
      hn::Min(hn::Min(dot(t.edge[0], x, y, z), dot(t.edge[1], x, y, z)), dot(t.edge[2], x, y, z));
    const auto near = hn::Ge(edge, minusOne);
    if (hn::AllFalse(lanes, near))
    {
      continue;
    }
    const Rays w = dot(t.w, x, y, z);
    const Rays low = hn::Sub(w, t.error);
    const Rays high = hn::Add(w, t.error);
    const Rays bestLow = hn::Load(lanes, best.low + i);
    const Rays bestHigh = hn::Load(lanes, best.high + i);
    const auto inside = hn::Ge(edge, t.inside);
    const auto sure = hn::And(inside, hn::Gt(low, bestHigh));
    outcome.level |= bitsOf(lanes, hn::And(hn::AndNot(sure, inside), hn::Ge(high, bestLow))) << i;
    // A ray that is accepted just beside the triangle has the range of a corner, not the range of
    // the plane.
    outcome.unsure |= bitsOf(lanes, hn::AndNot(inside, near)) << i;
    const RayBits changed = bitsOf(lanes, sure);
    if (changed != 0)
    {
      outcome.nearest |= changed << i;
      hn::BlendedStore(low, sure, lanes, best.low + i);
      hn::BlendedStore(high, sure, lanes, best.high + i);
      hn::BlendedStore(
        hn::Set(numbers, id), hn::RebindMask(numbers, sure), numbers, best.triangle + i);
    }
  }
}

RayBits testAll(
  const PacketView& view, int count, PacketTriangles& triangles, PacketBest& best, bool& undecided)
{
  RayBits changed = 0;
  RayBits left = 0;
  for (int k = 0; k < count; ++k)
  {
    const ApexTriangle& triangle = *triangles.seen[k];
    const TriangleLanes lanes(triangle);
    const RayBits rays = triangles.rays[k];
    Outcome outcome;
    for (int group = 0; group < PacketWidth; group += PacketGroup)
    {
      if ((rays >> group & 0xffffu) != 0)
      {
        testRays(view, lanes, triangle.number, group, best, outcome);
      }
    }
    changed |= outcome.nearest;
    triangles.level[k] = outcome.level & rays;
    triangles.unsure[k] = outcome.unsure & rays;
    left |= triangles.level[k] | triangles.unsure[k];
  }
  undecided = left != 0;
  return changed;
}

void shortenAll(const PacketBest& best, RayBits changed, PacketView& view)
{
  const RayTag lanes;
  const Rays nothing = everywhere(std::numeric_limits<float>::infinity());
  for (int group = 0; group < PacketWidth; group += PacketGroup)
  {
    if ((changed >> group & 0xffffu) == 0)
    {
      continue;
    }
    Rays farthest = hn::Zero(lanes);
    for (int i = group; i < group + PacketGroup; i += RayLanes)
    {
      const Rays low = hn::Load(lanes, best.low + i);
      const Rays far = hn::IfThenElse(
        hn::Gt(low, hn::Zero(lanes)), hn::Div(everywhere(1.0f + 1e-6f), low), nothing);
      hn::Store(far, lanes, view.far + i);
      farthest = hn::Max(farthest, far);
    }
    view.farthest[group / PacketGroup] = hn::GetLane(hn::MaxOfLanes(lanes, farthest));
  }
}
}
}
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace avianlidar
{
HWY_EXPORT(testAll);
HWY_EXPORT(shortenAll);

RayBits testTriangles(
  const PacketView& view, int count, PacketTriangles& triangles, PacketBest& best, bool& undecided)
{
  return HWY_DYNAMIC_DISPATCH(testAll)(view, count, triangles, best, undecided);
}

void shortenRays(const PacketBest& best, RayBits changed, PacketView& view)
{
  HWY_DYNAMIC_DISPATCH(shortenAll)(best, changed, view);
}
}
#endif
