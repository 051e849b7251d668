// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file HiddenGlint.h
 * @brief A specular lobe that is narrower than the spacing of the rays: what it may return unseen.
 *
 * A plane of exponent k returns f_s = ks exp(-2 k theta^2) near normal incidence theta (Eq. 7 with
 * delta = 2 theta). The lobe fills a share 1/(2 k t^2) of a cone of half-angle t, its square one of
 * 1/(4 k t^2). Of N rays n = N/(2 k t^2) fall in. Where n is small, often none does, and the values
 * of the others say nothing of it; the variance that the lobe brings is N (Q/N)^2 ks^2/(4 k t^2).
 * It is taken with ks lowered to what the lobe may still be near the hit closest to its middle, and
 * by what that hit shows of it, which is in the sample's own variance: plane by plane, since what
 * is seen of one says nothing of another (planes of different materials, too).
 */
#ifndef avianlidar_HiddenGlint_h
#define avianlidar_HiddenGlint_h

#include "BeamSamples.h"
#include "ScanSetup.h"

namespace avianlidar
{
/// Root of that variance, as a multiple of a ray's energy Q/N: the largest of any plane; 0 where
/// more than eight rays fall into every lobe. O(N log N) where lobes are so narrow.
double hiddenGlintOf(const ScanSetup& setup, const BeamSamples& samples);
}

#endif
