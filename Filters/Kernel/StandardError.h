// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file StandardError.h
 * @brief Standard error of the energy in one range unit, over the random choice of the beam's rays.
 *
 * The estimate is the sum of x_n over all N rays of the beam, x_n the energy that ray n (with all
 * its paths) put into the unit: rays that put nothing count as 0.
 *
 * - Monte Carlo: N s/sqrt(N + 4), s^2 the sample variance of the N values, two pseudo-rays of 0 and
 * two of the largest possible value (after Agresti and Coull, Am. Stat. 52(2), 1998). Without them
 * +-1.96 standard errors cover 89 % at an edge of random place and 39 % at a covered share of
 * 0.995; with them 95 %.
 * - Stratified: sqrt(sum over cells (x_1 - x_2)^2 + x_max^2); three rays in a cell: 3/2 of their
 * squared deviations. The last term stands for cells that an edge crosses and both rays missed.
 *
 * Both additions are left out where the caller knows that one plane fills the window: there is no
 * edge to miss. N = 1: NaN. It is an error of sampling alone: geometry, reflectance and selection
 * (a perceived echo near Qlow reads high) are not in it. Secondary connections share rays and make
 * it approximate.
 */
#ifndef avianlidar_StandardError_h
#define avianlidar_StandardError_h

#include "BeamRays.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Reusable without allocation; one per thread. A unit costs as much as the rays that put energy
/// into it, not N, unless many do: then all are taken in loops over lanes.
class StandardErrorEstimator
{
public:
  /// @param strata needed for Sampling::Stratified only, and must outlive this; its number of rays
  /// is used then
  StandardErrorEstimator(
    Sampling sampling, std::size_t numberOfRays, const StrataPartition* strata);

  /// Begin a range unit.
  void clear();

  /// Add energy (J) of a path of ray `ray` < N; several paths of a ray add up.
  void add(std::size_t ray, double energy);

  /// Begin a range unit with one path of each of `count` rays; no ray may come twice. Energies of 0
  /// are allowed.
  void begin(const std::uint32_t* rays, const double* energies, std::size_t count);

  /// The most that one ray put into the unit, J: what another ray of the beam might as well have
  /// put there.
  double largest() const;

  /// Standard error of the sum, J. @param largest the most that one ray can put into the unit, J
  /// @param onePlane one plane fills the unit's window: no edge can have been missed
  double estimate(double largest, bool onePlane);

private:
  template <class F>
  void forEachRay(F take) const;
  double monteCarlo(double largest, bool onePlane) const;
  double stratified(double largest, bool onePlane);

  Sampling Method;
  const StrataPartition* Strata;
  std::vector<double> Energies;     ///< of every ray
  std::vector<std::size_t> Touched; ///< rays with energy, if they are listed
  bool All = false;                 ///< they are not: any ray may have some
};
}

#endif
