// SPDX-License-Identifier: BSD-3-Clause
#include "Noise.h"

#include "PhotonReceiver.h"
#include "Random.h"
#include "RangeUnits.h"

#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/special_functions/log1p.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace avianlidar
{
namespace
{
namespace bm = boost::math;

/// No promotion to long double (the same bits where that type differs), and no exceptions: overflow
/// is infinity.
using DoublePolicy = bm::policies::policy<bm::policies::promote_double<false>,
  bm::policies::domain_error<bm::policies::ignore_error>,
  bm::policies::pole_error<bm::policies::ignore_error>,
  bm::policies::overflow_error<bm::policies::ignore_error>,
  bm::policies::underflow_error<bm::policies::ignore_error>,
  bm::policies::evaluation_error<bm::policies::ignore_error>>;

/// From here on the uniform expansion is exact to round-off; Boost's fractions take ever more
/// terms.
constexpr double LargeParameter = 1e5;

/// The probability that any unit exceeds the reported bound, and the units that a scan can have.
constexpr double BoundProbability = 1e-30;
constexpr double BoundUnits = 1e15;

/// A deviate of a unit that raises no false alarm is below CommonDeviate with this probability at
/// least: P(z < 3) = 0.99865, among all units.
constexpr double CommonShare = 0.9986;
constexpr double CommonDeviate = 3.0;

constexpr double Root2 = 1.4142135623730951;

struct GammaRatios
{
  double lower; // P(a, x)
  double upper; // Q(a, x)
};

template <std::size_t Terms>
double polynomial(const double (&coefficients)[Terms], double x)
{
  double sum = 0.0;
  for (std::size_t k = Terms; k-- > 0;)
  {
    sum = sum * x + coefficients[k];
  }
  return sum;
}

/// Temme's uniform expansion (DLMF 8.12.3-8.12.10), a >= 1e5: terms left out are below 1e-13,
/// relative, wherever the result does not underflow.
GammaRatios largeGammaRatios(double a, double x)
{
  static const double c0[] = { -0.33333333333333333, 0.083333333333333333, -0.014814814814814815,
    0.0011574074074074074, 0.0003527336860670194, -0.00017875514403292181, 0.39192631785224378e-4,
    -0.21854485106799922e-5, -0.185406221071516e-5, 0.8296711340953086e-6,
    -0.17665952736826079e-6 };
  static const double c1[] = { -0.0018518518518518519, -0.0034722222222222222,
    0.0026455026455026455, -0.00099022633744855967, 0.00020576131687242798 };
  const double y = -a * bm::log1pmx((x - a) / a, DoublePolicy()); // a eta^2/2
  if (!(y < 700.0))
  {
    return x < a ? GammaRatios{ 0.0, 1.0 } : GammaRatios{ 1.0, 0.0 };
  }
  const double eta = std::copysign(std::sqrt(2.0 * y / a), x - a);
  const double rest =
    std::exp(-y) / std::sqrt(2.0 * Pi * a) * (polynomial(c0, eta) + polynomial(c1, eta) / a);
  const double root = std::copysign(std::sqrt(y), x - a);
  return { 0.5 * std::erfc(-root) - rest, 0.5 * std::erfc(root) + rest };
}

/// Smallest whole number for which `good` holds, good(infinity) being true and `good` monotone.
template <typename Predicate>
double smallestCount(double mean, const Predicate& good)
{
  double step = std::max(1.0, std::floor(std::sqrt(mean)));
  double low = std::floor(mean);
  double high = low;
  if (good(low))
  {
    do
    {
      high = low;
      low = std::max(-1.0, low - step);
      step *= 2.0;
    } while (low >= 0.0 && good(low));
  }
  else
  {
    do
    {
      low = high;
      high += step;
      step *= 2.0;
    } while (!good(high));
  }
  while (high - low > 1.0)
  {
    const double middle = std::floor(0.5 * (low + high));
    (good(middle) ? high : low) = middle;
  }
  return high;
}

/// The most photons whose energy is not above the limit.
double countWithin(double limit, double photon)
{
  double count = std::floor(limit / photon);
  if (count >= 0x1p52)
  {
    return count; // beyond any number of photons that is modelled
  }
  // The product decides, as it does when noise meets the limit.
  while (count > 0.0 && count * photon > limit)
  {
    count -= 1.0;
  }
  while ((count + 1.0) * photon <= limit)
  {
    count += 1.0;
  }
  return count;
}
}

double poissonCdf(double mean, double count)
{
  if (count < 0.0)
  {
    return 0.0;
  }
  if (!(mean > 0.0))
  {
    return 1.0;
  }
  return count + 1.0 >= LargeParameter ? largeGammaRatios(count + 1.0, mean).upper
                                       : bm::gamma_q(count + 1.0, mean, DoublePolicy());
}

double poissonTail(double mean, double count)
{
  if (count < 0.0)
  {
    return 1.0;
  }
  if (!(mean > 0.0))
  {
    return 0.0;
  }
  return count + 1.0 >= LargeParameter ? largeGammaRatios(count + 1.0, mean).lower
                                       : bm::gamma_p(count + 1.0, mean, DoublePolicy());
}

double poissonQuantile(double mean, double p, double q)
{
  if (!(q > 0.0))
  {
    return std::numeric_limits<double>::infinity();
  }
  if (!(mean > 0.0) || !(p > 0.0))
  {
    return 0.0;
  }
  return p <= q ? smallestCount(mean, [mean, p](double n) { return poissonCdf(mean, n) >= p; })
                : smallestCount(mean, [mean, q](double n) { return poissonTail(mean, n) <= q; });
}

namespace
{
void planGaussian(const Sensor& sensor, NoisePlan& plan)
{
  const PhotonReceiver receiver(sensor);
  const double joules = 1.0 / receiver.electronsPerJoule;
  plan.active = true;
  plan.gaussian = true;
  plan.darkVariance = receiver.darkVariance * joules * joules;
  plan.varianceOfEnergy = receiver.excess * joules;
  const double k = sensor.lowerEnergyLimit / std::sqrt(plan.darkVariance);
  plan.alarmProbability = 0.5 * std::erfc(k / Root2);
  plan.quietProbability = 0.5 * std::erfc(-k / Root2);
  plan.falseAlarmsPerBeam = plan.alarmProbability * static_cast<double>(plan.gateUnits);
}
}

NoisePlan planNoise(const Sensor& sensor, bool enabled, bool inFull)
{
  NoisePlan plan;
  plan.gateUnits = unitsInsideGate(sensor.samplingInterval, sensor.rangeGate);
  plan.photonEnergy = sensor.photonEnergy();
  if (sensor.receiverModel == ReceiverModel::Photons)
  {
    if (enabled)
    {
      planGaussian(sensor, plan);
    }
    return plan;
  }
  plan.meanPhotons = enabled ? sensor.noisePhotonRate * sensor.samplingInterval : 0.0;
  if (!(plan.meanPhotons > 0.0))
  {
    return plan;
  }
  if (plan.meanPhotons > MaximumMeanPhotons)
  {
    plan.active = true; // an error: see checkNoise()
    return plan;
  }
  plan.bound =
    poissonQuantile(plan.meanPhotons, 1.0, BoundProbability / BoundUnits) * plan.photonEnergy;
  plan.active = inFull || !(plan.bound < NegligibleNoiseShare * sensor.lowerEnergyLimit);
  if (plan.active)
  {
    plan.alarmPhotons = countWithin(sensor.lowerEnergyLimit, plan.photonEnergy);
    plan.alarmProbability = poissonTail(plan.meanPhotons, plan.alarmPhotons);
    plan.quietProbability = poissonCdf(plan.meanPhotons, plan.alarmPhotons);
    plan.falseAlarmsPerBeam = plan.alarmProbability * static_cast<double>(plan.gateUnits);
  }
  return plan;
}

std::string checkNoise(const NoisePlan& plan, std::uint64_t beams)
{
  std::ostringstream text;
  text.precision(6);
  const char* const cause =
    plan.gaussian ? "the noise of the photon receiver" : "noise_photon_rate";
  const double perScan = plan.falseAlarmsPerBeam * static_cast<double>(beams);
  if (plan.meanPhotons > MaximumMeanPhotons)
  {
    text << "noise_photon_rate times sampling_interval is " << plan.meanPhotons
         << ", expected at most " << MaximumMeanPhotons << " photons";
  }
  else if (plan.falseAlarmsPerBeam > MaximumFalseAlarmsPerBeam)
  {
    text << cause << " and lower_energy_limit give " << plan.falseAlarmsPerBeam
         << " false alarms per beam, expected at most " << MaximumFalseAlarmsPerBeam;
  }
  else if (perScan > MaximumFalseAlarmsPerScan)
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
  if (!plan.active || !(plan.alarmProbability > 0.0))
  {
    return;
  }
  // Quiet units between two alarms are geometric: floor(ln u/ln(1 - p)); ln(1 - p) from the smaller
  // of the two.
  const double logQuiet = plan.alarmProbability > 0.5 ? std::log(plan.quietProbability)
                                                      : std::log1p(-plan.alarmProbability);
  std::int64_t unit = 0;
  for (std::uint64_t draw = 0; unit < plan.gateUnits; ++draw)
  {
    const double u = uniformPair(seed, beam, draw, RandomPurpose::FalseAlarms, revolution)[0];
    const double gap = std::floor(std::log(u) / logQuiet);
    if (!(gap < static_cast<double>(plan.gateUnits - unit)))
    {
      return;
    }
    unit += static_cast<std::int64_t>(gap);
    this->Alarms.push_back(unit);
    ++unit;
  }
}

/// Photons of a unit. @param u uniform in (0, 1) @param alarm they exceed Qlow alone
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

/// The same of a standard normal deviate.
double BeamNoise::deviate(double u, bool alarm) const
{
  const NoisePlan& plan = this->Plan;
  const double above = alarm ? (1.0 - u) * plan.alarmProbability
                             : plan.alarmProbability + (1.0 - u) * plan.quietProbability;
  // The smaller of the two tails has the digits.
  return above < 0.5 ? Root2 * bm::erfc_inv(2.0 * above, DoublePolicy())
                     : -Root2 * bm::erfc_inv(2.0 * u * plan.quietProbability, DoublePolicy());
}

double BeamNoise::energy(std::int64_t unit, double light, double limit) const
{
  const NoisePlan& plan = this->Plan;
  if (!plan.active || unit < 0 || unit >= plan.gateUnits)
  {
    return 0.0;
  }
  const double u = uniformPair(this->Seed, this->Beam, static_cast<std::uint64_t>(unit),
    RandomPurpose::Noise, this->Revolution)[0];
  const bool alarm = std::binary_search(this->Alarms.begin(), this->Alarms.end(), unit);
  if (!plan.gaussian)
  {
    return this->photons(u, alarm) * plan.photonEnergy;
  }
  const double deviation = std::sqrt(plan.darkVariance + plan.varianceOfEnergy * light);
  // Most units of grazing beams get so little that only a rare deviate would make them perceived.
  const bool hopeless = !alarm && u < CommonShare && light + CommonDeviate * deviation < limit;
  return hopeless ? 0.0 : deviation * this->deviate(u, alarm);
}
}
