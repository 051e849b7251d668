// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CoverageShares.h
 * @brief What share of places is covered: sums over places, means with their standard errors.
 *
 * Source: heights of bird strikes: R. A. Dolbeer, J. Wildl. Manage. 70 (2006).
 * Differs: strikes at or below 500 feet are taken as even over these heights.
 * Valid: standard errors are those of places drawn at random; places far apart on a lattice have
 * about the same, neighbours that are alike count as several.
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
  std::array<double, 3> weight{}; ///< sums of 1, w, w^2
  std::array<double, 2> value{};  ///< of w v, w^2 v
  double square = 0.0;            ///< of w^2 v^2
  void add(double w, double v);
  void add(const WeightedMean& other);
  double mean() const;     ///< NaN without weight
  double stdError() const; ///< NaN below two values
};

/// Sums over the places of a region and height band.
struct CoverageShares
{
  static constexpr std::size_t Statuses = 8;
  WeightedMean detected;
  WeightedMean tracked;
  std::array<double, Statuses> byStatus{}; ///< weights

  void add(double weight, const CoverageValue& value, double trackProbability);
  void add(const CoverageShares& other);
};

/// Density of bird strikes over the height above ground, 1/m, of 1 in all; 0 below ground.
double strikeHeightDensity(double height);
}

#endif
