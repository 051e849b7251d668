// SPDX-License-Identifier: BSD-3-Clause
#include "BeamWaveforms.h"

#include "Distributions.h"
#include "Random.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Largest number of noise photons of a unit that are drawn one by one.
constexpr double MostPhotons = 1000.0;

double unitsOfMargin(const Sensor& sensor)
{
  const ReceivedPulse pulse(sensor, sensor.samplingInterval);
  return std::ceil(std::max(pulse.before(), pulse.after())) + 1.0;
}

/// Order of units for std::lower_bound().
constexpr auto isBefore = [](const auto& one, std::int64_t index) { return one.index < index; };

template <class T>
void appendTo(std::vector<T>& all, const std::vector<T>& more)
{
  all.insert(all.end(), more.begin(), more.end());
}
}

void Waveforms::append(const Waveforms& more)
{
  for (Stretch stretch : more.stretches)
  {
    stretch.begin += this->signal.size();
    this->stretches.push_back(stretch);
  }
  appendTo(this->signal, more.signal);
  appendTo(this->drawn, more.drawn);
  appendTo(this->received, more.received);
  appendTo(this->threshold, more.threshold);
  appendTo(this->shapes, more.shapes);
}

BeamWaveforms::BeamWaveforms(const ScanSetup& setup, const ScanAir& air, BeamReceiver& receiver)
  : Setup(setup)
  , Scan(air)
  , Receiver(receiver)
  , PerUnit(static_cast<std::int64_t>(setup.sensor.samplesOfUnit()))
  , Interval(setup.sensor.samplingInterval / setup.sensor.samplesOfUnit())
  , FirstUnit(firstUnitInsideGate(setup.sensor.samplingInterval, setup.sensor.minimumRange))
  , GateUnits(unitsInsideGate(setup.sensor.samplingInterval, setup.sensor.rangeGate))
  , Margin(static_cast<std::int64_t>(unitsOfMargin(setup.sensor)))
  , Fine(setup.sensor, setup.sensor.samplesOfUnit())
  , Air(air)
{
  const double floor = setup.settings.waveformFloor * setup.sensor.lowerEnergyLimit;
  for (std::int64_t unit = 0; unit < air.units(); ++unit)
  {
    this->AirUnits =
      air.means()[static_cast<std::size_t>(unit)] > floor ? unit + 1 : this->AirUnits;
  }
  const double response = setup.sensor.responseTime / this->Interval;
  if (!(response > 0.0))
  {
    return;
  }
  const double deviation = response / WidthOfGaussian;
  const auto below = [&](double place) { return 0.5 * std::erfc(-place / deviation / Root2); };
  const auto reach = static_cast<std::int64_t>(std::ceil(2.0 * response)) + 1;
  const auto weightAt = [&](std::int64_t m)
  {
    const auto place = static_cast<double>(m);
    return std::abs(m) > reach ? 0.0 : below(place + 0.5) - below(place - 0.5);
  };
  // The variance of a unit's sum of smoothed noise, over that of white noise.
  double variance = 0.0;
  for (std::int64_t from = -reach; from < this->PerUnit + reach; ++from)
  {
    double sum = 0.0;
    for (std::int64_t k = 0; k < this->PerUnit; ++k)
    {
      sum += weightAt(k - from);
    }
    variance += sum * sum;
  }
  const double scale = std::sqrt(static_cast<double>(this->PerUnit) / variance);
  for (std::int64_t m = 0; m <= reach; ++m)
  {
    this->Kernel.push_back(scale * weightAt(m));
  }
  this->NoiseUnits = (reach + this->PerUnit - 1) / this->PerUnit;
}

