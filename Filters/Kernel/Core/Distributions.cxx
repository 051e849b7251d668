// SPDX-License-Identifier: BSD-3-Clause
#include "Distributions.h"

#include "Vector.h"

#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/special_functions/log1p.hpp>
#include <boost/math/tools/rational.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace avianlidar
{
namespace
{
namespace bm = boost::math;

/// Policy without promotion to long double, so that systems with another long double give the same
/// bits. Without exceptions, overflow is infinity.
using DoublePolicy = bm::policies::policy<bm::policies::promote_double<false>,
  bm::policies::domain_error<bm::policies::ignore_error>,
  bm::policies::pole_error<bm::policies::ignore_error>,
  bm::policies::overflow_error<bm::policies::ignore_error>,
  bm::policies::underflow_error<bm::policies::ignore_error>,
  bm::policies::evaluation_error<bm::policies::ignore_error>>;

/// Parameter above which the uniform expansion is exact to round-off. Boost's fractions take ever
/// more terms there.
constexpr double LargeParameter = 1e5;

/// P(a, x), or Q(a, x) with `isTail`, by Temme's uniform expansion (DLMF 8.12.3-8.12.10), a >= 1e5:
/// terms left out are below 1e-13, relative, wherever the result does not underflow.
double largeGammaRatio(double a, double x, bool isTail)
{
  using boost::math::tools::evaluate_polynomial;
  static const double c0[] = { -0.33333333333333333, 0.083333333333333333, -0.014814814814814815,
    0.0011574074074074074, 0.0003527336860670194, -0.00017875514403292181, 0.39192631785224378e-4,
    -0.21854485106799922e-5, -0.185406221071516e-5, 0.8296711340953086e-6,
    -0.17665952736826079e-6 };
  static const double c1[] = { -0.0018518518518518519, -0.0034722222222222222,
    0.0026455026455026455, -0.00099022633744855967, 0.00020576131687242798 };
  const double y = -a * bm::log1pmx((x - a) / a, DoublePolicy()); // a eta^2/2
  const double sign = isTail ? 1.0 : -1.0;
  if (!(y < 700.0))
  {
    return sign * (x - a) < 0.0 ? 1.0 : 0.0;
  }
  const double eta = std::copysign(std::sqrt(2.0 * y / a), x - a);
  const double rest = std::exp(-y) / std::sqrt(2.0 * Pi * a) *
    (evaluate_polynomial(c0, eta, std::size(c0)) + evaluate_polynomial(c1, eta, std::size(c1)) / a);
  return 0.5 * std::erfc(sign * std::copysign(std::sqrt(y), x - a)) + sign * rest;
}

/// Smallest whole number for which `good` holds, good(infinity) being true and `good` monotone.
template <typename Predicate>
double smallestCount(double mean, const Predicate& good)
{
  double step = std::max(1.0, std::floor(std::sqrt(mean)));
  double low = std::floor(mean);
  double high = low;
  for (; low >= 0.0 && good(low); step *= 2.0)
  {
    high = low;
    low = std::max(-1.0, low - step);
  }
  for (bool isBracketed = high > low; !isBracketed; step *= 2.0)
  {
    low = high;
    high += step;
    isBracketed = good(high);
  }
  while (high - low > 1.0)
  {
    const double middle = std::floor(0.5 * (low + high));
    (good(middle) ? high : low) = middle;
  }
  return high;
}
}

double gammaTail(double shape, double x)
{
  return shape >= LargeParameter ? largeGammaRatio(shape, x, true)
                                 : bm::gamma_q(shape, x, DoublePolicy());
}

double poissonCdf(double mean, double count)
{
  return count < 0.0 ? 0.0 : gammaTail(count + 1.0, mean);
}

double poissonTail(double mean, double count)
{
  return count < 0.0                ? 1.0
    : count + 1.0 >= LargeParameter ? largeGammaRatio(count + 1.0, mean, false)
                                    : bm::gamma_p(count + 1.0, mean, DoublePolicy());
}

double poissonQuantile(double mean, double p, double q)
{
  if (!(q > 0.0))
  {
    return Infinity;
  }
  if (!(mean > 0.0) || !(p > 0.0))
  {
    return 0.0;
  }
  return p <= q ? smallestCount(mean, [mean, p](double n) { return poissonCdf(mean, n) >= p; })
                : smallestCount(mean, [mean, q](double n) { return poissonTail(mean, n) <= q; });
}

double normalDeviate(double below, double above)
{
  return above < 0.5 ? Root2 * bm::erfc_inv(2.0 * above, DoublePolicy())
                     : -Root2 * bm::erfc_inv(2.0 * below, DoublePolicy());
}
}
