// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CoverageShares.h
 * @brief Covered share of places: weighted means over places and their standard errors.
 *
 * Source: heights of bird strikes: R. A. Dolbeer, J. Wildl. Manage. 70 (2006).
 * Differs: heights of strikes at or below 500 feet are uniformly distributed.
 * Valid: standard errors hold for places drawn at random. On a lattice, standard errors are about
 * right if places are far apart. Standard errors are too small where neighbouring places have
 * similar values.
 * Test: TestCoverageShares.cxx.
 */
#ifndef avianlidar_CoverageShares_h
#define avianlidar_CoverageShares_h

#include "Coverage.h"

#include <array>

namespace avianlidar
{
/// A weighted mean of values and its standard error.
struct WeightedMean
{
  std::array<double, 3> weight{}; ///< sums of 1, w, w^2, with w the weight
  std::array<double, 2> value{};  ///< sums of w v, w^2 v, with v the value
  double square = 0.0;            ///< sum of w^2 v^2
  void add(double w, double v);
  void add(const WeightedMean& other);
  double mean() const;     ///< weighted mean; NaN if the sum of weights is 0
  double stdError() const; ///< standard error; NaN for fewer than two values
};

/// Sums over the places of a region and height band.
struct CoverageShares
{
  static constexpr std::size_t Statuses = 8;
  WeightedMean detected;
  WeightedMean tracked;
  std::array<double, Statuses> byStatus{}; ///< sums of weights of the places with each status

  void add(double weight, const CoverageValue& value, double trackProbability);
  void add(const CoverageShares& other);
};

/// Probability density of the height of bird strikes above ground, 1/m; 0 below ground.
/// @param height height above ground, m
double strikeHeightDensity(double height);
}

#endif
