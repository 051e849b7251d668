// SPDX-License-Identifier: BSD-3-Clause
// Every number that a scan depends on, from 1e-320 to 1e308, one by one and all at once: either an
// error that names what is wrong and what was expected, or echoes that are numbers. And the limits.
#include "Distributions.h"
#include "EchoTestScene.h"
#include "Sanitized.h"
#include "ScanPattern.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

using namespace echotest;
using stability::record;

namespace
{
/// All that a user may set.
struct World
{
  Sensor sensor;
  EchoSettings settings;
  Material material{ 0.3, 0.5, 100.0 };
  Vec3 position{ 0.0 };
  Vec3 direction{ 1.0, 0.0, 0.0 };
};

struct Number
{
  std::string name; ///< as errors speak of it
  std::function<double&(World&)> of;
};

const std::vector<Number>& numbers()
{
  static const std::vector<Number> all = []
  {
    std::vector<Number> list = { { "AttenuationCoefficient",
                                   [](World& w) -> double&
                                   { return w.settings.attenuationCoefficient; } },
      { "kd", [](World& w) -> double& { return w.material.kd; } },
      { "ks", [](World& w) -> double& { return w.material.ks; } },
      { "kp", [](World& w) -> double& { return w.material.kp; } },
      { "position", [](World& w) -> double& { return w.position.y; } },
      { "direction", [](World& w) -> double& { return w.direction.y; } } };
    for (const SensorField& field : sensorFields())
    {
      // Below 1e-170 the share that is detected takes energies to infinity: left out. So are
      // numbers that must be whole (TestWaveforms.py).
      if (field.member != &Sensor::receiverEfficiency && field.member != &Sensor::digitiserRate &&
        field.member != &Sensor::digitiserBits)
      {
        list.push_back(
          { field.name, [m = field.member](World& w) -> double& { return w.sensor.*m; } });
      }
    }
    return list;
  }();
  return all;
}

ScanBeams beamsOf(const World& world)
{
  ScanBeams beams;
  const Vec3 directions[] = { world.direction, { 1.0, -0.19, 0.0 }, { 1.0, 0.2, 0.01 } };
  for (const Vec3& direction : directions)
  {
    addBeam(beams, unitVector(direction), world.position); // as they are read
  }
  return beams;
}

/// What the filter says before it scans.
std::string refusal(const World& world, const ScanSetup& setup, const ScanBeams& beams)
{
  for (const std::string& wrong :
    { checkSensor(world.sensor), checkSettings(world.settings), checkMaterial(world.material),
      checkPosition(world.position), checkUnits(world.sensor, world.settings) })
  {
    if (!wrong.empty())
    {
      return wrong;
    }
  }
  return checkNoise(setup.noise, beams.size());
}

bool isShare(double value)
{
  return value >= 0.0 && value <= 1.0 + 1e-9;
}

bool isNumber(double value)
{
  return std::isfinite(value) && value >= 0.0;
}

/// Empty, or what of the result is no number.
std::string faultOf(const ScanResult& result, const ScanSetup& setup)
{
  const bool fewRays = setup.settings.raysPerBeam < 8; // which have no standard error
  for (const Echo& echo : result.echoes)
  {
    const bool numbers = isNumber(echo.range) && isNumber(echo.energy) &&
      isNumber(echo.energyReceived) && isNumber(echo.returnEnergy) &&
      (fewRays || isNumber(echo.energyStdError)) && isShare(echo.labelShare) &&
      isShare(echo.secondaryShare) && (isNumber(echo.incidenceAngle) || echo.objectId < 0);
    if (!numbers)
    {
      std::ostringstream text;
      text << "echo at " << echo.range << " of " << echo.energyReceived << " (" << echo.energy
           << ", all " << echo.returnEnergy << ") +- " << echo.energyStdError << ", shares "
           << echo.labelShare << ", " << echo.secondaryShare << ", angle " << echo.incidenceAngle;
      return text.str();
    }
  }
  for (const BeamReport& report : result.reports)
  {
    if (!isNumber(report.lost) || report.range < 0.0 || std::isinf(report.range))
    {
      return "report of " + std::to_string(report.lost) + " J at " + std::to_string(report.range);
    }
  }
  const ModelNeeds& needs = setup.needs;
  if (!isNumber(needs.secondaryBound) || !isNumber(needs.skippedEnergyBound) ||
    !isNumber(needs.missedDetailEnergy) || std::isnan(needs.perceivableRange))
  {
    return "a bound that is no number";
  }
  return {};
}

struct Outcome
{
  std::string refused;
  std::string fault;
  std::size_t echoes = 0;
};

Outcome outcomeOf(const World& world)
{
  Outcome outcome;
  // What the sensor or the settings forbid is not computed with.
  // A wall, a corner that sends light from plate to plate, and something small before it.
  Scene scene = squareAt(100.0, 20.0, world.material, 0);
  scene.plate(
    Vec3(80.0, -20.0, 0.0), Vec3(20.0, 0.0, 0.0), Vec3(0.0, 0.0, 20.0), world.material, 1);
  scene.box(Vec3(60.0, 0.0, 0.0), Vec3(0.01), world.material, 2);
  const ScanBeams beams = beamsOf(world);
  ScanSetup setup;
  outcome.refused = refusal(world, setup, beams);
  if (outcome.refused.empty())
  {
    setup = makeSetup(scene, world.sensor, world.settings);
    outcome.refused = refusal(world, setup, beams);
  }
  if (outcome.refused.empty())
  {
    const ScanResult result = runScan(setup, beams);
    outcome.fault = faultOf(result, setup);
    outcome.echoes = result.echoes.size();
  }
  return outcome;
}

/// The worlds in which one number is swept.
std::vector<World> worlds()
{
  std::vector<World> all(5);
  for (World& world : all)
  {
    world.settings.raysPerBeam = 40;
  }
  all[1].sensor.lowerEnergyLimit = 0.0;
  all[1].sensor.upperEnergyLimit = 1e3;
  all[1].settings.noise = false;
  all[2].sensor.lowerEnergyLimit = 0.0;
  all[2].sensor.receiverAperture = 0.01;
  all[2].sensor.beamProfile = BeamProfile::Gaussian;
  all[2].sensor.noisePhotonRate = 0.0;
  all[2].settings.sampling = Sampling::MonteCarlo;
  all[3].settings.fullModel = true;
  all[4].sensor.receiverModel = ReceiverModel::Photons;
  all[4].sensor.receiverAperture = 0.01;
  all[4].sensor.backgroundRadiance = 0.05;
  all[4].sensor.amplifierNoise = 60.0;
  return all;
}

std::string describe(World world)
{
  std::ostringstream text;
  text.precision(17);
  for (const Number& number : numbers())
  {
    text << number.name << ' ' << number.of(world) << ", ";
  }
  return text.str();
}
}

