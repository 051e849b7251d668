// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaces.h"

#include <algorithm>

//------------------------------------------------------------------------------
std::string vtkAvianLidarSurfaces::WarningOnCoincidence(
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) const
{
  if (pairs.empty())
  {
    return {};
  }
  const auto nameOf = [this](std::uint32_t triangle)
  {
    const auto id = static_cast<std::size_t>(this->objectIds[triangle]);
    return id < this->objectNames.size() && !this->objectNames[id].empty()
      ? "'" + this->objectNames[id] + "'"
      : "object " + std::to_string(id);
  };
  constexpr std::size_t Shown = 3;
  const std::size_t shown = std::min(Shown, pairs.size());
  std::string list;
  for (std::size_t i = 0; i < shown; ++i)
  {
    list += (i > 0 ? ", " : "") + nameOf(pairs[i].first) + " over " + nameOf(pairs[i].second);
  }
  const std::string more =
    pairs.size() > shown ? " and " + std::to_string(pairs.size() - shown) + " more" : "";
  return "surfaces: faces coincide, so that their object ids alone decide which is seen: " + list +
    more +
    ". The face of the object with the lower id is seen. Remove one of the two, or move it by a "
    "millimetre or more.";
}