bool BeamWaveforms::find(const BeamLight& light, const Received& received, const BeamAir& air)
{
  const double floor =
    this->Setup.settings.waveformFloor * this->Receiver.exposureTo(light.radiance).lower;
  this->Air.begin(air, light.surfaces);
  this->Found.clear();
  if (!(floor > 0.0))
  {
    this->Found.emplace_back(this->FirstUnit, this->GateUnits);
    return true;
  }
  const auto inAir = [&](std::int64_t unit) { return this->Air.nextLooked(unit, this->AirUnits); };
  for (std::int64_t unit = inAir(this->FirstUnit); unit < this->GateUnits; unit = inAir(unit + 1))
  {
    if (this->airIn(unit) > floor)
    {
      this->Found.emplace_back(unit, unit + 1);
    }
  }
  for (const RangeUnit& unit : light.units.units())
  {
    if (unit.energy + this->airIn(unit.index) > floor)
    {
      this->Found.emplace_back(unit.index, unit.index + 1);
    }
  }
  for (const Return& run : received.returns)
  {
    this->Found.emplace_back(
      received.units[run.firstUnit].index, received.units[run.lastUnit - 1].index + 1);
  }
  std::sort(this->Found.begin(), this->Found.end());
  std::size_t count = 0;
  for (const Units& one : this->Found)
  {
    const Units wide{ std::max(this->FirstUnit, one.first - this->Margin),
      std::min(this->GateUnits, one.second + this->Margin) };
    if (count > 0 && wide.first <= this->Found[count - 1].second)
    {
      this->Found[count - 1].second = std::max(this->Found[count - 1].second, wide.second);
      continue;
    }
    this->Found[count++] = wide;
  }
  this->Found.resize(count);
  return !this->Found.empty();
}

void BeamWaveforms::record(std::size_t beam, const BeamLight& light, const BeamLight& divided,
  const Received& received, Waveforms& waveforms)
{
  const BeamReceiver::Exposure& exposed = this->Receiver.exposureTo(light.radiance);
  this->Fine.clear();
  if (this->PerUnit > 1 && !light.units.units().empty() && !this->Found.empty())
  {
    this->Fine.take(divided.units);
    this->Fine.accumulate();
  }
  this->Noise.begin(exposed.plan, received.key);
  const std::size_t first = waveforms.stretches.size();
  const double background = exposed.plan.gaussian
    ? exposed.photons.background / exposed.photons.electronsPerJoule
    : exposed.plan.meanPhotons * exposed.plan.photonEnergy;
  for (const Units& one : this->Found)
  {
    waveforms.stretches.push_back({ beam, one.first * this->PerUnit, waveforms.signal.size(),
      background / static_cast<double>(this->PerUnit) });
    this->recordUnits(one, light, received, exposed, waveforms);
  }
  for (const Return& run : received.returns)
  {
    waveforms.shapes.push_back(this->shapeOf(received, run, waveforms, first));
  }
  this->Air.end();
}

/// Set `Signal` to the light of paths in units [begin, end). What a unit receives is the light's
/// own; its division among samples is that of `Fine`.
void BeamWaveforms::setSignal(const BeamLight& light, std::int64_t begin, std::int64_t end)
{
  const std::vector<RangeUnit>& units = light.units.units();
  const std::vector<RangeUnit>& samples = this->Fine.units();
  auto unit = std::lower_bound(units.begin(), units.end(), begin, isBefore);
  auto sample = std::lower_bound(samples.begin(), samples.end(), begin * this->PerUnit, isBefore);
  for (; unit != units.end() && unit->index < end; ++unit)
  {
    double* const signal =
      &this->Signal[static_cast<std::size_t>((unit->index - begin) * this->PerUnit)];
    double sum = 0.0;
    for (; sample != samples.end() && sample->index < (unit->index + 1) * this->PerUnit; ++sample)
    {
      const std::int64_t place = sample->index - unit->index * this->PerUnit;
      if (place >= 0)
      {
        signal[place] = sample->energy;
        sum += sample->energy;
      }
    }
    for (std::int64_t k = 0; k < this->PerUnit; ++k)
    {
      signal[k] = sum > 0.0 ? signal[k] * (unit->energy / sum)
                            : unit->energy / static_cast<double>(this->PerUnit);
    }
  }
}

