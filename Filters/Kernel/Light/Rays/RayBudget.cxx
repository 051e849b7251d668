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

/// Least distance from Qlow, as a share of it, that more rays are spent on.
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
  , Units(setup.sensor.samplingInterval, setup.sensor.pulseWidth, setup.sensor.rangeGate)
  , Error(samplers)
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
bool meetsOthers(const BeamSamples& pilot)
{
  for (std::size_t i = 0; i < pilot.size(); ++i)
  {
    if (pilot.ray[i] < pilot.rays && pilot.weight[i] > 0.0)
    {
      return true;
    }
  }
  return false;
}
}

std::uint32_t RayBudget::raysFor(const BeamSamples& pilot, TargetRays& ofTargets)
{
  const EchoSettings& settings = this->Setup.settings;
  const bool targetsError = settings.targetRelativeError > 0.0;
  const double least = targetsError ? MinimumTargetRays : pilot.rays;
  const std::uint32_t ofTarget = targetsError ? PilotRays : RaysOfTarget;
  this->Wanted = least;
  this->OfPilot.assign(pilot.extraRays / ofTarget, ofTarget);
  this->WantedOfTargets.assign(this->OfPilot.size(), RaysOfTarget);
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

/// Rays needed by the units in which the direct echoes of the pilot arrive.
void RayBudget::addUnits(const BeamSamples& pilot)
{
  const double pulseEnergy = this->Setup.sensor.pulseEnergy;
  const double limit = this->Setup.sensor.lowerEnergyLimit;
  const bool targetsError = this->Setup.settings.targetRelativeError > 0.0;
  this->Light.measure(this->Setup, pilot);
  const double sum = directEnergies(this->Setup, pilot, this->Light, this->Energies);
  const double glint = pulseEnergy / pilot.rays * hiddenGlintOf(this->Setup, pilot);
  const bool mayBeSure = !targetsError && glint == 0.0 && pilot.extraRays == 0;
  this->LargestOfPilot = mayBeSure ? *std::max_element(this->Energies.begin(), this->Energies.end())
                                   : std::numeric_limits<double>::infinity();
  if (sum < limit && this->isSure(sum))
  {
    return;
  }
  this->Units.clear();
  this->Units.add(pilot.range.data(), this->Energies.data(), pilot.size());
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

/// True if, by a bound of its standard error, it is certain whether this energy, J, exceeds Qlow.
bool RayBudget::isSure(double energy) const
{
  // Sums of squares of rays, or of differences of two, and twice that of the largest.
  const double most = this->LargestOfPilot;
  return std::abs(energy - this->Setup.sensor.lowerEnergyLimit) >=
    Sure * std::sqrt(most * (energy + 2.0 * most));
}

/// Rays needed by a unit.
void RayBudget::addUnit(const BeamSamples& pilot, const RangeUnit& unit, double glint)
{
  this->Error.gather(pilot, {}, this->Units.sharesOf(unit.index, unit.index + 1), this->OfPilot);
  const bool plane = pilot.onOnePlane();
  const double unseen = this->Error.ofRays(plane, 0.0);
  double parts = unseen > 0.0 || glint > 0.0 ? 1.0 : 0.0;
  double variance = unseen * unseen + glint * glint;
  for (const double part : this->Error.ofTargets())
  {
    variance += part * part;
    parts += part > 0.0 ? 1.0 : 0.0;
  }
  const double allowed =
    this->allowedError(unit.energy, std::sqrt(variance)) / std::sqrt(std::max(1.0, parts));
  if (!(allowed > 0.0))
  {
    return; // underflow: no number of rays suffices
  }
  const double power = this->Setup.settings.sampling == Sampling::MonteCarlo ? 2.0
    : plane                                                                  ? PowerOfPlane
                                                                             : PowerOfEdges;
  this->Wanted = std::max(this->Wanted,
    pilot.rays * std::max(std::pow(unseen / allowed, power), std::pow(glint / allowed, 2.0)));
  const std::vector<double>& ofTargets = this->Error.ofTargets();
  for (std::size_t g = 0; g < ofTargets.size(); ++g)
  {
    this->WantedOfTargets[g] = std::max(
      this->WantedOfTargets[g], this->OfPilot[g] * std::pow(ofTargets[g] / allowed, PowerOfEdges));
  }
}

/// Allowed standard error, J, of a unit with this energy and standard error in the pilot.
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

/// Rays needed so that an object that the pilot missed is not perceived because one ray meets it.
double RayBudget::raysForTheUnseen(double reflectance) const
{
  const double limit = this->Setup.sensor.lowerEnergyLimit;
  const double usual = this->Setup.settings.raysPerBeam;
  const double energy = this->Setup.sensor.pulseEnergy * reflectance * RaysToBePerceived;
  return energy < usual * limit ? energy / limit : usual;
}
}
