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
  static_assert(sizeof(Material) == 3 * sizeof(double), "materials are hashed as bytes");
  const SharedBlocks<Material>& materials = setup.materials;
  this->Hashes.resize(materials.blocks());
  this->Largest.resize(materials.blocks());
  this->Gains.resize(materials.blocks());
  for (std::size_t k = 0; k < materials.blocks(); ++k)
  {
    if (materials.sharesBlock(k, this->Materials))
    {
      continue;
    }
    this->Hashes[k] = hash(materials.block(k), 0);
    this->Largest[k] = 0.0;
    this->Gains[k] = 0.0;
    for (const Material& m : materials.block(k))
    {
      this->Largest[k] = std::max(this->Largest[k], m.kd + m.ks);
      this->Gains[k] = std::max(this->Gains[k], apertureGain(m));
    }
  }
  this->Materials = materials;
  if (this->Ids == 0 || !this->ObjectIds.sharesWith(setup.objectIds) ||
    !this->MaterialIds.sharesWith(setup.materialIds))
  {
    this->ObjectIds = setup.objectIds;
    this->MaterialIds = setup.materialIds;
    this->Ids = hash(setup.materialIds, hash(setup.objectIds, 0));
  }
}

namespace
{
double largestOf(const std::vector<double>& values)
{
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}
}

double SceneSummary::largestReflectance() const
{
  return largestOf(this->Largest);
}

double SceneSummary::largestGain() const
{
  return largestOf(this->Gains);
}

std::uint64_t SceneSummary::checksum(std::uint64_t geometry) const
{
  const std::vector<std::uint64_t> parts{ geometry, hash(this->Hashes, 0), this->Ids };
  return hash(parts, 0);
}
}
