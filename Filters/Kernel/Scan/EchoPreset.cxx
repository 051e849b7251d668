// SPDX-License-Identifier: BSD-3-Clause
#include "EchoPreset.h"

#include "ValueError.h"

namespace avianlidar
{
namespace
{
void setFidelity(EchoSettings& s, int rays, double targetError, int reflections, int connections)
{
  s.raysPerBeam = rays;
  s.sampling = Sampling::Stratified;
  s.targetRelativeError = targetError;
  s.numberOfReflections = reflections;
  s.numberOfConnections = connections;
  s.refineNearLimit = false;
}
}

std::string applyPreset(EchoPreset preset, EchoSettings& settings)
{
  switch (preset)
  {
    case EchoPreset::Custom:
      return {};
    case EchoPreset::Draft:
      setFidelity(settings, 100, 0.0, 1, 0);
      return {};
    case EchoPreset::Standard:
      setFidelity(settings, 100, 0.02, 2, 2);
      return {};
    case EchoPreset::Reference:
      setFidelity(settings, 10000, 0.0, 2, 8);
      return {};
  }
  return valueError("Preset", static_cast<int>(preset), "0 (custom) to 3 (reference)");
}
}