TEST(StabilitySweep, OneNumberAfterTheOther)
{
  std::size_t bad = 0;
  for (const Number& number : numbers())
  {
    std::size_t accepted = 0;
    for (World world : worlds())
    {
      const double usual = number.of(world);
      for (int exponent = -320; exponent <= 308;
           exponent += exponent == -8 || exponent == -4 ? 4 : 8)
      {
        number.of(world) = std::pow(10.0, exponent);
        for (const BeamSampleSource source : BothSources)
        {
          world.settings.beamSamples = source;
          const Outcome outcome = outcomeOf(world);
          accepted += outcome.refused.empty();
          const bool named =
            outcome.refused.empty() || outcome.refused.find(number.name) != std::string::npos;
          const bool good = named && outcome.fault.empty();
          bad += !good;
          EXPECT_TRUE(good) << number.name << " 1e" << exponent << ", usually " << usual
                            << (source == BeamSampleSource::Cells ? ", integrated: "
                                                                  : ", sampled: ")
                            << outcome.refused << outcome.fault;
        }
      }
    }
    EXPECT_GT(accepted, 0u) << number.name;
  }
  record({ "Out of range", "each number of sensor, air, materials and beams, 1e-320 to 1e308",
    "both", "scans with neither an error that names it nor echoes that are numbers", 0.0,
    static_cast<double>(bad) });
}

