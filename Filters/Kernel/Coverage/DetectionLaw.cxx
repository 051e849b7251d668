// SPDX-License-Identifier: BSD-3-Clause
#include "DetectionLaw.h"

#include "PhotonReceiver.h"
#include "ReceivedPulse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

namespace avianlidar
{
namespace
{
/// Positions in half a range unit over which the mean is taken.
constexpr int PlacesInHalfUnit = 20;
/// A pose represents similar poses. The logarithm of the energies of similar poses is normally
/// distributed with this standard deviation. One quantile (k + 0.5)/PlacesOfParts is sampled for
/// each position.
constexpr double SpreadOfEnergies = 0.15;
constexpr double Quantiles[] = { 1.5341, -0.4888, -0.8871, -0.1570, 0.1570, 0.8871, 0.4888,
  -1.5341 };
/// Change of a pose's probability below which the lit parts are not computed.
constexpr double NegligiblePart = 0.004;
/// Standard deviations at which a normal distribution is cut.
constexpr double Deviations = 3.0;
/// Number of classes of the standard deviation of depth, and deviation of the last class over the
/// target's reach.
constexpr std::size_t DepthClasses = 9;
constexpr double DeepestOfReach = 0.6;
/// Largest number of range units that are evaluated. If there are more, each evaluated unit
/// represents its neighbours.
constexpr double MostUnits = 64.0;
/// Lower limit, J, in place of a lower limit of 0.
constexpr double LeastLimit = 1e-280;

/// Linear interpolation, constant beyond both ends. @param at in steps of the table
template <class Real>
double between(const Real* table, std::size_t count, double at)
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

template <std::size_t N>
std::array<double, N> powers(const std::array<double, N>& factors, std::size_t exponent)
{
  std::array<double, N> found;
  found.fill(1.0);
  for (std::size_t n = 0; n < exponent; ++n)
  {
    std::transform(found.begin(), found.end(), factors.begin(), found.begin(), std::multiplies<>());
  }
  return found;
}

/// Probability that beams perceive something, mean over positions. @param missed probabilities that
/// all beams perceive nothing
template <std::size_t N>
double detectedBy(const std::array<double, N>& missed)
{
  return 1.0 - std::accumulate(missed.begin(), missed.end(), 0.0) / static_cast<double>(N);
}

/// Share of an echo that lies before `t`, range units from the target. @param deviation standard
/// deviation of the target's depth, range units
double shareBefore(double t, const ReceivedPulse& pulse, double deviation)
{
  if (!pulse.isRectangle() && deviation > 0.0)
  {
    constexpr int depths = 8; // on each side of the middle
    double sum = 0.0, weights = 0.0;
    for (int k = -depths; k <= depths; ++k)
    {
      const double z = Deviations * k / depths;
      const double weight = std::exp(-0.5 * z * z);
      sum += weight * pulse.shareBefore(t - z * deviation);
      weights += weight;
    }
    return sum / weights;
  }
  const double width = pulse.width();
  if (!(deviation > 0.0))
  {
    return pulse.isRectangle() && width > 0.0 ? std::clamp(t / width + 0.5, 0.0, 1.0)
                                              : pulse.shareBefore(t);
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

/// Shares of an echo in range units. Each value represents `units` range units.
struct Shares
{
  std::vector<double> values;
  double units = 1.0;
};

/// Shares of an echo in the range units that the echo overlaps.
/// @param place place of the target in a unit, 0 to 1 @param pulse pulse, in range units
/// @param deviation standard deviation of the target's depth, range units
Shares sharesOf(double place, const ReceivedPulse& pulse, double deviation)
{
  const double depth = Deviations * deviation;
  const double first = std::floor(place - (pulse.before() + depth));
  const double count = std::max(1.0, std::ceil(place + (pulse.after() + depth)) - first);
  Shares shares;
  shares.units = std::ceil(count / MostUnits);
  for (double unit = first; unit < first + count; unit += shares.units)
  {
    // The middle unit represents its neighbours.
    const double begin = unit + std::floor(0.5 * (shares.units - 1.0)) - place;
    shares.values.push_back(
      shareBefore(begin + 1.0, pulse, deviation) - shareBefore(begin, pulse, deviation));
  }
  return shares;
}

/// Probability that no range unit of a beam is perceived.
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

TargetViews viewsOf(TargetPoses poses, double reach)
{
  TargetViews views;
  views.reach = reach;
  views.poses = poses.size();
  views.from = [all = std::make_shared<const TargetPoses>(std::move(poses))](double)
  { return all; };
  return views;
}

DetectionLaw::DetectionLaw(
  const Sensor& sensor, const TargetViews& views, double lowest, double highest, int mostBeams)
  : Most(std::clamp(mostBeams, 1, MostBeams))
  , Limit(std::max(sensor.lowerEnergyLimit, LeastLimit))
  , UnitLength(sensor.rangeUnitLength())
  , Reach(views.reach)
  , Deepest(DeepestOfReach * views.reach)
  , Lowest(views.step * std::floor(lowest / views.step))
  , Step(views.step)
  , Headings(views.headings)
{
  const PhotonReceiver receiver(sensor);
  const ReceivedPulse pulse(sensor, sensor.samplingInterval);
  const std::size_t classes = this->Deepest > 0.0 ? DepthClasses : 1;
  this->Places = pulse.width() > 0.0 || this->Deepest > 0.0 ? PlacesInHalfUnit : 1;
  this->Missed.reserve(classes * this->Places * Points);
  for (std::size_t depth = 0; depth < classes; ++depth)
  {
    const double deviation = this->Deepest / this->UnitLength * static_cast<double>(depth) /
      static_cast<double>(DepthClasses - 1);
    for (int place = 0; place < this->Places; ++place)
    {
      // The two halves of a unit are mirror images if the two halves of the pulse are.
      const double at = 0.5 * (place + 0.5) / this->Places;
      const Shares shares = sharesOf(at, pulse, deviation);
      const Shares mirrored = pulse.isRectangle() ? shares : sharesOf(1.0 - at, pulse, deviation);
      for (std::size_t k = 0; k < Points; ++k)
      {
        const double energy =
          this->Limit * std::pow(10.0, FirstDecade + static_cast<double>(k) / PointsPerDecade);
        const double missed = missedBy(sensor, receiver, energy, shares);
        this->Missed.push_back(static_cast<float>(pulse.isRectangle()
            ? missed
            : 0.5 * (missed + missedBy(sensor, receiver, energy, mirrored))));
      }
    }
  }
  std::vector<std::vector<double>> wholeTargets; // by depth class
  for (std::size_t depth = 0; depth < classes; ++depth)
  {
    wholeTargets.push_back(this->wholeTarget(depth));
  }
  const double steps = std::ceil((highest - this->Lowest) / this->Step);
  for (int view = 0; view <= std::max(0.0, steps); ++view)
  {
    this->Views.push_back(views.from(this->Lowest + view * this->Step));
    this->tabulate(*this->Views.back(), wholeTargets);
  }
  for (std::size_t i = 0; i < this->poses(); ++i)
  {
    // The thresholds are spread evenly between 0 and 1, also within any run of poses.
    constexpr double golden = 0.6180339887498949;
    const double turned = golden * (static_cast<double>(i) + 0.5);
    this->Thresholds.push_back(turned - std::floor(turned));
  }
}

std::vector<double> DetectionLaw::wholeTarget(std::size_t spread) const
{
  std::vector<double> detected(this->Most * Points, 0.0);
  const double weight = 1.0 / this->Places;
  for (int place = 0; place < this->Places; ++place)
  {
    const float* const missedAt = &this->Missed[(spread * this->Places + place) * Points];
    for (std::size_t k = 0; k < Points; ++k)
    {
      const double missed =
        between(missedAt, Points, static_cast<double>(k) + this->spreadAt(place % PlacesOfParts));
      double byAll = 1.0;
      for (int beams = 0; beams < this->Most; ++beams)
      {
        byAll *= missed;
        detected[beams * Points + k] += weight * (1.0 - byAll);
      }
    }
  }
  return detected;
}

void DetectionLaw::tabulate(
  const TargetPoses& poses, const std::vector<std::vector<double>>& wholeTargets)
{
  std::vector<double>& table = this->Tables.emplace_back(this->Most * Points, 0.0);
  std::vector<Received>& whole = this->Whole.emplace_back();
  const double weight = 1.0 / static_cast<double>(poses.size());
  for (const Silhouette& pose : poses)
  {
    whole.push_back(this->received(pose.all().area, pose.all()));
    const double shift = std::log10(pose.all().area) * PointsPerDecade;
    const double* const detected = wholeTargets[whole.back().spread].data();
    for (std::size_t row = 0; row < table.size(); row += Points)
    {
      for (std::size_t k = 0; k < Points; ++k)
      {
        table[row + k] += weight * between(detected + row, Points, static_cast<double>(k) + shift);
      }
    }
  }
  for (double& p : table)
  {
    p = std::min(1.0, p); // rounding of the sums may exceed 1
  }
}

std::size_t DetectionLaw::bytes() const
{
  std::size_t sum =
    this->views() * this->Most * Points * sizeof(double) + this->Missed.size() * sizeof(float);
  for (const SharedPoses& view : this->Views)
  {
    sum += std::accumulate(view->begin(), view->end(), std::size_t(0),
      [](std::size_t all, const Silhouette& pose) { return all + pose.bytes(); });
  }
  return sum;
}

DetectionLaw::Between DetectionLaw::betweenAt(double elevation) const
{
  const double at = std::clamp(
    (elevation - this->Lowest) / this->Step, 0.0, static_cast<double>(this->Views.size() - 1));
  const auto below = static_cast<std::size_t>(at);
  return { below, at - static_cast<double>(below) };
}

double DetectionLaw::probabilityAt(double step, int beams, const Between& at) const
{
  if (beams < 1)
  {
    return 0.0;
  }
  const auto row = static_cast<std::size_t>(std::min(beams, this->Most) - 1) * Points;
  const double p = between(&this->Tables[at.below][row], Points, step);
  return at.share > 0.0
    ? p + at.share * (between(&this->Tables[at.below + 1][row], Points, step) - p)
    : p;
}

double DetectionLaw::stepOf(double energy) const
{
  return (std::log10(energy / this->Limit) - FirstDecade) * PointsPerDecade;
}

DetectionLaw::Received DetectionLaw::received(double energy, const LitPart& lit) const
{
  const double spread = this->Deepest > 0.0
    ? std::min(1.0, lit.spread / this->Deepest) * static_cast<double>(DepthClasses - 1)
    : 0.0;
  return { this->stepOf(energy), static_cast<std::size_t>(spread + 0.5),
    lit.depth / this->UnitLength };
}

/// Steps that a quantile of the energies around a pose adds to the pose's own energy.
double DetectionLaw::spreadAt(std::size_t quantile) const
{
  constexpr double steps = SpreadOfEnergies * PointsPerDecade / 2.302585092994046;
  return this->Deepest > 0.0 ? steps * Quantiles[quantile] : 0.0;
}

/// Probabilities that a beam perceives nothing.
DetectionLaw::ByPlace DetectionLaw::missed(const Received& beam) const
{
  static_assert(std::size(Quantiles) == PlacesOfParts);
  const float* const tables = &this->Missed[beam.spread * this->Places * Points];
  ByPlace missed;
  for (int place = 0; place < PlacesOfParts; ++place)
  {
    const double at = (place + 0.5) / PlacesOfParts + beam.depth;
    const double inUnit = at - std::floor(at);
    const double half = std::min(inUnit, 1.0 - inUnit);
    const int number = static_cast<int>(2.0 * half * this->Places);
    missed[place] = between(&tables[std::min(number, this->Places - 1) * Points], Points,
      beam.step + this->spreadAt(place));
  }
  return missed;
}

/// Index of the view that a pose is taken from.
std::size_t DetectionLaw::viewOf(std::size_t pose, const Between& at) const
{
  return at.below + (this->Thresholds[pose] < at.share ? 1 : 0);
}

double DetectionLaw::probability(double energy, double most, const BeamAtTarget* beams,
  std::size_t count, const Between& at, double* ofPoses) const
{
  const std::size_t used = std::min<std::size_t>(count, MostBeams);
  std::array<double, MostBeams> away; // distance of the target's middle beyond the border, m
  for (std::size_t b = 0; b < used; ++b)
  {
    away[b] = beams[b].beyond();
  }
  const double stepOfAll = std::log10(energy) * PointsPerDecade;
  const double mostStep = this->stepOf(most);
  const bool isUniform = used == 0 || beams[0].profile == BeamProfile::Uniform;
  double sum = 0.0;
  for (std::size_t i = 0; i < this->poses(); ++i)
  {
    const std::size_t view = this->viewOf(i, at);
    const Silhouette& shown = (*this->Views[view])[i];
    std::array<std::uint8_t, MostBeams> crossing;
    std::size_t crossings = 0;
    std::size_t whole = 0;
    for (std::size_t b = 0; b < used; ++b)
    {
      if (beams[b].profile == BeamProfile::Uniform && away[b] <= -shown.reach())
      {
        ++whole;
      }
      else if (away[b] < shown.reach())
      {
        crossing[crossings++] = static_cast<std::uint8_t>(b);
      }
    }
    Received all = this->Whole[view][i];
    all.step = std::min(mostStep, all.step + stepOfAll);
    ByPlace byWhole{}; // used where the target is, or could be, whole in a beam
    if (whole > 0 || (crossings > 0 && isUniform))
    {
      byWhole = this->missed(all);
    }
    ByPlace byAll = powers(byWhole, whole);
    double p = whole > 0 ? detectedBy(byAll) : 0.0;
    // A beam receives no more from a part than from the whole target, which bounds the change.
    if (crossings > 0 &&
      (!isUniform || detectedBy(powers(byWhole, whole + crossings)) - p > NegligiblePart))
    {
      // Near 1, further beams change the probability by no more than NegligiblePart.
      for (std::size_t c = 0; c < crossings && p < 1.0 - NegligiblePart; ++c)
      {
        const LitPart part = shown.litBy(beams[crossing[c]]);
        if (part.area > 0.0)
        {
          const ByPlace byPart =
            this->missed(this->received(std::min(most, energy * part.area), part));
          std::transform(
            byAll.begin(), byAll.end(), byPart.begin(), byAll.begin(), std::multiplies<>());
        }
        p = detectedBy(byAll);
      }
    }
    if (ofPoses)
    {
      ofPoses[i] = p;
    }
    sum += p;
  }
  return sum / static_cast<double>(this->poses());
}

void DetectionLaw::ofPoses(double energy, int beams, const Between& at, double* probabilities) const
{
  for (std::size_t i = 0; i < this->poses(); ++i)
  {
    Received all = this->Whole[this->viewOf(i, at)][i];
    all.step += std::log10(energy) * PointsPerDecade;
    const auto whole = static_cast<std::size_t>(std::clamp(beams, 0, this->Most));
    probabilities[i] = detectedBy(powers(this->missed(all), whole));
  }
}

double DetectionLaw::energyFor(double wanted, int beams, std::size_t view) const
{
  const double* const table =
    &this->Tables[view][static_cast<std::size_t>(std::clamp(beams, 1, this->Most) - 1) * Points];
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
  // The binomial distribution, built up scan by scan.
  std::array<double, MostScans> exactly; // probabilities of exactly n detections
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