/// Mean energy that the air returns in a unit, J.
double BeamWaveforms::airIn(std::int64_t unit)
{
  double sum = 0.0;
  for (const AirLight::Share& share : this->Air.sharesOf(unit))
  {
    sum += share.mean;
  }
  return sum;
}

/// Record units. The response also carries noise of their neighbours into them.
void BeamWaveforms::recordUnits(const Units& units, const BeamLight& light,
  const Received& received, const BeamReceiver::Exposure& exposed, Waveforms& waveforms)
{
  const std::int64_t begin = std::max(this->FirstUnit, units.first - this->NoiseUnits);
  const std::int64_t end = std::min(this->GateUnits, units.second + this->NoiseUnits);
  const auto perUnit = static_cast<std::size_t>(this->PerUnit);
  this->Signal.assign(static_cast<std::size_t>(end - begin) * perUnit, 0.0);
  this->White.assign(this->Signal.size(), 0.0);
  this->setSignal(light, begin, end);
  auto known = std::lower_bound(received.units.begin(), received.units.end(), begin, isBefore);
  for (std::int64_t unit = begin; unit < end; ++unit)
  {
    const bool isKnown = known != received.units.end() && known->index == unit;
    const double all = this->airIn(unit);
    const double followed = this->Air.followed(unit);
    const double air = isKnown ? followed + known->leaves : all;
    const auto place = static_cast<std::size_t>(unit - begin) * perUnit;
    double* const signal = &this->Signal[place];
    double sum = 0.0;
    for (std::size_t k = 0; k < perUnit; ++k)
    {
      signal[k] += air / static_cast<double>(this->PerUnit);
      sum += signal[k];
    }
    const double subtracted = this->Setup.sensor.followsAir() ? followed : 0.0;
    const double noise = isKnown ? known->energy + subtracted - sum : this->Noise.energy(unit, sum);
    this->divideNoise(unit, noise, exposed.plan, received.key, place);
    if (unit >= units.first && unit < units.second)
    {
      waveforms.received.insert(waveforms.received.end(), perUnit, sum + noise - subtracted);
      waveforms.threshold.insert(waveforms.threshold.end(), perUnit,
        isKnown ? known->lower : this->Receiver.lowerIn(exposed, followed));
    }
    known += isKnown ? 1 : 0;
  }
  const auto first = static_cast<std::size_t>(units.first - begin) * perUnit;
  const auto last = static_cast<std::size_t>(units.second - begin) * perUnit;
  for (std::size_t i = first; i < last; ++i)
  {
    waveforms.signal.push_back(this->Signal[i]);
    waveforms.drawn.push_back(this->rounded(this->Signal[i] + this->smoothed(i), exposed.upper));
  }
}

/// Divide the noise of a unit among its samples. @param place place of the unit in `White`
void BeamWaveforms::divideNoise(
  std::int64_t unit, double noise, const NoisePlan& plan, const NoiseKey& key, std::size_t place)
{
  const auto perUnit = static_cast<std::size_t>(this->PerUnit);
  const auto uniform = [&](std::int64_t number)
  {
    return uniformPair(key.seed, key.beam, static_cast<std::uint64_t>(number),
      RandomPurpose::Waveforms, key.revolution);
  };
  double* const white = &this->White[place];
  const double photons = plan.photonEnergy > 0.0 ? std::round(noise / plan.photonEnergy) : 0.0;
  if (this->PerUnit == 1)
  {
    white[0] = noise;
    return;
  }
  if (plan.active && !plan.gaussian && photons <= MostPhotons)
  {
    const auto streams = static_cast<std::int64_t>(MostPhotons);
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(photons); ++i)
    {
      const double at = uniform(unit * streams + i)[1] * static_cast<double>(this->PerUnit);
      white[static_cast<std::size_t>(at)] += plan.photonEnergy;
    }
    return;
  }
  // Normal deviates whose sum is given. Many photons are nearly normal, too.
  const double samples = static_cast<double>(this->PerUnit);
  const double dark = plan.gaussian ? plan.darkVariance / samples
                                    : photons * plan.photonEnergy * plan.photonEnergy / samples;
  double sum = 0.0;
  double variances = 0.0;
  const auto varianceOf = [&](std::size_t k)
  { return dark + plan.varianceOfEnergy * std::max(0.0, this->Signal[place + k]); };
  for (std::size_t k = 0; k < perUnit; ++k)
  {
    const double u = uniform(unit * this->PerUnit + static_cast<std::int64_t>(k))[0];
    white[k] = plan.active ? std::sqrt(varianceOf(k)) * normalDeviate(u, 1.0 - u) : 0.0;
    sum += white[k];
    variances += varianceOf(k);
  }
  for (std::size_t k = 0; k < perUnit; ++k)
  {
    white[k] += (variances > 0.0 ? varianceOf(k) / variances : 1.0 / samples) * (noise - sum);
  }
}

