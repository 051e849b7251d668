// SPDX-License-Identifier: BSD-3-Clause
#include "Scalars.h"

#include <cmath>
#include <limits>

namespace avianlidar::formats
{
std::size_t sizeOf(Scalar type)
{
  return withType(type, [](auto value) { return sizeof value; });
}

bool isFloat(Scalar type)
{
  return type == Scalar::Float32 || type == Scalar::Float64;
}

bool isSigned(Scalar type)
{
  return withType(type, [](auto value) { return std::is_signed_v<decltype(value)>; });
}

std::optional<Scalar> scalarOf(char kind, std::size_t size)
{
  for (int i = 0; i <= static_cast<int>(Scalar::Float64); ++i)
  {
    const auto candidate = static_cast<Scalar>(i);
    const char its = isFloat(candidate) ? 'F' : isSigned(candidate) ? 'I' : 'U';
    if (its == kind && sizeOf(candidate) == size)
    {
      return candidate;
    }
  }
  return {};
}

namespace
{
template <class T>
T nearestOf(double value)
{
  if constexpr (std::is_floating_point_v<T>)
  {
    return static_cast<T>(value);
  }
  else
  {
    using Limits = std::numeric_limits<T>;
    if (std::isnan(value))
    {
      return 0;
    }
    const double rounded = std::nearbyint(value);
    // As a double, the greatest 64-bit integer is rounded up.
    if (rounded >= static_cast<double>(Limits::max()))
    {
      return Limits::max();
    }
    return rounded <= static_cast<double>(Limits::min()) ? Limits::min() : static_cast<T>(rounded);
  }
}
}

double nearest(Scalar type, double value)
{
  return withType(
    type, [value](auto kind) { return static_cast<double>(nearestOf<decltype(kind)>(value)); });
}

void storeAs(Scalar type, double value, unsigned char* bytes)
{
  withType(type, [=](auto kind) { store(nearestOf<decltype(kind)>(value), bytes); });
}

double loadAs(Scalar type, const unsigned char* bytes)
{
  return withType(
    type, [bytes](auto kind) { return static_cast<double>(load<decltype(kind)>(bytes)); });
}
}
