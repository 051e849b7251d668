// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file StandardError.h
 * @brief Standard error of the energy in one range unit, due to the random choice of rays.
 *
 * The error follows from one value x_n for each of the N rays of the beam. Here x_n is the energy
 * that depends on ray n: the energy that ray n puts into the unit, plus the energy that other rays
 * put into the unit by way of the point that ray n hits. A path with two reflections therefore
 * counts in two x_n. This double count gives the first-order term of a sum over pairs. Rays that
 * put no energy into the unit count as 0.
 *
 * - Monte Carlo: sqrt(N) s, with s^2 the sample variance of the N values and four pseudo-rays. Two
 *   pseudo-rays have the least energy that a ray can put into the unit, and two pseudo-rays have
 *   the largest such energy.
 * - Stratified: sqrt(sum over cells (x_1 - x_2)^2 + (most - least)^2). A cell of three rays adds
 *   3/2 of the sum of the squared deviations from the cell's mean. The term (most - least)^2
 *   accounts for cells with a surface that both rays of the cell miss.
 *
 * With 8 to 15 rays both errors are multiplied by t / 1.96, with t Student's t of N - 1 degrees of
 * freedom. If one plane fills the beam, 8 to 15 rays give little information about missed surfaces.
 *
 * Source: Hoeffding, Ann. Math. Stat. 19(3), 1948; Agresti and Coull, Am. Stat. 52(2), 1998;
 * Student, Biometrika 6(1), 1908.
 * Differs: the pseudo-rays of Agresti and Coull also change the estimate. Here the estimate has to
 * be unbiased, so the divisor is N, not N + 4.
 * Valid: at least 8 rays. With fewer rays the error is NaN. Only the sampling error is estimated.
 * Errors of geometry, reflectance and selection (a perceived echo near Qlow is too strong) are not
 * included, nor is the energy of specular lobes that no ray met. The caller gives bounds of the
 * energy that all rays may miss (UnseenEnergy). Without pseudo-rays, intervals of +-1.96 standard
 * errors of Monte Carlo hold the energy in 89 % of cases at an edge in a random place, and in 39 %
 * of cases where a surface covers a share of 0.995. With pseudo-rays, intervals hold the energy in
 * 95 % of cases. If one plane fills the beam, intervals without the factor t / 1.96 hold the energy
 * in 61 % (N = 2) to 93 % (N = 7) of cases. Intervals with this factor are up to fourteen times as
 * wide as the error.
 * Test: TestStandardError.cxx.
 */
#ifndef avianlidar_StandardError_h
#define avianlidar_StandardError_h

#include "BeamRays.h"

#include <cstddef>
#include <vector>

namespace avianlidar
{
/// Bounds of the energy that a ray can put into a range unit, J. The bounds account for surfaces
/// that all rays may have missed.
struct UnseenEnergy
{
  double least = 0.0; ///< lower bound, J; 0 unless one plane fills the beam
  double most = 0.0;  ///< upper bound, J
};

/// Estimates the error of one range unit after the other, without allocation for each unit. Each
/// thread needs its own object. The cost of a unit grows with the number of rays that put energy
/// into the unit, not with N.
class StandardErrorEstimator
{
public:
  /// @param strata strata of numberOfRays rays; must outlive the object; may be null for MonteCarlo
  StandardErrorEstimator(
    Sampling sampling, std::size_t numberOfRays, const StrataPartition* strata);

  /// Begins a range unit.
  void begin();

  /// Adds the energy (J) of a path of ray `ray` < N. The energies of several paths of a ray add up.
  void add(std::size_t ray, double energy);

  /// Least and most energy that one ray put into the unit, J.
  double smallest() const;
  double largest() const;

  /// Standard error of the sum, J.
  double estimate(const UnseenEnergy& unseen);

private:
  double monteCarlo(const UnseenEnergy& unseen) const;
  double stratified(const UnseenEnergy& unseen);

  Sampling Method;
  const StrataPartition* Strata;
  std::vector<double> Energies;     ///< energy that each ray put into the unit, J
  std::vector<std::size_t> Touched; ///< rays that put energy into the unit
};

}

#endif
