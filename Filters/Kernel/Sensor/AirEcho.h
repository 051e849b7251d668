// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AirEcho.h
 * @brief What the air sends back in each range unit of a beam: its mean, and how drops change it.
 *
 * Media that fill the scene return, in the unit from R1 to R2, E sum(mu/S) times the integral over
 * R of O(R) min(A/R^2, 2 pi) exp(-2 mu_all R): A the aperture, O what reaches the detector of the
 * near range, mu_all the extinction of all air. Drops are a Poisson number in the unit's part of
 * the beam's cone, and the energy of each is exponential in its diameter (Medium.h): up to FewDrops
 * are drawn one by one, more are a gamma distribution of the same mean and variance.
 *
 * Source: the lidar equation, single scattering, e.g. U. Wandinger, in: Lidar, Springer, 2005.
 * Differs: the paper's air sends nothing back.
 * Valid: the pulse is short against the unit; the beam is evenly lit as far as drops are concerned.
 * Integrals are right to 1e-6. Units beyond a million are without air.
 * Test: TestAirEcho.cxx, TestWeather.py.
 */
#ifndef avianlidar_AirEcho_h
#define avianlidar_AirEcho_h

#include "Medium.h"
#include "Sensor.h"

#include <boost/math/quadrature/gauss.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Integral of f over the ranges from one to another, m, which falls no faster than 1/r^2, but for
/// the range up to which an aperture gathers half of all, and exp(-decay r). @param decay 1/m
/// @param change 1/m, of the logarithm of f besides
template <class F>
double airIntegral(
  const Sensor& sensor, double from, double to, double decay, F f, double change = 0.0)
{
  // Panels grow by this, and none is longer than so many lengths of extinction, there and back.
  constexpr double growth = 1.5;
  constexpr double longestPanel = 2.0;
  constexpr double nothingLeft = 700.0; // as an exponent
  const double reach = std::sqrt(sensor.receiverAperture / (2.0 * Pi));
  const double longest = longestPanel / std::max(1e-300, decay + change);
  double sum = 0.0;
  for (double begin = from; begin < to && decay * (begin - from) < nothingLeft;)
  {
    // A step, even where light goes no farther than the last digit.
    const double step = std::max(longest, 1e-15 * begin);
    const double end = std::min({ begin < reach ? reach : growth * begin, begin + step, to });
    // Where a panel is short against its range a rule of few points does as well, to 1e-8.
    constexpr double isShort = 0.05;
    sum += end - begin < std::min(isShort * begin, 0.25 * longest)
      ? boost::math::quadrature::gauss<double, 3>::integrate(f, begin, end)
      : boost::math::quadrature::gauss<double, 10>::integrate(f, begin, end);
    begin = end;
  }
  return sum;
}

/// What drops or leaves return beyond their mean, over that: a compound Poisson law. @param drops
/// on average @param number of the unit, or one that no other has @param medium whose squareOfDrops
/// and `renewed` count
double dropsBeyondMean(std::int32_t seed, std::uint64_t beam, std::uint64_t number,
  std::int32_t revolution, double drops, const Medium& medium);

class AirEcho
{
public:
  /// No echo.
  AirEcho() = default;

  /// @param attenuation of all air, that of the media included, 1/m
  AirEcho(const Sensor& sensor, const std::vector<Medium>& media, double attenuation);

  /// Whether the air sends anything back.
  bool any() const { return !this->Means.empty(); }

  /// Units [0, count) are known; in others there is none.
  std::int64_t units() const { return static_cast<std::int64_t>(this->Means.size()); }

  /// Mean energy in a unit, J.
  double mean(std::int64_t unit) const
  {
    return unit >= 0 && unit < this->units() ? this->Means[static_cast<std::size_t>(unit)] : 0.0;
  }

  /// Variance of a unit's energy by its drops, J^2.
  double variance(std::int64_t unit) const;

  /// Note from where on drops may matter. @param least J beyond the mean of the unit
  void setLeast(std::int64_t unit, double least);

  /// What the drops of a unit return beyond their mean, J: the same for the same numbers. @param
  /// all false: negative infinity may stand for less than what setLeast() was told @param open
  /// share of the pulse that no nearer surface has met
  double beyondMean(std::int32_t seed, std::uint64_t beam, std::int64_t unit,
    std::int32_t revolution, bool all, double open = 1.0) const;

  /// Up to so many drops in a unit, on average, are drawn one by one.
  static constexpr double FewDrops = 40.0;

  static constexpr double MostUnits = 1e6;

private:
  std::vector<double> Means; ///< of units, J
  std::vector<double> Quiet; ///< probabilities that drops do not matter
  double OfDrops = 0.0;      ///< share of the means that drops return
  double Drops = 0.0;        ///< 1/m^3
  double SolidAngle = 0.0;   ///< sr
  double UnitLength = 0.0;   ///< m
  double Nearest = 0.0;      ///< m, at which the gate begins
  double dropsIn(std::int64_t unit) const;
};
}

#endif
