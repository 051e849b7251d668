// SPDX-License-Identifier: BSD-3-Clause
#include "Coverage.h"

#include "AirFinder.h"
#include "AirLight.h"
#include "Hash.h"
#include "PhotonReceiver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace avianlidar
{
namespace
{
constexpr std::size_t PlacesOfBlock = 512;
/// Largest angles outside a beam at which the beam is found, rad: for far, near and very near
/// targets.
constexpr double Margins[] = { 4e-3, 4e-2, 0.4 };
/// Error of a probability below which the probability is not refined.
constexpr double Negligible = 0.004;

/// Half the angle that a target subtends, rad. @param reach reach from the target's middle, m
/// @param range range of the target, m
double angleOf(double reach, double range)
{
  return std::asin(std::min(1.0, reach / range));
}

std::vector<double> marginsFor(double halfBeamwidth)
{
  std::vector<double> margins;
  for (const double margin : Margins)
  {
    margins.push_back(std::min(margin, Pi / 3.0 - halfBeamwidth));
  }
  return margins;
}

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
  , Shape(setup.sensor)
  , Pulse(setup.sensor, setup.sensor.samplingInterval)
  , Directions(directions ? std::move(directions)
                          : std::make_shared<const BeamDirections>(beams.directions,
                              this->Shape.width().half, marginsFor(this->Shape.width().half)))
  , Air(setup.sensor, setup.air())
  , Most(static_cast<int>(std::clamp<std::size_t>(this->Directions->mostNear(), 1, 255)))
  , ElectronsPerJoule(setup.sensor.receiverModel == ReceiverModel::Photons
        ? PhotonReceiver(setup.sensor).electronsPerJoule
        : 0.0)
  , CosineHeld(std::cos(this->Shape.width().half))
  , Lowest(std::numeric_limits<double>::infinity())
  , Highest(-std::numeric_limits<double>::infinity())
  , ClutterBegins(beams.size() + 1, 0)
{
  for (const Vec3& direction : beams.directions)
  {
    const double elevation = elevationOf(direction, up);
    this->Lowest = std::min(this->Lowest, elevation - this->Shape.width().half);
    this->Highest = std::max(this->Highest, elevation + this->Shape.width().half);
  }
  const double length = setup.sensor.rangeUnitLength();
  for (std::size_t e = 0; e < still.echoes.size(); ++e)
  {
    ++this->ClutterBegins[still.beamOfEcho[e] + 1];
    this->Clutter.push_back(static_cast<std::int64_t>(std::floor(still.echoes[e].range / length)));
  }
  std::partial_sum(
    this->ClutterBegins.begin(), this->ClutterBegins.end(), this->ClutterBegins.begin());
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

/// True if the echo of a point target may share a range unit with an echo of a surface.
bool Coverage::isInClutter(std::uint32_t beam, double range) const
{
  const Sensor& sensor = this->Setup.sensor;
  const double place = range / sensor.rangeUnitLength();
  const auto first = static_cast<std::int64_t>(std::floor(place - this->Pulse.before()));
  const auto last = static_cast<std::int64_t>(std::floor(place + this->Pulse.after()));
  const auto begin = this->Clutter.begin() + this->ClutterBegins[beam];
  const auto end = this->Clutter.begin() + this->ClutterBegins[beam + 1];
  const auto next = std::lower_bound(begin, end, first);
  return next != end && *next <= last;
}

/// True if a beam contains a direction. @param cosine of the angle between direction and beam axis
bool Coverage::holds(std::uint32_t beam, const Vec3& direction, double cosine) const
{
  return cosine >= this->CosineHeld &&
    (this->Shape.isRound() || this->frameOf(beam).contains(direction));
}

BeamFrame Coverage::frameOf(std::uint32_t beam) const
{
  return makeBeamFrame(Vec3(0.0), this->Directions->axis(beam), this->Shape.width());
}

CoverageSight Coverage::sightOf(const Vec3& to, BeamTracer& tracer) const
{
  CoverageSight sight;
  const double range = safeLength(to);
  if (!(range >= this->Setup.sensor.minimumRange && range <= this->Setup.sensor.rangeGate))
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
  const double reach = std::min(angleOf(WidestTarget, range), this->Directions->largestMargin());
  const double cosineNear = std::cos(this->Shape.width().half + reach);
  const Vec3 direction = to / range;
  this->Directions->forEachNear(direction, reach,
    [&](std::uint32_t beam, double cosine)
    {
      sight.isNear = sight.isNear || cosine >= cosineNear;
      sight.beams += sight.beams < 255 && this->holds(beam, direction, cosine) ? 1 : 0;
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
      const SceneTriangles scene(*this->Setup.tree);
      BeamTracer tracer(scene);
      tracer.setBeam(frame);
      for (std::size_t k = begin; k < end; ++k)
      {
        sights[k] = this->sightOf(placeAt(k) - frame.origin, tracer);
      }
    },
    keepGoing);
}

/// A target at a place, and the energies that beams receive from the target.
struct Coverage::PlacedTarget
{
  const CoverageTarget& target;
  double range;             ///< range of the target, m
  Vec3 direction;           ///< unit vector towards the target
  Vec3 right, up;           ///< unit vectors across the direction, as in Silhouette.h
  double filling;           ///< energy of a target that fills the beam, J
  double energy;            ///< energy if the beam contains the whole target, J
  double electronsPerJoule; ///< photoelectrons per joule of these energies
  DetectionLaw::Between elevation;

  double probability(double step, int beams) const
  {
    return this->target.law->probabilityAt(step, beams, this->elevation);
  }

  /// Sets the results for `beams` beams, each of which contains the whole target.
  void fill(CoverageValue& value, int beams, double* ofPoses) const
  {
    const double received = std::min(this->energy, this->filling);
    value.probability = this->target.law->probability(received, beams, this->elevation);
    value.photoelectrons = this->electronsPerJoule * this->energy;
    if (beams > 0)
    {
      const std::size_t view = this->elevation.below + (this->elevation.share > 0.5 ? 1 : 0);
      value.leastArea =
        this->target.area / this->energy * this->target.law->energyFor(0.5, beams, view);
    }
    if (ofPoses)
    {
      this->target.law->ofPoses(this->energy, beams, this->elevation, ofPoses);
    }
  }
};

/// Beams that may light a target and are not in clutter there. If there are too many, the nearest
/// beams are kept, and three times as many others, drawn, which meet the outer parts of a near
/// target.
struct Coverage::NearBeams
{
  struct Beam
  {
    std::uint32_t number;
    double nearness; ///< larger for beams that are nearer
    bool isHeld;     ///< true if the beam contains the place
  };
  Beam beams[DetectionLaw::MostBeams]; ///< not initialised, as a NearBeams is made for each place
  std::size_t count = 0;
  int clear = 0; ///< number of beams that contain the place
  int whole = 0; ///< number of beams that contain the whole target

  void add(const Beam& beam)
  {
    constexpr std::size_t most = DetectionLaw::MostBeams;
    constexpr std::size_t nearest = most / 4;
    const auto isNearer = [](const Beam& a, const Beam& b) { return a.nearness > b.nearness; };
    if (this->count < most)
    {
      this->beams[this->count++] = beam;
      if (this->count == most)
      {
        std::nth_element(this->beams, this->beams + nearest, this->beams + most, isNearer);
      }
      return;
    }
    Beam left = beam;
    Beam* farthest = std::max_element(this->beams, this->beams + nearest, isNearer);
    if (isNearer(left, *farthest))
    {
      std::swap(left, *farthest);
    }
    const auto drawn = [](const Beam& b) { return hashOf(&b.number, sizeof(b.number), 0); };
    Beam* last = std::max_element(this->beams + nearest, this->beams + most,
      [&](const Beam& a, const Beam& b) { return drawn(a) < drawn(b); });
    if (drawn(left) < drawn(*last))
    {
      *last = left;
    }
  }
};

Coverage::PlacedTarget Coverage::placed(const CoverageTarget& target, const Vec3& place) const
{
  const Sensor& sensor = this->Setup.sensor;
  const Vec3 to = place - this->Beams.origins[0];
  const double range = safeLength(to);
  double filling = energyFromTarget(
    sensor, range, std::numeric_limits<double>::infinity(), target.reflectance, target.attenuation);
  const auto unit = static_cast<std::int64_t>(range / sensor.rangeUnitLength());
  double air = 0.0;
  if (!this->Setup.media.empty())
  {
    const BeamAir along = AirFinder(this->Air).alongRay(this->Beams.origins[0], to / range, 0.0);
    filling *= along.transmission(range);
    const std::vector<MetSurface> none;
    AirLight light(this->Air);
    light.begin(along, none);
    air = light.followed(unit);
  }
  double growth = 1.0;
  if (air > 0.0 && sensor.followsAir())
  {
    const PhotonReceiver receiver(sensor);
    growth = receiver.growthInAir(receiver.electronsPerJoule * air);
  }
  const double energy = filling * target.area / (sensor.solidAngle() * range * range);
  const Vec3 direction = to / range;
  const Vec3 across = glm::cross(direction, this->Up);
  const Vec3 right =
    glm::dot(across, across) > 0.0 ? unitVector(across) : Vec3(this->Up.y, this->Up.z, this->Up.x);
  return { target, range, direction, right, glm::cross(right, direction), filling / growth,
    energy / growth, growth * this->ElectronsPerJoule,
    target.law->betweenAt(elevationOf(to, this->Up)) };
}

/// True if no number of beams detects the target and no beam that may be near has clutter.
bool Coverage::isHopeless(const PlacedTarget& at, double step) const
{
  return this->Setup.sensor.beamProfile != BeamProfile::Gaussian &&
    at.target.law->reach() < this->Directions->leastMargin() * at.range &&
    at.probability(step, this->Most) < Negligible &&
    !this->HasClutter[this->Directions->cellOf(at.direction)];
}

Coverage::NearBeams Coverage::clearBeams(const PlacedTarget& at) const
{
  // A beam whose border does not cross the target lights all or nothing of it.
  const double halfBeamwidth = this->Shape.width().half;
  const double reach =
    std::min(angleOf(at.target.law->reach(), at.range), this->Directions->largestMargin());
  const double within = reach < halfBeamwidth ? std::cos(halfBeamwidth - reach) : 1.0;
  const double beyond = std::cos(halfBeamwidth + reach);
  NearBeams near;
  this->Directions->forEachNear(at.direction, reach,
    [&](std::uint32_t beam, double cosine)
    {
      if (cosine < beyond)
      {
        return;
      }
      const bool isHeld = this->holds(beam, at.direction, cosine);
      // The cone around a beam that is not round is larger than the beam.
      const double away = this->Shape.isRound() ? 0.0 : this->beamAt(at, beam).beyond();
      const bool isNear = isHeld || away < at.target.law->reach();
      if (isNear && !this->isInClutter(beam, at.range))
      {
        near.clear += isHeld;
        near.whole += isHeld && ((this->Shape.isRound() && cosine > within) || !(reach > 0.0));
        near.add({ beam, this->Shape.isRound() ? cosine : -away, isHeld });
      }
    });
  return near;
}

/// True if the parts lit by beams whose borders cross the target do not change its probability.
bool Coverage::isCertain(const PlacedTarget& at, double step, const NearBeams& near) const
{
  const int all = static_cast<int>(near.count);
  return this->Setup.sensor.beamProfile != BeamProfile::Gaussian &&
    (near.whole >= all ||
      (all <= at.target.law->mostBeams() &&
        at.probability(step, all) - at.probability(step, near.whole) < Negligible));
}

/// Returns a beam in the plane across the line of sight to a target (see Silhouette.h).
BeamAtTarget Coverage::beamAt(const PlacedTarget& at, std::uint32_t beam) const
{
  const Sensor& sensor = this->Setup.sensor;
  const Vec3 axis = at.range * this->Directions->axis(beam);
  BeamAtTarget found{ at.range * std::sin(sensor.halfBeamwidth), glm::dot(axis, at.right),
    glm::dot(axis, at.up), sensor.beamProfile };
  if (sensor.beamProfile == BeamProfile::Gaussian)
  {
    found.fall = 2.0 * sensor.gaussianTruncation * sensor.gaussianTruncation;
    found.most = this->Shape.mostDensity();
  }
  if (this->Shape.isRound())
  {
    return found;
  }
  const BeamFrame frame = this->frameOf(beam);
  const BeamWidth& width = this->Shape.width();
  const double x = glm::dot(frame.e1, at.right);
  const double y = glm::dot(frame.e1, at.up);
  found.isRectangle = width.isRectangle;
  found.radius = at.range * width.tangent * (width.isRectangle ? BeamShape::HalfSide : 1.0);
  found.across = found.radius * width.flatness;
  found.cosine = x / std::hypot(x, y);
  found.sine = y / std::hypot(x, y);
  return found;
}

/// Replaces results for the whole target by results for the parts that the beams light.
void Coverage::share(
  const PlacedTarget& at, NearBeams& near, double* ofPoses, CoverageValue& value) const
{
  std::sort(near.beams, near.beams + near.count,
    [](const auto& a, const auto& b) { return a.nearness > b.nearness; });
  std::array<BeamAtTarget, DetectionLaw::MostBeams> beams;
  double irradiance = 0.0; // sum over the beams that contain the place
  for (std::size_t b = 0; b < near.count; ++b)
  {
    beams[b] = this->beamAt(at, near.beams[b].number);
    irradiance += near.beams[b].isHeld ? beams[b].irradiance() : 0.0;
  }
  value.probability = at.target.law->probability(
    at.energy, at.filling, beams.data(), near.count, at.elevation, ofPoses);
  if (near.clear > 0)
  {
    irradiance /= std::min<double>(near.clear, near.count);
    value.photoelectrons *= irradiance;
    value.leastArea /= irradiance;
  }
}

/// Detection at a place that is near a beam and not hidden.
/// @param ofPoses results, one for each pose, filled with 0 by the caller; or null
CoverageValue Coverage::valueOf(
  const PlacedTarget& at, const CoverageSight& sight, double* ofPoses) const
{
  CoverageValue value;
  value.beams = sight.beams;
  value.status = sight.beams > 0 ? CoverageStatus::TooWeak : sight.status;
  if (!(at.energy > 0.0))
  {
    return value;
  }
  const double step = at.target.law->stepOf(at.energy); // upper bound: parts receive no more
  if (sight.beams > 0 && this->isHopeless(at, step))
  {
    at.fill(value, sight.beams, ofPoses);
    return value;
  }
  NearBeams near = this->clearBeams(at);
  if (near.count > 0)
  {
    const bool isCertain = this->isCertain(at, step, near);
    at.fill(value, near.clear, isCertain ? ofPoses : nullptr);
    if (!isCertain)
    {
      this->share(at, near, ofPoses, value);
    }
  }
  if (value.probability >= WeakProbability)
  {
    value.status = CoverageStatus::Seen;
  }
  else if (sight.beams > 0 && near.clear == 0)
  {
    value.status = CoverageStatus::InClutter;
  }
  return value;
}

CoverageValue Coverage::valueAt(
  const Vec3& place, const CoverageSight& sight, const CoverageTarget& target, float* ofPoses) const
{
  const std::size_t poses = ofPoses ? target.law->poses() : 0;
  std::fill_n(ofPoses, poses, 0.0F);
  if (!sight.isNear || sight.isHidden)
  {
    CoverageValue value;
    value.status = sight.status;
    value.beams = sight.beams;
    return value;
  }
  const PlacedTarget at = this->placed(target, place);
  if (!ofPoses)
  {
    return this->valueOf(at, sight, nullptr);
  }
  // The law's headings count from the line of sight. Values for headings from north are
  // interpolated linearly.
  std::vector<double> found(poses, 0.0);
  const CoverageValue value = this->valueOf(at, sight, found.data());
  const std::size_t headings = target.law->headings();
  const double turn = std::atan2(at.direction.x, at.direction.y) / (2.0 * Pi);
  const double shift = (1.0 - turn) * static_cast<double>(headings); // 0.5 to 1.5 turns
  const auto whole = static_cast<std::size_t>(shift);
  const double share = shift - static_cast<double>(whole);
  for (std::size_t i = 0; i < poses; ++i)
  {
    const std::size_t first = i - i % headings;
    const double low = found[first + (i + whole) % headings];
    const double next = found[first + (i + whole + 1) % headings];
    ofPoses[i] = static_cast<float>(low + share * (next - low));
  }
  return value;
}
}
