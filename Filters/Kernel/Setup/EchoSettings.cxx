// SPDX-License-Identifier: BSD-3-Clause
#include "EchoSettings.h"

#include "MemberCount.h"
#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace avianlidar
{
namespace
{
/// EchoSetting::get() and set() of a member.
template <auto Member>
struct Access
{
  static double get(const EchoSettings& s) { return static_cast<double>(s.*Member); }
  static void set(EchoSettings& s, double value)
  {
    s.*Member = static_cast<std::decay_t<decltype(s.*Member)>>(value);
  }
};

template <auto Member>
EchoSetting row(const char* property, const char* name, SettingEffect effect, double least,
  double most, const char* expected, const char* unit = "1", bool whole = true)
{
  return { property, name, unit, whole, effect, least, most, expected, Access<Member>::get,
    Access<Member>::set };
}

template <auto Member>
EchoSetting toggle(const char* property, const char* name)
{
  return row<Member>(property, name, SettingEffect::Echoes, 0.0, 1.0, "0 (off) or 1 (on)");
}

void setFidelity(EchoSettings& s, int rays, int connections)
{
  s.raysPerBeam = rays;
  s.sampling = Sampling::Stratified;
  s.numberOfReflections = 3;
  s.numberOfConnections = connections;
}
}

double CellDensity::rays() const
{
  // The disc is pi/4 of a square of 16 or 256 cells.
  return 0.25 * Pi * 16.0 * (this->levels == 1 ? 16.0 : 256.0) * this->blocks * this->blocks;
}

double CellDensity::raysOnObject() const
{
  return this->levels > 1 ? OnObject : std::max(16.0, this->rays() / 25.0);
}

CellDensity densityOfCells(int raysPerBeam)
{
  // From about 1,000 rays on, a second level saves more time than its lists cost.
  constexpr double many = 1000.0;
  const double rays = CellRaysPerRay * raysPerBeam;
  const CellDensity least{ rays < many ? 1 : 2, 1 };
  const double blocks = std::round(std::sqrt(rays / least.rays()));
  return { least.levels,
    static_cast<int>(std::clamp(blocks, 1.0, double{ CellDensity::MostBlocksAcross })) };
}

const std::vector<EchoSetting>& echoSettings()
{
  using S = EchoSettings;
  using E = SettingEffect;
  constexpr double most = std::numeric_limits<std::int32_t>::max();
  static const std::vector<EchoSetting> all = { row<&S::raysPerBeam>("RaysPerBeam", "rays_per_beam",
                                                  E::Rays, 1.0, 1e6, "1 to 1000000"),
    row<&S::beamSamples>("BeamSamples", "beam_samples", E::Rays, 0.0, 1.0, "0 (cells) or 1 (rays)"),
    row<&S::sampling>(
      "Sampling", "sampling", E::Rays, 0.0, 1.0, "0 (Monte Carlo) or 1 (stratified)"),
    row<&S::seed>("Seed", "seed", E::Rays, -1.0 - most, most, "an int", ""),
    row<&S::attenuationCoefficient>("AttenuationCoefficient", "attenuation_coefficient", E::Echoes,
      0.0, MaximumAttenuation, "0 to 1e30 1/m", "1/m", false),
    row<&S::reflectanceModel>(
      "ReflectanceModel", "reflectance_model", E::Echoes, 0.0, 3.0, "0 to 3"),
    row<&S::numberOfReflections>(
      "NumberOfReflections", "number_of_reflections", E::Echoes, 1.0, 3.0, "1, 2 or 3"),
    toggle<&S::beamConstraint>("BeamConstraint", "beam_constraint"),
    toggle<&S::lightEnergyConstraint>("LightEnergyConstraint", "light_energy_constraint"),
    row<&S::lightEnergyFraction>("LightEnergyFraction", "light_energy_fraction", E::Echoes, 0.0,
      MaximumLightEnergyFraction, "0 to 1e8", "1", false),
    row<&S::lightEnergyThreshold>("LightEnergyThreshold", "light_energy_threshold", E::Echoes, 0.0,
      2.0, "0 (share of the limit), 1 (the limit) or 2 (the limit per ray)"),
    row<&S::traceMode>("BatchCollisionDetection", "batch_collision_detection", E::None, 0.0, 2.0,
      "0 (every ray), 1 (groups of beams) or 2 (every beam)"),
    toggle<&S::noise>("Noise", "noise"), toggle<&S::fullModel>("FullModel", "full_model"),
    row<&S::returnMode>("ReturnMode", "return_mode", E::Echoes, 0.0, 4.0, "0 to 4"),
    row<&S::numberOfConnections>(
      "NumberOfConnections", "number_of_connections", E::Echoes, 0.0, most, "at least 0"),
    toggle<&S::waveforms>("RecordWaveforms", "record_waveforms"),
    row<&S::waveformFloor>("WaveformFloor", "waveform_floor", E::Echoes, 0.0, 1e9,
      "0 (whole beams) to 1e9", "1", false) };
  static_assert(memberCount<EchoSettings>() == 18, "is the new member a row of the table?");
  return all;
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
    pathsOfABeam(settings) * (2.0 + ReceivedPulse(sensor, sensor.samplingInterval).width());
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
  const double most =
    std::clamp(TrianglesPerRay * settings.raysPerBeam, FewTriangles, ManyTriangles);
  return settings.beamSamples == BeamSampleSource::Cells ? static_cast<std::size_t>(most) : 0;
}

std::string checkSettings(const EchoSettings& s)
{
  for (const EchoSetting& setting : echoSettings())
  {
    const double value = setting.get(s);
    if (!(value >= setting.least && value <= setting.most)) // refuses NaN, too
    {
      return valueError(setting.property, value, setting.expected);
    }
  }
  if (pathsOfABeam(s) > MaximumPathsPerBeam)
  {
    const std::string expected =
      "so few that a beam has at most 1e8 paths; RaysPerBeam is " + std::to_string(s.raysPerBeam);
    return valueError("NumberOfConnections", s.numberOfConnections, expected.c_str());
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
    case EchoPreset::Paper:
      setFidelity(settings, 100, 2);                 // Table 2
      settings.numberOfReflections = 2;              // Sec. 3.4
      settings.beamSamples = BeamSampleSource::Rays; // Sec. 2.1
      settings.sampling = Sampling::MonteCarlo;      // Sec. 2.1
      settings.traceMode = TraceMode::Beams;         // Sec. 3.2 and 3.3
      settings.beamConstraint = true;                // Sec. 3.4
      settings.lightEnergyConstraint = true;         // Sec. 3.4
      settings.lightEnergyThreshold = LightEnergyThreshold::Limit;
      settings.reflectanceModel = ReflectanceModel::LambertBlinnPhong; // Eq. 8
      settings.returnMode = ReturnMode::RangeUnits;                    // Eq. 10 and 12
      return {};
    case EchoPreset::Preview:
      setFidelity(settings, 100, 0);
      settings.beamSamples = BeamSampleSource::Rays;
      settings.numberOfReflections = 1;
      return {};
  }
  return valueError("Preset", static_cast<int>(preset), "0 (custom) to 5 (preview)");
}
}
