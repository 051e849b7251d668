// SPDX-License-Identifier: BSD-3-Clause
#include "RayBudget.h"

#include "HiddenGlint.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Whether a unit exceeds Qlow is sure so many standard errors away from it. Where it is not, more
/// rays bring the standard error to this part of the distance, of which a new draw may lose some.
constexpr double Sure = 2.0;
constexpr double Resampled = 3.0;

/// A distance from Qlow of less than this share of it is not worth the rays that it would take.
constexpr double FinestDistance = 0.05;

/// Where a pilot met nothing, this many rays of the beam must meet something to be perceived.
constexpr double RaysToBePerceived = 2.0;

/// Echoes below so many Qlow read high by selection, which more rays than this would want do not
/// mend.
constexpr double Near = 2.0;

constexpr double StepOfRays = 1.19;

/// Of strata: rays go with this power of the error's inverse where edges cross the beam, and where
/// one plane fills it.
constexpr double PowerOfEdges = 4.0 / 3.0;
constexpr double PowerOfPlane = 1.0;
}

RayBudget::RayBudget(const ScanSetup& setup, BeamSamplers& samplers)
  : Setup(setup)
  , Samplers(samplers)
  , Units(setup.sensor.samplingInterval, setup.sensor.pulseWidth, setup.sensor.rangeGate)
{
}

namespace
{
/// The next of the steps, from `least` on, that is no less than `wanted`; at most `most`.
double stepOf(double wanted, double least, double most)
{
  double rays = least;
  while (rays < wanted && rays < most)
  {
    rays = std::ceil(rays * StepOfRays);
  }
  return std::min(rays, most);
}

/// True if any of the beam's rays met what is no small target.
bool meetsOthers(const PrimaryHits& pilot)
{
  const std::size_t ordinary = pilot.ordinary();
  return pilot.share.empty() ? ordinary > 0
                             : std::any_of(pilot.share.begin(), pilot.share.begin() + ordinary,
                                 [](double share) { return share > 0.0; });
}
}

std::uint32_t RayBudget::raysFor(const PrimaryHits& pilot, TargetRays& ofTargets)
{
  const EchoSettings& settings = this->Setup.settings;
  const bool targetsError = settings.targetRelativeError > 0.0;
  const double least = targetsError ? MinimumTargetRays : pilot.rays;
  this->RaysOfPilotTarget = targetsError ? PilotRays : RaysOfTarget;
  this->Wanted = least;
  this->WantedOfTargets.assign(pilot.extraRays / this->RaysOfPilotTarget, RaysOfTarget);
  if (targetsError && !meetsOthers(pilot))
  {
    this->Wanted = this->raysForTheUnseen(this->Setup.largestReflectance);
  }
  if (pilot.size() > 0)
  {
    this->addUnits(pilot);
  }
  ofTargets.clear();
  for (const double wanted : this->WantedOfTargets)
  {
    const auto rays = static_cast<std::uint32_t>(stepOf(wanted, RaysOfTarget, MostRaysOfTarget));
    ofTargets.push_back(rays + rays % 2);
  }
  return static_cast<std::uint32_t>(stepOf(this->Wanted, least, mostRaysOfABeam(settings)));
}

/// What the units want in which the direct echoes of the pilot arrive.
void RayBudget::addUnits(const PrimaryHits& pilot)
{
  const double rayEnergy = this->Setup.sensor.pulseEnergy / pilot.rays;
  const double limit = this->Setup.sensor.lowerEnergyLimit;
  const bool targetsError = this->Setup.settings.targetRelativeError > 0.0;
  this->Light.clear();
  this->Light.reflect(this->Setup, pilot);
  this->Light.attenuate(this->Setup, pilot, this->Light.reflected, rayEnergy);
  const double glint = rayEnergy * hiddenGlintOf(this->Setup, pilot, this->Light);
  const bool mayBeSure = !targetsError && glint == 0.0 && pilot.extraRays == 0;
  this->LargestOfPilot = mayBeSure
    ? *std::max_element(this->Light.energy.begin(), this->Light.energy.end())
    : std::numeric_limits<double>::infinity();
  if (this->Light.sum < limit && this->isSure(this->Light.sum))
  {
    return;
  }
  this->Units.clear();
  this->Units.add(pilot.range.data(), this->Light.energy.data(), pilot.ray.data(), pilot.size());
  this->Units.accumulate();
  const std::vector<RangeUnit>& units = this->Units.units();
  for (std::size_t u = 0; u < units.size(); ++u)
  {
    const bool begins = u == 0 || units[u - 1].index + 1 < units[u].index;
    const bool ends = u + 1 == units.size() || units[u].index + 1 < units[u + 1].index;
    const double energy = units[u].energy;
    const bool isPeak =
      (begins || units[u - 1].energy <= energy) && (ends || units[u + 1].energy <= energy);
    // Between two peaks it decides whether they are one return.
    const bool isValley =
      !begins && !ends && units[u - 1].energy > energy && units[u + 1].energy > energy;
    if ((isPeak || (!targetsError && isValley)) && !this->isSure(energy))
    {
      this->addUnit(pilot, units[u], glint);
    }
  }
}

