// SPDX-License-Identifier: BSD-3-Clause
#include "Noise.h"

#include "PhotonReceiver.h"
#include "Random.h"
#include "RangeUnits.h"

#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/special_functions/log1p.hpp>
#include <boost/math/tools/rational.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

namespace avianlidar
{
namespace
{
namespace bm = boost::math;

/// Policy without promotion to long double, so that systems with another long double give the same
/// bits. Without exceptions, overflow is infinity.
using DoublePolicy = bm::policies::policy<bm::policies::promote_double<false>,
  bm::policies::domain_error<bm::policies::ignore_error>,
  bm::policies::pole_error<bm::policies::ignore_error>,
  bm::policies::overflow_error<bm::policies::ignore_error>,
  bm::policies::underflow_error<bm::policies::ignore_error>,
  bm::policies::evaluation_error<bm::policies::ignore_error>>;

/// Parameter above which the uniform expansion is exact to round-off. Boost's fractions take ever
/// more terms there.
constexpr double LargeParameter = 1e5;

/// Probability that any unit exceeds the reported bound, and largest number of units of a scan.
constexpr double BoundProbability = 1e-30;
constexpr double BoundUnits = 1e15;

/// Share of units with a common deviate, below CommonDeviate, among the units without a false
/// alarm. Among all units, P(z < 3) = 0.99865.
constexpr double CommonShare = 0.9986;

/// P(a, x), or Q(a, x) with `isTail`, by Temme's uniform expansion (DLMF 8.12.3-8.12.10), a >= 1e5:
/// terms left out are below 1e-13, relative, wherever the result does not underflow.
double largeGammaRatio(double a, double x, bool isTail)
{
  using boost::math::tools::evaluate_polynomial;
  static const double c0[] = { -0.33333333333333333, 0.083333333333333333, -0.014814814814814815,
    0.0011574074074074074, 0.0003527336860670194, -0.00017875514403292181, 0.39192631785224378e-4,
    -0.21854485106799922e-5, -0.185406221071516e-5, 0.8296711340953086e-6,
    -0.17665952736826079e-6 };
  static const double c1[] = { -0.0018518518518518519, -0.0034722222222222222,
    0.0026455026455026455, -0.00099022633744855967, 0.00020576131687242798 };
  const double y = -a * bm::log1pmx((x - a) / a, DoublePolicy()); // a eta^2/2
  const double sign = isTail ? 1.0 : -1.0;
  if (!(y < 700.0))
  {
    return sign * (x - a) < 0.0 ? 1.0 : 0.0;
  }
  const double eta = std::copysign(std::sqrt(2.0 * y / a), x - a);
  const double rest = std::exp(-y) / std::sqrt(2.0 * Pi * a) *
    (evaluate_polynomial(c0, eta, std::size(c0)) + evaluate_polynomial(c1, eta, std::size(c1)) / a);
  return 0.5 * std::erfc(sign * std::copysign(std::sqrt(y), x - a)) + sign * rest;
}

/// Smallest whole number for which `good` holds, good(infinity) being true and `good` monotone.
template <typename Predicate>
double smallestCount(double mean, const Predicate& good)
{
  double step = std::max(1.0, std::floor(std::sqrt(mean)));
  double low = std::floor(mean);
  double high = low;
  for (; low >= 0.0 && good(low); step *= 2.0)
  {
    high = low;
    low = std::max(-1.0, low - step);
  }
  for (bool isBracketed = high > low; !isBracketed; step *= 2.0)
  {
    low = high;
    high += step;
    isBracketed = good(high);
  }
  while (high - low > 1.0)
  {
    const double middle = std::floor(0.5 * (low + high));
    (good(middle) ? high : low) = middle;
  }
  return high;
}

/// A standard normal deviate. @param below, above tails of the deviate, which sum to 1: the smaller
/// tail has the digits
double deviate(double below, double above)
{
  return above < 0.5 ? Root2 * bm::erfc_inv(2.0 * above, DoublePolicy())
                     : -Root2 * bm::erfc_inv(2.0 * below, DoublePolicy());
}

/// Largest number of photons whose energy is not above the limit.
double countWithin(double limit, double photon)
{
  // The product decides, as in the comparison of noise with the limit.
  const double count = std::floor(limit / photon);
  return (count + 1.0) * photon <= limit ? count + 1.0
    : count * photon <= limit            ? count
                                         : count - 1.0;
}
}

double gammaTail(double shape, double x)
{
  return shape >= LargeParameter ? largeGammaRatio(shape, x, true)
                                 : bm::gamma_q(shape, x, DoublePolicy());
}

double poissonCdf(double mean, double count)
{
  return count < 0.0 ? 0.0 : gammaTail(count + 1.0, mean);
}

double poissonTail(double mean, double count)
{
  return count < 0.0                ? 1.0
    : count + 1.0 >= LargeParameter ? largeGammaRatio(count + 1.0, mean, false)
                                    : bm::gamma_p(count + 1.0, mean, DoublePolicy());
}

double poissonQuantile(double mean, double p, double q)
{
  if (!(q > 0.0))
  {
    return Infinity;
  }
  if (!(mean > 0.0) || !(p > 0.0))
  {
    return 0.0;
  }
  return p <= q ? smallestCount(mean, [mean, p](double n) { return poissonCdf(mean, n) >= p; })
                : smallestCount(mean, [mean, q](double n) { return poissonTail(mean, n) <= q; });
}

double leastLight(double limit, double dark, double perEnergy)
{
  const double square = CommonDeviate * CommonDeviate;
  const double half = limit + 0.5 * square * perEnergy;
  const double rest = limit * limit - square * dark;
  return limit > 0.0 && rest > 0.0 ? (1.0 - 1e-9) * rest / (half + std::sqrt(half * half - rest))
                                   : -Infinity;
}

NoisePlan planNoise(const Sensor& sensor, bool enabled, bool inFull)
{
  NoisePlan plan;
  plan.gateUnits = unitsInsideGate(sensor.samplingInterval, sensor.rangeGate);
  plan.firstUnit = firstUnitInsideGate(sensor.samplingInterval, sensor.minimumRange);
  plan.photonEnergy = sensor.photonEnergy();
  plan.enabled = plan.ofRanges = enabled;
  plan.gaussian = enabled && sensor.receiverModel == ReceiverModel::Photons;
  plan.meanPhotons =
    enabled && !plan.gaussian ? sensor.noisePhotonRate * sensor.samplingInterval : 0.0;
  if (plan.gaussian)
  {
    const PhotonReceiver receiver(sensor);
    const double joules = 1.0 / receiver.electronsPerJoule;
    plan.active = true;
    plan.darkVariance = receiver.darkVariance * joules * joules;
    plan.varianceOfEnergy = receiver.excess * joules;
    const double k = sensor.lowerEnergyLimit / std::sqrt(plan.darkVariance);
    plan.alarmProbability = 0.5 * std::erfc(k / Root2);
    plan.quietProbability = 0.5 * std::erfc(-k / Root2);
    plan.faintLight = leastLight(sensor.lowerEnergyLimit, plan.darkVariance, plan.varianceOfEnergy);
  }
  else if (plan.meanPhotons > MaximumMeanPhotons)
  {
    plan.active = true; // checkNoise() reports the error
  }
  else if (plan.meanPhotons > 0.0)
  {
    plan.bound =
      poissonQuantile(plan.meanPhotons, 1.0, BoundProbability / BoundUnits) * plan.photonEnergy;
    plan.active = inFull || !(plan.bound < NegligibleNoiseShare * sensor.lowerEnergyLimit);
    plan.alarmPhotons = countWithin(sensor.lowerEnergyLimit, plan.photonEnergy);
    plan.alarmProbability = poissonTail(plan.meanPhotons, plan.alarmPhotons);
    plan.quietProbability = poissonCdf(plan.meanPhotons, plan.alarmPhotons);
  }
  plan.falseAlarmsPerBeam =
    plan.alarmProbability * static_cast<double>(plan.gateUnits - plan.firstUnit);
  return plan;
}

std::string checkNoise(const NoisePlan& plan, std::uint64_t beams)
{
  std::ostringstream text;
  text.precision(6);
  const char* const cause =
    plan.gaussian ? "the noise of the photon receiver" : "noise_photon_rate";
  const double perScan = plan.falseAlarmsPerBeam * static_cast<double>(beams);
  // A photon receiver's limit follows from the requested false alarms, and is rounded.
  constexpr double rounding = 1.0 + 1e-9;
  if (plan.meanPhotons > MaximumMeanPhotons)
  {
    text << "noise_photon_rate times sampling_interval is " << plan.meanPhotons
         << ", expected at most " << MaximumMeanPhotons << " photons";
  }
  else if (plan.falseAlarmsPerBeam > rounding * MaximumFalseAlarmsPerBeam)
  {
    text << cause << " and lower_energy_limit give " << plan.falseAlarmsPerBeam
         << " false alarms per beam, expected at most " << MaximumFalseAlarmsPerBeam;
  }
  else if (perScan > rounding * MaximumFalseAlarmsPerScan)
  {
    text << cause << " and lower_energy_limit give " << perScan << " false alarms in " << beams
         << " beams, expected at most " << MaximumFalseAlarmsPerScan;
  }
  return text.str();
}

void BeamNoise::begin(
  const NoisePlan& plan, std::int32_t seed, std::uint64_t beam, std::int32_t revolution)
{
  this->Plan = plan;
  this->Seed = seed;
  this->Beam = beam;
  this->Revolution = revolution;
  this->Alarms.clear();
  this->RareBegin = -1;
  if (!plan.active || !(plan.alarmProbability > 0.0))
  {
    return;
  }
  // ln(1 - p) from the smaller of the two probabilities.
  const double logQuiet = plan.alarmProbability > 0.5 ? std::log(plan.quietProbability)
                                                      : std::log1p(-plan.alarmProbability);
  this->forEachInGaps(logQuiet, plan.firstUnit, plan.gateUnits, RandomPurpose::FalseAlarms,
    [&](std::int64_t unit) { this->Alarms.push_back(unit); });
}

/// Uniform random numbers that belong to a unit or to another index.
std::array<double, 2> BeamNoise::draw(std::int64_t unit, RandomPurpose purpose) const
{
  return uniformPair(
    this->Seed, this->Beam, static_cast<std::uint64_t>(unit), purpose, this->Revolution);
}

/// Calls f(unit) for units drawn independently. The number of units between two of them is
/// geometric, floor(ln u/ln(1 - p)).
template <class F>
void BeamNoise::forEachInGaps(
  double logOthers, std::int64_t begin, std::int64_t end, RandomPurpose purpose, F f) const
{
  for (std::int64_t number = begin; begin < end; ++number)
  {
    const double gap = std::floor(std::log(this->draw(number, purpose)[0]) / logOthers);
    if (!(gap < static_cast<double>(end - begin)))
    {
      return;
    }
    begin += static_cast<std::int64_t>(gap);
    f(begin);
    ++begin;
  }
}

bool BeamNoise::isRare(std::int64_t unit)
{
  const std::int64_t begin = unit - unit % UnitsOfBlock;
  if (begin != this->RareBegin)
  {
    static const double logCommon = std::log(CommonShare);
    this->RareBegin = begin;
    this->Rare.reset();
    this->forEachInGaps(logCommon, begin, begin + UnitsOfBlock, RandomPurpose::RareNoise,
      [&](std::int64_t one) { this->Rare.set(static_cast<std::size_t>(one - begin)); });
  }
  return this->Rare.test(static_cast<std::size_t>(unit - begin)) && !this->isAlarm(unit);
}

/// Photons of a unit. @param u uniform in (0, 1) @param alarm true if the photons alone exceed Qlow
double BeamNoise::photons(double u, bool alarm) const
{
  const NoisePlan& plan = this->Plan;
  if (alarm)
  {
    const double q = (1.0 - u) * plan.alarmProbability;
    return std::max(plan.alarmPhotons + 1.0,
      poissonQuantile(plan.meanPhotons, plan.quietProbability + u * plan.alarmProbability, q));
  }
  const double q = plan.alarmProbability + (1.0 - u) * plan.quietProbability;
  return std::min(
    plan.alarmPhotons, poissonQuantile(plan.meanPhotons, u * plan.quietProbability, q));
}

double BeamNoise::rangeDeviate(std::int64_t unit) const
{
  const double u = this->draw(unit, RandomPurpose::RangeNoise)[0];
  return deviate(u, 1.0 - u);
}

double BeamNoise::place(std::int64_t unit) const
{
  // energy() uses the first number of the pair.
  return this->draw(unit, RandomPurpose::Noise)[1];
}

double BeamNoise::energy(std::int64_t unit, double light)
{
  const NoisePlan& plan = this->Plan;
  if (!plan.active || unit < plan.firstUnit || unit >= plan.gateUnits)
  {
    return 0.0;
  }
  const double u = this->draw(unit, RandomPurpose::Noise)[0];
  const bool alarm = this->isAlarm(unit);
  if (!plan.gaussian)
  {
    return this->photons(u, alarm) * plan.photonEnergy;
  }
  const double deviation = std::sqrt(plan.darkVariance + plan.varianceOfEnergy * light);
  if (alarm)
  {
    const double above = (1.0 - u) * plan.alarmProbability;
    return deviation * deviate(plan.quietProbability + u * plan.alarmProbability, above);
  }
  // Shares of the deviates that raise no alarm.
  const bool rare = this->isRare(unit);
  const double below = rare ? CommonShare + (1.0 - CommonShare) * u : CommonShare * u;
  const double rest =
    rare ? (1.0 - CommonShare) * (1.0 - u) : (1.0 - CommonShare) + CommonShare * (1.0 - u);
  return deviation *
    deviate(below * plan.quietProbability, plan.alarmProbability + rest * plan.quietProbability);
}
}
