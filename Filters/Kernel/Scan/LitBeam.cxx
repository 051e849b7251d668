// SPDX-License-Identifier: BSD-3-Clause
#include "LitBeam.h"

#include "Hash.h"
#include "MemberCount.h"

#include <vector>

namespace avianlidar
{
bool takeOver(LightKey& key, const ScanSetup& setup)
{
  // A new member of one of the two does not compile until it is named here. A lit beam belongs to a
  // trace, so to its tree (traceKey()). Largest gain and noise plan decide what the needs say.
  // Beams that movers touch are not kept, and revolutions differ by noise alone, which is not kept
  // either.
  [[maybe_unused]] const auto& [tree, materials, objectIds, materialIds, largestReflectance,
    largestGain, movers, sensor, settings, noisePlan, revolution, needs] = setup;
  const auto& [range, secondary, bound, further, faint, skipped, missed] = needs;
  static_assert(memberCount<ModelNeeds>() == 7, "every member counts");
  std::vector<double> numbers = { largestReflectance, range, secondary ? 1.0 : 0.0, bound, further,
    faint, skipped, missed, static_cast<double>(sensor.beamProfile),
    static_cast<double>(sensor.receiverModel) };
  for (const SensorField& field : sensorFields())
  {
    numbers.push_back(sensor.*field.member);
  }
  for (const EchoSetting& setting : echoSettings())
  {
    numbers.push_back(setting.get(settings));
  }
  const std::uint64_t now = hashOf(numbers.data(), numbers.size() * sizeof(double), 0);
  const bool same = key.numbers == now && key.materials.sharesWith(materials) &&
    key.objectIds.sharesWith(objectIds) && key.materialIds.sharesWith(materialIds);
  key = { materials, objectIds, materialIds, now };
  return same;
}
}
