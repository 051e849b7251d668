// SPDX-License-Identifier: BSD-3-Clause
#include "Coverage.h"

#include "PhotonReceiver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace avianlidar
{
namespace
{
constexpr std::size_t PlacesOfBlock = 4096;
/// rad: half of a bird at 100 m.
constexpr double WideMargin = 6e-3;
/// Probabilities that are known this well are not looked at more closely.
constexpr double Negligible = 0.004;

double elevationOf(const Vec3& direction, const Vec3& up)
{
  return std::asin(std::clamp(glm::dot(unitVector(direction), up), -1.0, 1.0));
}
}

std::string checkOrigins(const ScanBeams& beams)
{
  if (beams.size() == 0)
  {
    return "has no beams, expected those of a scan";
  }
  const auto other = std::find_if(beams.origins.begin(), beams.origins.end(),
    [&](const Vec3& origin) { return origin != beams.origins[0]; });
  return other == beams.origins.end()
    ? std::string()
    : "has beams that begin at different points, expected those of one sensor";
}

Coverage::Coverage(const ScanSetup& setup, const ScanBeams& beams, const Vec3& up,
  const ScanResult& still, std::shared_ptr<const BeamDirections> directions)
  : Setup(setup)
  , Beams(beams)
  , Up(up)
  , Margin(std::min(
      std::max(setup.sensor.halfBeamwidth, WideMargin), Pi / 3.0 - setup.sensor.halfBeamwidth))
  , Directions(directions ? std::move(directions)
                          : std::make_shared<const BeamDirections>(
                              beams.directions, setup.sensor.halfBeamwidth, this->Margin))
  , Most(static_cast<int>(std::clamp<std::size_t>(this->Directions->mostNear(), 1, 255)))
  , CosineHeld(std::cos(setup.sensor.halfBeamwidth))
  , CosineNear(std::cos(setup.sensor.halfBeamwidth + this->Margin))
  , Lowest(std::numeric_limits<double>::infinity())
  , Highest(-std::numeric_limits<double>::infinity())
  , ClutterBegins(beams.size() + 1, 0)
{
  for (const Vec3& direction : beams.directions)
  {
    const double elevation = elevationOf(direction, up);
    this->Lowest = std::min(this->Lowest, elevation - setup.sensor.halfBeamwidth);
    this->Highest = std::max(this->Highest, elevation + setup.sensor.halfBeamwidth);
  }
  const double length = setup.sensor.rangeUnitLength();
  for (std::size_t e = 0; e < still.echoes.size(); ++e)
  {
    ++this->ClutterBegins[still.beamOfEcho[e] + 1];
    this->Clutter.push_back(static_cast<std::int64_t>(std::floor(still.echoes[e].range / length)));
  }
  for (std::size_t b = 0; b < beams.size(); ++b)
  {
    this->ClutterBegins[b + 1] += this->ClutterBegins[b];
  }
  this->HasClutter.resize(this->Directions->cells());
  for (std::size_t cell = 0; cell < this->HasClutter.size() && !this->Clutter.empty(); ++cell)
  {
    this->Directions->forEachOfCell(cell,
      [&](std::uint32_t b)
      {
        this->HasClutter[cell] =
          this->HasClutter[cell] || this->ClutterBegins[b + 1] > this->ClutterBegins[b];
      });
  }
}

/// True if a target's echo may share a unit with that of a surface.
bool Coverage::isInClutter(std::uint32_t beam, double range) const
{
  const Sensor& sensor = this->Setup.sensor;
  const double place = range / sensor.rangeUnitLength();
  const double half = 0.5 * sensor.pulseWidth / sensor.samplingInterval;
  const auto first = static_cast<std::int64_t>(std::floor(place - half));
  const auto last = static_cast<std::int64_t>(std::floor(place + half));
  const auto begin = this->Clutter.begin() + this->ClutterBegins[beam];
  const auto end = this->Clutter.begin() + this->ClutterBegins[beam + 1];
  const auto next = std::lower_bound(begin, end, first);
  return next != end && *next <= last;
}

CoverageSight Coverage::sightOf(const Vec3& to, BeamTracer& tracer) const
{
  CoverageSight sight;
  const double range = safeLength(to);
  if (!(range <= this->Setup.sensor.rangeGate))
  {
    return sight;
  }
  sight.status = CoverageStatus::BetweenBeams;
  if (!(range > 0.0))
  {
    return sight;
  }
  const double elevation = elevationOf(to, this->Up);
  if (elevation > this->Highest || elevation < this->Lowest)
  {
    sight.status =
      elevation > this->Highest ? CoverageStatus::AboveBand : CoverageStatus::BelowBand;
  }
  this->Directions->forEachNear(to / range,
    [&](std::uint32_t, double cosine)
    {
      sight.isNear = sight.isNear || cosine >= this->CosineNear;
      sight.beams += cosine >= this->CosineHeld && sight.beams < 255 ? 1 : 0;
    });
  sight.status = sight.beams > 0 ? CoverageStatus::Seen : sight.status;
  sight.isHidden =
    sight.isNear && tracer.occluded(Vec3(0.0), to, 1e-9 * range, NoTriangle, NoTriangle);
  if (sight.status == CoverageStatus::Seen && sight.isHidden)
  {
    sight.status = CoverageStatus::Shadowed;
  }
  return sight;
}

bool Coverage::look(const PlaceAt& placeAt, std::size_t count, int threads,
  const KeepGoing& keepGoing, CoverageSight* sights) const
{
  BeamFrame frame;
  frame.origin = this->Beams.origins[0];
  return parallelFor(
    count, PlacesOfBlock, threads,
    [&](std::size_t begin, std::size_t end, int)
    {
      BeamTracer tracer(*this->Setup.tree);
      tracer.setBeam(frame);
      for (std::size_t k = begin; k < end; ++k)
      {
        sights[k] = this->sightOf(placeAt(k) - frame.origin, tracer);
      }
    },
    keepGoing);
}

CoverageTarget::CoverageTarget(const Sensor& sensor, double air, double meanArea, double reflected,
  const std::vector<TargetPose>& poses, int mostBeams)
  : attenuation(air)
  , area(meanArea)
  , reflectance(reflected)
  , electronsPerJoule(sensor.receiverModel == ReceiverModel::Photons
        ? PhotonReceiver(sensor).electronsPerJoule
        : 0.0)
  , law(sensor, poses, mostBeams)
{
  for (int beams = 0; beams <= std::clamp(mostBeams, 1, 255); ++beams)
  {
    this->halfEnergies.push_back(this->law.energyFor(0.5, beams));
  }
}

/// A target at a place, and the energies, J, that beams receive of it.
struct Coverage::PlacedTarget
{
  const CoverageTarget& target;
  double range;   ///< m
  Vec3 direction; ///< unit vector
  double filling; ///< of a target that fills the beam
  double energy;  ///< where the beam holds all of the target

  /// Where the energy lies in the tables of the law.
  double step() const { return this->target.law.stepOf(std::min(this->energy, this->filling)); }

  /// Fill in what so many beams that hold all of the target detect.
  void fill(CoverageValue& value, double step, int beams) const
  {
    value.probability = this->target.law.probabilityAt(step, beams);
    value.photoelectrons = this->target.electronsPerJoule * this->energy;
    if (beams > 0)
    {
      const std::vector<double>& half = this->target.halfEnergies;
      value.leastArea = this->target.area / this->energy *
        half[std::min(half.size() - 1, static_cast<std::size_t>(beams))];
    }
  }
};

/// The beams that reach a target and are not in clutter there; of too many the nearest.
struct Coverage::NearBeams
{
  struct Beam
  {
    std::uint32_t number;
    double cosine; ///< of the angle from its axis
  };
  Beam beams[DetectionLaw::MostBeams]; ///< not initialised: this is made for each place
  std::size_t count = 0;
  int clear = 0; ///< hold the place
  int whole = 0; ///< hold all of the target

  void add(const Beam& beam)
  {
    if (this->count < DetectionLaw::MostBeams)
    {
      this->beams[this->count++] = beam;
      return;
    }
    Beam* farthest = std::min_element(this->beams, this->beams + this->count,
      [](const Beam& a, const Beam& b) { return a.cosine < b.cosine; });
    if (farthest->cosine < beam.cosine)
    {
      *farthest = beam;
    }
  }
};

Coverage::PlacedTarget Coverage::placed(const CoverageTarget& target, const Vec3& place) const
{
  const Sensor& sensor = this->Setup.sensor;
  const Vec3 to = place - this->Beams.origins[0];
  const double range = safeLength(to);
  const double filling = energyFromTarget(
    sensor, range, std::numeric_limits<double>::infinity(), target.reflectance, target.attenuation);
  return { target, range, to / range, filling,
    filling * target.area / (sensor.solidAngle() * range * range) };
}

/// True if no number of beams detects the target, and none that may be near is in clutter.
bool Coverage::isHopeless(const PlacedTarget& at, double step) const
{
  return this->Setup.sensor.beamProfile != BeamProfile::Gaussian &&
    at.target.law.probabilityAt(step, this->Most) < Negligible &&
    !this->HasClutter[this->Directions->cellOf(at.direction)];
}

Coverage::NearBeams Coverage::clearBeams(const PlacedTarget& at) const
{
  // Beams whose borders the target does not reach hold all of it, or nothing. The cosines are off
  // by less than the cube of the angles.
  const double halfBeamwidth = this->Setup.sensor.halfBeamwidth;
  const double reach = std::min(at.target.law.reach() / at.range, this->Margin);
  const double change = reach * std::sin(halfBeamwidth);
  const double bend = 0.5 * reach * reach * this->CosineHeld;
  const double within = reach < halfBeamwidth ? this->CosineHeld - bend + change : 1.0;
  const double beyond = this->CosineHeld - bend - change;
  NearBeams near;
  this->Directions->forEachNear(at.direction,
    [&](std::uint32_t beam, double cosine)
    {
      const bool isHeld = cosine >= this->CosineHeld;
      if ((isHeld || cosine > beyond) && !this->isInClutter(beam, at.range))
      {
        near.clear += isHeld;
        near.whole += isHeld && (cosine > within || !(reach > 0.0));
        near.add({ beam, cosine });
      }
    });
  return near;
}

/// True if it does not matter how much of the target the beams hold whose borders cross it.
bool Coverage::isCertain(const PlacedTarget& at, double step, const NearBeams& near) const
{
  const int all = static_cast<int>(near.count);
  return this->Setup.sensor.beamProfile != BeamProfile::Gaussian &&
    (near.whole >= all ||
      at.target.law.probabilityAt(step, all) - at.target.law.probabilityAt(step, near.whole) <
        Negligible);
}

/// A beam near a place, and where the place lies in it.
BeamAtTarget Coverage::beamAt(
  std::uint32_t beam, double cosine, const Vec3& direction, double range) const
{
  const Sensor& sensor = this->Setup.sensor;
  const Vec3 off = this->Directions->axis(beam) - cosine * direction;
  const double vertical =
    std::min(1.0, std::fabs(glm::dot(off, this->Up)) / std::max(glm::length(off), 1e-300));
  const double u = std::min(1.0, (1.0 - cosine) / (1.0 - this->CosineHeld));
  return {
    range * std::sin(sensor.halfBeamwidth), range * std::sqrt(std::max(0.0, 1.0 - cosine * cosine)),
    std::sqrt(1.0 - vertical * vertical), vertical,
    sensor.beamProfile == BeamProfile::Gaussian ? 2.0 * std::exp(-2.0 * u) / -std::expm1(-2.0) : 1.0
  };
}

/// Replace what beams that hold all of a target detect by what they do with their shares of it.
void Coverage::share(const PlacedTarget& at, const NearBeams& near, CoverageValue& value) const
{
  std::array<BeamAtTarget, DetectionLaw::MostBeams> beams;
  double irradiance = 0.0; // of the beams that hold the place
  for (std::size_t b = 0; b < near.count; ++b)
  {
    const auto& [number, cosine] = near.beams[b];
    beams[b] = this->beamAt(number, cosine, at.direction, at.range);
    irradiance += cosine >= this->CosineHeld ? beams[b].irradiance : 0.0;
  }
  value.probability = at.target.law.probability(at.energy, at.filling, beams.data(), near.count);
  if (near.clear > 0)
  {
    irradiance /= std::min<double>(near.clear, near.count);
    value.photoelectrons *= irradiance;
    value.leastArea /= irradiance;
  }
}

CoverageValue Coverage::valueAt(
  const Vec3& place, const CoverageSight& sight, const CoverageTarget& target) const
{
  CoverageValue value;
  value.status = sight.status;
  value.beams = sight.beams;
  if (!sight.isNear || sight.isHidden)
  {
    return value;
  }
  const CoverageStatus missed = sight.beams > 0 ? CoverageStatus::TooWeak : sight.status;
  const PlacedTarget at = this->placed(target, place);
  if (!(at.energy > 0.0))
  {
    value.status = missed;
    return value;
  }
  const double step = at.step();
  if (sight.beams > 0 && this->isHopeless(at, step))
  {
    at.fill(value, step, sight.beams);
    value.status = missed;
    return value;
  }
  const NearBeams near = this->clearBeams(at);
  if (near.count > 0)
  {
    at.fill(value, step, near.clear);
    if (!this->isCertain(at, step, near))
    {
      this->share(at, near, value);
    }
  }
  if (value.probability >= WeakProbability)
  {
    value.status = CoverageStatus::Seen;
  }
  else if (sight.beams > 0)
  {
    value.status = near.clear > 0 ? CoverageStatus::TooWeak : CoverageStatus::InClutter;
  }
  return value;
}
}
