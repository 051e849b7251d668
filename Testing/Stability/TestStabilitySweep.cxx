// SPDX-License-Identifier: BSD-3-Clause
// Every number that a scan depends on, from 1e-320 to 1e308, one by one and all at once: either an
// error that names what is wrong and what was expected, or echoes that are numbers.
#include "EchoTestScene.h"
#include "ScanPattern.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
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
  const char* name; ///< as errors speak of it
  std::function<double&(World&)> of;
};

const std::vector<Number>& numbers()
{
  static const std::vector<Number> all = {
    { "half_beamwidth", [](World& w) -> double& { return w.sensor.halfBeamwidth; } },
    { "pulse_energy", [](World& w) -> double& { return w.sensor.pulseEnergy; } },
    { "pulse_width", [](World& w) -> double& { return w.sensor.pulseWidth; } },
    { "frequency", [](World& w) -> double& { return w.sensor.frequency; } },
    { "sampling_interval", [](World& w) -> double& { return w.sensor.samplingInterval; } },
    { "range_gate", [](World& w) -> double& { return w.sensor.rangeGate; } },
    { "noise_photon_rate", [](World& w) -> double& { return w.sensor.noisePhotonRate; } },
    { "lower_energy_limit", [](World& w) -> double& { return w.sensor.lowerEnergyLimit; } },
    { "upper_energy_limit", [](World& w) -> double& { return w.sensor.upperEnergyLimit; } },
    { "receiver_aperture", [](World& w) -> double& { return w.sensor.receiverAperture; } },
    { "AttenuationCoefficient",
      [](World& w) -> double& { return w.settings.attenuationCoefficient; } },
    { "kd", [](World& w) -> double& { return w.material.kd; } },
    { "ks", [](World& w) -> double& { return w.material.ks; } },
    { "kp", [](World& w) -> double& { return w.material.kp; } },
    { "position", [](World& w) -> double& { return w.position.y; } },
    { "direction", [](World& w) -> double& { return w.direction.y; } }
  };
  return all;
}

/// A wall, a corner that sends light from plate to plate, and something small before it.
Scene sceneOf(const Material& material)
{
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.0, 20.0, 0.0), Vec3(0.0, 0.0, 20.0), material, 0);
  scene.plate(Vec3(80.0, -20.0, 0.0), Vec3(20.0, 0.0, 0.0), Vec3(0.0, 0.0, 20.0), material, 1);
  scene.box(Vec3(60.0, 0.0, 0.0), Vec3(0.01), material, 2);
  return scene;
}

ScanBeams beamsOf(const World& world)
{
  ScanBeams beams;
  const Vec3 directions[] = { world.direction, { 1.0, -0.19, 0.0 }, { 1.0, 0.2, 0.01 } };
  for (const Vec3& direction : directions)
  {
    beams.ids.push_back(beams.ids.size());
    beams.origins.push_back(world.position);
    beams.directions.push_back(unitVector(direction)); // as they are read
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
  const Scene scene = sceneOf(world.material);
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
  std::vector<World> all(4);
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
      for (int exponent = -320; exponent <= 308; exponent += 4)
      {
        number.of(world) = std::pow(10.0, exponent);
        for (const bool integrated : { true, false })
        {
          world.settings.beamSamples =
            integrated ? BeamSampleSource::Cells : BeamSampleSource::Rays;
          const Outcome outcome = outcomeOf(world);
          accepted += outcome.refused.empty();
          const bool named =
            outcome.refused.empty() || outcome.refused.find(number.name) != std::string::npos;
          const bool good = named && outcome.fault.empty();
          bad += !good;
          EXPECT_TRUE(good) << number.name << " 1e" << exponent << ", usually " << usual
                            << (integrated ? ", integrated: " : ", sampled: ") << outcome.refused
                            << outcome.fault;
        }
      }
    }
    EXPECT_GT(accepted, 0u) << number.name;
  }
  record({ "Out of range", "each number of sensor, air, materials and beams, 1e-320 to 1e308",
    "scans with neither an error that names it nor echoes that are numbers", 0.0,
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
  record({ "Out of range", "each number of a scan's pattern, 1e-320 to 1e308 and below 0",
    "patterns with neither an error that names it nor beams and times that are numbers", 0.0,
    static_cast<double>(bad) });
}

TEST(StabilitySweep, AllNumbersAtOnce)
{
  std::size_t bad = 0;
  std::size_t scans = 0;
  std::size_t echoes = 0;
  const char* const text = std::getenv("AVIANLIDAR_PROPERTY_SEEDS");
  const std::uint64_t seeds = text ? std::strtoull(text, nullptr, 10) : 4000;
  for (std::uint64_t seed = 0; seed < seeds; ++seed)
  {
    std::mt19937_64 random(seed);
    const auto below = [&random](unsigned count)
    { return static_cast<unsigned>(random() % count); };
    World world = worlds()[below(4)];
    world.settings.raysPerBeam = 1 + static_cast<int>(below(64));
    world.settings.noise = below(2) != 0;
    world.settings.beamSamples = static_cast<BeamSampleSource>(below(2));
    world.settings.numberOfReflections = 1 + static_cast<int>(below(2));
    world.settings.reflectanceModel = static_cast<ReflectanceModel>(below(3));
    for (const Number& number : numbers())
    {
      // Far from the usual, as far as anything goes, or as it is.
      const double span = below(8) == 0 ? 600.0 : 40.0;
      const double decades = span * (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5);
      double& value = number.of(world);
      const double about = value > 0.0 ? value : 1.0;
      value = below(3) == 0 ? about * std::pow(10.0, decades) : value;
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
  record({ "Out of range", "all numbers of sensor, air, materials and beams at once, drawn",
    "scans with neither an error that says what was expected nor echoes that are numbers", 0.0,
    static_cast<double>(bad) });
}
