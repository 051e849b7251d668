// SPDX-License-Identifier: BSD-3-Clause
#include "DetectionLaw.h"

#include "PhotonReceiver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace avianlidar
{
namespace
{
/// Places in half a range unit over which the mean is taken.
constexpr int PlacesInHalfUnit = 15;
/// Of these, the middle one of so many where beams hold shares.
constexpr std::size_t EachPlace = 3;
/// A normal distribution ends here.
constexpr double Deviations = 3.0;
/// Depths of poses are rounded to as many.
constexpr std::size_t DepthClasses = 9;
/// Of more units only as many are looked at, each for its neighbours.
constexpr double MostUnits = 64.0;
/// J: in place of a lower limit of 0.
constexpr double LeastLimit = 1e-280;

/// Linear interpolation; the first and last value go on. @param at in steps of the table
double between(const double* table, std::size_t count, double at)
{
  if (!(at > 0.0))
  {
    return table[0];
  }
  if (!(at < static_cast<double>(count - 1)))
  {
    return table[count - 1];
  }
  const auto below = static_cast<std::size_t>(at);
  const double share = at - static_cast<double>(below);
  return table[below] + share * (table[below + 1] - table[below]);
}

/// Share of an echo that lies before `t`, 0 where its middle is. @param width of the pulse
/// @param deviation of the target's depth
double shareBefore(double t, double width, double deviation)
{
  if (!(deviation > 0.0))
  {
    return width > 0.0 ? std::clamp(t / width + 0.5, 0.0, 1.0) : (t >= 0.0 ? 1.0 : 0.0);
  }
  const auto below = [](double z) { return 0.5 * std::erfc(-z / Root2); };
  if (!(width > 0.0))
  {
    return below(t / deviation);
  }
  const auto integral = [&](double z)
  { return z * below(z) + std::exp(-0.5 * z * z) / std::sqrt(2.0 * Pi); };
  return (integral((t + 0.5 * width) / deviation) - integral((t - 0.5 * width) / deviation)) *
    deviation / width;
}

/// Shares of an echo in units, and of how many units each is the share.
struct Shares
{
  std::vector<double> values;
  double units = 1.0;
};

/// Shares of an echo in the units that it overlaps. @param place of its middle in a unit, 0 to 1
/// @param width of the pulse @param deviation of the target's depth, both in units
Shares sharesOf(double place, double width, double deviation)
{
  const double half = 0.5 * width + Deviations * deviation;
  const double first = std::floor(place - half);
  const double count = std::max(1.0, std::ceil(place + half) - first);
  Shares shares;
  shares.units = std::ceil(count / MostUnits);
  for (double unit = first; unit < first + count; unit += shares.units)
  {
    // The middle one of so many.
    const double begin = unit + std::floor(0.5 * (shares.units - 1.0)) - place;
    shares.values.push_back(
      shareBefore(begin + 1.0, width, deviation) - shareBefore(begin, width, deviation));
  }
  return shares;
}

/// Probability that no unit of a beam is perceived.
double missedBy(
  const Sensor& sensor, const PhotonReceiver& receiver, double energy, const Shares& shares)
{
  double missed = 1.0;
  for (const double share : shares.values)
  {
    missed *= 1.0 - perceptionProbability(sensor, receiver, share * energy);
  }
  return shares.units > 1.0 ? std::pow(missed, shares.units) : missed;
}
}

double shareHeld(const BeamAtTarget& beam, const TargetPose& pose)
{
  const double h = beam.horizontal * pose.horizontal;
  const double v = beam.vertical * pose.vertical;
  const double along = std::sqrt(h * h + v * v); // towards the beam's axis
  const double hAcross = beam.vertical * pose.horizontal;
  const double vAcross = beam.horizontal * pose.vertical;
  const double across = std::sqrt(hAcross * hAcross + vAcross * vAcross);
  const auto below = [](double distance, double deviation)
  {
    constexpr double far = 4.0; // deviations: 3e-5 beyond
    return distance >= far * deviation ? 1.0
      : distance <= -far * deviation   ? 0.0
                                       : 0.5 * std::erfc(-distance / (deviation * Root2));
  };
  // The disc as a rectangle that is as wide along, and holds as much of a wide distribution.
  const double width = 0.25 * Pi * beam.radius;
  return (below(beam.radius - beam.distance, along) - below(-beam.radius - beam.distance, along)) *
    (below(width, across) - below(-width, across));
}

DetectionLaw::DetectionLaw(
  const Sensor& sensor, const std::vector<TargetPose>& poses, int mostBeams)
  : Most(std::clamp(mostBeams, 1, MostBeams))
  , Reach(0.0)
  , Poses(poses)
  , Table(this->Most * Points, 0.0)
  , Limit(std::max(sensor.lowerEnergyLimit, LeastLimit))
{
  for (const TargetPose& pose : poses)
  {
    this->Reach = std::max(this->Reach, Deviations * std::max(pose.horizontal, pose.vertical));
  }
  const PhotonReceiver receiver(sensor);
  const double width = sensor.pulseWidth / sensor.samplingInterval;
  double deepest = 0.0; // units
  for (const TargetPose& pose : poses)
  {
    deepest = std::max(deepest, pose.depth / sensor.rangeUnitLength());
  }
  const std::size_t classes = deepest > 0.0 ? DepthClasses : 1;
  const int places = width > 0.0 || deepest > 0.0 ? PlacesInHalfUnit : 1;
  this->Missed.assign(classes, MissedTable(places, std::vector<double>(Points)));
  for (std::size_t depth = 0; depth < classes; ++depth)
  {
    const double deviation =
      deepest * static_cast<double>(depth) / static_cast<double>(DepthClasses - 1);
    for (int place = 0; place < places; ++place)
    {
      // The second half of a unit is as the first.
      const Shares shares = sharesOf(0.5 * (place + 0.5) / places, width, deviation);
      for (std::size_t k = 0; k < Points; ++k)
      {
        const double decade = FirstDecade + static_cast<double>(k) / PointsPerDecade;
        this->Missed[depth][place][k] =
          missedBy(sensor, receiver, this->Limit * std::pow(10.0, decade), shares);
      }
    }
  }
  const auto classOf = [&](const TargetPose& pose)
  {
    return deepest > 0.0
      ? static_cast<std::size_t>(std::lround(
          pose.depth / sensor.rangeUnitLength() / deepest * static_cast<double>(DepthClasses - 1)))
      : 0;
  };
  for (const TargetPose& pose : poses)
  {
    this->DepthOf.push_back(classOf(pose));
  }
  const double weight = 1.0 / (static_cast<double>(poses.size()) * places);
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    const double shift = std::log10(poses[i].area) * PointsPerDecade;
    for (const std::vector<double>& missedAt : this->Missed[this->DepthOf[i]])
    {
      for (std::size_t k = 0; k < Points; ++k)
      {
        const double missed = between(missedAt.data(), Points, static_cast<double>(k) + shift);
        double byAll = 1.0;
        for (int beams = 1; beams <= this->Most; ++beams)
        {
          byAll *= missed;
          this->Table[(beams - 1) * Points + k] += weight * (1.0 - byAll);
        }
      }
    }
  }
  for (double& p : this->Table)
  {
    p = std::min(1.0, p); // rounding of the sums
  }
}

