// SPDX-License-Identifier: BSD-3-Clause
// Values out of range: each gets an error that names it, and the last legal ones pass.
#include "CollisionTreeBuilder.h"
#include "EchoTestScene.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

using namespace echotest;
using stability::record;

namespace
{
const double NotANumber = std::numeric_limits<double>::quiet_NaN();

struct Count
{
  std::size_t unnamed = 0;
  std::size_t refused = 0;
};

void expectNamed(const std::string& message, const std::string& name, Count& count)
{
  count.unnamed += message.find(name) == std::string::npos;
  EXPECT_NE(message.find(name), std::string::npos) << name << ": '" << message << "'";
}

void expectLegal(const std::string& message, Count& count)
{
  count.refused += !message.empty();
  EXPECT_EQ(message, "");
}
}

TEST(StabilityErrors, OfTheSensor)
{
  struct Case
  {
    const char* name;
    double Sensor::*member;
    std::vector<double> bad;
    std::vector<double> good;
  };
  const Case cases[] = { { "half_beamwidth", &Sensor::halfBeamwidth,
                           { 0.0, -1e-9, 9e-10, 1.05, Infinity, NotANumber },
                           { 1e-9, 1.0, Pi / 3.0 } },
    { "pulse_energy", &Sensor::pulseEnergy, { 0.0, -1.0, 9e-51, 1.1e50, Infinity, NotANumber },
      { 1e-50, 1e3, 1e50 } },
    { "pulse_width", &Sensor::pulseWidth, { -1e-9, 1e-3, Infinity, NotANumber }, { 0.0, 5e-6 } },
    { "frequency", &Sensor::frequency, { 0.0, -1.0, 0.9, 1.1e30, Infinity, NotANumber },
      { 1.0, 1e30 } },
    { "sampling_interval", &Sensor::samplingInterval,
      { 0.0, -1e-9, 9e-31, 1.1e20, Infinity, NotANumber }, { 1e-11, 1e-3, 1e20 } },
    { "range_gate", &Sensor::rangeGate, { 0.0, -1.0, 1e16, 1.1e30, Infinity, NotANumber },
      { 1e-320, 1e-3, 1e5 } },
    { "minimum_range", &Sensor::minimumRange, { -1.0, 4000.0, Infinity, NotANumber },
      { 0.0, 1e-3, 3999.0 } },
    { "noise_photon_rate", &Sensor::noisePhotonRate, { -1.0, 1.1e50, Infinity, NotANumber },
      { 0.0, 1e12, 1e50 } },
    { "lower_energy_limit", &Sensor::lowerEnergyLimit, { -1e-9, Infinity, NotANumber },
      { 0.0, 6.25e-5 } },
    { "upper_energy_limit", &Sensor::upperEnergyLimit, { 1.9e-6, -1.0, Infinity, NotANumber },
      { 2e-6, 1e3, 1e50 } },
    { "receiver_aperture", &Sensor::receiverAperture, { -1.0, 1.1e20, Infinity, NotANumber },
      { 0.0, 1.0, 1e20 } } };
  Count count;
  for (const Case& c : cases)
  {
    for (const double value : c.bad)
    {
      Sensor sensor;
      sensor.*c.member = value;
      expectNamed(checkSensor(sensor), c.name, count);
    }
    for (const double value : c.good)
    {
      Sensor sensor;
      sensor.*c.member = value;
      expectLegal(checkSensor(sensor), count);
    }
  }
  // A picosecond over 100 km, and what no number of units holds any more.
  Sensor fine;
  fine.samplingInterval = 1e-12;
  fine.pulseWidth = 1e-12;
  fine.rangeGate = 1e5;
  expectLegal(checkSensor(fine), count);
  fine.samplingInterval = 1e-20;
  fine.pulseWidth = 0.0;
  expectNamed(checkSensor(fine), "range_gate", count);
  record({ "Out of range", "sensor", "values without an error that names them, legal ones with one",
    0.0, static_cast<double>(count.unnamed + count.refused) });
}