/// The noise of a sample behind the response, J.
double BeamWaveforms::smoothed(std::size_t sample) const
{
  if (this->Kernel.empty())
  {
    return this->White[sample];
  }
  double sum = this->Kernel[0] * this->White[sample];
  for (std::size_t m = 1; m < this->Kernel.size(); ++m)
  {
    sum += sample >= m ? this->Kernel[m] * this->White[sample - m] : 0.0;
    sum += sample + m < this->White.size() ? this->Kernel[m] * this->White[sample + m] : 0.0;
  }
  return sum;
}

/// A drawn sample as the digitiser stores it, J. @param upper upper limit of a range unit, J
double BeamWaveforms::rounded(double sample, double upper) const
{
  if (!(this->Setup.sensor.digitiserBits > 0.0))
  {
    return sample;
  }
  const DigitiserLevels levels = this->Setup.sensor.levelsOfDigitiser(upper);
  return levels.step * std::clamp(std::round(sample / levels.step), -levels.below, levels.above);
}

/// @param firstStretch first stretch of the beam
EchoShape BeamWaveforms::shapeOf(const Received& received, const Return& run,
  const Waveforms& waveforms, std::size_t firstStretch) const
{
  const std::int64_t from = received.units[run.firstUnit].index * this->PerUnit;
  const std::int64_t to = (received.units[run.lastUnit - 1].index + 1) * this->PerUnit;
  std::size_t stretch = firstStretch;
  while (stretch + 1 < waveforms.stretches.size() && waveforms.stretches[stretch + 1].first <= from)
  {
    ++stretch;
  }
  const Waveforms::Stretch& of = waveforms.stretches[stretch];
  const auto begin = static_cast<std::int64_t>(of.begin);
  const auto end = static_cast<std::int64_t>(waveforms.endOf(stretch));
  const auto at = [&](std::int64_t i)
  { return i >= begin && i < end ? waveforms.drawn[static_cast<std::size_t>(i)] : 0.0; };
  std::int64_t peak = begin + from - of.first;
  for (std::int64_t i = peak; i < begin + to - of.first; ++i)
  {
    peak = at(i) > at(peak) ? i : peak;
  }
  EchoShape shape;
  const double most = at(peak);
  if (!(most > 0.0))
  {
    return shape;
  }
  // Distance from the peak, in samples, at which the echo falls below a share of its peak.
  const auto fallsAt = [&](double share, std::int64_t step)
  {
    std::int64_t i = peak;
    while (at(i + step) >= share * most)
    {
      i += step;
    }
    return static_cast<double>(std::abs(i - peak)) +
      (at(i) - share * most) / (at(i) - at(i + step));
  };
  shape.amplitude = most / this->Interval;
  shape.width = this->Interval * (fallsAt(0.5, -1) + fallsAt(0.5, 1));
  shape.riseTime = this->Interval * (fallsAt(0.1, -1) - fallsAt(0.9, -1));
  for (const std::int64_t step : { -1, 1 })
  {
    for (std::int64_t i = step < 0 ? peak : peak + 1; at(i) >= 0.1 * most; i += step)
    {
      shape.integral += at(i);
      ++shape.samples;
    }
  }
  return shape;
}
}
