// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SmallTargets.h
 * @brief Rays of their own for objects that are small against the spacing of a beam's rays.
 *
 * An object of 0.15 m2 at 1 km takes 0.15 % of a beam of 5.6 mrad: 86 % of such beams miss it with
 * all of 100 random rays, and the others see it more than six times too bright. Here the narrowest
 * cone about its bounding sphere, the guard cone, is a stratum of its own: eight rays in it, two in
 * each of four cells of equal solid angle, weigh Omega_g/(8 Omega) of the pulse each (times the
 * profile's density there, if it is Gaussian), and the beam's N rays count only outside of it. The
 * sum over both is the same integral over the beam: unbiased, whatever the rays meet, in the guard
 * cone as outside, be it the object, what hides it, or what is behind it.
 *
 * Guard cones may overlap, and reach out of the beam. A direction belongs to the smallest guard
 * cone that holds it; rays of the others there, and those outside the beam, count as 0. (Merging
 * cones would, along a fence, make one that is not small at all.)
 *
 * Objects are told by their ids (ObjectSpheres.h): where a scene has none there are no small
 * objects.
 */
#ifndef avianlidar_SmallTargets_h
#define avianlidar_SmallTargets_h

#include "BeamRays.h"
#include "EchoSettings.h"
#include "ObjectSpheres.h"
#include "PrimaryHits.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// The cone about a small object, as a beam sees it.
struct GuardCone
{
  Vec3 axis;         ///< unit
  double halfAngle;  ///< rad
  double chord2;     ///< of the directions on its rim, squared distance from the axis
  double solidAngle; ///< over the beam's
  bool contains(const Vec3& direction) const
  {
    const Vec3 d = direction - this->axis;
    return glm::dot(d, d) <= this->chord2;
  }
};

/// Reusable; one per thread. What the constructor is given must outlive it.
class SmallTargets
{
public:
  SmallTargets(std::int32_t seed, double halfBeamwidth, BeamProfile profile);

  /// The guard cones of a beam of `rays` rays, the smallest first: objects whose share of the
  /// beam's solid angle is below 1/rays and at least `smallest`. The list for a larger `smallest`
  /// is the end of that for a smaller one, so that for one scene, beam and number of rays its
  /// length tells which it is.
  void find(const ObjectSpheres& objects, const BeamFrame& beam, std::uint32_t rays,
    double smallest, std::vector<GuardCone>& guards);

  /// Draw the rays of the guard cones, which must be of this beamwidth, in the beam's plane. @param
  /// shares of the pulse energy that each carries; 0 of those that do not count, which lie on the
  /// axis
  void draw(std::uint64_t beamId, const BeamFrame& beam, const std::vector<GuardCone>& guards,
    BeamRays& rays, std::vector<double>& shares);

private:
  std::int32_t Seed;
  double HalfBeamwidth;
  ShareWindow Window; ///< of the last search
  BeamProfile Profile;
  StrataPartition Strata;
  BeamRays Own; ///< of a guard cone, in its plane
  std::vector<ObjectSpheres::Seen> Seen;
};

/// Give hits the shares that follow: 0 to those of the N rays that lie in a guard cone.
/// @param hits of N + extra rays, their numbers set @param shares of the extra rays
void shareOut(const std::vector<GuardCone>& guards, const HitGeometry& geometry,
  const std::vector<double>& shares, PrimaryHits& hits);
}

#endif
