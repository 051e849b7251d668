// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AirEcho.h
 * @brief What the air sends back in each range unit of a beam: its mean, and how drops change it.
 *
 * Media that fill the scene return, in the unit from R1 to R2, E sum(mu/S) times the integral over
 * R of O(R) min(A/R^2, 2 pi) exp(-2 mu_all R): A the aperture, O what reaches the detector of the
 * near range, mu_all the extinction of all air. Drops are a Poisson number in the unit's part of
 * the beam's cone, and the energy of each is the square of an exponential diameter (Medium.h): up
 * to FewDrops are drawn one by one, more are a gamma distribution of the same mean and variance.
 *
 * A drop shares its pulse with the units that the pulse overlaps, as surfaces do (RangeUnits.h), so
 * drops vary less in a unit, and neighbouring units vary together. Each of few drops has a place of
 * its own in its unit. Many vary as if all were at one of two places, either equally likely, which
 * are chosen such that variances, covariances and third moments of units are those of drops
 * anywhere (of pulses no wider than a unit, or of whole units). The mean is that of a short pulse.
 *
 * Source: the lidar equation, single scattering, e.g. U. Wandinger, in: Lidar, Springer, 2005.
 * Differs: the paper's air sends nothing back.
 * Valid: the mean changes little within a pulse, as beyond the first few units; the beam is evenly
 * lit as far as drops are concerned. Integrals are right to 1e-6. Units beyond a million are empty.
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

/// What a sensor sees of light that drops turn. A beam that is not round has the half angle of a
/// round one of its solid angle.
LidarView viewOf(const Sensor& sensor);

/// How the pulse of a drop is divided among range units.
class PulseShares
{
public:
  /// @param width tau_e/tau_s, 0 to 1000
  explicit PulseShares(double width = 0.0);

  /// Units that a pulse reaches before and behind its own.
  std::int64_t reach() const { return this->Reach; }

  /// Add the energy of a pulse to 2 reach() + 1 units, its own in the middle. @param place in its
  /// own unit, 0 to 1
  void add(double energy, double place, double* units) const;

  /// One of the two places of many drops, in [0, 1]; the other is as far from the other end.
  double placeOfMany() const { return this->Place; }

private:
  double Width;
  std::int64_t Reach;
  double Place;
};

/// Add what the drops of a unit return beyond their mean to 2 reach() + 1 units: a compound Poisson
/// law. @param mean J @param drops on average @param number of the unit, or one that no other has
/// @param medium whose squareOfDrops and `renewed` count
void addDropsBeyondMean(std::int32_t seed, std::uint64_t beam, std::uint64_t number,
  std::int32_t revolution, double mean, double drops, const Medium& medium,
  const PulseShares& pulse, double* units);

/// What all drops of a beam return beyond their mean in each unit. Units are drawn once, if they
/// are asked for in order. One per thread.
class SharedDrops
{
public:
  explicit SharedDrops(const PulseShares& pulse);

  /// Begin a beam.
  void clear() { this->Numbers.assign(this->Numbers.size(), -1); }

  /// J. @param draw called with a unit and a pointer to its 2 reach() + 1 sums, which are 0
  template <class F>
  double in(std::int64_t unit, F draw)
  {
    double sum = 0.0;
    const std::int64_t reach = this->Reach;
    const std::int64_t count = 2 * reach + 1;
    for (std::int64_t of = std::max<std::int64_t>(0, unit - reach); of <= unit + reach; ++of)
    {
      double* const shares = this->Shares.data() + (of % count) * count;
      std::int64_t& number = this->Numbers[static_cast<std::size_t>(of % count)];
      if (number != of)
      {
        number = of;
        std::fill_n(shares, count, 0.0);
        draw(of, shares);
      }
      sum += shares[unit - of + reach];
    }
    return sum;
  }

private:
  std::int64_t Reach;
  std::vector<std::int64_t> Numbers; ///< units whose drops are known
  std::vector<double> Shares;        ///< J, of each in 2 Reach + 1 units
};

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

  /// Variance by the drops of a unit, J^2, wherever their pulses arrive.
  double variance(std::int64_t unit) const;

  /// How the pulse of a drop is divided among units.
  const PulseShares& pulse() const { return this->Pulse; }

  /// Add what the drops of a unit return beyond their mean, J, to the units that their pulses
  /// reach: the same for the same numbers. @param open share of the pulse that no nearer surface
  /// has met
  void addBeyondMean(std::int32_t seed, std::uint64_t beam, std::int64_t unit,
    std::int32_t revolution, double open, double* units) const;

  /// Up to so many drops in a unit, on average, are drawn one by one.
  static constexpr double FewDrops = 40.0;

  static constexpr double MostUnits = 1e6;

private:
  std::vector<double> Means; ///< of units, J
  double OfDrops = 0.0;      ///< share of the means that drops return
  double Drops = 0.0;        ///< 1/m^3
  double SolidAngle = 0.0;   ///< sr
  double UnitLength = 0.0;   ///< m
  PulseShares Pulse;
  double Nearest = 0.0; ///< m, at which the gate begins
  double dropsIn(std::int64_t unit) const;
};
}

#endif
