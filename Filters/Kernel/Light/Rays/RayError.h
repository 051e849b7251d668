// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayError.h
 * @brief Standard error of what the rays of a beam put into a range unit: of its N rays
 * (StandardError.h), and of those of each small target, two to a cell.
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

/// Reusable; one per thread. The samplers must outlive it.
class RayError
{
public:
  explicit RayError(BeamSamplers& samplers)
    : Samplers(samplers)
  {
  }

  /// Take what samples, and paths on from them, put into a range unit. @param targets rays of each
  /// small target
  void gather(const BeamSamples& samples, const std::vector<SecondaryPath>& paths,
    const RangeShares& shares, const TargetRays& targets);

  /// J, of the N rays. @param filled every ray put energy here, and one plane fills the beam: no
  /// ray puts less than these @param glint J, see UnseenEnergy
  double ofRays(bool filled, double glint) const;

  /// J, of the rays of each target.
  const std::vector<double>& ofTargets() const { return this->Targets; }

  /// J, of all together.
  double total(bool filled, double glint) const;

private:
  BeamSamplers& Samplers;
  StandardErrorEstimator* Rays = nullptr;
  std::vector<double> Energies; ///< J, by ray of targets
  std::vector<double> Targets;
};
}

#endif
