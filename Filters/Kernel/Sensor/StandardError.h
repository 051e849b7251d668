// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file StandardError.h
 * @brief Standard error of the energy in one range unit, over the random choice of the beam's rays.
 *
 * The estimate is the sum of x_n over all N rays of the beam, x_n the energy that depends on ray n:
 * what it put into the unit itself, and what others put there over the point that it hit (so paths
 * over two reflections stand in two x_n: the first-order term of a sum over pairs, Hoeffding, Ann.
 * Math. Stat. 19(3), 1948). Rays that put nothing count as 0.
 *
 * - Monte Carlo: sqrt(N) s, s^2 the sample variance of the N values, two pseudo-rays of the least
 * and two of the most that a ray can put (after Agresti and Coull, Am. Stat. 52(2), 1998; theirs
 * also move the estimate, which has to stay without bias here, so it is N and not N + 4 that
 * divides). Without them +-1.96 standard errors cover 89 % at an edge of random place and 39 % at a
 * covered share of 0.995; with them 95 %.
 * - Stratified: sqrt(sum over cells (x_1 - x_2)^2 + (most - least)^2); three rays in a cell: 3/2 of
 * their squared deviations. The last term stands for cells that an edge crosses and both rays
 * missed.
 *
 * From 8 to 15 rays both are widened by Student's t of N - 1 degrees of freedom over 1.96 (Student,
 * Biometrika 6(1), 1908): where one plane fills the window, so few rays say little of what they did
 * not see. Below 8: NaN. Unwidened +-1.96 hold 61 % there at N = 2 to 93 % at 7; widened, they are
 * up to fourteen times as wide as the error.
 *
 * What may have been missed is the caller's to say (UnseenEnergy). It is an error of
 * sampling alone: geometry, reflectance and selection (a perceived echo near Qlow reads high) are
 * not in it.
 */
#ifndef avianlidar_StandardError_h
#define avianlidar_StandardError_h

#include "BeamRays.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// What the rays of a beam may have missed in a range unit, J.
struct UnseenEnergy
{
  double least = 0.0; ///< the least that a ray can put there: 0 unless one plane fills the window
  double most = 0.0;  ///< the most
  double glint = 0.0; ///< root of the variance of a lobe too narrow to be met by some of the rays
};

/// Reusable without allocation; one per thread. A unit costs as much as the rays that put energy
/// into it, not N, unless many do: then all are taken in loops over lanes.
class StandardErrorEstimator
{
public:
  /// @param strata needed for Sampling::Stratified only, and must outlive this; its number of rays
  /// is used then
  StandardErrorEstimator(
    Sampling sampling, std::size_t numberOfRays, const StrataPartition* strata);

  /// Begin a range unit. @param expected about how many rays will have energy: by it rays are
  /// listed, or all looked at
  void begin(std::size_t expected = 0);

  /// Add energy (J) of a path of ray `ray` < N; several paths of a ray add up.
  void add(std::size_t ray, double energy);

  /// The least and the most that one ray put into the unit, J.
  double smallest() const;
  double largest() const;

  /// Standard error of the sum, J.
  double estimate(const UnseenEnergy& unseen);

private:
  template <class F>
  void forEachRay(F take) const;
  double monteCarlo(const UnseenEnergy& unseen) const;
  double stratified(const UnseenEnergy& unseen);

  Sampling Method;
  const StrataPartition* Strata;
  std::vector<double> Energies;     ///< of every ray
  std::vector<std::size_t> Touched; ///< rays with energy, if they are listed
  bool All = false;                 ///< they are not: any ray may have some
};

/// Variance of the sum of energies of `count` rays (an even number, at least 2), two in each cell:
/// sum over cells (x_1 - x_2)^2, and x_max^2, which stands for cells that an edge crosses and both
/// rays missed.
double varianceOfPairs(const double* energies, std::size_t count);
}

#endif