double DetectionLaw::probabilityAt(double step, int beams) const
{
  return beams > 0 ? between(&this->Table[(std::min(beams, this->Most) - 1) * Points], Points, step)
                   : 0.0;
}

double DetectionLaw::stepOf(double energy) const
{
  return (std::log10(energy / this->Limit) - FirstDecade) * PointsPerDecade;
}

double DetectionLaw::probability(
  double energy, double most, const BeamAtTarget* beams, std::size_t count) const
{
  const std::size_t used = std::min<std::size_t>(count, MostBeams);
  double sum = 0.0;
  double cases = 0.0;
  for (std::size_t i = 0; i < this->Poses.size(); ++i)
  {
    const TargetPose& pose = this->Poses[i];
    std::array<double, MostBeams> steps; // of beams that hold some of it
    std::size_t holding = 0;
    for (std::size_t b = 0; b < used; ++b)
    {
      const double held =
        beams[b].irradiance * std::min(most, energy * pose.area * shareHeld(beams[b], pose));
      if (held > 0.0)
      {
        steps[holding++] = this->stepOf(held);
      }
    }
    const MissedTable& tables = this->Missed[this->DepthOf[i]];
    for (std::size_t place = std::min(EachPlace / 2, tables.size() - 1); place < tables.size();
         place += EachPlace)
    {
      double byAll = 1.0;
      for (std::size_t b = 0; b < holding; ++b)
      {
        byAll *= between(tables[place].data(), Points, steps[b]);
      }
      sum += 1.0 - byAll;
      cases += 1.0;
    }
  }
  return sum / cases;
}

double DetectionLaw::energyFor(double wanted, int beams) const
{
  const double* const table =
    &this->Table[static_cast<std::size_t>(std::clamp(beams, 1, this->Most) - 1) * Points];
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
  std::array<double, MostScans> exactly; // so many detections
  std::fill_n(exactly.begin(), needed, 0.0);
  exactly[0] = 1.0;
  for (int scan = 0; scan < scans; ++scan)
  {
    for (int n = needed; n-- > 0;)
    {
      exactly[n] = exactly[n] * (1.0 - p) + (n > 0 ? exactly[n - 1] * p : 0.0);
    }
  }
  const double fewer = std::accumulate(exactly.begin(), exactly.begin() + needed, 0.0);
  return std::clamp(1.0 - fewer, 0.0, 1.0);
}
}
