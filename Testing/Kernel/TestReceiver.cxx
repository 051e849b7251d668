// SPDX-License-Identifier: BSD-3-Clause
// Receiver: dynamic range, returns and their ranges, return modes, false alarms.
#include "BeamRays.h"
#include "BeamReceiver.h"
#include "ParallelLoop.h"
#include "PhotonReceiver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace avianlidar;

namespace
{
/// Units of 1 m in range, delta pulses, limits 1 and 10 J, no noise.
Sensor unitSensor()
{
  Sensor sensor;
  sensor.samplingInterval = 2.0 / SpeedOfLight;
  sensor.pulseWidth = 0.0;
  sensor.rangeGate = 1000.0;
  sensor.noisePhotonRate = 0.0;
  sensor.lowerEnergyLimit = 1.0;
  sensor.upperEnergyLimit = 10.0;
  return sensor;
}

struct Pulse
{
  double range;
  double energy;
};

/// Receives a beam of unitSensor() or a like one.
class Bench
{
public:
  Bench(const Sensor& sensor, ReturnMode mode)
    : Accumulator(sensor.samplingInterval, sensor.pulseWidth, sensor.rangeGate)
    , Clear(sensor, {})
    , Receiver(sensor, planNoise(sensor, true), 0, mode, this->Clear)
    , Ranges(sensor, mode)
  {
  }
  const std::vector<Return>& operator()(const std::vector<Pulse>& echoes, std::uint64_t beam = 0)
  {
    this->Accumulator.clear();
    for (const Pulse& echo : echoes)
    {
      this->Accumulator.add({ 2.0 * echo.range, echo.energy });
    }
    this->Accumulator.accumulate();
    this->Got =
      this->Receiver.receive(beam, { this->Accumulator.units(), {}, Sensor().backgroundRadiance },
        BeamAir(this->Clear), DrawnLeaves());
    ShareFinder shares;
    shares.begin(this->Accumulator);
    for (Return& ret : this->Got.returns)
    {
      ret.range = this->Ranges.of(this->Got, ret,
        shares.sharesOf(
          this->Got.units[ret.firstUnit].index, this->Got.units[ret.lastUnit - 1].index + 1),
        this->Accumulator.pathLengths());
    }
    return this->Got.returns;
  }

  RangeUnitAccumulator Accumulator;
  const ScanAir Clear;
  BeamReceiver Receiver;
  const ReturnRanges Ranges;
  Received Got;
};

/// Receives a beam without light.
Received inTheDark(BeamReceiver& receiver, const ScanAir& air, std::uint64_t beam)
{
  return receiver.receive(
    beam, { {}, {}, Sensor().backgroundRadiance }, BeamAir(air), DrawnLeaves());
}

/// Probability that numbers which are uniform in (0, 1) are as far from it as these: Kolmogorov and
/// Smirnov, with Stephens' correction for few numbers.
double uniformProbability(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const auto k = static_cast<double>(i);
    distance = std::max({ distance, values[i] - k / n, (k + 1.0) / n - values[i] });
  }
  const double x = distance * (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n));
  double sum = 0.0;
  for (int j = 1; j < 100; ++j)
  {
    sum += (j % 2 == 1 ? 2.0 : -2.0) * std::exp(-2.0 * j * j * x * x);
  }
  return std::clamp(sum, 0.0, 1.0);
}

/// Units of 1 m, and false alarms: one in 270 units with counted photons, in 740 with Gaussian
/// noise.
Sensor noisySensor(ReceiverModel model)
{
  Sensor sensor = unitSensor();
  sensor.receiverModel = model;
  sensor.noisePhotonRate = 1.0 / sensor.samplingInterval;
  sensor.receiverAperture = 0.01;
  const PhotonReceiver receiver(sensor);
  sensor.lowerEnergyLimit = model == ReceiverModel::Photons
    ? 3.0 * receiver.deviation(0.0) / receiver.electronsPerJoule
    : 4.0 * sensor.photonEnergy();
  return sensor;
}

// Three returns: units 10-12, unit 20 (saturated), units 30-31; unit 13 and 25 are not perceived.
const std::vector<Pulse> threeReturns = { { 10.5, 2.0 }, { 11.5, 4.0 }, { 12.5, 3.0 },
  { 13.5, 1.0 }, { 20.2, 8.0 }, { 20.8, 8.0 }, { 25.5, 0.5 }, { 30.5, 5.0 }, { 31.5, 5.0 } };
}

