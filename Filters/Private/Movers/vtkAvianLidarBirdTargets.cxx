// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBirdTargets.h"

#include "vtkAvianLidarBirds.h"

#include <algorithm>
#include <tuple>

//------------------------------------------------------------------------------
const avianlidar::BirdAreas& vtkAvianLidarBirdTargets::AreasOf(
  const avianlidar::BirdSpecies& species, bool gliding)
{
  const auto shapeOf = [](const avianlidar::BirdSpecies& s)
  { return std::tie(s.mass, s.length, s.span, s.wingArea, s.passerine); };
  auto& known = this->Known[gliding ? 1 : 0];
  auto found = known.find(species.name);
  if (found == known.end() || shapeOf(found->second.first) != shapeOf(species))
  {
    auto areas = avianlidar::effectiveAreas(avianlidar::BirdShape(species), gliding);
    found = known.insert_or_assign(species.name, std::make_pair(species, std::move(areas))).first;
  }
  return found->second.second;
}

//------------------------------------------------------------------------------
std::vector<vtkAvianLidarBirdTargets::Target> vtkAvianLidarBirdTargets::Choose(
  const std::string& species, const std::string& speciesFileName, bool gliding, double area,
  bool all)
{
  std::vector<Target> targets;
  const auto known = vtkAvianLidarBirds::KnownSpecies(speciesFileName);
  const auto add = [&](const avianlidar::BirdSpecies& bird, double wanted)
  {
    const avianlidar::BirdAreas& areas = this->AreasOf(bird, gliding);
    targets.push_back({ bird.name, wanted > 0.0 ? wanted : areas.mean, areas.poses });
  };
  if (species.empty())
  {
    targets.push_back({ "", area, { { 1.0 } } });
  }
  else
  {
    add(known[vtkAvianLidarBirds::FindSpecies(known, species)], area);
  }
  for (const avianlidar::BirdSpecies& bird : known)
  {
    // A table of the user's may name a species anew.
    const bool isThere = std::any_of(targets.begin(), targets.end(),
      [&](const Target& target) { return target.Name == bird.name; });
    if (all && !isThere)
    {
      add(bird, 0.0);
    }
  }
  return targets;
}
