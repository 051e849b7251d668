// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SmallTargets.h
 * @brief Gives rays of their own to objects that are small against the spacing of a beam's rays.
 *
 * An object of 0.15 m2 at 1 km takes 0.15 % of a beam of 5.6 mrad: 86 % of such beams miss it with
 * all of 100 random rays, and the others receive more than six times its energy. Here such an
 * object has n rays of its own (eight, without a target error) in the sampling cone, the narrowest
 * cone about its bounding sphere: two in each of n/2 cells of equal solid angle, each with a weight
 * of Omega_g/(n Omega) of the pulse (times the density of a Gaussian profile there).
 *
 * A ray counts for the object it hits first. A target's own ray counts where it hits that object;
 * the beam's N rays count where they hit no target. So the integral over the beam is divided into
 * those over the visible part of each target and over all else. Each estimate is unbiased, whatever
 * stands before or behind the target, and however sampling cones overlap or reach out of the beam.
 * A beam none of whose rays meets its targets is what it would be without them.
 *
 * Source: none.
 * Valid: objects are distinguished by their ids (ObjectSpheres.h); a scene without ids has none. At
 * most MaximumTargets objects of a beam, those of the largest solid angles.
 * Test: TestSmallTargets.cxx, TestTargetsAndOthers.cxx.
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
/// The sampling cone of a small object, relative to a beam.
struct SamplingCone
{
  Vec3 axis;         ///< unit
  double halfAngle;  ///< rad
  double solidAngle; ///< share of the beam's solid angle
  int object;        ///< id
};

/// Number of rays of each small target of a beam.
using TargetRays = std::vector<std::uint32_t>;

/// The small targets of a beam, the smallest first, and their rays.
struct BeamTargets
{
  std::vector<SamplingCone> cones; ///< empty before find()
  std::uint32_t leftOut = 0;       ///< small objects beyond the MaximumTargets largest
  bool found = false;              ///< find() was called
  TargetRays wanted;               ///< number of rays of each
  BeamRays rays;                   ///< drawn last, in the beam's plane
  std::vector<double> shares;      ///< their shares of the pulse energy; empty: none drawn

  /// Begin a beam.
  void clear();
};

/// Finds small targets, draws their rays and weighs the samples. One per thread; the constructor's
/// arguments must outlive it.
class SmallTargets
{
public:
  /// @param setup with objects, if find() is called
  SmallTargets(const ScanSetup& setup, BeamSamplers& samplers);

  /// Find the sampling cones of objects whose share of the beam's solid angle is below
  /// endOfSmallTargets() and at least ModelNeeds::smallestTarget. The list for a larger
  /// smallestTarget is the end of that for a smaller one, so its length identifies it for one
  /// scene, beam and number of rays.
  void find(const BeamFrame& beam, BeamTargets& targets);

  /// Draw `rays` of each target, of the beam or of its pilot, from a random stream of their own.
  /// Rays outside the beam are put on its axis with a share of 0.
  void draw(std::uint64_t beamId, const BeamFrame& beam, RandomPurpose purpose,
    const TargetRays& rays, BeamTargets& targets);

  /// Remove hits of targets' rays that do not count. @param triangles that they hit, in their order
  /// @return true if any is left
  bool keepOwn(const BeamTargets& targets, const TargetRays& rays, std::uint32_t* triangles) const;

  /// Set weights and numbers of rays of samples. @param samples of N rays and of the targets' rays
  /// that count @param rays N
  void weigh(const BeamTargets& targets, std::uint32_t rays, BeamSamples& samples) const;

private:
  const ScanSetup& Setup;
  BeamSamplers& Samplers;
  ShareWindow Window;
  BeamRays Own; ///< rays of a sampling cone, in its own plane
  std::vector<ObjectSpheres::Seen> Seen;
};

/// Share of a beam's solid angle from which on an object is left to the beam's rays: as many of
/// them meet its sampling cone as it would have of its own (with Monte Carlo half as many again,
/// which give the error of pairs in cells), or it fills half of the beam.
double endOfSmallTargets(const EchoSettings& settings);

/// Sum over all targets.
std::uint32_t sumOf(const TargetRays& rays);
}

#endif