TEST(StabilitySweep, WhatLiesBeyondTheLimitsIsNamed)
{
  constexpr double inf = std::numeric_limits<double>::infinity();
  std::size_t bad = 0;
  const auto expect = [&bad](const std::string& message, const std::string& name)
  {
    const bool good = name.empty() ? message.empty() : message.find(name) != std::string::npos;
    bad += !good;
    EXPECT_TRUE(good) << (name.empty() ? "legal" : name) << ": '" << message << "'";
  };
  for (const SensorField& field : sensorFields())
  {
    for (const double value : { std::nextafter(field.least, -inf), std::nextafter(field.most, inf),
           -inf, inf, std::numeric_limits<double>::quiet_NaN() })
    {
      Sensor sensor;
      sensor.*field.member = value;
      expect(checkSensor(sensor), field.name);
    }
  }
  const std::pair<double Sensor::*, double> legal[] = { { &Sensor::halfBeamwidth, 1e-9 },
    { &Sensor::halfBeamwidth, Pi / 3.0 }, { &Sensor::pulseEnergy, 1e-50 },
    { &Sensor::pulseEnergy, 1e50 }, { &Sensor::frequency, 1.0 }, { &Sensor::frequency, 1e30 },
    { &Sensor::pulseWidth, 5e-6 }, { &Sensor::samplingInterval, 1e20 },
    { &Sensor::rangeGate, 1e-320 }, { &Sensor::minimumRange, 3999.0 },
    { &Sensor::noisePhotonRate, 1e50 }, { &Sensor::upperEnergyLimit, 1e50 },
    { &Sensor::receiverAperture, 1e20 } };
  for (const auto& [member, value] : legal)
  {
    Sensor sensor;
    sensor.*member = value;
    expect(checkSensor(sensor), "");
  }
  const auto settingsWith = [](int EchoSettings::*member, int value)
  {
    EchoSettings settings;
    settings.*member = value;
    return checkSettings(settings);
  };
  for (const int rays : { 0, -1, 1000001 })
  {
    expect(settingsWith(&EchoSettings::raysPerBeam, rays), "RaysPerBeam");
  }
  expect(settingsWith(&EchoSettings::raysPerBeam, 1000000), "");
  expect(settingsWith(&EchoSettings::numberOfReflections, 4), "NumberOfReflections");
  expect(settingsWith(&EchoSettings::numberOfConnections, -1), "NumberOfConnections");
  // Noise and paths that would need more than memory is there for, and the last that do not.
  Sensor fine;
  fine.samplingInterval = fine.pulseWidth = 1e-12;
  fine.rangeGate = 1e5;
  expect(checkSensor(fine), "");
  EchoSettings many;
  many.raysPerBeam = 100000;
  expect(checkUnits(fine, many), "");
  fine.pulseWidth = 1e-9;
  expect(checkUnits(fine, many), "pulse_width");
  fine.noisePhotonRate = 1.0 / fine.samplingInterval;
  double photons = 0.0;
  while (poissonTail(1.0, photons) * 7e8 > 500.0)
  {
    photons += 1.0;
  }
  fine.lowerEnergyLimit = photons * fine.photonEnergy();
  expect(checkNoise(planNoise(fine, true), 20), "");
  fine.lowerEnergyLimit = 0.0;
  expect(checkNoise(planNoise(fine, true), 1), "noise_photon_rate");
  record({ "Out of range", "limits of each number of the sensor, of rays, noise and range units",
    "-", "values beyond without an error that names them, legal ones with one", 0.0,
    static_cast<double>(bad) });
}

