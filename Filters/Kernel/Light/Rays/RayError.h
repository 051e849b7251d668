// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayError.h
 * @brief Standard error of the energy that the rays of a beam put into a range unit: of its N rays,
 * and of those of each small target, two to a cell.
 *
 * Source: none; the estimators are those of StandardError.h.
 * Valid: as StandardError.h; the parts are independent, and their variances add.
 * Test: TestScanReport.cxx, TestTargetsAndOthers.cxx, TestRayBudget.cxx.
 */
#ifndef avianlidar_RayError_h
#define avianlidar_RayError_h

#include "BeamSamplers.h"
#include "BeamSamples.h"
#include "RangeUnits.h"
#include "SmallTargets.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
struct SecondaryPath;

/// Standard errors of one range unit after the other. One per thread; the samplers must outlive it.
class RayError
{
public:
  static constexpr std::size_t NoNodes = static_cast<std::size_t>(-1);

  explicit RayError(BeamSamplers& samplers)
    : Samplers(samplers)
  {
  }

  /// Take what the samples, and paths that start from them, put into a range unit. @param targets
  /// rays of each small target @param nodes number of contributions before those of the paths that
  /// are no samples but nodes, whose error is not estimated here; NoNodes: they are the samples
  void gather(const BeamSamples& samples, const std::vector<SecondaryPath>& paths,
    const RangeShares& shares, const TargetRays& targets, std::size_t nodes = NoNodes);

  /// Standard error of the N rays, J. @param filled every ray put energy here, and one plane fills
  /// the beam, so that no ray puts less @param glint J, see UnseenEnergy
  double ofRays(bool filled, double glint) const;

  /// Standard error of the rays of each target, J.
  const std::vector<double>& ofTargets() const { return this->Targets; }

  /// Standard error of all together, J.
  double total(bool filled, double glint) const;

private:
  BeamSamplers& Samplers;
  StandardErrorEstimator* Rays = nullptr;
  std::vector<double> Energies; ///< energies of the targets' rays, J
  std::vector<double> Targets;
};
}

#endif
