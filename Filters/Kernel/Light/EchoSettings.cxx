// SPDX-License-Identifier: BSD-3-Clause
#include "EchoSettings.h"

#include "ValueError.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
template <class E>
bool outside(E value, int last)
{
  return static_cast<int>(value) < 0 || static_cast<int>(value) > last;
}

void setFidelity(EchoSettings& s, int rays, int connections)
{
  s.raysPerBeam = rays;
  s.sampling = Sampling::Stratified;
  s.numberOfReflections = 2;
  s.numberOfConnections = connections;
}
}

double CellDensity::rays() const
{
  // 16 and 256 cells fill the square, of which the disc is pi/4.
  return 0.25 * Pi * 16.0 * (this->levels == 1 ? 16.0 : 256.0) * this->blocks * this->blocks;
}

double CellDensity::raysOnObject() const
{
  return std::clamp(this->rays() / 25.0, 16.0, MostOnObject);
}

CellDensity densityOfCells(int raysPerBeam)
{
  // A second level is worth its lists from about 1,000 rays on.
  constexpr double many = 1000.0;
  const double rays = CellRaysPerRay * raysPerBeam;
  const CellDensity least{ rays < many ? 1 : 2, 1 };
  const double blocks = std::round(std::sqrt(rays / least.rays()));
  return { least.levels,
    static_cast<int>(std::clamp(blocks, 1.0, double{ CellDensity::MostBlocksAcross })) };
}

std::uint32_t tracedRaysOf(const EchoSettings& s)
{
  const int few = std::max(LeastStarts, s.raysPerBeam / RaysPerStart);
  return static_cast<std::uint32_t>(
    s.beamSamples == BeamSampleSource::Rays ? s.raysPerBeam : std::min(few, s.raysPerBeam));
}

std::uint32_t connectionsOf(const EchoSettings& s)
{
  return s.numberOfReflections > 1
    ? std::min(static_cast<std::uint32_t>(s.numberOfConnections), tracedRaysOf(s) - 1)
    : 0;
}

double pathsOfABeam(const EchoSettings& s)
{
  return s.raysPerBeam * (2.0 + connectionsOf(s));
}

std::string checkUnits(const Sensor& sensor, const EchoSettings& settings)
{
  const double inGate = 2.0 * sensor.rangeGate / (SpeedOfLight * sensor.samplingInterval);
  const double reached =
    pathsOfABeam(settings) * (2.0 + sensor.pulseWidth / sensor.samplingInterval);
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
  return settings.beamSamples == BeamSampleSource::Cells
    ? static_cast<std::size_t>(std::min(rays, most))
    : 0;
}

std::string checkSettings(const EchoSettings& s)
{
  if (outside(s.beamSamples, 1))
  {
    return valueError("BeamSamples", static_cast<int>(s.beamSamples), "0 (cells) or 1 (rays)");
  }
  if (s.raysPerBeam < 1 || s.raysPerBeam > 1000000)
  {
    return valueError("RaysPerBeam", s.raysPerBeam, "1 to 1000000");
  }
  if (outside(s.sampling, 1))
  {
    return valueError(
      "Sampling", static_cast<int>(s.sampling), "0 (Monte Carlo) or 1 (stratified)");
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
  if (pathsOfABeam(s) > MaximumPathsPerBeam)
  {
    const std::string expected =
      "so few that a beam has at most 1e8 paths; RaysPerBeam is " + std::to_string(s.raysPerBeam);
    return valueError("NumberOfConnections", s.numberOfConnections, expected.c_str());
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
      setFidelity(settings, 25, 0);
      return {};
    case EchoPreset::Standard:
      setFidelity(settings, 200, 2);
      return {};
    case EchoPreset::Reference:
      setFidelity(settings, 3200, 8);
      return {};
  }
  return valueError("Preset", static_cast<int>(preset), "0 (custom) to 3 (reference)");
}
}
