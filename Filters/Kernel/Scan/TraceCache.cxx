// SPDX-License-Identifier: BSD-3-Clause
#include "TraceCache.h"

#include "Hash.h"
#include "MemberCount.h"

#include <unordered_map>
#include <utility>

namespace avianlidar
{
namespace
{
BeamKey keyOf(const ScanBeams& beams, std::size_t b)
{
  const Vec3 line[] = { beams.origins[b], beams.directions[b] };
  return { beams.ids[b], hashOf(line, sizeof(line), 0) };
}

struct HashOfKey
{
  std::size_t operator()(const BeamKey& key) const
  {
    return static_cast<std::size_t>(key.geometry ^ key.id);
  }
};

std::size_t bytesOf(const std::vector<KeptBeam>& traces)
{
  std::size_t sum = 0;
  for (const KeptBeam& trace : traces)
  {
    sum += sizeof(KeptBeam) + trace.held;
  }
  return sum;
}
}

std::size_t TraceCache::bytes() const
{
  const std::size_t known = this->keys.capacity() + this->absentKeys.capacity();
  return bytesOf(this->beams) + bytesOf(this->absent) + known * sizeof(BeamKey);
}

void TraceCache::clear()
{
  this->key = 0;
  this->scan = 0;
  std::vector<KeptBeam>().swap(this->beams);
  std::vector<BeamKey>().swap(this->keys);
  std::vector<KeptBeam>().swap(this->absent);
  std::vector<BeamKey>().swap(this->absentKeys);
  this->samplers.clear();
}

void TraceCache::follow(const ScanSetup& setup, const ScanBeams& scanned, std::size_t maximumBytes)
{
  const std::uint64_t wanted = traceKey(setup);
  const std::uint64_t checksum = scanned.checksum != 0 ? scanned.checksum : checksumOf(scanned);
  if (this->key != wanted)
  {
    this->clear();
  }
  const std::uint64_t wantedCrowd = crowdKey(setup);
  if (this->crowd != wantedCrowd)
  {
    this->forgetCrowds();
  }
  this->crowd = wantedCrowd;
  this->stays =
    this->scan == checksum && this->beams.size() == scanned.size() && this->key == wanted;
  if (!this->stays)
  {
    this->take(scanned);
    if (this->bytes() > maximumBytes)
    {
      std::vector<KeptBeam>().swap(this->absent);
      std::vector<BeamKey>().swap(this->absentKeys);
    }
  }
  this->key = wanted;
  this->scan = checksum;
  const std::uint64_t wantedLight = lightKey(setup);
  if (this->light != wantedLight)
  {
    this->forgetLight();
  }
  this->light = wantedLight;
}

void TraceCache::forgetLight()
{
  for (KeptBeam& trace : this->beams)
  {
    if (trace.lit)
    {
      trace.lit.reset();
      trace.held = trace.heldBytes();
    }
  }
}

/// Forget the views of crowded beams, and of beams with too many strips, which may be crowded.
/// Surfaces behind the gate matter in daylight.
void TraceCache::forgetCrowds()
{
  for (std::vector<KeptBeam>* traces : { &this->beams, &this->absent })
  {
    for (KeptBeam& trace : *traces)
    {
      if (trace.view.direct() == DirectEcho::Rays || trace.view.isBehindGate() ||
        (trace.view.cells() && trace.view.cells()->isCrowded))
      {
        trace = KeptBeam{};
      }
    }
  }
}

void TraceCache::take(const ScanBeams& scanned)
{
  this->forgetLight();
  std::unordered_map<BeamKey, KeptBeam*, HashOfKey> known;
  known.reserve(this->keys.size() + this->absentKeys.size());
  for (std::size_t b = 0; b < this->keys.size(); ++b)
  {
    known.emplace(this->keys[b], &this->beams[b]);
  }
  for (std::size_t b = 0; b < this->absentKeys.size(); ++b)
  {
    known.emplace(this->absentKeys[b], &this->absent[b]);
  }
  const std::size_t before = known.size();
  std::vector<KeptBeam> traces(scanned.size());
  std::vector<BeamKey> names(scanned.size());
  for (std::size_t b = 0; b < scanned.size(); ++b)
  {
    names[b] = keyOf(scanned, b);
    const auto found = known.find(names[b]);
    if (found != known.end())
    {
      traces[b] = std::move(*found->second);
      known.erase(found);
    }
  }
  std::vector<KeptBeam> rest;
  std::vector<BeamKey> restKeys;
  if (known.size() < before || scanned.size() == 0) // else no beam is in common
  {
    rest.reserve(known.size());
    restKeys.reserve(known.size());
    for (const auto& other : known)
    {
      restKeys.push_back(other.first);
      rest.push_back(std::move(*other.second));
    }
  }
  this->beams = std::move(traces);
  this->keys = std::move(names);
  this->absent = std::move(rest);
  this->absentKeys = std::move(restKeys);
}

std::uint64_t checksumOf(const ScanBeams& beams)
{
  std::uint64_t key = hashOf(beams.ids.data(), beams.ids.size() * sizeof(beams.ids[0]), 0);
  key = hashOf(beams.origins.data(), beams.origins.size() * sizeof(Vec3), key);
  return hashOf(beams.directions.data(), beams.directions.size() * sizeof(Vec3), key);
}

std::uint64_t traceKey(const ScanSetup& setup)
{
  // Other members are energies, times and limits, or affect only paths that start at hits.
  static_assert(memberCount<Sensor>() == 39,
    "do a beam's rays depend on the new member? Then it belongs to the key");
  const Sensor& sensor = setup.sensor;
  const bool cells = setup.settings.beamSamples == BeamSampleSource::Cells;
  const ReceivedPulse pulse(sensor, sensor.samplingInterval);
  std::vector<double> numbers = { sensor.halfBeamwidth, static_cast<double>(sensor.beamProfile),
    sensor.gaussianTruncation, static_cast<double>(sensor.beamOutline), sensor.halfBeamwidthAcross,
    sensor.beamRotation, sensor.up.x, sensor.up.y, sensor.up.z,
    cells ? sensor.samplingInterval : 0.0, cells ? sensor.pulseWidth : 0.0,
    cells ? sensor.rangeGate : 0.0, cells ? partsOfStrips(setup) : 0.0,
    cells ? pulse.before() : 0.0 };
  for (const EchoSetting& setting : echoSettings())
  {
    if (setting.effect == SettingEffect::Rays)
    {
      numbers.push_back(setting.get(setup.settings));
    }
  }
  // Places of media that do not fill the scene, and their number.
  std::vector<double> places;
  for (const PlacedMedium& placed : setup.media)
  {
    if (placed.fillsScene())
    {
      continue;
    }
    const MediumVolume& volume = placed.volume;
    const bool isStill = volume.velocity == Vec3(0.0);
    places.push_back((isStill ? 1.0 : 0.0) + (placed.medium.sharesGaps ? 2.0 : 0.0));
    if (isStill)
    {
      places.insert(places.end(),
        { static_cast<double>(volume.shape), volume.centre.x, volume.centre.y, volume.centre.z,
          volume.radius(), volume.up.x, volume.up.y, volume.up.z, volume.bottom, volume.top,
          volume.softness });
    }
  }
  const std::uint64_t objects =
    hashOf(places.data(), places.size() * sizeof(double), cells ? setup.objectIds.checksum() : 0);
  return hashOf(numbers.data(), numbers.size() * sizeof(double),
    hashOf(&setup.tree->checksum, sizeof(setup.tree->checksum), objects));
}

std::uint64_t crowdKey(const ScanSetup& setup)
{
  const Sensor& sensor = setup.sensor;
  const double numbers[] = { sensor.pulseEnergy, sensor.lowerEnergyLimit, sensor.receiverAperture,
    setup.largestReflectance, static_cast<double>(setup.settings.reflectanceModel),
    sensor.seesDaylight() ? 1.0 : 0.0 };
  return setup.settings.beamSamples == BeamSampleSource::Cells
    ? hashOf(numbers, sizeof(numbers), setup.materials.checksum())
    : 0;
}
}
