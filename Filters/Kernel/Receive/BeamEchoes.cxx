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

LitBeam::KnownReturn unitsOf(const Received& received, const Return& ret)
{
  const std::vector<ReceivedUnit>& units = received.units;
  return { units[ret.firstUnit].index, units[ret.lastUnit - 1].index,
    units[ret.strongestUnit].index, {} };
}

/// The known values of a return; null if there are no known values.
const LitBeam::KnownReturn* find(const LitBeam& known, const Received& received, const Return& ret)
{
  const LitBeam::KnownReturn wanted = unitsOf(received, ret);
  const auto found = std::find_if(known.returns.begin(), known.returns.end(),
    [&](const LitBeam::KnownReturn& one)
    {
      return one.first == wanted.first && one.last == wanted.last &&
        one.strongest == wanted.strongest;
    });
  return found == known.returns.end() ? nullptr : &*found;
}
}

BeamEchoes::BeamEchoes(
  const ScanSetup& setup, BeamReceiver& receiver, StandardErrorEstimator& ofRays)
  : Setup(setup)
  , Receiver(receiver)
  , Labels(setup)
  , Errors(setup, ofRays)
{
}

BeamEchoes::Report BeamEchoes::add(
  const Received& received, const BeamLight& light, LitBeam* keep, std::vector<Echo>& echoes)
{
  this->Shares.begin(light.units);
  const auto echoOf = [&](const Return& ret)
  {
    LitBeam::KnownReturn known = unitsOf(received, ret);
    known.echo = this->echoOfLight(received, light, ret);
    if (keep && keep->returns.size() < LitBeam::MostReturns && !find(*keep, received, ret))
    {
      keep->returns.push_back(known);
    }
    return known.echo;
  };
  const Report report =
    this->finish(received, echoOf, light.isOutsideGate(), light.samples() != nullptr, echoes);
  this->Shares.end();
  return report;
}

std::optional<BeamEchoes::Report> BeamEchoes::addKnown(
  const Received& received, const LitBeam& known, std::vector<Echo>& echoes)
{
  const auto isKnown = [&](const Return& ret)
  { return !ret.hasLight || find(known, received, ret); };
  if (!std::all_of(received.returns.begin(), received.returns.end(), isKnown) ||
    (received.strongest && !isKnown(*received.strongest)))
  {
    return {};
  }
  return this->finish(
    received, [&](const Return& ret) { return find(known, received, ret)->echo; },
    known.outsideGate, true, echoes);
}

/// Make echoes of the returns. @param echoOf gives the part of an echo that follows from light
/// @param outsideGate see BeamLight::isOutsideGate(). The value follows from direct echoes
/// alone, as the cache may change which paths with two reflections are traced. @param meets true if
/// the beam meets a surface
template <class F>
BeamEchoes::Report BeamEchoes::finish(
  const Received& received, F echoOf, bool outsideGate, bool meets, std::vector<Echo>& echoes)
{
  const auto make = [&](const Return& ret)
  {
    Echo echo;
    echo.incidenceAngle = std::numeric_limits<double>::quiet_NaN();
    echo.range = ret.range;
    if (ret.hasLight)
    {
      echo = echoOf(ret);
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
    echo.range = this->Receiver.measured(received, ret, echo.range);
    echo.background = received.radiance;
    echo.energyReceived = ret.energyReceived;
    echo.energy = ret.energy;
    echo.returnEnergy = ret.returnEnergy;
    echo.returnNumber = ret.returnNumber;
    echo.numberOfReturns = ret.numberOfReturns;
    return echo;
  };
  for (const Return& ret : received.returns)
  {
    echoes.push_back(make(ret));
  }
  // The return mode selects what is shown, not what is received.
  const std::optional<Return>& strongest = received.strongest;
  if (!strongest)
  {
    const BeamStatus status = !meets ? BeamStatus::NoSurface
      : outsideGate                  ? BeamStatus::OutsideGate
                                     : BeamStatus::BelowLimit;
    return { status, std::numeric_limits<double>::quiet_NaN() };
  }
  const auto same = std::find_if(echoes.end() - received.returns.size(), echoes.end(),
    [&](const Echo& echo) { return echo.returnNumber == strongest->returnNumber; });
  return { strongest->energyReceived >= this->Setup.sensor.upperEnergyLimit ? BeamStatus::Saturated
                                                                            : BeamStatus::Echo,
    same != echoes.end() ? same->range : make(*strongest).range };
}

/// The part of an echo that follows from light alone.
Echo BeamEchoes::echoOfLight(const Received& received, const BeamLight& light, const Return& ret)
{
  const std::vector<ReceivedUnit>& units = received.units;
  const RangeShares shares =
    this->Shares.sharesOf(units[ret.firstUnit].index, units[ret.lastUnit - 1].index + 1);
  Echo echo;
  echo.range = this->Receiver.rangeOf(received, ret, shares, light.units.pathLengths());
  this->Labels.label(light, shares, echo);
  const ReceivedUnit& strongest = units[ret.strongestUnit];
  echo.energyStdError = this->Errors.of(
    light, this->Shares.sharesOf(strongest.index, strongest.index + 1), strongest.paths);
  return echo;
}
}
