// SPDX-License-Identifier: BSD-3-Clause
#include "BeamLight.h"

#include <algorithm>

namespace avianlidar
{
bool BeamLight::isOutsideGate() const
{
  return this->units.units().empty() &&
    (this->units.energyBeyondGate() > 0.0 || this->units.energyBeforeGate() > 0.0) &&
    std::any_of(this->energies.begin(), this->energies.end(), [](double e) { return e > 0.0; });
}

double BeamLight::nearestRange() const
{
  const double nearest = this->samples()->nearest;
  return this->cells ? (1.0 - MostOfRange) * nearest : nearest;
}

void BeamLight::clear(double sky)
{
  this->isPerceivable = this->isIntegrated = false;
  this->seen = this->starts = nullptr;
  this->cells = nullptr;
  this->energies.clear();
  this->means.clear();
  this->leaves = {};
  this->paths.clear();
  this->units.clear();
  this->surfaces.clear();
  this->radiance = sky;
  this->mostOfPaths = 0.0;
  this->lost = 0.0;
  this->skipped = 0;
}
}