TEST(Receiver, DynamicRange)
{
  EXPECT_EQ(perceivedEnergy(0.0, 2e-6, 6.25e-5), 0.0);
  EXPECT_EQ(perceivedEnergy(2e-6, 2e-6, 6.25e-5), 0.0);
  EXPECT_EQ(perceivedEnergy(std::nextafter(2e-6, 1.0), 2e-6, 6.25e-5), std::nextafter(2e-6, 1.0));
  EXPECT_EQ(perceivedEnergy(5e-5, 2e-6, 6.25e-5), 5e-5);
  EXPECT_EQ(perceivedEnergy(6.25e-5, 2e-6, 6.25e-5), 6.25e-5);
  EXPECT_EQ(perceivedEnergy(1.0, 2e-6, 6.25e-5), 6.25e-5);
  EXPECT_EQ(perceivedEnergy(1.0, 0.5, 0.5), 0.5);
  EXPECT_EQ(perceivedEnergy(0.5, 0.5, 0.5), 0.0);
  EXPECT_EQ(perceivedEnergy(1e-30, 0.0, 1.0), 1e-30);
}

TEST(Receiver, ReturnsAreMaximalRuns)
{
  Bench bench(unitSensor(), ReturnMode::All);
  const auto& returns = bench(threeReturns);
  ASSERT_EQ(returns.size(), 3u);
  const auto& units = bench.Got.units;
  EXPECT_EQ(units.size(), 8u);
  EXPECT_EQ(units[returns[0].firstUnit].index, 10);
  EXPECT_EQ(units[returns[0].lastUnit - 1].index, 12);
  EXPECT_EQ(units[returns[0].strongestUnit].index, 11);
  EXPECT_EQ(returns[0].energyReceived, 4.0);
  EXPECT_EQ(returns[0].energy, 4.0);
  EXPECT_EQ(returns[0].returnEnergy, 9.0);
  EXPECT_NEAR(returns[0].range, (2.0 * 10.5 + 4.0 * 11.5 + 3.0 * 12.5) / 9.0, 1e-14);
  EXPECT_EQ(returns[1].energyReceived, 16.0);
  EXPECT_EQ(returns[1].energy, 10.0);
  EXPECT_NEAR(returns[1].range, 20.5, 1e-14);
  EXPECT_EQ(units[returns[2].strongestUnit].index, 30); // a tie goes to the nearest
  for (int r = 0; r < 3; ++r)
  {
    EXPECT_EQ(returns[r].returnNumber, r + 1);
    EXPECT_EQ(returns[r].numberOfReturns, 3);
  }
  EXPECT_EQ(bench.Got.strongest->energyReceived, 16.0);
}

TEST(Receiver, ModesChooseAndKeepTheNumbering)
{
  const struct
  {
    ReturnMode mode;
    int number;
    double range;
  } cases[] = { { ReturnMode::Strongest, 2, 20.5 }, { ReturnMode::First, 1, 104.5 / 9.0 },
    { ReturnMode::Last, 3, 31.0 } };
  for (const auto& item : cases)
  {
    Bench bench(unitSensor(), item.mode);
    const auto& returns = bench(threeReturns);
    ASSERT_EQ(returns.size(), 1u);
    EXPECT_EQ(returns[0].returnNumber, item.number);
    EXPECT_EQ(returns[0].numberOfReturns, 3);
    EXPECT_NEAR(returns[0].range, item.range, 1e-13);
  }
}

TEST(Receiver, StrongestOfEqualReturnsIsTheNearest)
{
  Bench bench(unitSensor(), ReturnMode::Strongest);
  const auto& returns = bench({ { 5.5, 3.0 }, { 9.5, 3.0 } });
  ASSERT_EQ(returns.size(), 1u);
  EXPECT_EQ(returns[0].returnNumber, 1);
}

TEST(Receiver, RangeUnitsModeIsThePaperLiterally)
{
  Bench bench(unitSensor(), ReturnMode::RangeUnits);
  const auto& returns = bench(threeReturns);
  ASSERT_EQ(returns.size(), 6u);
  EXPECT_NEAR(returns[3].range, 20.5, 1e-12);
  EXPECT_NEAR(returns[1].range, 11.5, 1e-12);
  EXPECT_EQ(returns[3].energyReceived, 16.0);
  EXPECT_EQ(returns[3].returnEnergy, 16.0);
  EXPECT_EQ(returns[5].returnNumber, 6);
  EXPECT_EQ(returns[5].numberOfReturns, 6);
}

