// SPDX-License-Identifier: BSD-3-Clause
#include "LitBeam.h"

#include "Hash.h"
#include "MemberCount.h"

#include <vector>

namespace avianlidar
{
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
    static_cast<double>(sensor.receiverModel), sensor.up.x, sensor.up.y, sensor.up.z };
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
