// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LaneMath.h
 * @brief Elementary functions for loops over independent lanes, without branches, tables or calls.
 *
 * A compiler turns a `#pragma omp simd` loop that calls these functions into vector code, unlike a
 * loop that calls the functions of libm. Every instruction set gives the same bits: only sums,
 * products, quotients, roots and bit patterns are used, in a fixed order (compile with
 * -ffp-contract=off).
 *
 * Source: reductions and polynomials of fdlibm (K. C. Ng, Sun Microsystems, 1993: e_exp.c,
 * e_log.c, s_log1p.c, e_acos.c, k_sin.c, k_cos.c).
 * Differs: selections replace branches. Cosine and sine take their angle in turns.
 * Valid: errors are below 1.5 units in the last place within the range stated at each function, and
 * below 2.5 for arcsines of numbers above 1/2. Errors of cosine and sine are below 2.5e-16.
 * Test: TestLaneMath.cxx.
 */
#ifndef avianlidar_LaneMath_h
#define avianlidar_LaneMath_h

#include "Multiversion.h"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace avianlidar
{
namespace lanes
{
/// std::max() and std::min() by value, for loops over lanes. A value passed by reference, also to a
/// lambda, has an address. Where the address is not optimised away (clang 14 under sanitizers), the
/// vectorised loop uses one address for all lanes.
template <class T>
AVIANLIDAR_ALWAYS_INLINE T larger(T a, T b)
{
  return a < b ? b : a;
}
template <class T>
AVIANLIDAR_ALWAYS_INLINE T smaller(T a, T b)
{
  return b < a ? b : a;
}

/// Value clamped to [0, 1].
AVIANLIDAR_ALWAYS_INLINE double unit(double value)
{
  const double positive = value > 0.0 ? value : 0.0;
  return positive < 1.0 ? positive : 1.0;
}

AVIANLIDAR_ALWAYS_INLINE std::uint64_t bitsOf(double value)
{
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

AVIANLIDAR_ALWAYS_INLINE double fromBits(std::uint64_t bits)
{
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// Number whose sum with x, |x| < 2^51, holds the whole number nearest to x in its low bits.
constexpr double Rounder = 6755399441055744.0; // 1.5 * 2^52

/// 2^n for the whole number n in the low bits of `rounded` = n + Rounder, |n| <= 1022.
AVIANLIDAR_ALWAYS_INLINE double powerOfTwo(double rounded)
{
  return fromBits((bitsOf(rounded) + 1023u) << 52);
}

/// e^x for x <= 709; 0 where e^x underflows.
AVIANLIDAR_ALWAYS_INLINE double exp(double x)
{
  constexpr double Ln2High = 6.93147180369123816490e-01;
  constexpr double Ln2Low = 1.90821492927058770002e-10;
  constexpr double InverseLn2 = 1.44269504088896338700;
  const double y = x < -746.0 ? -746.0 : x;
  const double n = (y * InverseLn2 + Rounder) - Rounder;
  const double high = y - n * Ln2High;
  const double low = n * Ln2Low;
  const double r = high - low;
  const double t = r * r;
  const double c = r -
    t *
      (1.66666666666666019037e-01 +
        t *
          (-2.77777777770155933842e-03 +
            t *
              (6.61375632143793436117e-05 +
                t * (-1.65339022054652515390e-06 + t * 4.13813679705723846039e-08))));
  const double value = 1.0 - ((low - (r * c) / (2.0 - c)) - high);
  // 2^n is applied in two steps, because it may be too small for a normal number.
  const double half = 0.5 * n + Rounder;
  const double rest = n - (half - Rounder);
  return value * powerOfTwo(half) * powerOfTwo(rest + Rounder);
}

/// ln(y) + correction/y for a normal number y > 0. @param correction rounding error of y
AVIANLIDAR_ALWAYS_INLINE double logOf(double y, double correction)
{
  constexpr double Ln2High = 6.93147180369123816490e-01;
  constexpr double Ln2Low = 1.90821492927058770002e-10;
  constexpr std::uint64_t One = 0x3ff0000000000000u;
  constexpr std::uint64_t RootOfHalf = 0x3fe6a09e667f3bcdu;
  // y = 2^k (1 + f), 1 + f in [sqrt(1/2), sqrt(2)).
  const std::uint64_t shifted = bitsOf(y) + (One - RootOfHalf);
  const double k = fromBits((shifted >> 52) | 0x4330000000000000u) - (4503599627370496.0 + 1023.0);
  const double f = fromBits((shifted & 0x000fffffffffffffu) + RootOfHalf) - 1.0;
  const double s = f / (2.0 + f);
  const double z = s * s;
  const double w = z * z;
  const double even =
    w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const double odd = z *
    (6.666666666666735130e-01 +
      w *
        (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
  const double half = 0.5 * f * f;
  const double low = k * Ln2Low + correction / y;
  return k * Ln2High - ((half - (s * (half + (even + odd)) + low)) - f);
}

/// ln(1 - x) for x in [0, 1), to full relative precision also where x is small.
AVIANLIDAR_ALWAYS_INLINE double logOneMinus(double x)
{
  const double y = 1.0 - x;
  return logOf(y, (1.0 - y) - x);
}

/// (asin(s) - s) / s for z = s^2, s in [0, sqrt(1/2)].
AVIANLIDAR_ALWAYS_INLINE double arcsineTail(double z)
{
  const double p = z *
    (1.66666666666666657415e-01 +
      z *
        (-3.25565818622400915405e-01 +
          z *
            (2.01212532134862925881e-01 +
              z *
                (-4.00555345006794114027e-02 +
                  z * (7.91534994289814532176e-04 + z * 3.47933107596021167570e-05)))));
  const double q = 1.0 +
    z *
      (-2.40339491173441421878e+00 +
        z *
          (2.02094576023350569471e+00 +
            z * (-6.88283971605453293030e-01 + z * 7.70381505559019352791e-02)));
  return p / q;
}

/// Angle in [0, pi/2], rad, of a cosine in [0, 1].
AVIANLIDAR_ALWAYS_INLINE double acos(double x)
{
  const bool steep = x < 0.5;
  const double z = steep ? x * x : 0.5 * (1.0 - x);
  const double s = steep ? x : std::sqrt(z);
  const double arcsine = s + s * arcsineTail(z);
  return steep ? 1.57079632679489655800 - (arcsine - 6.12323399573676603587e-17) : 2.0 * arcsine;
}

/// Angle in [0, pi/2], rad, of a sine in [0, 1], to full relative precision also for small sines.
AVIANLIDAR_ALWAYS_INLINE double asin(double x)
{
  const bool small = x < 0.5;
  const double z = small ? x * x : 0.5 * (1.0 - x);
  const double s = small ? x : std::sqrt(z);
  const double arcsine = s + s * arcsineTail(z);
  return small ? arcsine : 1.57079632679489655800 - (2.0 * arcsine - 6.12323399573676603587e-17);
}

/// Cosine and sine of an angle given in turns, in [-1, 2].
AVIANLIDAR_ALWAYS_INLINE void cosSinOfTurns(double turns, double& cosine, double& sine)
{
  const double quarters = 4.0 * turns;
  const double rounded = quarters + Rounder;
  // Angle from the nearest quarter of a turn, rad, at most pi/4 in magnitude.
  const double x = (quarters - (rounded - Rounder)) * 1.57079632679489661923;
  const double z = x * x;
  const double s = x +
    x * z *
      (-1.66666666666666324348e-01 +
        z *
          (8.33333333332248946124e-03 +
            z *
              (-1.98412698298579493134e-04 +
                z *
                  (2.75573137070700676789e-06 +
                    z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
  const double tail = z * z *
    (4.16666666666666019037e-02 +
      z *
        (-1.38888888888741095749e-03 +
          z *
            (2.48015872894767294178e-05 +
              z *
                (-2.75573143513906633035e-07 +
                  z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  const double half = 0.5 * z;
  const double first = 1.0 - half;
  const double c = first + (((1.0 - first) - half) + tail);
  // Each quarter of a turn changes (c, s) into (-s, c).
  const std::uint64_t quarter = bitsOf(rounded);
  const bool odd = (quarter & 1u) != 0;
  const double across = odd ? s : c;
  const double along = odd ? c : s;
  const std::uint64_t signOfCosine = ((quarter + 1u) & 2u) << 62;
  const std::uint64_t signOfSine = (quarter & 2u) << 62;
  cosine = fromBits(bitsOf(across) ^ signOfCosine);
  sine = fromBits(bitsOf(along) ^ signOfSine);
}
}
}

#endif
