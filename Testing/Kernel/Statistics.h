// SPDX-License-Identifier: BSD-3-Clause
// Sums, means and their errors, and the message of an exception.
#ifndef Statistics_h
#define Statistics_h

#include <gtest/gtest.h>

#include <cmath>
#include <exception>
#include <numeric>
#include <string>
#include <vector>

namespace statistics
{
inline double sumOf(const std::vector<double>& values)
{
  return std::accumulate(values.begin(), values.end(), 0.0);
}

inline double meanOf(const std::vector<double>& values)
{
  return sumOf(values) / static_cast<double>(values.size());
}

/// Integral of a function, by midpoints.
template <class Function>
double byMidpoints(double from, double to, int steps, Function&& function)
{
  double sum = 0.0;
  for (int i = 0; i < steps; ++i)
  {
    sum += function(from + (i + 0.5) / steps * (to - from));
  }
  return sum * (to - from) / steps;
}

/// Share of the unit disc beyond a line at a distance from its middle.
inline double shareBeyond(double distance)
{
  const double d = std::fmin(1.0, std::fmax(-1.0, distance));
  return (std::acos(d) - d * std::sqrt(1.0 - d * d)) / std::acos(-1.0);
}

/// Numbers that come one after the other.
struct Moments
{
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;

  void add(double x)
  {
    this->count += 1.0;
    this->sum += x;
    this->squares += x * x;
  }
  double mean() const { return this->sum / this->count; }
  double variance() const { return this->squares / this->count - this->mean() * this->mean(); }
  double rms() const { return std::sqrt(this->squares / this->count); }
  /// Standard error of the mean.
  double error() const { return std::sqrt(this->variance() / (this->count - 1.0)); }
};

/// A message has these words.
inline void expectSays(const std::string& message, const std::string& words)
{
  EXPECT_NE(message.find(words), std::string::npos) << message << "\nexpected: " << words;
}

/// What the exception says that a call throws; empty without one.
template <class Call>
std::string errorOf(Call&& call)
{
  try
  {
    call();
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return {};
}
}

#endif
