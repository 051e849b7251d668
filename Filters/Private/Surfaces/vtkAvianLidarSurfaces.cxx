// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaces.h"

#include "vtkAvianLidarMedia.h"

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
