// SPDX-License-Identifier: BSD-3-Clause
#include "EchoSettings.h"

#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace avianlidar
{
namespace
{
/// The standard error of fewer is not known (StandardError.h).
constexpr int FewestRaysRefined = 8;

template <class E>
bool outside(E value, int last)
{
  return static_cast<int>(value) < 0 || static_cast<int>(value) > last;
}

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

bool refinesNearLimit(const EchoSettings& settings)
{
  return settings.refineNearLimit && settings.targetRelativeError <= 0.0 &&
    settings.raysPerBeam >= FewestRaysRefined && settings.raysPerBeam < MostRaysNearLimit;
}

std::uint32_t mostRaysOfABeam(const EchoSettings& s)
{
  const std::int64_t usual = s.raysPerBeam;
  const std::int64_t more = MaximumRayFactor * usual;
  if (s.targetRelativeError > 0.0)
  {
    return static_cast<std::uint32_t>(
      std::max<std::int64_t>(MinimumTargetRays, std::min<std::int64_t>(1000000, more)));
  }
  return static_cast<std::uint32_t>(
    refinesNearLimit(s) ? std::min<std::int64_t>(MostRaysNearLimit, more) : usual);
}

std::uint32_t mostRaysOfATarget(const EchoSettings& s)
{
  return s.targetRelativeError > 0.0 || refinesNearLimit(s) ? MostRaysOfTarget : RaysOfTarget;
}

double mostPathsOfABeam(const EchoSettings& s)
{
  const double rays = mostRaysOfABeam(s);
  const double connections =
    s.numberOfReflections > 1 ? std::min<double>(s.numberOfConnections, rays - 1.0) : 0.0;
  // Rays of targets have a direct echo and a mirror path, and are not connected.
  const double ofTargets = s.smallTargets ? 2.0 * MaximumTargets * mostRaysOfATarget(s) : 0.0;
  return rays * (2.0 + connections) + ofTargets;
}

std::string checkUnits(const Sensor& sensor, const EchoSettings& settings)
{
  const double inGate = 2.0 * sensor.rangeGate / (SpeedOfLight * sensor.samplingInterval);
  const double reached =
    mostPathsOfABeam(settings) * (2.0 + sensor.pulseWidth / sensor.samplingInterval);
  if (std::min(inGate, reached) > MaximumUnitsPerBeam)
  {
    const std::string expected = "so few sampling intervals, or RaysPerBeam (it is " +
      std::to_string(settings.raysPerBeam) +
      ") so small, that the paths of a beam meet at most 1e8 range units of the gate";
    return valueError("pulse_width", sensor.pulseWidth, expected.c_str());
  }
  return {};
}

std::size_t mostTrianglesIntegrated(const EchoSettings& settings)
{
  const double rays = settings.raysPerBeam;
  const double most = std::clamp(TrianglesPerRay * rays, FewTriangles, ManyTriangles);
  // With a target error N only bounds the rays of a beam.
  const bool few = settings.targetRelativeError <= 0.0 && rays < most;
  return settings.planeIntegration ? static_cast<std::size_t>(few ? rays : most) : 0;
}

std::string checkSettings(const EchoSettings& s)
{
  if (s.raysPerBeam < 1 || s.raysPerBeam > 1000000)
  {
    return valueError("RaysPerBeam", s.raysPerBeam, "1 to 1000000");
  }
  if (outside(s.sampling, 1))
  {
    return valueError(
      "Sampling", static_cast<int>(s.sampling), "0 (Monte Carlo) or 1 (stratified)");
  }
  if (!std::isfinite(s.targetRelativeError) || s.targetRelativeError < 0.0 ||
    s.targetRelativeError >= 1.0)
  {
    return valueError("TargetRelativeError", s.targetRelativeError, "0 (off) to less than 1");
  }
  if (!(s.attenuationCoefficient >= 0.0) || s.attenuationCoefficient > MaximumAttenuation)
  {
    return valueError("AttenuationCoefficient", s.attenuationCoefficient, "0 to 1e30 1/m");
  }
  if (outside(s.reflectanceModel, 2))
  {
    return valueError("ReflectanceModel", static_cast<int>(s.reflectanceModel), "0 to 2");
  }
  if (s.numberOfReflections < 1 || s.numberOfReflections > 2)
  {
    return valueError("NumberOfReflections", s.numberOfReflections, "1 or 2");
  }
  if (!(s.lightEnergyFraction >= 0.0) || s.lightEnergyFraction > MaximumLightEnergyFraction)
  {
    return valueError("LightEnergyFraction", s.lightEnergyFraction, "0 to 1e8");
  }
  if (outside(s.lightEnergyThreshold, 1))
  {
    return valueError("LightEnergyThreshold", static_cast<int>(s.lightEnergyThreshold),
      "0 (share of the limit) or 1 (the limit)");
  }
  if (outside(s.returnMode, 4))
  {
    return valueError("ReturnMode", static_cast<int>(s.returnMode), "0 to 4");
  }
  if (s.numberOfConnections < 0)
  {
    return valueError("NumberOfConnections", s.numberOfConnections, "at least 0");
  }
  if (mostPathsOfABeam(s) > MaximumPathsPerBeam)
  {
    std::ostringstream expected;
    expected << "so few that a beam has at most 1e8 paths; RaysPerBeam is " << s.raysPerBeam
             << " and TargetRelativeError " << s.targetRelativeError;
    return valueError("NumberOfConnections", s.numberOfConnections, expected.str().c_str());
  }
  if (outside(s.traceMode, 2))
  {
    return valueError("BatchCollisionDetection", static_cast<int>(s.traceMode),
      "0 (every ray), 1 (groups of beams) or 2 (every beam)");
  }
  return {};
}

std::string applyPreset(EchoPreset preset, EchoSettings& settings)
{
  switch (preset)
  {
    case EchoPreset::Custom:
      return {};
    case EchoPreset::Draft:
      setFidelity(settings, 100, 0.0, 2, 0);
      return {};
    case EchoPreset::Standard:
      setFidelity(settings, 400, 0.02, 2, 2);
      return {};
    case EchoPreset::Reference:
      setFidelity(settings, 10000, 0.0, 2, 8);
      return {};
  }
  return valueError("Preset", static_cast<int>(preset), "0 (custom) to 3 (reference)");
}
}
