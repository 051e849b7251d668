// SPDX-License-Identifier: BSD-3-Clause
// Paths at random for the tests of range units.
#ifndef RandomContributions_h
#define RandomContributions_h

#include "Random.h"
#include "RangeUnits.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace echotest
{
constexpr double nanosecond = 1e-9; // s

/// @param nearest, farthest m, of path lengths
inline std::vector<avianlidar::Contribution> randomContributions(
  std::size_t count, double nearest, double farthest)
{
  using namespace avianlidar;
  std::vector<Contribution> list;
  for (std::size_t n = 0; n < count; ++n)
  {
    const auto u = uniformPair(8, 0, n, RandomPurpose::Rays);
    list.push_back({ nearest + (farthest - nearest) * u[0], 1e-6 * u[1] });
  }
  return list;
}
}

#endif
