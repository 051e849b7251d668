// SPDX-License-Identifier: BSD-3-Clause
#include "BeamOutcome.h"

#include "PathStrengths.h"

#include <cmath>

namespace avianlidar
{
bool BeamOutcome::holds(const LimitsAndAir& now) const
{
  if (this->echoes > 0)
  {
    return now.attenuation == this->attenuation && this->window.contains(now.lower);
  }
  const double change = now.attenuation - this->attenuation;
  const double least =
    change != 0.0 ? std::exp(-change * (change > 0.0 ? this->longest : this->shortest)) : 1.0;
  const double surest = this->surest * least * SurelyBelow;
  // Nothing is perceived, and where the surest path arrives the report tells.
  return this->loudestIn(now.attenuation) < SurelyBelow * now.lower && surest > LostInUnderflow &&
    surest >= now.pathThreshold;
}

double BeamOutcome::loudestIn(double air) const
{
  const double change = air - this->attenuation;
  const double most =
    change != 0.0 ? std::exp(-change * (change > 0.0 ? this->shortest : this->longest)) : 1.0;
  return (this->loudest + LostInUnderflow) * most * SurelyAbove;
}

namespace
{
std::array<double, 9> valuesOf(const ScanSetup& setup)
{
  const EchoSettings& s = setup.settings;
  return { setup.sensor.pulseEnergy, setup.sensor.pulseWidth, setup.sensor.samplingInterval,
    setup.sensor.rangeGate, static_cast<double>(s.numberOfReflections),
    static_cast<double>(s.numberOfConnections), static_cast<double>(dropsFaintPaths(s)),
    static_cast<double>(setup.needs.secondaryReflections), static_cast<double>(s.returnMode) };
}
}

Circumstances::Circumstances(const ScanSetup& setup)
  : values(valuesOf(setup))
  , objectIds(setup.objectIds)
  , materialIds(setup.materialIds)
{
}

bool Circumstances::areThoseOf(const ScanSetup& setup) const
{
  return this->values == valuesOf(setup) && this->objectIds.sharesWith(setup.objectIds) &&
    this->materialIds.sharesWith(setup.materialIds);
}
}
