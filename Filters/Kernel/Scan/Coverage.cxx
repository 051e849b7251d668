// SPDX-License-Identifier: BSD-3-Clause
#include "Coverage.h"

#include "PhotonReceiver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
constexpr std::size_t PlacesOfBlock = 4096;

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

Coverage::Coverage(
  const ScanSetup& setup, const ScanBeams& beams, const Vec3& up, const ScanResult& still)
  : Setup(setup)
  , Beams(beams)
  , Up(up)
  , Directions(beams.directions, setup.sensor.halfBeamwidth)
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

CoverageView Coverage::viewOf(const Vec3& place, BeamTracer& tracer) const
{
  const Vec3 to = place - this->Beams.origins[0];
  const double range = safeLength(to);
  CoverageView view;
  view.range = range;
  if (!(range <= this->Setup.sensor.rangeGate))
  {
    return view;
  }
  view.status = CoverageStatus::BetweenBeams;
  if (!(range > 0.0))
  {
    return view;
  }
  const Vec3 direction = to / range;
  const double elevation = elevationOf(direction, this->Up);
  if (elevation > this->Highest || elevation < this->Lowest)
  {
    view.status = elevation > this->Highest ? CoverageStatus::AboveBand : CoverageStatus::BelowBand;
    return view;
  }
  const bool gaussian = this->Setup.sensor.beamProfile == BeamProfile::Gaussian;
  const double edge = 1.0 - std::cos(this->Setup.sensor.halfBeamwidth);
  double irradiance = 0.0;
  this->Directions.forEachHolding(direction,
    [&](std::uint32_t beam)
    {
      view.beams += view.beams < 255 ? 1 : 0;
      if (view.clear < 255 && !this->isInClutter(beam, range))
      {
        ++view.clear;
        const double u =
          (1.0 - glm::dot(unitVector(this->Beams.directions[beam]), direction)) / edge;
        irradiance += gaussian ? 2.0 * std::exp(-2.0 * u) / -std::expm1(-2.0) : 1.0;
      }
    });
  if (view.beams == 0)
  {
    return view;
  }
  view.irradiance = view.clear > 0 ? static_cast<float>(irradiance / view.clear) : 0.0f;
  const bool hidden = tracer.occluded(Vec3(0.0), to, 1e-9 * range, NoTriangle, NoTriangle);
  view.status = hidden ? CoverageStatus::Shadowed
    : view.clear == 0  ? CoverageStatus::InClutter
                       : CoverageStatus::Seen;
  return view;
}

bool Coverage::view(const Vec3* places, std::size_t count, int threads, const KeepGoing& keepGoing,
  CoverageView* views) const
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
        views[k] = this->viewOf(places[k], tracer);
      }
    },
    keepGoing);
}

CoverageValue Coverage::valueAt(
  const CoverageView& view, const CoverageTarget& target, const DetectionLaw& law) const
{
  CoverageValue value;
  value.status = view.status;
  value.leastArea = std::numeric_limits<double>::infinity();
  if (view.status != CoverageStatus::Seen)
  {
    return value;
  }
  const Sensor& sensor = this->Setup.sensor;
  const double energy = view.irradiance *
    energyFromTarget(sensor, view.range, target.area, target.reflectance,
      this->Setup.settings.attenuationCoefficient);
  value.probability = law.probability(energy, view.clear);
  if (sensor.receiverModel == ReceiverModel::Photons)
  {
    value.photoelectrons = PhotonReceiver(sensor).electronsPerJoule * energy;
  }
  value.leastArea =
    energy > 0.0 ? target.area / energy * law.energyFor(0.5, view.clear) : value.leastArea;
  if (value.probability < WeakProbability)
  {
    value.status = CoverageStatus::TooWeak;
  }
  return value;
}
}
