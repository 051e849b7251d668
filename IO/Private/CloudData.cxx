// SPDX-License-Identifier: BSD-3-Clause
#include "CloudData.h"

#include "AvailableMemory.h"

namespace avianlidar::formats
{
Values makeValues(Scalar type, std::size_t size)
{
  return withType(type, [size](auto kind) { return Values(std::vector<decltype(kind)>(size)); });
}

std::size_t sizeOf(const Values& values)
{
  return std::visit([](const auto& typed) { return typed.size(); }, values);
}

void setFromBytes(Values& values, std::size_t i, const unsigned char* bytes)
{
  std::visit([i, bytes](auto& typed)
    { typed[i] = load<typename std::decay_t<decltype(typed)>::value_type>(bytes); },
    values);
}

void requireMemoryFor(std::uint64_t points, std::uint64_t length)
{
  // A point with its vertex, range and angles, both as read and as handed on, and what the file
  // says of it unpacked, as arrays and handed on.
  const double bytes = 100.0 + 3.0 * static_cast<double>(length);
  const auto count = static_cast<double>(points);
  requireMemory(count, "points", count * bytes);
}

void keepMarked(Values& values, int components, const std::vector<bool>& marks)
{
  std::visit(
    [&](auto& typed)
    {
      std::size_t kept = 0;
      for (std::size_t i = 0; i < marks.size(); ++i)
      {
        for (int c = 0; marks[i] && c < components; ++c)
        {
          typed[kept++] = typed[i * components + c];
        }
      }
      typed.resize(kept);
    },
    values);
}
}
