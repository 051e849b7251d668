// SPDX-License-Identifier: BSD-3-Clause
#include "CloudData.h"

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

double valueOf(const Values& values, std::size_t i)
{
  return std::visit([i](const auto& typed) { return static_cast<double>(typed[i]); }, values);
}

void setFromBytes(Values& values, std::size_t i, const unsigned char* bytes)
{
  std::visit([i, bytes](auto& typed)
    { typed[i] = load<typename std::decay_t<decltype(typed)>::value_type>(bytes); },
    values);
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
