// SPDX-License-Identifier: BSD-3-Clause
#include "BeamEchoes.h"

namespace avianlidar
{
BeamEchoes::BeamEchoes(const ScanSetup& setup, BeamLighting& lighting, BeamReceiver& receiver)
  : Setup(setup)
  , Lighting(lighting)
  , Receiver(receiver)
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
    this->Lighting.samples(), this->Lighting.paths(), echo);
  const ReceivedUnit& strongest = units[ret.strongestUnit];
  echo.energyStdError = this->Lighting.errorOf(strongest.index, strongest.paths);
  return echo;
}

/// Direct echoes tell what lies outside the gate: of the paths over two reflections it depends on
/// how well the beam is known whether they are looked at.
BeamStatus BeamEchoes::statusOf() const
{
  // Before the choice of the return mode: it says what is shown, not what the receiver heard.
  if (const Return* strongest = this->Receiver.strongest())
  {
    return strongest->energyReceived >= this->Setup.sensor.upperEnergyLimit ? BeamStatus::Saturated
                                                                            : BeamStatus::Echo;
  }
  if (!this->Lighting.samples())
  {
    return BeamStatus::NoSurface;
  }
  return this->Lighting.isBeyondGate() ? BeamStatus::OutsideGate : BeamStatus::BelowLimit;
}
}
