// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AirIntegral.h
 * @brief Integrals of the light that air returns, over ranges.
 *
 * Source: Gauss-Legendre quadrature on panels that grow with the range.
 * Valid: the relative error is at most 2e-6, and at most 1e-3 in the first range unit.
 * Test: TestAir.cxx.
 */
#ifndef avianlidar_AirIntegral_h
#define avianlidar_AirIntegral_h

#include <boost/math/quadrature/gauss.hpp>

#include <algorithm>

namespace avianlidar
{
/// Integral of f over ranges, m. f falls no faster than exp(-(decay + change) r)/r^2, with a kink.
/// @param reach range of the kink, m: the range to which the aperture gathers half of all light
/// @param decay decay by extinction, 1/m @param change change by densities, 1/m
template <class F>
double airIntegral(double reach, double from, double to, double decay, double change, F f)
{
  // Panels grow by `growth`. No panel is longer than `longestPanel`/(decay + change).
  constexpr double growth = 1.5;
  constexpr double longestPanel = 2.0;
  constexpr double nothingLeft = 700.0; // exponent at which f has vanished
  const double longest = longestPanel / std::max(1e-300, decay + change);
  double sum = 0.0;
  for (double begin = from; begin < to && decay * (begin - from) < nothingLeft;)
  {
    // The step must change `begin` even where extinction acts within the last digit of `begin`.
    const double step = std::max(longest, 1e-15 * begin);
    const double end = std::min({ begin < reach ? reach : growth * begin, begin + step, to });
    // Three points suffice, to 1e-8, on a panel that is short against range and extinction length.
    constexpr double isShort = 0.05;
    sum += end - begin < std::min(isShort * begin, 0.25 * longest)
      ? boost::math::quadrature::gauss<double, 3>::integrate(f, begin, end)
      : boost::math::quadrature::gauss<double, 10>::integrate(f, begin, end);
    begin = end;
  }
  return sum;
}
}

#endif
