// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBirdTargets.h"

#include "BirdViews.h"
#include "vtkAvianLidarBirds.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <tuple>
#include <utility>

namespace
{
/// Number of sizes that are kept for one bird, because sites are compared for larger and smaller
/// birds.
constexpr std::size_t MostSizes = 8;
/// Number of birds that are kept, more than the built-in species.
constexpr std::size_t MostBirds = 64;

/// A species with its targets, which are kept from one filter to the next.
struct Bird
{
  avianlidar::BirdSpecies Species;
  bool Gliding;
  double MeanArea; ///< mean area of the species, m^2
  std::vector<vtkAvianLidarBirdTargets::Target> Sizes;
};

std::mutex Mutex;
std::vector<Bird> Known;
}

//------------------------------------------------------------------------------
vtkAvianLidarBirdTargets::Target vtkAvianLidarBirdTargets::TargetOf(
  const avianlidar::BirdSpecies& species, bool gliding, double area)
{
  const auto numbersOf = [](const avianlidar::BirdSpecies& s)
  { return std::tie(s.name, s.mass, s.length, s.span, s.wingArea, s.passerine); };
  const avianlidar::BirdShape shape(species);
  const std::lock_guard<std::mutex> lock(Mutex);
  auto bird = std::find_if(Known.begin(), Known.end(),
    [&](const Bird& known)
    { return known.Gliding == gliding && numbersOf(known.Species) == numbersOf(species); });
  if (bird == Known.end())
  {
    const double meanArea = avianlidar::meanEffectiveArea(shape, gliding);
    if (Known.size() >= MostBirds)
    {
      Known.erase(Known.begin());
    }
    Known.push_back({ species, gliding, meanArea, {} });
    bird = Known.end() - 1;
  }
  const double wanted = area > 0.0 ? area : bird->MeanArea;
  const auto found = std::find_if(bird->Sizes.begin(), bird->Sizes.end(),
    [&](const Target& size) { return size.Area == wanted; });
  if (found != bird->Sizes.end())
  {
    return *found;
  }
  if (bird->Sizes.size() >= MostSizes)
  {
    bird->Sizes.erase(bird->Sizes.begin());
  }
  auto views = std::make_shared<const avianlidar::TargetViews>(
    avianlidar::birdViews(shape.scaled(std::sqrt(wanted / bird->MeanArea)), gliding, wanted));
  bird->Sizes.push_back({ species.name, wanted, std::move(views) });
  return bird->Sizes.back();
}

//------------------------------------------------------------------------------
std::vector<vtkAvianLidarBirdTargets::Target> vtkAvianLidarBirdTargets::Choose(
  const std::string& species, const std::string& speciesFileName, bool gliding, double area,
  bool all)
{
  std::vector<Target> targets;
  const auto known = vtkAvianLidarBirds::KnownSpecies(speciesFileName);
  const auto add = [&](const avianlidar::BirdSpecies& bird, double wanted)
  { targets.push_back(this->TargetOf(bird, gliding, wanted)); };
  if (species.empty())
  {
    this->Point.Area = area;
    targets.push_back(this->Point);
  }
  else
  {
    add(known[vtkAvianLidarBirds::FindSpecies(known, species)], area);
  }
  for (const avianlidar::BirdSpecies& bird : known)
  {
    // The user's table may contain a species with the name of a built-in species.
    const bool isThere = std::any_of(targets.begin(), targets.end(),
      [&](const Target& target) { return target.Name == bird.name; });
    if (all && !isThere)
    {
      add(bird, 0.0);
    }
  }
  return targets;
}
