// SPDX-License-Identifier: BSD-3-Clause
#include "LitBeam.h"

#include "Hash.h"
#include "MemberCount.h"

#include <iterator>

namespace avianlidar
{
void LightKey::follow(const ScanSetup& setup)
{
  // A new member of one of the four does not compile until it is named here. A lit beam belongs to
  // a trace, so to its tree (traceKey()). Largest gain and noise plan decide what the needs say.
  // Beams that movers touch are not kept, and revolutions differ by noise alone, which is not kept
  // either.
  [[maybe_unused]] const auto& [tree, materials, objectIds, materialIds, largestReflectance,
    largestGain, movers, sensorOf, settingsOf, noisePlan, revolution, needsOf] = setup;
  const auto& [width, profile, energy, pulse, frequency, interval, gate, photons, lower, upper,
    aperture, receiver, efficiency, filter, radiance, amplifier, excess] = setup.sensor;
  const auto& [source, rays, sampling, seed, air, model, reflections, beam, light, fraction,
    threshold, mode, noise, fullModel, returns, connections] = setup.settings;
  const auto& [range, secondary, bound, further, faint, skipped, missed] = setup.needs;
  const auto number = [](auto value) { return static_cast<double>(value); };
  const double numbers[] = { largestReflectance, width, number(profile), energy, pulse, frequency,
    interval, gate, photons, lower, upper, aperture, number(receiver), efficiency, filter, radiance,
    amplifier, excess, number(source), number(rays), number(sampling), number(seed), air,
    number(model), number(reflections), number(beam), number(light), fraction, number(threshold),
    number(mode), number(noise), number(fullModel), number(returns), number(connections), range,
    number(secondary), bound, further, faint, skipped, missed };
  static_assert(std::size(numbers) ==
      1 + memberCount<Sensor>() + memberCount<EchoSettings>() + memberCount<ModelNeeds>(),
    "every member of the three counts");
  const std::uint64_t now = hashOf(numbers, sizeof(numbers), 0);
  if (this->number == 0 || this->settings != now || !this->materials.sharesWith(setup.materials) ||
    !this->objectIds.sharesWith(setup.objectIds) ||
    !this->materialIds.sharesWith(setup.materialIds))
  {
    *this = { setup.materials, setup.objectIds, setup.materialIds, now, this->number + 1 };
  }
}
}
