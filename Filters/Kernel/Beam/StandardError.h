// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file StandardError.h
 * @brief Standard error of the energy in one range unit, over the random choice of the beam's rays.
 *
 * The estimate is the sum of x_n over all N rays of the beam. x_n is the energy that depends on ray
 * n: the energy that it put into the unit itself, and the energy that other rays put there over the
 * point that it hit. A path over two reflections therefore counts in two x_n, which is the
 * first-order term of a sum over pairs. Rays that put no energy into the unit count as 0.
 *
 * - Monte Carlo: sqrt(N) s, s^2 the sample variance of the N values and four pseudo-rays: two of
 *   the least and two of the most energy that a ray can put there.
 * - Stratified: sqrt(sum over cells (x_1 - x_2)^2 + (most - least)^2); a cell of three rays adds
 *   3/2 of their squared deviations. (most - least)^2 stands for cells that an edge crosses and
 *   both rays missed.
 *
 * From 8 to 15 rays both are widened by Student's t of N - 1 degrees of freedom over 1.96: where
 * one plane fills the window, so few rays say little of what they did not see.
 *
 * Source: Hoeffding, Ann. Math. Stat. 19(3), 1948; Agresti and Coull, Am. Stat. 52(2), 1998;
 * Student, Biometrika 6(1), 1908.
 * Differs: the pseudo-rays of Agresti and Coull also move the estimate, which has to stay unbiased
 * here; the divisor is therefore N, not N + 4.
 * Valid: from 8 rays on; NaN below. Only the sampling error is estimated, without errors of
 * geometry, reflectance and selection (a perceived echo near Qlow reads high), and without specular
 * lobes that no ray met. The caller states what may have been missed (UnseenEnergy). Without
 * pseudo-rays +-1.96 standard errors of Monte Carlo cover 89 % at an edge of random place and 39 %
 * at a covered share of 0.995; with them 95 %. Where one plane fills the window, +-1.96 standard
 * errors cover 61 % at N = 2 to 93 % at N = 7 if they are not widened; widened, they are up to
 * fourteen times as wide as the error.
 * Test: TestStandardError.cxx.
 */
#ifndef avianlidar_StandardError_h
#define avianlidar_StandardError_h

#include "BeamRays.h"

#include <cstddef>
#include <vector>

namespace avianlidar
{
/// Bounds of the energy that a ray can put into a range unit, J, for what all rays may have missed.
struct UnseenEnergy
{
  double least = 0.0; ///< 0 unless one plane fills the window
  double most = 0.0;
};

/// Reusable without allocation; one per thread. The cost of a unit grows with the number of rays
/// that put energy into it, not with N.
class StandardErrorEstimator
{
public:
  /// @param strata of numberOfRays rays, must outlive this; may be null for MonteCarlo
  StandardErrorEstimator(
    Sampling sampling, std::size_t numberOfRays, const StrataPartition* strata);

  /// Begins a range unit.
  void begin();

  /// Adds the energy (J) of a path of ray `ray` < N; several paths of a ray add up.
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
  std::vector<double> Energies;     ///< by ray, J
  std::vector<std::size_t> Touched; ///< rays with energy
};

}

#endif