TEST(StabilityErrors, OfSettingsMaterialsAndNoise)
{
  Count count;
  const auto settingsWith = [](const std::function<void(EchoSettings&)>& change)
  {
    EchoSettings settings;
    change(settings);
    return checkSettings(settings);
  };
  for (const int rays : { 0, -1, 1000001, std::numeric_limits<int>::min() })
  {
    expectNamed(settingsWith([&](EchoSettings& s) { s.raysPerBeam = rays; }), "RaysPerBeam", count);
  }
  for (const double mu : { -1e-9, 1.1e30, Infinity, NotANumber })
  {
    expectNamed(settingsWith([&](EchoSettings& s) { s.attenuationCoefficient = mu; }),
      "AttenuationCoefficient", count);
  }
  expectNamed(settingsWith([](EchoSettings& s) { s.beamSamples = BeamSampleSource{ 2 }; }),
    "BeamSamples", count);
  expectNamed(
    settingsWith([](EchoSettings& s) { s.numberOfReflections = 3; }), "NumberOfReflections", count);
  expectNamed(settingsWith([](EchoSettings& s) { s.numberOfConnections = -1; }),
    "NumberOfConnections", count);
  expectNamed(settingsWith(
                [](EchoSettings& s)
                {
                  s.raysPerBeam = 1000000;
                  s.numberOfConnections = 1000;
                }),
    "NumberOfConnections", count);
  expectLegal(settingsWith([](EchoSettings& s) { s.raysPerBeam = 1000000; }), count);
  expectLegal(settingsWith([](EchoSettings& s) { s.attenuationCoefficient = 1e30; }), count);
  for (const Material& bad :
    { Material{ -0.1, 0.0, 1.0 }, Material{ NotANumber, 0.0, 1.0 }, Material{ 1.1, 0.0, 1.0 } })
  {
    expectNamed(checkMaterial(bad), "kd", count);
  }
  expectNamed(checkMaterial({ 0.1, -0.1, 1.0 }), "ks", count);
  expectNamed(checkMaterial({ 0.1, 0.1, 1.1e6 }), "kp", count);
  expectNamed(checkMaterial({ 0.1, 0.1, NotANumber }), "kp", count);
  expectLegal(checkMaterial({ 0.0, 0.0, 0.0 }), count);
  expectLegal(checkMaterial({ 0.5, 0.5, 1e6 }), count);
  Sensor loud;
  loud.noisePhotonRate = 1.001e12 / loud.samplingInterval;
  expectNamed(checkNoise(planNoise(loud, true), 1), "noise_photon_rate", count);
  Sensor alarming;
  alarming.samplingInterval = 1e-12;
  alarming.rangeGate = 1e5;
  alarming.noisePhotonRate = 1e12;
  alarming.lowerEnergyLimit = 0.0;
  expectNamed(checkNoise(planNoise(alarming, true), 1), "noise_photon_rate", count);
  // Paths that would meet more range units than memory is there for.
  Sensor wide;
  wide.samplingInterval = 1e-12;
  wide.pulseWidth = 1e-9;
  wide.rangeGate = 1e5;
  EchoSettings many;
  many.raysPerBeam = 100000;
  expectNamed(checkUnits(wide, many), "pulse_width", count);
  wide.pulseWidth = 1e-12;
  expectLegal(checkUnits(wide, many), count);
  expectLegal(checkUnits(Sensor(), many), count);
  record({ "Out of range", "settings, materials, noise, range units",
    "values without an error that names them, legal ones with one", 0.0,
    static_cast<double>(count.unnamed + count.refused) });
}

TEST(StabilityErrors, OfCoordinates)
{
  Count count;
  for (const double value : { Infinity, -Infinity, NotANumber, 1e31 })
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      Scene scene;
      scene.plate({ 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 }, Wall);
      scene.mesh->points[4][axis] = value;
      std::string message;
      try
      {
        buildCollisionTree(scene.mesh, TreeOptions());
      }
      catch (const std::invalid_argument& error)
      {
        message = error.what();
      }
      expectNamed(message, "triangle 1", count);
    }
  }
  record({ "Out of range", "coordinates: infinite, NaN, beyond 1e30 m",
    "triangles without an error that names them", 0.0, static_cast<double>(count.unnamed) });
}
