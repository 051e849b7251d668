// SPDX-License-Identifier: BSD-3-Clause
#include "CoverageSurvey.h"

#include "Hash.h"
#include "PhotonReceiver.h"
#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace avianlidar
{
namespace
{
constexpr std::size_t PlacesOfSum = 512;

std::uint64_t hashOfBeams(const std::vector<Vec3>& vectors, double number, std::uint64_t seed)
{
  return hashOf(
    vectors.data(), vectors.size() * sizeof(Vec3), hashOf(&number, sizeof(number), seed));
}
}

std::string checkRules(const SurveyRules& rules)
{
  if (rules.scans < 1 || rules.scans > MostScans)
  {
    return valueError("NumberOfScans", rules.scans, "1 to 100");
  }
  if (rules.requiredDetections < 1 || rules.requiredDetections > rules.scans)
  {
    return valueError("RequiredDetections", rules.requiredDetections, "1 to NumberOfScans");
  }
  for (std::size_t i = 0; i < rules.heightLimits.size(); ++i)
  {
    const double limit = rules.heightLimits[i];
    if (!std::isfinite(limit) || (i > 0 && !(limit > rules.heightLimits[i - 1])))
    {
      return valueError("HeightLimits", limit, "finite and rising m");
    }
  }
  return {};
}

bool CoverageSurvey::look(const ScanSetup& setup, const ScanBeams& beams, const ScanResult& still,
  const SurveyPlaces& places, std::uint64_t geometry, int threads, const KeepGoing& keepGoing)
{
  this->Places = places;
  this->Traced = 0;
  const BeamShape shape(setup.sensor);
  const std::uint64_t directionsOf = hashOfBeams(beams.directions, shape.width().half, 0);
  const double outline[] = { setup.sensor.halfBeamwidth,
    static_cast<double>(setup.sensor.beamOutline), setup.sensor.halfBeamwidthAcross,
    setup.sensor.beamRotation, setup.sensor.up.x, setup.sensor.up.y, setup.sensor.up.z,
    setup.sensor.minimumRange };
  // The parts are hashed in order: in an exclusive or, equal parts would cancel.
  const std::uint64_t parts[] = { directionsOf, places.hash, geometry,
    hashOf(outline, sizeof(outline), 0) };
  const std::uint64_t sightsOf =
    hashOfBeams(beams.origins, setup.sensor.rangeGate, hashOf(parts, sizeof(parts), 0));
  const auto known =
    this->Covered && this->DirectionsOf == directionsOf ? this->Covered->directions() : nullptr;
  this->Covered.reset();
  if (beams.size() > 0)
  {
    this->Covered = std::make_unique<Coverage>(setup, beams, Vec3(0.0, 0.0, 1.0), still, known);
    this->DirectionsOf = directionsOf;
  }
  if (this->SightsOf == sightsOf && this->Sights.size() == places.count)
  {
    return true;
  }
  this->SightsOf = 0;
  this->Sights.assign(places.count, CoverageSight());
  if (this->Covered &&
    !this->Covered->look(places.at, places.count, threads, keepGoing, this->Sights.data()))
  {
    return false;
  }
  this->Traced = places.count;
  this->SightsOf = sightsOf;
  return true;
}

bool CoverageSurvey::evaluate(const SurveyTarget& wanted, const SurveyRules& rules, int threads,
  const KeepGoing& keepGoing, const EachPlace& each, CoverageShares* sums, const PosesOf& posesOf)
{
  std::optional<CoverageTarget> target;
  if (this->Covered)
  {
    const Sensor& sensor = this->Covered->setup().sensor;
    target = { this->Covered->setup().attenuation(), wanted.area, wanted.reflectance,
      this->Laws->get(sensor, wanted.views, this->Covered->lowest(), this->Covered->highest(),
        this->Covered->mostBeams()) };
  }
  std::vector<std::map<std::size_t, CoverageShares>> ofBlock(
    (this->size() + PlacesOfSum - 1) / PlacesOfSum);
  const auto body = [&](std::size_t begin, std::size_t end, int)
  {
    auto& own = ofBlock[begin / PlacesOfSum];
    for (std::size_t k = begin; k < end; ++k)
    {
      const Vec3 place = this->Places.at(k);
      const CoverageValue value = target
        ? this->Covered->valueAt(place, this->Sights[k], *target, posesOf ? posesOf(k) : nullptr)
        : CoverageValue{ CoverageStatus::BetweenBeams };
      const double track = value.probability > 0.0
        ? trackProbability(value.probability, rules.requiredDetections, rules.scans)
        : 0.0;
      if (each)
      {
        each(k, value, track);
      }
      const std::size_t region = this->Places.regionOf(k);
      if (region != SurveyPlaces::NoRegion)
      {
        const auto limit =
          std::upper_bound(rules.heightLimits.begin(), rules.heightLimits.end(), place.z);
        const auto band = static_cast<std::size_t>(limit - rules.heightLimits.begin());
        own[region * rules.bands() + band].add(
          rules.strikeHeightWeights ? strikeHeightDensity(place.z) : 1.0, value, track);
      }
    }
  };
  if (!parallelFor(this->size(), PlacesOfSum, threads, body, keepGoing))
  {
    return false;
  }
  for (const auto& block : ofBlock)
  {
    for (const auto& [cell, sum] : block)
    {
      sums[cell].add(sum);
    }
  }
  return true;
}

std::vector<double> shareOfScans(const Sensor& sensor, const std::vector<Echo>& echoes)
{
  std::vector<double> shares(echoes.size(), 1.0);
  if (sensor.receiverModel == ReceiverModel::Photons)
  {
    const PhotonReceiver receiver(sensor);
    std::transform(echoes.begin(), echoes.end(), shares.begin(),
      [&](const Echo& echo)
      {
        return receiver.detectionProbability(receiver.electronsPerJoule * echo.energyReceived,
          receiver.electronsPerJoule * sensor.lowerEnergyLimit);
      });
  }
  return shares;
}
}
