// SPDX-License-Identifier: BSD-3-Clause
#include "BeamEchoes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
BeamEchoes::BeamEchoes(
  const ScanSetup& setup, BeamLighting& lighting, BeamReceiver& receiver, BeamSamplers& samplers)
  : Setup(setup)
  , Lighting(lighting)
  , Receiver(receiver)
  , Samplers(samplers)
  , Labels(setup)
{
}

void BeamEchoes::receive(std::uint64_t beam, std::vector<Echo>& echoes, BeamReport& report)
{
  this->Receiver.receive(beam, this->Lighting.units());
  for (const Return& ret : this->Receiver.returns())
  {
    echoes.push_back(this->makeEcho(ret));
  }
  if (const Return* strongest = this->Receiver.strongest())
  {
    report.range = strongest->range;
  }
  report.status = this->statusOf();
}

Echo BeamEchoes::makeEcho(const Return& ret)
{
  Echo echo;
  echo.range = ret.range;
  echo.energyReceived = ret.energyReceived;
  echo.energy = ret.energy;
  echo.returnEnergy = ret.returnEnergy;
  echo.returnNumber = ret.returnNumber;
  echo.numberOfReturns = ret.numberOfReturns;
  const auto& units = this->Receiver.units();
  this->Labels.label(
    this->Lighting.units().sharesOf(units[ret.firstUnit].index, units[ret.lastUnit - 1].index + 1),
    this->Lighting.hits(), this->Lighting.paths(), echo);
  echo.energyStdError = this->standardError(units[ret.strongestUnit]);
  return echo;
}

/// Of the return's strongest unit.
double BeamEchoes::standardError(const ReceivedUnit& unit)
{
  if (unit.paths == 0)
  {
    return 0.0; // a false alarm: no ray had a part in it
  }
  const PrimaryHits& hits = *this->Lighting.hits();
  const RangeShares shares = this->Lighting.units().sharesOf(unit.index, unit.index + 1);
  if (this->Lighting.isIntegrated())
  {
    return this->Lighting.boundOf(shares);
  }
  const std::size_t ordinary = hits.ordinary();
  StandardErrorEstimator& error = this->Samplers.of(hits.rays).error;
  this->TargetEnergies.assign(hits.extraRays, 0.0);
  const auto add = [&](std::size_t hit, double energy)
  {
    const std::uint32_t ray = hits.ray[hit];
    if (ray < hits.rays)
    {
      error.add(ray, energy);
    }
    else
    {
      this->TargetEnergies[ray - hits.rays] += energy;
    }
  };
  std::size_t s = 0;
  if (shares.which)
  {
    error.clear();
  }
  else
  {
    error.begin(hits.ray.data(), shares.energies, ordinary);
    s = ordinary;
  }
  for (; s < shares.count; ++s)
  {
    const std::size_t contribution = shares.contribution(s);
    if (contribution < hits.size())
    {
      add(contribution, shares.energies[s]);
      continue;
    }
    // A connection depends on both its rays.
    const SecondaryPath& path = this->Lighting.paths()[contribution - hits.size()];
    add(path.one, shares.energies[s]);
    if (path.two != NoHit)
    {
      add(path.two, shares.energies[s]);
    }
  }
  const double least = this->fillsWindow(unit) ? error.smallest() : 0.0;
  const double others = error.estimate({ least, error.largest(), this->Lighting.hiddenGlint() });
  return hits.extraRays == 0 ? others : std::sqrt(others * others + this->varianceOfTargets());
}

/// Of what the rays of small targets put into the unit.
double BeamEchoes::varianceOfTargets() const
{
  double variance = 0.0;
  const double* energies = this->TargetEnergies.data();
  for (const std::uint32_t rays : *this->Lighting.targets())
  {
    variance += varianceOfPairs(energies, rays);
    energies += rays;
  }
  return variance;
}

/// True if one plane fills the window of the range unit: every ray hit it, and put energy here.
bool BeamEchoes::fillsWindow(const ReceivedUnit& unit) const
{
  return unit.paths >= this->Lighting.hits()->rays && this->Lighting.hits()->onOnePlane();
}

BeamStatus BeamEchoes::statusOfEcho(double energyReceived) const
{
  return energyReceived >= this->Setup.sensor.upperEnergyLimit ? BeamStatus::Saturated
                                                               : BeamStatus::Echo;
}

/// Direct echoes tell what lies outside the gate: of the paths over two reflections it depends on
/// how well the beam is known whether they are looked at.
BeamStatus BeamEchoes::statusOf() const
{
  // Before the choice of the return mode: it says what is shown, not what the receiver heard.
  if (const Return* strongest = this->Receiver.strongest())
  {
    return this->statusOfEcho(strongest->energyReceived);
  }
  if (!this->Lighting.hits())
  {
    return this->Lighting.isIntegrated() ? BeamStatus::BelowLimit : BeamStatus::NoSurface;
  }
  const std::vector<double>& direct = this->Lighting.directEnergies();
  const bool beyond = this->Lighting.units().units().empty() &&
    this->Lighting.units().energyBeyondGate() > 0.0 &&
    std::any_of(direct.begin(), direct.end(), [](double energy) { return energy > 0.0; });
  return beyond ? BeamStatus::OutsideGate : BeamStatus::BelowLimit;
}
}
