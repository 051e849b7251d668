// SPDX-License-Identifier: BSD-3-Clause
#include "ReceivedPulse.h"

#include "Sensor.h"
#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

namespace avianlidar
{
namespace
{
constexpr std::size_t Steps = 2048; ///< steps of the table
constexpr int PartsOfSamples = 256; ///< parts of sampled power that a response smooths one by one
constexpr double LongestTail = 2.0; ///< distance at which a Gaussian ends, over its full width

/// A power with straight lines between samples.
class SampledPower
{
public:
  /// @param samples time, s, and power of each sample
  explicit SampledPower(const std::vector<double>& samples)
  {
    for (std::size_t i = 0; i < samples.size(); i += 2)
    {
      this->Times.push_back(samples[i]);
      this->Powers.push_back(samples[i + 1]);
    }
    this->Sums.assign(this->Times.size(), 0.0);
    double moment = 0.0;
    for (std::size_t i = 1; i < this->Times.size(); ++i)
    {
      const double from = this->Times[i - 1], step = this->Times[i] - from;
      const double p = this->Powers[i - 1], q = this->Powers[i];
      this->Sums[i] = this->Sums[i - 1] + 0.5 * step * (p + q);
      moment += step * (from * 0.5 * (p + q) + step * (p + 2.0 * q) / 6.0);
    }
    this->Mean = moment / this->Sums.back();
  }

  double begin() const { return this->Times.front() - this->Mean; }
  double end() const { return this->Times.back() - this->Mean; }
  /// Share of the energy before a time, and power over the energy. Times count from the mean.
  std::pair<double, double> at(double time) const
  {
    const double t = std::clamp(time + this->Mean, this->Times.front(), this->Times.back());
    const auto next = std::upper_bound(this->Times.begin() + 1, this->Times.end() - 1, t);
    const auto i = static_cast<std::size_t>(next - this->Times.begin());
    const double step = this->Times[i] - this->Times[i - 1], part = t - this->Times[i - 1];
    const double rise = (this->Powers[i] - this->Powers[i - 1]) / step;
    const double sum = this->Sums[i - 1] + part * (this->Powers[i - 1] + 0.5 * part * rise);
    return { sum / this->Sums.back(), (this->Powers[i - 1] + part * rise) / this->Sums.back() };
  }

private:
  std::vector<double> Times, Powers, Sums;
  double Mean = 0.0;
};
}

ReceivedPulse::ReceivedPulse(const Sensor& sensor, double interval)
  : ReceivedPulse(sensor.pulseWidth / interval)
{
  const bool isGaussian = sensor.pulseShape == PulseShape::Gaussian;
  const bool isSampled = sensor.pulseShape == PulseShape::Samples;
  double width = isGaussian ? sensor.pulseWidth : 0.0; // full width of what is smooth, s
  // What is not smooth, as shares of the energy at equal steps.
  double begin = isGaussian ? 0.0 : -0.5 * sensor.pulseWidth;
  double end = -begin;
  std::function<std::pair<double, double>(double)> at;
  if (isSampled)
  {
    const SampledPower power(sensor.pulseSamples);
    begin = power.begin();
    end = power.end();
    at = [power](double time) { return power.at(time); };
  }
  const double length = end - begin;
  width = std::hypot(width, sensor.responseTime);
  width = 1000.0 * width < length ? 0.0 : width;
  if (!(width > 0.0) && !isSampled)
  {
    return;
  }
  this->Before = (LongestTail * width - begin) / interval;
  this->After = (LongestTail * width + end) / interval;
  const double step = (length + 2.0 * LongestTail * width) / static_cast<double>(Steps);
  const double first = begin - LongestTail * width;
  const double deviation = width / WidthOfGaussian;
  const auto below = [](double z) { return 0.5 * std::erfc(-z / Root2); };
  const auto integral = [&](double z)
  { return z * below(z) + std::exp(-0.5 * z * z) / std::sqrt(2.0 * Pi); };
  for (std::size_t i = 0; i <= Steps; ++i)
  {
    const double time = first + step * static_cast<double>(i);
    Node node{ 0.0, 0.0 };
    if (!(width > 0.0))
    {
      const auto [share, power] = at(time);
      node = { share, power * step };
    }
    else if (!(length > 0.0))
    {
      const double z = time / deviation;
      node = { below(z), std::exp(-0.5 * z * z) / std::sqrt(2.0 * Pi) * step / deviation };
    }
    // The power is constant within a part.
    const int parts = !(width > 0.0 && length > 0.0) ? 0 : isSampled ? PartsOfSamples : 1;
    const double part = length / deviation / parts;
    for (int k = 0; k < parts; ++k)
    {
      const auto shareTo = [&](int n) { return at ? at(begin + length * n / parts).first : n; };
      const double density = (shareTo(k + 1) - shareTo(k)) / part;
      const double z = (time - begin) / deviation - part * k;
      node.share += density * (integral(z) - integral(z - part));
      node.slope += density * (below(z) - below(z - part)) * step / deviation;
    }
    this->Table.push_back(node);
  }
  const double cut = this->Table.front().share;
  const double rest = this->Table.back().share - cut;
  for (Node& node : this->Table)
  {
    node = { (node.share - cut) / rest, node.slope / rest };
  }
}

double ReceivedPulse::lookUp(double part) const
{
  const double at = std::clamp(part, 0.0, 1.0) * static_cast<double>(Steps);
  const std::size_t i = std::min(static_cast<std::size_t>(at), Steps - 1);
  const double x = at - static_cast<double>(i);
  const Node& from = this->Table[i];
  const Node& to = this->Table[i + 1];
  const double rise = to.share - from.share;
  // Cubic with the shares and slopes of both nodes.
  return from.share +
    x *
    (from.slope +
      x * (3.0 * rise - 2.0 * from.slope - to.slope + x * (from.slope + to.slope - 2.0 * rise)));
}

double ReceivedPulse::shareBefore(double place) const
{
  const double width = this->width();
  return width > 0.0 ? this->shareOf(std::clamp((place + this->Before) / width, 0.0, 1.0))
                     : (place >= 0.0 ? 1.0 : 0.0);
}

std::string checkPulseSamples(const Sensor& sensor)
{
  const std::vector<double>& samples = sensor.pulseSamples;
  const std::size_t count = samples.size() / 2;
  bool hasEnergy = false;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double time = samples[2 * i], power = samples[2 * i + 1];
    const std::string sample = "pulse_samples, sample " + std::to_string(i) + ": the ";
    if (!std::isfinite(time) || (i > 0 && !(time > samples[2 * i - 2])))
    {
      return valueError(
        (sample + "time").c_str(), time, "a time, s, after that of the sample before");
    }
    if (!(power >= 0.0 && power <= MaximumEnergy))
    {
      return valueError((sample + "power").c_str(), power, "0 to 1e50");
    }
    hasEnergy = hasEnergy || power > 0.0;
  }
  if (count < 2 || samples.size() % 2 != 0)
  {
    return valueError("pulse_samples, number of samples", static_cast<double>(count),
      "2 or more, each with a time (s) and a power");
  }
  if (!hasEnergy)
  {
    return valueError("pulse_samples, greatest power", 0.0, "more than 0");
  }
  const double length = samples[2 * count - 2] - samples[0];
  return rangeError("pulse_samples, time from the first to the last sample", length, 0.0,
    1000.0 * sensor.samplingInterval, "at most 1000 times sampling_interval");
}
}