TEST(Receiver, NothingPerceivedGivesNoReturn)
{
  for (const ReturnMode mode : { ReturnMode::All, ReturnMode::Strongest, ReturnMode::RangeUnits })
  {
    Bench bench(unitSensor(), mode);
    EXPECT_TRUE(bench({}).empty());
    EXPECT_FALSE(bench.Got.strongest);
    EXPECT_TRUE(bench({ { 7.5, 1.0 } }).empty());
    EXPECT_FALSE(bench.Got.strongest);
  }
}

TEST(ReceiverNoise, FalseAlarmsLieAnywhereInTheirUnit)
{
  for (const ReceiverModel model : { ReceiverModel::EnergyLimits, ReceiverModel::Photons })
  {
    const Sensor sensor = noisySensor(model);
    Bench bench(sensor, ReturnMode::All);
    Bench again(sensor, ReturnMode::All);
    const ScanAir clear(sensor, {});
    BeamReceiver next(sensor, planNoise(sensor, true), 0, ReturnMode::All, clear, 1);
    std::vector<double> places;
    std::vector<double> energies;
    std::vector<double> nextPlaces;
    for (std::uint64_t beam = 0; beam < 3000; ++beam)
    {
      const auto& returns = bench({}, beam);
      for (const Return& one : returns)
      {
        if (one.lastUnit - one.firstUnit == 1)
        {
          places.push_back(one.range - std::floor(one.range));
          energies.push_back(one.returnEnergy);
        }
      }
      // The same for the same beam, whatever came before it; others in another revolution.
      if (beam % 100 == 99)
      {
        const auto& same = again({}, beam);
        ASSERT_EQ(same.size(), returns.size());
        for (std::size_t r = 0; r < same.size(); ++r)
        {
          EXPECT_EQ(same[r].range, returns[r].range);
        }
      }
      for (const Return& one : inTheDark(next, clear, beam).returns)
      {
        nextPlaces.push_back(one.range - std::floor(one.range));
      }
    }
    ASSERT_GT(places.size(), 2000u);
    EXPECT_GT(uniformProbability(places), 1e-3) << places.size();
    ASSERT_GT(nextPlaces.size(), 2000u);
    EXPECT_NE(places[0], nextPlaces[0]);
    // What they receive does not say where they lie.
    double moment = 0.0;
    double square = 0.0;
    double mean = 0.0;
    for (const double energy : energies)
    {
      mean += energy / static_cast<double>(energies.size());
    }
    for (std::size_t i = 0; i < places.size(); ++i)
    {
      moment += (places[i] - 0.5) * (energies[i] - mean);
      square += (energies[i] - mean) * (energies[i] - mean);
    }
    EXPECT_LT(std::fabs(moment), 3.0 * std::sqrt(square / 12.0));
  }
}

TEST(ReceiverNoise, PointsOfRangeUnitsLieAtTheirCentresFalseAlarmsToo)
{
  Bench bench(noisySensor(ReceiverModel::EnergyLimits), ReturnMode::RangeUnits);
  std::size_t alarms = 0;
  for (std::uint64_t beam = 0; beam < 100; ++beam)
  {
    for (const Return& one : bench({}, beam))
    {
      EXPECT_NEAR(one.range - std::floor(one.range), 0.5, 1e-9);
      ++alarms;
    }
  }
  EXPECT_GT(alarms, 100u);
}

TEST(ReceiverNoise, AReceiverThatIsNoLongerWantedStopsAndGoesOnLater)
{
  Sensor sensor = noisySensor(ReceiverModel::EnergyLimits);
  sensor.lowerEnergyLimit = 0.0; // nearly two thirds of all units alarm
  sensor.rangeGate = 50000.0;
  const NoisePlan plan = planNoise(sensor, true);
  int asked = 0;
  const ScanAir clear(sensor, {});
  BeamReceiver receiver(
    sensor, plan, 0, ReturnMode::All, clear, 0, [&asked]() { return ++asked != 3; });
  EXPECT_THROW(inTheDark(receiver, clear, 0), WorkStopped);
  EXPECT_EQ(asked, 3);
  const std::vector<Return> later = inTheDark(receiver, clear, 0).returns;
  EXPECT_GT(asked, 6);
  BeamReceiver whole(sensor, plan, 0, ReturnMode::All, clear);
  const std::vector<Return> expected = inTheDark(whole, clear, 0).returns;
  ASSERT_EQ(later.size(), expected.size());
  EXPECT_EQ(later.back().range, expected.back().range);
}

