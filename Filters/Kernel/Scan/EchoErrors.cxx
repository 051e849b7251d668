// SPDX-License-Identifier: BSD-3-Clause
#include "EchoErrors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
constexpr double Ghost = 0.5;    ///< share of the energy over two reflections
constexpr double Surely = 1.645; ///< standard deviations of a one-sided bound of 95 %
constexpr double OfNone = 3.0;   ///< 95 % bound of a count, beyond sqrt(count), if few were seen
constexpr double FewestCarriers = 30.0; ///< beams from which a bound of an rms follows

std::size_t nearest(const std::vector<SeenEcho>& echoes, double range)
{
  std::size_t best = 0;
  for (std::size_t i = 1; i < echoes.size(); ++i)
  {
    best = std::fabs(echoes[i].range - range) < std::fabs(echoes[best].range - range) ? i : best;
  }
  return best;
}

/// Pairs of echoes, each the nearest of the other and within the tolerance, m.
std::vector<std::array<std::size_t, 2>> matches(
  const std::vector<SeenEcho>& one, const std::vector<SeenEcho>& other, double tolerance)
{
  std::vector<std::array<std::size_t, 2>> pairs;
  for (std::size_t i = 0; i < one.size() && !other.empty(); ++i)
  {
    const std::size_t j = nearest(other, one[i].range);
    if (nearest(one, other[j].range) == i && std::fabs(one[i].range - other[j].range) < tolerance)
    {
      pairs.push_back({ i, j });
    }
  }
  return pairs;
}
}

EchoesByBeam byBeam(const ScanResult& result)
{
  EchoesByBeam beams(result.reports.size());
  for (std::size_t e = 0; e < result.echoes.size(); ++e)
  {
    beams[result.beamOfEcho[e]].push_back(
      { result.echoes[e].range, result.echoes[e].energyReceived, result.echoes[e].secondaryShare });
  }
  return beams;
}

EchoReference::EchoReference(double tolerance, double strong)
  : Tolerance(tolerance)
  , Strong(strong)
{
}

void EchoReference::resize(std::size_t beams)
{
  this->Sure.resize(beams);
  this->Undecided.resize(beams);
  this->Spread.resize(beams);
  this->Bias.resize(beams);
}

void EchoReference::average(std::size_t b, const std::vector<std::vector<SeenEcho>>& scans)
{
  this->Sure[b].clear();
  this->Undecided[b].clear();
  CountedErrors spread;
  const std::size_t needed = scans.size() - scans.size() / 8;
  std::vector<std::vector<SeenEcho>> found(scans[0].size());
  std::vector<SeenEcho> others;
  for (const std::vector<SeenEcho>& scan : scans)
  {
    std::vector<char> known(scan.size(), 0);
    for (const auto& [i, j] : matches(scans[0], scan, this->Tolerance))
    {
      found[i].push_back(scan[j]);
      known[j] = 1;
    }
    for (std::size_t j = 0; j < scan.size(); ++j)
    {
      known[j] ? void() : others.push_back(scan[j]);
    }
  }
  for (const std::vector<SeenEcho>& all : found)
  {
    const auto n = static_cast<double>(all.size());
    SeenEcho mean{ 0.0, 0.0, 0.0 };
    for (const SeenEcho& one : all)
    {
      mean.range += one.range / n;
      mean.energy += one.energy / n;
      mean.secondary += one.secondary / n;
    }
    if (all.size() < needed)
    {
      others.push_back(mean);
      continue;
    }
    this->Sure[b].push_back(mean);
    for (const SeenEcho& one : all)
    {
      if (this->isStrong(mean))
      {
        const double variance = 1.0 / (n * (n - 1.0)); // of the mean
        spread.x[EnergyError] += variance * std::pow(one.energy / mean.energy - 1.0, 2);
        spread.x[RangeError] += variance * std::pow(one.range - mean.range, 2);
        spread.y[EnergyError] += 1.0 / n;
        spread.y[RangeError] += 1.0 / n;
      }
    }
  }
  spread.x[EchoError] = static_cast<double>(others.size());
  spread.y[EchoError] = static_cast<double>(this->Sure[b].size());
  this->Undecided[b] = std::move(others);
  this->Spread[b] = spread;
}

void EchoReference::compare(std::size_t b, const std::array<EchoesByBeam, 2>& witness)
{
  const auto first = matches(this->Sure[b], witness[0][b], this->Tolerance);
  const auto second = matches(this->Sure[b], witness[1][b], this->Tolerance);
  for (const auto& [i, j] : first)
  {
    for (const auto& [k, l] : second)
    {
      const SeenEcho& truth = this->Sure[b][i];
      if (i == k && this->isStrong(truth))
      {
        const SeenEcho &one = witness[0][b][j], &other = witness[1][b][l];
        // The mean of this product is the square of the bias: the two are independent.
        this->Bias[b].x[EnergyError] +=
          (one.energy / truth.energy - 1.0) * (other.energy / truth.energy - 1.0);
        this->Bias[b].x[RangeError] += (one.range - truth.range) * (other.range - truth.range);
        this->Bias[b].y[EnergyError] += 1.0;
        this->Bias[b].y[RangeError] += 1.0;
      }
    }
  }
}

bool EchoReference::isStrong(const SeenEcho& echo) const
{
  return echo.energy >= this->Strong && echo.secondary <= Ghost;
}

