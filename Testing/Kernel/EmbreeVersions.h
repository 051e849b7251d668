// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EmbreeVersions.h
 * @brief Embree 3 or 4, whichever is there: what changed its name between them, under one.
 */
#ifndef avianlidar_EmbreeVersions_h
#define avianlidar_EmbreeVersions_h

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>

/// How rays are traced.
struct EmbreeQuery : RTCIntersectArguments
{
  /// @param coherent rays of a packet go nearly the same way
  explicit EmbreeQuery(bool coherent = false)
  {
    rtcInitIntersectArguments(this);
    this->flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  }
  void trace(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray, this); }
  void trace(RTCScene scene, const int* valid, RTCRayHit16& rays)
  {
    rtcIntersect16(valid, scene, &rays, this);
  }
};
#else
#include <embree3/rtcore.h>

/// How rays are traced.
struct EmbreeQuery : RTCIntersectContext
{
  /// @param coherent rays of a packet go nearly the same way
  explicit EmbreeQuery(bool coherent = false)
  {
    rtcInitIntersectContext(this);
    this->flags =
      coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
  void trace(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, this, &ray); }
  void trace(RTCScene scene, const int* valid, RTCRayHit16& rays)
  {
    rtcIntersect16(valid, scene, this, &rays);
  }
};
#endif

#endif
