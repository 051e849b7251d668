// SPDX-License-Identifier: BSD-3-Clause
// Elementary functions for lanes against those of the long double library, within the ranges that
// LaneMath.h promises.
#include "LaneMath.h"

#include <gtest/gtest.h>

#include <random>

using namespace avianlidar;

namespace
{
constexpr int Count = 200000;
constexpr double AllowedUlps = 1.5;

/// Error in units in the last place of the right value.
double ulps(double value, long double right)
{
  const int exponent = std::max(-1022, std::ilogb(static_cast<double>(right)));
  return static_cast<double>(std::fabs(value - right) / std::ldexp(1.0L, exponent - 52));
}

template <class Draw, class Function, class Right>
void expectClose(Draw draw, Function function, Right right, double allowed = AllowedUlps)
{
  std::mt19937_64 random(5);
  for (int i = 0; i < Count; ++i)
  {
    const double x = draw(random);
    ASSERT_LT(ulps(function(x), right(static_cast<long double>(x))), allowed) << x;
  }
}

std::uniform_real_distribution<double> between(double lower, double upper)
{
  return std::uniform_real_distribution<double>(lower, upper);
}
}

TEST(LaneMath, Exponential)
{
  const auto right = [](long double x) { return std::exp(x); };
  expectClose(between(-745.0, 709.0), lanes::exp, right);
  expectClose(between(-1.0, 1.0), lanes::exp, right);
  EXPECT_EQ(lanes::exp(0.0), 1.0);
  EXPECT_EQ(lanes::exp(-0.0), 1.0);
  EXPECT_EQ(lanes::exp(-746.0), 0.0);
  EXPECT_EQ(lanes::exp(-1e300), 0.0);
}

TEST(LaneMath, Logarithm)
{
  const auto small = [](auto& random) { return std::exp(between(-80.0, 0.0)(random)); };
  expectClose(
    small, [](double y) { return lanes::logOf(y, 0.0); },
    [](long double y) { return std::log(y); });
  const auto right = [](long double x) { return std::log1p(-x); };
  expectClose(small, lanes::logOneMinus, right);
  expectClose(between(0.0, 0.999999), lanes::logOneMinus, right);
  EXPECT_EQ(lanes::logOneMinus(0.0), 0.0);
}

TEST(LaneMath, Arccosine)
{
  expectClose(between(0.0, 1.0), lanes::acos, [](long double x) { return std::acos(x); });
  // Just above 1/2 the arcsine is the difference of larger numbers.
  const auto arcsine = [](long double x) { return std::asin(x); };
  expectClose(between(0.0, 0.5), lanes::asin, arcsine);
  expectClose(between(0.5, 1.0), lanes::asin, arcsine, 2.5);
  EXPECT_EQ(lanes::acos(1.0), 0.0);
  EXPECT_EQ(lanes::acos(0.0), std::acos(0.0));
}

TEST(LaneMath, CosineAndSineOfTurns)
{
  std::mt19937_64 random(6);
  for (int i = 0; i < Count; ++i)
  {
    const double turns = between(-1.0, 2.0)(random);
    double cosine = 0.0;
    double sine = 0.0;
    lanes::cosSinOfTurns(turns, cosine, sine);
    const long double angle = 2.0L * std::acos(-1.0L) * turns;
    ASSERT_NEAR(cosine, static_cast<double>(std::cos(angle)), 2.5e-16) << turns;
    ASSERT_NEAR(sine, static_cast<double>(std::sin(angle)), 2.5e-16) << turns;
  }
  const double exact[][3] = { { 0.0, 1.0, 0.0 }, { 0.25, 0.0, 1.0 }, { 0.5, -1.0, 0.0 },
    { 0.75, 0.0, -1.0 }, { 1.0, 1.0, 0.0 } };
  for (const auto& [turns, right, up] : exact)
  {
    double cosine = 2.0;
    double sine = 2.0;
    lanes::cosSinOfTurns(turns, cosine, sine);
    EXPECT_EQ(cosine, right) << turns;
    EXPECT_EQ(sine, up) << turns;
  }
}
