// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SmallTargets.h
 * @brief Rays of their own for objects that are small against the spacing of a beam's rays.
 *
 * An object of 0.15 m2 at 1 km takes 0.15 % of a beam of 5.6 mrad: 86 % of such beams miss it with
 * all of 100 random rays, and the others see it more than six times too bright. Here such an object
 * has n rays of its own (eight, without a target error) in the narrowest cone about its bounding
 * sphere, the sampling cone: two in each of n/2 cells of equal solid angle, which weigh
 * Omega_g/(n Omega) of the pulse each (times the profile's density there, if it is Gaussian).
 *
 * Whose a direction is, is told by what its ray hits first. A target's own ray counts where it hits
 * that very object; the beam's N rays count where they hit no target. So the integral over the beam
 * is parted into those over what is seen of each target, and of all else: each estimate is
 * unbiased, whatever stands before or behind the target, however sampling cones overlap or reach
 * out of the beam; what hides a target, and what it does not hide, is not disturbed by it, and a
 * beam no ray of which meets its targets is what it would be without them.
 *
 * Objects are told by their ids (ObjectSpheres.h): where a scene has none there are no small
 * objects.
 */
#ifndef avianlidar_SmallTargets_h
#define avianlidar_SmallTargets_h

#include "BeamRays.h"
#include "BeamSamplers.h"
#include "BeamSamples.h"
#include "ObjectSpheres.h"
#include "ScanSetup.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// The cone about a small object, as a beam sees it.
struct SamplingCone
{
  Vec3 axis;         ///< unit
  double halfAngle;  ///< rad
  double solidAngle; ///< over the beam's
  int object;        ///< id
};

/// Rays of each small target of a beam.
using TargetRays = std::vector<std::uint32_t>;

/// The small targets of a beam, the smallest first, and rays of theirs.
struct BeamTargets
{
  std::vector<SamplingCone> guards; ///< if they were looked for
  std::uint32_t leftOut = 0;        ///< small objects beyond the MaximumTargets largest
  bool found = false;               ///< they were looked for
  TargetRays wanted;                ///< rays of each
  BeamRays rays;                    ///< drawn last, in the beam's plane
  std::vector<double> shares;       ///< of the pulse energy, theirs; empty: none drawn

  /// Begin a beam.
  void clear();
};

/// Reusable; one per thread. What the constructor is given must outlive it.
class SmallTargets
{
public:
  /// @param setup whose objects are not null in find()
  SmallTargets(const ScanSetup& setup, BeamSamplers& samplers);

  /// Guard cones of objects whose share of the beam's solid angle is below endOfSmallTargets() and
  /// at least the needs' smallestTarget. The list for a larger smallestTarget is the end of that
  /// for a smaller one, so that for one scene, beam and number of rays its length tells which it
  /// is.
  void find(const BeamFrame& beam, BeamTargets& targets);

  /// Draw `rays` of each target: the beam's, or the pilot's, in a stream of their own. Those
  /// outside the beam lie on its axis, with a share of 0.
  void draw(std::uint64_t beamId, const BeamFrame& beam, RandomPurpose purpose,
    const TargetRays& rays, BeamTargets& targets);

  /// Forget hits of targets' rays that do not count. @param triangles that they hit, in their order
  /// @return true if any is left
  bool keepOwn(const BeamTargets& targets, const TargetRays& rays, std::uint32_t* triangles) const;

  /// Give samples their weights, and their numbers of rays. @param samples of N rays and those of
  /// targets that count @param rays N
  void weigh(const BeamTargets& targets, std::uint32_t rays, BeamSamples& samples) const;

private:
  const ScanSetup& Setup;
  BeamSamplers& Samplers;
  ShareWindow Window;
  BeamRays Own; ///< of a sampling cone, in its plane
  std::vector<ObjectSpheres::Seen> Seen;
};

/// Share of a beam's solid angle from which on an object is left to the beam's rays: as many of
/// them meet its sampling cone as it would have of its own (half as many again of independent ones,
/// which tell as much as pairs in cells do), or it fills half of the beam.
double endOfSmallTargets(const EchoSettings& settings);

/// Of all targets.
std::uint32_t sumOf(const TargetRays& rays);
}

#endif
