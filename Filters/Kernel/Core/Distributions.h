// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Distributions.h
 * @brief Tails and quantiles of the Poisson, gamma and normal distributions.
 *
 * Tails are computed from the incomplete gamma function and the error function. Callers give both
 * tails of a probability, so even tails that a uniform number of 53 bits does not reach are exact.
 *
 * Source: Boost.Math; above a parameter of 1e5 Temme's uniform expansion (DLMF 8.12.3-8.12.10).
 * Valid: means up to 1e12. Tails agree with reference values to 1e-11, relative.
 * Test: TestNoise.cxx.
 */
#ifndef avianlidar_Distributions_h
#define avianlidar_Distributions_h

namespace avianlidar
{
/// P(X > x) for X of a gamma distribution with the scale 1. @param shape shape parameter, above 0
double gammaTail(double shape, double x);

/// P(X <= count) and P(X > count) for X ~ Poisson(mean), each to full relative precision.
double poissonCdf(double mean, double count);
double poissonTail(double mean, double count);

/// Smallest count with P(X <= count) >= p, infinity for p = 1. The caller also gives q = 1 - p. The
/// smaller of p and q is used, so both tails are exact. The count is monotone in p. @param mean
/// mean of the distribution, in [0, 1e12] @param p, q probabilities in [0, 1]
double poissonQuantile(double mean, double p, double q);

/// A standard normal deviate. @param below, above tails of the deviate, which sum to 1: the smaller
/// tail has the digits
double normalDeviate(double below, double above);
}

#endif