TEST(ReceiverNoise, AddsToEchoesBeforeTheLimits)
{
  // Every unit alarms, so an echo joins a run over the whole gate, and the noise is in its
  // energies.
  Sensor sensor = unitSensor();
  sensor.rangeGate = 50.0;
  sensor.noisePhotonRate = 1e4 / sensor.samplingInterval;
  sensor.lowerEnergyLimit = 10.0 * sensor.photonEnergy();
  sensor.upperEnergyLimit = 1.5e4 * sensor.photonEnergy();
  const double photon = sensor.photonEnergy();
  Bench bench(sensor, ReturnMode::All);
  const auto& returns = bench({ { 20.3, 1e5 * photon } });
  ASSERT_EQ(returns.size(), 1u);
  const auto& units = bench.Got.units;
  EXPECT_EQ(units.size(), 50u);
  EXPECT_EQ(units[returns[0].strongestUnit].index, 20);
  EXPECT_NEAR(returns[0].energyReceived / photon, 1.1e5, 600.0);
  EXPECT_EQ(returns[0].energy, sensor.upperEnergyLimit);
  EXPECT_NEAR(returns[0].returnEnergy / photon, 1e5 + 50e4, 4.5 * std::sqrt(50e4));
  EXPECT_NEAR(returns[0].range, 20.3, 1e-12); // its paths, not the noise, say where it is
  for (const ReceivedUnit& unit : units)
  {
    EXPECT_GT(unit.noise, 0.0);
  }
}

TEST(ReceiverNoise, AlarmsLieEvenlyInTheGate)
{
  // A unit of 1 m, of which 0.3 m lie inside the gate.
  Sensor sensor = noisySensor(ReceiverModel::EnergyLimits);
  sensor.samplingInterval = 2.0 / SpeedOfLight;
  sensor.minimumRange = 9.7;
  sensor.rangeGate = 10.0;
  sensor.noisePhotonRate = 3.0 / sensor.samplingInterval;
  sensor.lowerEnergyLimit = 4.0 * sensor.photonEnergy();
  for (const ReturnMode mode : { ReturnMode::All, ReturnMode::RangeUnits })
  {
    const NoisePlan plan = planNoise(sensor, true);
    const ScanAir clear(sensor, {});
    BeamReceiver receiver(sensor, plan, 0, mode, clear);
    double sum = 0.0;
    double count = 0.0;
    for (std::uint64_t beam = 0; beam < 4000; ++beam)
    {
      for (const Return& one : inTheDark(receiver, clear, beam).returns)
      {
        ASSERT_GE(one.range, 9.7);
        ASSERT_LE(one.range, 10.0);
        sum += one.range;
        count += 1.0;
      }
    }
    ASSERT_GT(count, 400.0);
    EXPECT_NEAR(sum / count, 9.85, 4.5 * 0.3 / std::sqrt(12.0 * count));
  }
}

TEST(Receiver, RangesFarBelowAUnitKeepTheirDigits)
{
  // Units of 150 km. Differences from the centre of one would be rounded to 1e-11 m, also below 0.
  Sensor sensor = unitSensor();
  sensor.samplingInterval = 1e-3;
  sensor.rangeGate = 1e6;
  Bench bench(sensor, ReturnMode::All);
  for (double range = 1e-20; range < 1e5; range *= 9.7)
  {
    const auto& returns = bench({ { range, 2.0 }, { 3.0 * range, 2.0 } });
    if (3.0 * range < sensor.rangeUnitLength())
    {
      ASSERT_EQ(returns.size(), 1u);
      EXPECT_NEAR(returns[0].range / (2.0 * range), 1.0, 1e-15);
    }
  }
}

TEST(ReceiverNoise, AUnitsNoiseDoesNotDependOnItsEcho)
{
  Sensor sensor = unitSensor();
  sensor.rangeGate = 200.0;
  sensor.noisePhotonRate = 3.0 / sensor.samplingInterval;
  sensor.lowerEnergyLimit = 4.0 * sensor.photonEnergy();
  sensor.upperEnergyLimit = 1.0;
  Bench empty(sensor, ReturnMode::All);
  Bench full(sensor, ReturnMode::All);
  empty({});
  std::vector<Pulse> faint;
  for (int unit = 0; unit < 200; ++unit)
  {
    faint.push_back({ unit + 0.5, 1e-40 });
  }
  full(faint);
  EXPECT_EQ(full.Got.units.size(), 200u);
  ASSERT_EQ(full.Got.returns.size(), empty.Got.returns.size());
  for (std::size_t r = 0; r < full.Got.returns.size(); ++r)
  {
    EXPECT_EQ(full.Got.returns[r].returnEnergy, empty.Got.returns[r].returnEnergy);
  }
}
