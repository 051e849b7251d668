// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayLanes.h
 * @brief Vectors of rays and boxes for the instruction set that the including file is compiled for
 * (Highway, <hwy/highway.h>).
 *
 * Source: none.
 * Valid: only for single-precision tests with bounds of the error. The processor may fuse sums with
 * products, so no decision may depend on the last bit. Instruction sets whose vectors have no fixed
 * length are excluded.
 * Test: TestRayPacket.cxx and TestBeamGroup.cxx, for every instruction set of this processor.
 */
// This file is included once for every instruction set.
#if defined(avianlidar_RayLanes_h) == defined(HWY_TARGET_TOGGLE)
#ifdef avianlidar_RayLanes_h
#undef avianlidar_RayLanes_h
#else
#define avianlidar_RayLanes_h
#endif

#include <hwy/highway.h>

#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace avianlidar::HWY_NAMESPACE
{
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_HAVE_SCALABLE
#error "vectors of unknown length are not supported: see HWY_DISABLED_TARGETS in CMakeLists.txt"
#endif

/// Up to sixteen rays.
using RayTag = hn::CappedTag<float, 16>;
using Rays = hn::Vec<RayTag>;
constexpr int RayLanes = static_cast<int>(hn::MaxLanes(RayTag()));

/// Up to eight boxes.
using BoxTag = hn::CappedTag<float, 8>;
using Boxes = hn::Vec<BoxTag>;
constexpr int BoxLanes = static_cast<int>(hn::MaxLanes(BoxTag()));

HWY_INLINE Rays everywhere(float value)
{
  return hn::Set(RayTag(), value);
}

/// One bit for each lane.
template <class Tag, class Mask>
HWY_INLINE std::uint64_t bitsOf(Tag tag, Mask mask)
{
  alignas(8) std::uint8_t bytes[8];
  hn::StoreMaskBits(tag, mask, bytes);
  if (hn::MaxLanes(tag) > 8)
  {
    std::uint16_t bits;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
  }
  return bytes[0];
}
}
HWY_AFTER_NAMESPACE();
#endif
