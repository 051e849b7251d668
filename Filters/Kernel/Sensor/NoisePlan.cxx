// SPDX-License-Identifier: BSD-3-Clause
#include "NoisePlan.h"

#include "Distributions.h"
#include "PhotonReceiver.h"

#include <cmath>
#include <sstream>

namespace avianlidar
{
namespace
{
/// Probability that any unit exceeds the reported bound, and largest number of units of a scan.
constexpr double BoundProbability = 1e-30;
constexpr double BoundUnits = 1e15;

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
}
