// SPDX-License-Identifier: BSD-3-Clause
#include "ScanSetup.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Probability of a miss for ModelNeeds::missedDetailEnergy.
constexpr double MissProbability = 0.05;

double perceivableRange(const ScanSetup& setup)
{
  const double limit = setup.sensor.lowerEnergyLimit;
  const auto isPerceivable = [&](double range)
  {
    return setup.sensor.pulseEnergy * returnBound(setup, range) *
      transmission(setup.attenuation(), 2.0 * range) * SurelyAbove >
      limit;
  };
  double near = 1e-3;
  if (!isPerceivable(near))
  {
    return 0.0;
  }
  double far = near;
  for (; isPerceivable(far); far *= 2.0)
  {
    if (far > 1e12)
    {
      return Infinity;
    }
    near = far;
  }
  for (int i = 0; i < 60; ++i)
  {
    const double middle = 0.5 * (near + far);
    (isPerceivable(middle) ? near : far) = middle;
  }
  return far;
}

/// returnBound() at any range.
double returnBoundAnyRange(const ScanSetup& setup)
{
  // Near the lidar, an aperture gathers all reflected light.
  const bool gathers = setup.sensor.receiverAperture > 0.0 && setup.largestReflectance > 0.0;
  return gathers ? 1.0 : setup.largestReflectance;
}

}

double partsOfUnit(const ScanSetup& setup)
{
  const Sensor& sensor = setup.sensor;
  const ReceivedPulse pulse(sensor, sensor.samplingInterval);
  if (pulse.isRectangle())
  {
    return 1.0;
  }
  // The light of a part arrives as if from its middle. With four parts in the full width of a
  // Gaussian, a surface as long as a part errs by 1.4 % at the peak, and longer surfaces err less.
  constexpr double partsOfWidth = 4.0;
  constexpr double most = 64.0;
  double detail = std::hypot(
    sensor.pulseShape == PulseShape::Gaussian ? sensor.pulseWidth : 0.0, sensor.responseTime);
  for (std::size_t i = 2;
       sensor.pulseShape == PulseShape::Samples && i < sensor.pulseSamples.size(); i += 2)
  {
    detail = std::max(detail, sensor.pulseSamples[i] - sensor.pulseSamples[i - 2]);
  }
  return std::clamp(std::ceil(partsOfWidth * sensor.samplingInterval / detail), 1.0, most);
}

double partsForSamples(const ScanSetup& setup)
{
  const double samples = setup.sensor.samplesOfUnit();
  return std::ceil(partsOfUnit(setup) / samples) * samples;
}

double returnBound(const ScanSetup& setup, double range)
{
  const double aperture = setup.sensor.receiverAperture;
  return aperture > 0.0 ? std::min(1.0, setup.largestGain * aperture / (range * range))
                        : setup.largestReflectance;
}

bool dropsFaintPaths(const EchoSettings& settings)
{
  return settings.lightEnergyConstraint && !settings.fullModel;
}

double limitOfPath(const ScanSetup& setup)
{
  const double limit = setup.sensor.lowerEnergyLimit;
  switch (setup.settings.lightEnergyThreshold)
  {
    case LightEnergyThreshold::Limit:
      return limit;
    case LightEnergyThreshold::LimitPerRay:
      return limit / setup.settings.raysPerBeam;
    default:
      return 0.0;
  }
}

double lightEnergyTolerance(const ScanSetup& setup)
{
  return setup.settings.lightEnergyThreshold == LightEnergyThreshold::ShareOfLimit
    ? setup.settings.lightEnergyFraction * setup.sensor.lowerEnergyLimit
    : 0.0;
}

ModelNeeds needsOf(const ScanSetup& setup)
{
  const EchoSettings& settings = setup.settings;
  const bool drops = dropsFaintPaths(settings);
  const double once = returnBoundAnyRange(setup);
  ModelNeeds needs;
  needs.perceivableRange = perceivableRange(setup);
  needs.secondaryBound = setup.sensor.pulseEnergy * setup.largestReflectance * once * SurelyAbove;
  // On longer paths, `numberOfReflections` surfaces reflect the light before the last surface. Of
  // the paths with three reflections, only those over one mirror are modelled.
  needs.furtherBound = setup.sensor.pulseEnergy *
    std::pow(setup.largestReflectance, std::min(settings.numberOfReflections, 2)) * once *
    SurelyAbove;
  // Direct echoes may lose the other half of the tolerance.
  const double least = limitOfPath(setup) + 0.5 * lightEnergyTolerance(setup);
  needs.secondaryReflections =
    settings.numberOfReflections > 1 && !(drops && needs.secondaryBound < least);
  if (drops)
  {
    needs.lightEnergyBound = settings.lightEnergyThreshold == LightEnergyThreshold::ShareOfLimit
      ? lightEnergyTolerance(setup)
      : (settings.numberOfReflections > 1 ? needs.secondaryBound : 0.0);
  }
  needs.skippedEnergyBound =
    needs.lightEnergyBound + (setup.noise.active ? 0.0 : setup.noise.bound);
  const double rays = settings.beamSamples == BeamSampleSource::Cells
    ? densityOfCells(settings.raysPerBeam).rays()
    : settings.raysPerBeam;
  // Stratified rays do not miss an object with a greater probability than independent rays.
  needs.missedDetailEnergy =
    setup.sensor.pulseEnergy * once * -std::expm1(std::log(MissProbability) / rays);
  return needs;
}

void includeMovers(ScanSetup& setup)
{
  setup.firstTriangles.clear();
  if (!setup.movers)
  {
    return;
  }
  auto next = static_cast<std::uint32_t>(setup.materials.size());
  for (const Mover& mover : *setup.movers)
  {
    setup.firstTriangles.push_back(next);
    next += static_cast<std::uint32_t>(mover.mesh.size());
    for (const Material& material : mover.materials)
    {
      setup.largestReflectance = std::max(setup.largestReflectance, material.albedo());
      setup.largestGain = std::max(setup.largestGain, apertureGain(material));
    }
  }
}

void planModel(ScanSetup& setup)
{
  setup.noise = planNoise(setup.sensor, setup.settings.noise, setup.settings.fullModel);
  setup.noise.ofRanges =
    setup.noise.ofRanges && setup.settings.returnMode != ReturnMode::RangeUnits;
  setup.needs = needsOf(setup);
}
}