TEST(StabilitySweep, ThePatternOfAScan)
{
  const std::pair<const char*, double ScanPattern::*> angles[] = { { "Orientation",
                                                                     &ScanPattern::yaw },
    { "Orientation", &ScanPattern::pitch }, { "Orientation", &ScanPattern::roll },
    { "levation", &ScanPattern::minimumElevation }, { "levation", &ScanPattern::elevationStep },
    { "AzimuthRange", &ScanPattern::azimuthStart }, { "AzimuthRange", &ScanPattern::azimuthEnd },
    { "AzimuthStep", &ScanPattern::azimuthStep }, { "RotationRate", &ScanPattern::rotationRate },
    { "FiringInterval", &ScanPattern::firingInterval } };
  std::size_t bad = 0;
  for (const auto& [name, member] : angles)
  {
    for (int exponent = -320; exponent <= 308; ++exponent)
    {
      for (const double sign : { -1.0, 1.0 })
      {
        ScanPattern pattern;
        pattern.*member = sign * std::pow(10.0, exponent);
        const std::string refused = checkPattern(pattern);
        bool good = refused.empty() || refused.find(name) != std::string::npos;
        const std::int64_t beams = refused.empty() ? numberOfBeams(pattern) : 0;
        for (std::int64_t i = 0; i < beams; i += std::max<std::int64_t>(1, beams / 7))
        {
          const ScanBeam beam = ScanGenerator(pattern).beam(i);
          const auto& d = beam.direction;
          good = good && isNumber(beam.time) && isNumber(1e6 * beam.time) &&
            isNumber(beam.azimuth) && std::isfinite(beam.elevation) &&
            std::fabs(std::hypot(d[0], d[1], d[2]) - 1.0) < 1e-12;
        }
        bad += !good;
        EXPECT_TRUE(good) << name << ' ' << sign << "e" << exponent << ": " << refused;
      }
    }
  }
  record({ "Out of range", "each number of a scan's pattern, 1e-320 to 1e308 and below 0", "-",
    "patterns with neither an error that names it nor beams and times that are numbers", 0.0,
    static_cast<double>(bad) });
}

TEST(StabilitySweep, AllNumbersAtOnce)
{
  std::size_t bad = 0;
  std::size_t scans = 0;
  std::size_t echoes = 0;
  const std::uint64_t seeds = casesAskedFor("AVIANLIDAR_PROPERTY_SEEDS", 1500);
  for (std::uint64_t seed = 0; seed < seeds; ++seed)
  {
    std::mt19937_64 random(seed);
    const auto below = [&random](unsigned count)
    { return static_cast<unsigned>(random() % count); };
    World world = worlds()[below(5)];
    world.settings.raysPerBeam = 1 + static_cast<int>(below(64));
    world.settings.noise = below(2) != 0;
    world.settings.beamSamples = static_cast<BeamSampleSource>(below(2));
    world.settings.numberOfReflections = 1 + static_cast<int>(below(3));
    world.settings.reflectanceModel = static_cast<ReflectanceModel>(below(3));
    for (const Number& number : numbers())
    {
      // Far from the usual, as far as anything goes, or as it is.
      const double span = below(8) == 0 ? 600.0 : 40.0;
      const double decades = span * (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5);
      double& value = number.of(world);
      const double about = value > 0.0 ? value : 1.0;
      value = below(7) == 0 ? about * std::pow(10.0, decades) : value; // five of them
    }
    const Outcome outcome = outcomeOf(world);
    const bool expected =
      outcome.refused.empty() || outcome.refused.find("expected") != std::string::npos;
    const bool good = expected && outcome.fault.empty();
    bad += !good;
    scans += outcome.refused.empty();
    echoes += outcome.echoes;
    EXPECT_TRUE(good) << "seed " << seed << ": " << outcome.refused << outcome.fault << '\n'
                      << describe(world);
  }
  EXPECT_GT(10 * scans, seeds);
  EXPECT_GT(echoes, seeds);
  record({ "Out of range", "all numbers of sensor, air, materials and beams at once, drawn", "both",
    "scans with neither an error that says what was expected nor echoes that are numbers", 0.0,
    static_cast<double>(bad) });
}
