// SPDX-License-Identifier: BSD-3-Clause
#include "SceneSummary.h"

#include "Hash.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
template <class Values>
std::uint64_t hash(const Values& values, std::uint64_t seed)
{
  return hashOf(values.data(), values.size() * sizeof(*values.data()), seed);
}
}

void SceneSummary::follow(const ScanSetup& setup)
{
  if (this->Hash == 0 || !this->Materials.sharesWith(setup.materials))
  {
    this->Materials = setup.materials;
    this->Hash = hash(setup.materials, 0);
    this->Reflectance = 0.0;
    this->Gain = 0.0;
    for (const Material& m : setup.materials)
    {
      this->Reflectance = std::max(this->Reflectance, m.albedo());
      this->Gain = std::max(this->Gain, apertureGain(m));
    }
  }
  if (this->Ids == 0 || !this->ObjectIds.sharesWith(setup.objectIds) ||
    !this->MaterialIds.sharesWith(setup.materialIds))
  {
    this->ObjectIds = setup.objectIds;
    this->MaterialIds = setup.materialIds;
    this->Ids = hash(setup.materialIds, hash(setup.objectIds, 0));
  }
}

std::uint64_t SceneSummary::checksum(std::uint64_t geometry) const
{
  const std::vector<std::uint64_t> parts{ geometry, this->Hash, this->Ids };
  return hash(parts, 0);
}
}
