// SPDX-License-Identifier: BSD-3-Clause
#include "BeamEchoes.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// Include the light of leaves in the range and the label of an echo.
void addLeaves(const Return& ret, Echo& echo)
{
  const double share = std::clamp(ret.leaves / ret.returnEnergy, 0.0, 1.0);
  if (ret.hasLight)
  {
    echo.range += share * (ret.rangeOfLeaves - echo.range);
    echo.labelShare *= 1.0 - share;
  }
  if (share > (ret.hasLight ? echo.labelShare : 0.5))
  {
    echo.objectId = ret.medium;
    echo.materialId = -1;
    echo.labelShare = share;
  }
}

/// The entry of a return with light, which must exist. Returns mostly come in the order of the
/// entries. @param place where to begin, set to the place behind the entry
const Echo& find(
  const std::vector<LightEcho>& ofLight, const UnitsOfReturn& units, std::size_t& place)
{
  for (place %= ofLight.size(); !(ofLight[place].units == units);)
  {
    place = (place + 1) % ofLight.size();
  }
  return ofLight[place++].echo;
}

/// The return that BeamReport names, unless it is one of the beam's selected returns.
const Return* strongestBeside(const Received& received)
{
  const auto isStrongest = [&](const Return& ret)
  { return ret.returnNumber == received.strongest->returnNumber; };
  return received.strongest &&
      std::none_of(received.returns.begin(), received.returns.end(), isStrongest)
    ? &*received.strongest
    : nullptr;
}
}

UnitsOfReturn unitsOf(const Received& received, const Return& ret)
{
  const std::vector<ReceivedUnit>& units = received.units;
  return { units[ret.firstUnit].index, units[ret.lastUnit - 1].index,
    units[ret.strongestUnit].index };
}

BeamEchoes::BeamEchoes(const ScanSetup& setup, StandardErrorEstimator& ofRays)
  : Setup(setup)
  , Ranges(setup.sensor, setup.settings.returnMode)
  , Labels(setup)
  , Errors(setup, ofRays)
{
}

std::vector<LightEcho> BeamEchoes::ofLight(const Received& received, const BeamLight& light)
{
  std::vector<LightEcho> found;
  const auto add = [&](const Return& ret)
  {
    if (!ret.hasLight)
    {
      return;
    }
    const UnitsOfReturn units = unitsOf(received, ret);
    const RangeShares shares = this->Shares.sharesOf(units.first, units.last + 1);
    Echo echo;
    echo.range = this->Ranges.of(received, ret, shares, light.units.pathLengths());
    this->Labels.label(light, shares, echo);
    echo.energyStdError =
      this->Errors.of(light, this->Shares.sharesOf(units.strongest, units.strongest + 1),
        received.units[ret.strongestUnit].paths);
    found.push_back({ units, echo });
  };
  this->Shares.begin(light.units);
  for (const Return& ret : received.returns)
  {
    add(ret);
  }
  if (const Return* const strongest = strongestBeside(received))
  {
    add(*strongest);
  }
  this->Shares.end();
  return found;
}

/// @param place place in `ofLight` where to begin to search, changed
Echo BeamEchoes::echoOf(const Received& received, const Return& ret, std::size_t& place,
  const std::vector<LightEcho>& ofLight) const
{
  Echo echo;
  echo.incidenceAngle = std::numeric_limits<double>::quiet_NaN();
  echo.range = ret.range;
  if (ret.hasLight)
  {
    echo = find(ofLight, unitsOf(received, ret), place);
  }
  if (ret.leaves > 0.0)
  {
    addLeaves(ret, echo);
  }
  if (!ret.hasLight && ret.air > std::max(0.5 * ret.returnEnergy, ret.leaves))
  {
    echo.objectId = ObjectOfAir;
    echo.labelShare = std::min(1.0, ret.air / ret.returnEnergy);
  }
  echo.range = this->Ranges.reported(ret, echo.range);
  echo.background = received.radiance;
  echo.energyReceived = ret.energyReceived;
  echo.energy = ret.energy;
  echo.returnEnergy = ret.returnEnergy;
  echo.returnNumber = ret.returnNumber;
  echo.numberOfReturns = ret.numberOfReturns;
  return echo;
}

BeamEchoes::Report BeamEchoes::add(const Received& received, const std::vector<LightEcho>& ofLight,
  bool meets, bool outsideGate, std::vector<Echo>& echoes) const
{
  // The return mode selects what is shown, not what is received.
  const std::optional<Return>& strongest = received.strongest;
  if (!strongest)
  {
    const BeamStatus status = !meets ? BeamStatus::NoSurface
      : outsideGate                  ? BeamStatus::OutsideGate
                                     : BeamStatus::BelowLimit;
    return { status, std::numeric_limits<double>::quiet_NaN() };
  }
  std::size_t place = 0;
  double range = 0.0;
  for (const Return& ret : received.returns)
  {
    echoes.push_back(this->echoOf(received, ret, place, ofLight));
    range = ret.returnNumber == strongest->returnNumber ? echoes.back().range : range;
  }
  if (const Return* const beside = strongestBeside(received))
  {
    range = this->echoOf(received, *beside, place, ofLight).range;
  }
  return { strongest->energyReceived >= this->Setup.sensor.upperEnergyLimit ? BeamStatus::Saturated
                                                                            : BeamStatus::Echo,
    range };
}
}