/// True if, by a bound of its standard error, it is sure whether this energy, J, exceeds Qlow.
bool RayBudget::isSure(double energy) const
{
  // Sums of squares of rays, or of differences of two, and twice that of the largest.
  const double most = this->LargestOfPilot;
  return std::abs(energy - this->Setup.sensor.lowerEnergyLimit) >=
    Sure * std::sqrt(most * (energy + 2.0 * most));
}

/// What a unit wants.
void RayBudget::addUnit(const PrimaryHits& pilot, const RangeUnit& unit, double glint)
{
  StandardErrorEstimator& error = this->Samplers.of(pilot.rays).error;
  error.clear();
  this->TargetEnergies.assign(pilot.extraRays, 0.0);
  const RangeShares shares = this->Units.sharesOf(unit.index, unit.index + 1);
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::uint32_t ray = pilot.ray[shares.contribution(s)];
    if (ray < pilot.rays)
    {
      error.add(ray, shares.energies[s]);
    }
    else
    {
      this->TargetEnergies[ray - pilot.rays] += shares.energies[s];
    }
  }
  const bool plane = pilot.onOnePlane();
  const double least = plane ? error.smallest() : 0.0;
  const double unseen = error.estimate({ least, error.largest(), 0.0 });
  double parts = unseen > 0.0 || glint > 0.0 ? 1.0 : 0.0;
  double variance = unseen * unseen + glint * glint;
  this->ErrorsOfTargets.clear();
  const std::uint32_t perTarget = this->RaysOfPilotTarget;
  for (std::size_t first = 0; first < this->TargetEnergies.size(); first += perTarget)
  {
    const double part = varianceOfPairs(this->TargetEnergies.data() + first, perTarget);
    this->ErrorsOfTargets.push_back(std::sqrt(part));
    variance += part;
    parts += part > 0.0 ? 1.0 : 0.0;
  }
  const double allowed =
    this->allowedError(unit.energy, std::sqrt(variance)) / std::sqrt(std::max(1.0, parts));
  if (!(allowed > 0.0))
  {
    return; // below all numbers: no number of rays would do
  }
  const double power = this->Setup.settings.sampling == Sampling::MonteCarlo ? 2.0
    : plane                                                                  ? PowerOfPlane
                                                                             : PowerOfEdges;
  this->Wanted = std::max(this->Wanted,
    pilot.rays * std::max(std::pow(unseen / allowed, power), std::pow(glint / allowed, 2.0)));
  for (std::size_t g = 0; g < this->ErrorsOfTargets.size(); ++g)
  {
    this->WantedOfTargets[g] = std::max(this->WantedOfTargets[g],
      perTarget * std::pow(this->ErrorsOfTargets[g] / allowed, PowerOfEdges));
  }
}

/// The standard error, J, that a unit of this energy may have, of which the pilot's is known.
double RayBudget::allowedError(double energy, double error) const
{
  const double limit = this->Setup.sensor.lowerEnergyLimit;
  const double target = this->Setup.settings.targetRelativeError;
  if (target > 0.0)
  {
    return std::max(target * std::max(energy, Near * limit), (limit - energy) / Sure);
  }
  const double distance = std::abs(limit - energy);
  return Sure * error <= distance ? std::numeric_limits<double>::infinity()
                                  : std::max(FinestDistance * limit, distance) / Resampled;
}

/// So that what the pilot missed is not perceived because one ray meets it.
double RayBudget::raysForTheUnseen(double reflectance) const
{
  const double limit = this->Setup.sensor.lowerEnergyLimit;
  const double usual = this->Setup.settings.raysPerBeam;
  const double energy = this->Setup.sensor.pulseEnergy * reflectance * RaysToBePerceived;
  return energy < usual * limit ? energy / limit : usual;
}
}
