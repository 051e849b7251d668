// SPDX-License-Identifier: BSD-3-Clause
// What became of a beam tells with which limits and in which air it would have become the same.
#include "BeamOutcome.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace avianlidar;

TEST(BeamOutcome, WhatIsBelowStaysBelowWhereNoPathCanGainMore)
{
  BeamOutcome outcome;
  outcome.attenuation = 1e-3;
  outcome.loudest = 1e-6;
  outcome.surest = 1e-8;
  outcome.shortest = 100.0;
  outcome.longest = 300.0;
  const auto holds = [&](double limit, double attenuation, double threshold = 1e-10) {
    return outcome.holds({ limit, attenuation, threshold });
  };
  EXPECT_TRUE(holds(1.001e-6, 1e-3));
  EXPECT_FALSE(holds(1e-6, 1e-3)); // too near to say
  // Clearer air: the longest path gains most. Denser: the shortest loses least.
  EXPECT_TRUE(holds(1.001e-6 * std::exp(0.15), 5e-4));
  EXPECT_FALSE(holds(0.999e-6 * std::exp(0.15), 5e-4));
  EXPECT_TRUE(holds(1.001e-6 * std::exp(-0.1), 2e-3));
  EXPECT_FALSE(holds(0.999e-6 * std::exp(-0.1), 2e-3));
  // The surest path must not be dropped, or the report might say another thing.
  EXPECT_TRUE(holds(1e-5, 2e-3, 0.99e-8 * std::exp(-0.3)));
  EXPECT_FALSE(holds(1e-5, 2e-3, 1.01e-8 * std::exp(-0.3)));
  EXPECT_FALSE(holds(1e-5, 100.0, 0.0));
  // Near underflow nobody knows whether it arrives, nor what was lost of the loudest.
  EXPECT_TRUE(holds(1e-5, 2.1, 0.0));
  EXPECT_FALSE(holds(1e-5, 2.3, 0.0));
  BeamOutcome silent = outcome;
  silent.loudest = 0.0;
  EXPECT_TRUE(silent.holds({ 1e-280, 1e-3, 0.0 }));
  EXPECT_FALSE(silent.holds({ 1e-300, 1e-3, 0.0 }));
  // Echoes stay in the same air alone, and while the limit parts the same units.
  outcome.echoes = 1;
  outcome.window.atLeast(1e-7);
  outcome.window.below(3e-7);
  EXPECT_TRUE(holds(1e-7, 1e-3));
  EXPECT_FALSE(holds(3e-7, 1e-3));
  EXPECT_FALSE(holds(0.9e-7, 1e-3));
  EXPECT_FALSE(holds(2e-7, 1.1e-3));
}
