// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaces.h"

#include "vtkAvianLidarMedia.h"

#include <algorithm>

//------------------------------------------------------------------------------
vtkAvianLidarSurfaces vtkAvianLidarSurfaces::MergedAgain() const
{
  vtkAvianLidarSurfaces again = *this;
  again.warning.clear();
  again.leaves.clear();
  // Names and classes of objects without cells are not found there.
  std::vector<char> used(this->objectNames.size(), 0);
  for (const int id : this->objectIds)
  {
    used[id] = 1;
  }
  for (const std::string& medium : this->media)
  {
    int id = -1;
    std::string name;
    if (vtkAvianLidarMedia::IsObject(medium, id, name) && id >= 0)
    {
      used[id] = 1;
    }
  }
  for (std::size_t id = 0; id < used.size(); ++id)
  {
    if (!used[id])
    {
      again.objectNames[id].clear();
      if (!again.objectClasses.empty())
      {
        again.objectClasses[id].clear();
      }
    }
  }
  while (!used.empty() && !used.back())
  {
    used.pop_back();
  }
  again.objectNames.resize(used.size());
  again.objectClasses.resize(again.objectClasses.empty() ? 0 : used.size());
  return again;
}

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
