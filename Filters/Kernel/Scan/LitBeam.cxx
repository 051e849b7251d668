// SPDX-License-Identifier: BSD-3-Clause
#include "LitBeam.h"

#include "Hash.h"
#include "MemberCount.h"

#include <algorithm>
#include <vector>

namespace avianlidar
{
void LitBeam::add(const std::vector<LightEcho>& found)
{
  for (const LightEcho& one : found)
  {
    const auto isSame = [&](const LightEcho& known) { return known.units == one.units; };
    if (this->returns.size() < MostReturns &&
      std::none_of(this->returns.begin(), this->returns.end(), isSame))
    {
      this->returns.push_back(one);
    }
  }
}

bool LitBeam::knows(const Received& received) const
{
  const auto isKnown = [&](const Return& ret)
  {
    const UnitsOfReturn wanted = unitsOf(received, ret);
    return !ret.hasLight ||
      std::any_of(this->returns.begin(), this->returns.end(),
        [&](const LightEcho& known) { return known.units == wanted; });
  };
  return std::all_of(received.returns.begin(), received.returns.end(), isKnown) &&
    (!received.strongest || isKnown(*received.strongest));
}

std::uint64_t lightKey(const ScanSetup& setup)
{
  // The key leaves out values that cannot differ. A lit beam belongs to a trace, and thus to a tree
  // (traceKey()). The largest gain and the noise plan act through the needs. Beams that movers
  // touch are not kept. Revolutions differ in noise alone, and noise is not kept.
  static_assert(memberCount<ScanSetup>() == 14 && memberCount<ModelNeeds>() == 7,
    "does a lit beam depend on the new member?");
  const Sensor& sensor = setup.sensor;
  const ModelNeeds& needs = setup.needs;
  std::vector<double> numbers = { setup.largestReflectance, needs.perceivableRange,
    needs.secondaryReflections ? 1.0 : 0.0, needs.secondaryBound, needs.furtherBound,
    needs.lightEnergyBound, needs.skippedEnergyBound, needs.missedDetailEnergy,
    static_cast<double>(sensor.beamProfile), static_cast<double>(sensor.beamOutline),
    static_cast<double>(sensor.receiverModel), static_cast<double>(sensor.pulseShape), sensor.up.x,
    sensor.up.y, sensor.up.z };
  numbers.insert(numbers.end(), sensor.pulseSamples.begin(), sensor.pulseSamples.end());
  for (const SensorField& field : sensorFields())
  {
    numbers.push_back(sensor.*field.member);
  }
  for (const EchoSetting& setting : echoSettings())
  {
    numbers.push_back(setting.get(setup.settings));
  }
  for (const PlacedMedium& one : setup.media) // surfaces shadow the light of a medium
  {
    numbers.push_back(one.medium.extinction);
    numbers.push_back(one.medium.backscatterRatio);
  }
  const std::uint64_t surfaces[] = { setup.materials.checksum(), setup.objectIds.checksum(),
    setup.materialIds.checksum() };
  return hashOf(
    numbers.data(), numbers.size() * sizeof(double), hashOf(surfaces, sizeof(surfaces), 0));
}
}
