// SPDX-License-Identifier: BSD-3-Clause
#include "DetectionLaw.h"

#include "PhotonReceiver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Places in a range unit over which the mean is taken.
constexpr int PlacesInUnit = 32;

/// Shares of a pulse in the units that it overlaps. @param place of its middle in a unit, 0 to 1
/// @param width of the pulse, in units
std::vector<double> sharesOf(double place, double width)
{
  const double begin = place - 0.5 * width;
  const double end = place + 0.5 * width;
  std::vector<double> shares;
  for (double unit = std::floor(begin); unit < end || shares.empty(); unit += 1.0)
  {
    shares.push_back(
      width > 0.0 ? (std::min(end, unit + 1.0) - std::max(begin, unit)) / width : 1.0);
  }
  return shares;
}

/// Probability that no unit of a beam is perceived.
double missedBy(const Sensor& sensor, const PhotonReceiver& receiver, double energy,
  const std::vector<double>& shares)
{
  double missed = 1.0;
  for (const double share : shares)
  {
    missed *= 1.0 -
      (sensor.receiverModel == ReceiverModel::Photons
          ? receiver.detectionProbability(receiver.electronsPerJoule * share * energy,
              receiver.electronsPerJoule * sensor.lowerEnergyLimit)
          : (share * energy > sensor.lowerEnergyLimit ? 1.0 : 0.0));
  }
  return missed;
}
}

DetectionLaw::DetectionLaw(const Sensor& sensor, const std::vector<double>& areas)
  : Table(MostBeams * Points, 0.0)
  , Limit(sensor.lowerEnergyLimit)
{
  const PhotonReceiver receiver(sensor);
  const double width = sensor.pulseWidth / sensor.samplingInterval;
  const int places = width > 0.0 ? PlacesInUnit : 1;
  const double weight = 1.0 / (static_cast<double>(areas.size()) * places);
  for (int place = 0; place < places; ++place)
  {
    const std::vector<double> shares = sharesOf((place + 0.5) / places, width);
    for (const double area : areas)
    {
      for (std::size_t k = 0; k < Points; ++k)
      {
        const double decade = FirstDecade + static_cast<double>(k) / PointsPerDecade;
        const double energy = this->Limit * std::pow(10.0, decade) * area;
        const double missed = missedBy(sensor, receiver, energy, shares);
        double byAll = 1.0;
        for (int beams = 1; beams <= MostBeams; ++beams)
        {
          byAll *= missed;
          this->Table[(beams - 1) * Points + k] += weight * (1.0 - byAll);
        }
      }
    }
  }
}

double DetectionLaw::probability(double energy, int beams) const
{
  if (beams < 1 || !(energy > 0.0))
  {
    return 0.0;
  }
  const double* const table = &this->Table[(std::min(beams, MostBeams) - 1) * Points];
  const double at = (std::log10(energy / this->Limit) - FirstDecade) * PointsPerDecade;
  if (!(at > 0.0))
  {
    return table[0];
  }
  if (!(at < static_cast<double>(Points - 1)))
  {
    return table[Points - 1];
  }
  const auto below = static_cast<std::size_t>(at);
  const double share = at - static_cast<double>(below);
  return table[below] + share * (table[below + 1] - table[below]);
}

double DetectionLaw::energyFor(double wanted, int beams) const
{
  const double* const table =
    &this->Table[static_cast<std::size_t>(std::clamp(beams, 1, MostBeams) - 1) * Points];
  const double* const above = std::lower_bound(table, table + Points, wanted);
  if (beams < 1 || above == table + Points)
  {
    return std::numeric_limits<double>::infinity();
  }
  double at = static_cast<double>(above - table);
  if (above != table && above[0] > above[-1])
  {
    at -= (above[0] - wanted) / (above[0] - above[-1]);
  }
  return this->Limit * std::pow(10.0, FirstDecade + at / PointsPerDecade);
}

double trackProbability(double p, int needed, int scans)
{
  // From no detection on: the law of one scan more, scan by scan.
  std::vector<double> exactly(static_cast<std::size_t>(needed), 0.0);
  exactly[0] = 1.0;
  for (int scan = 0; scan < scans; ++scan)
  {
    for (std::size_t n = exactly.size(); n-- > 0;)
    {
      exactly[n] = exactly[n] * (1.0 - p) + (n > 0 ? exactly[n - 1] * p : 0.0);
    }
  }
  double fewer = 0.0;
  for (const double e : exactly)
  {
    fewer += e;
  }
  return std::clamp(1.0 - fewer, 0.0, 1.0);
}
}
