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
/// A unit below Qlow stays so many standard errors below it.
constexpr double SurelyFaint = 2.0;

/// Where a pilot met nothing, this many rays of the beam must meet something to be perceived.
constexpr double RaysToBePerceived = 2.0;

/// Echoes below so many Qlow read high by selection, which more rays than this would want do not
/// mend.
constexpr double Near = 2.0;

constexpr double StepOfRays = 1.19;
}

RayBudget::RayBudget(const ScanSetup& setup, BeamSamplers& samplers)
  : Setup(setup)
  , Samplers(samplers)
  , Units(setup.sensor.samplingInterval, setup.sensor.pulseWidth, setup.sensor.rangeGate)
{
}

std::uint32_t RayBudget::raysFor(const PrimaryHits& pilot)
{
  const EchoSettings& settings = this->Setup.settings;
  const double most = std::max(static_cast<double>(MinimumTargetRays),
    std::min(1e6, static_cast<double>(MaximumRayFactor) * settings.raysPerBeam));
  double wanted = MinimumTargetRays;
  if (pilot.size() == 0)
  {
    wanted = this->raysForTheUnseen(this->Setup.largestReflectance);
  }
  else
  {
    const double rayEnergy = this->Setup.sensor.pulseEnergy / pilot.rays;
    this->Light.clear();
    this->Light.reflect(this->Setup, pilot);
    this->Light.attenuate(this->Setup, pilot, this->Light.reflected, rayEnergy);
    this->Units.clear();
    this->Units.add(pilot.range.data(), this->Light.energy.data(), pilot.ray.data(), pilot.size());
    this->Units.accumulate();
    const double glint = rayEnergy * hiddenGlintOf(this->Setup, pilot, this->Light);
    const std::vector<RangeUnit>& units = this->Units.units();
    for (std::size_t u = 0; u < units.size(); ++u)
    {
      const bool risen =
        u == 0 || units[u - 1].index + 1 < units[u].index || units[u - 1].energy <= units[u].energy;
      const bool falls = u + 1 == units.size() || units[u].index + 1 < units[u + 1].index ||
        units[u + 1].energy <= units[u].energy;
      if (risen && falls)
      {
        wanted = std::max(wanted, this->raysForUnit(pilot, units[u], glint));
      }
    }
  }
  double rays = MinimumTargetRays;
  while (rays < wanted && rays < most)
  {
    rays = std::ceil(rays * StepOfRays);
  }
  return static_cast<std::uint32_t>(std::min(rays, most));
}

double RayBudget::raysForUnit(const PrimaryHits& pilot, const RangeUnit& unit, double glint)
{
  StandardErrorEstimator& error = this->Samplers.of(pilot.rays).error;
  error.clear();
  const RangeShares shares = this->Units.sharesOf(unit.index, unit.index + 1);
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    error.add(pilot.ray[shares.contribution(s)], shares.energies[s]);
  }
  const bool plane = pilot.onOnePlane();
  const double least = plane ? error.smallest() : 0.0;
  const double unseen = error.estimate({ least, error.largest(), 0.0 });
  const double limit = this->Setup.sensor.lowerEnergyLimit;
  const double target = this->Setup.settings.targetRelativeError;
  const double allowed =
    std::max(target * std::max(unit.energy, Near * limit), (limit - unit.energy) / SurelyFaint);
  const double power = this->Setup.settings.sampling == Sampling::MonteCarlo ? 2.0
    : plane                                                                  ? 1.0
                                                                             : 4.0 / 3.0;
  return pilot.rays * std::max(std::pow(unseen / allowed, power), std::pow(glint / allowed, 2.0));
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
