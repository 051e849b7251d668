// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file HiddenGlint.h
 * @brief The energy that a specular lobe narrower than the spacing of the rays may return without
 * being hit by any of them.
 *
 * A plane of exponent k returns f_s = ks exp(-2 k theta^2) near normal incidence theta. The lobe
 * fills a share 1/(2 k t^2) of a cone of half-angle t, its square 1/(4 k t^2). Of N rays n = N/(2 k
 * t^2) hit it. Where n is small, often no ray does, and the values of the others contain no
 * information on it. The variance that the lobe adds is N (Q/N)^2 ks^2/(4 k t^2). It is taken with
 * ks lowered to what the lobe may still be near the hit closest to its middle, and without what
 * that hit shows, which is in the sample's own variance. Each plane is taken by itself, as the hits
 * on one say nothing about another.
 *
 * Source: paper, Eq. 7 with delta = 2 theta.
 * Differs: the exponential stands for the power of the cosine, near normal incidence.
 * Valid: 0 where more than eight rays hit every lobe. Cost O(N log N) where lobes are so narrow.
 * Test: TestStandardError.cxx.
 */
#ifndef avianlidar_HiddenGlint_h
#define avianlidar_HiddenGlint_h

#include "BeamSamples.h"
#include "ScanSetup.h"

namespace avianlidar
{
/// Square root of that variance, as a multiple of a ray's energy Q/N; the largest of all planes.
double hiddenGlintOf(const ScanSetup& setup, const BeamSamples& samples);
}

#endif