void EchoReference::count(const ScanResult& result, std::vector<CountedErrors>& counted) const
{
  counted.resize(this->Sure.size());
  const EchoesByBeam found = byBeam(result);
  for (std::size_t b = 0; b < found.size(); ++b)
  {
    CountedErrors& here = counted[b];
    const auto pairs = matches(this->Sure[b], found[b], this->Tolerance);
    std::vector<SeenEcho> rest = found[b];
    double strong = 0.0;
    for (auto pair = pairs.rbegin(); pair != pairs.rend(); ++pair)
    {
      const SeenEcho &truth = this->Sure[b][(*pair)[0]], &echo = found[b][(*pair)[1]];
      if (this->isStrong(truth))
      {
        here.x[EnergyError] += std::pow(echo.energy / truth.energy - 1.0, 2);
        here.x[RangeError] += std::pow(echo.range - truth.range, 2);
        strong += 1.0;
      }
      rest[(*pair)[1]].range = -1.0;
    }
    rest.erase(std::remove_if(
                 rest.begin(), rest.end(), [](const SeenEcho& echo) { return echo.range < 0.0; }),
      rest.end());
    const auto all = static_cast<double>(std::count_if(this->Sure[b].begin(), this->Sure[b].end(),
      [this](const SeenEcho& echo) { return this->isStrong(echo); }));
    here.x[EnergyError] += all - strong;
    here.y[EnergyError] += all;
    here.y[RangeError] += strong;
    here.x[EchoError] += static_cast<double>(this->Sure[b].size() - pairs.size() + rest.size() -
      matches(rest, this->Undecided[b], this->Tolerance).size());
    here.y[EchoError] += static_cast<double>(this->Sure[b].size());
  }
}

std::size_t EchoReference::numberOfEchoes() const
{
  std::size_t echoes = 0;
  for (const std::vector<SeenEcho>& beam : this->Sure)
  {
    echoes += beam.size();
  }
  return echoes;
}

/// Sums over beams of which a ratio and its standard error follow.
struct SampledErrors::Sums
{
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  double carriers = 0.0; ///< beams of which y is not 0

  double deviation() const
  {
    const double ratio = this->x / this->y;
    const double square = this->xx - 2.0 * ratio * this->xy + ratio * ratio * this->yy;
    return std::sqrt(std::max(0.0, square)) / this->y;
  }
};

SampledErrors::SampledErrors(
  const std::vector<double>& weights, const std::function<double(double)>& sum)
  : Weights(weights)
  , Sum(sum)
{
}

SampledErrors::Sums SampledErrors::sumsOf(
  const std::vector<CountedErrors>& counted, int error) const
{
  Sums sums;
  for (std::size_t b = 0; b < counted.size(); ++b)
  {
    const double x = this->Weights[b] * counted[b].x[error];
    const double y = this->Weights[b] * counted[b].y[error];
    const double drawn = 1.0 + 1.0 / this->Weights[b]; // the scan that is judged has another seed
    sums.x += x;
    sums.y += y;
    sums.xx += drawn * x * x;
    sums.xy += drawn * x * y;
    sums.yy += drawn * y * y;
    sums.carriers += y > 0.0 ? 1.0 : 0.0;
  }
  for (double* one : { &sums.x, &sums.y, &sums.xx, &sums.xy, &sums.yy, &sums.carriers })
  {
    *one = this->Sum(*one);
  }
  return sums;
}

std::array<double, ErrorKinds> SampledErrors::ownErrors(const EchoReference& reference) const
{
  std::array<double, ErrorKinds> own{};
  for (int error = 0; error < ErrorKinds; ++error)
  {
    const Sums spread = this->sumsOf(reference.spread(), error);
    const Sums bias = this->sumsOf(reference.bias(), error);
    const double by = spread.y > 0.0 ? spread.x / spread.y : 0.0;
    const double off =
      bias.y > 0.0 ? std::max(0.0, bias.x / bias.y - Surely * bias.deviation()) : 0.0;
    own[error] = error == EchoError ? by : std::sqrt(by + off);
  }
  return own;
}

std::array<MeasuredError, ErrorKinds> SampledErrors::errorsOf(
  const std::vector<CountedErrors>& counted, const std::array<double, ErrorKinds>& of) const
{
  std::array<MeasuredError, ErrorKinds> errors;
  for (int error = 0; error < ErrorKinds; ++error)
  {
    const Sums sums = this->sumsOf(counted, error);
    const double ratio = sums.y > 0.0 ? sums.x / sums.y : 0.0;
    double by = sums.y > 0.0 ? Surely * sums.deviation() : 0.0;
    by += sums.x > 0.0 ? OfNone * sums.xx / (sums.x * sums.y) : 0.0;
    const double own = of[error];
    if (error == EchoError)
    {
      const double none = sums.y > 0.0 ? OfNone * sums.yy / (sums.y * sums.y) : 0.0;
      errors[error] = { ratio, std::max(0.0, ratio - by - own), std::max(ratio + by, none) + own };
    }
    else if (sums.carriers < FewestCarriers)
    {
      errors[error] = { std::sqrt(ratio), 0.0, std::numeric_limits<double>::infinity() };
    }
    else
    {
      errors[error] = { std::sqrt(ratio), std::max(0.0, std::sqrt(std::max(0.0, ratio - by)) - own),
        std::sqrt(ratio + by) + own };
    }
  }
  return errors;
}
}
