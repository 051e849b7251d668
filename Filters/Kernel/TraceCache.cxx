// SPDX-License-Identifier: BSD-3-Clause
#include "TraceCache.h"

#include "Hash.h"

namespace avianlidar
{
std::size_t TraceCache::bytes() const
{
  std::size_t sum = 0;
  for (const BeamTrace& trace : this->beams)
  {
    sum += sizeof(BeamTrace) + trace.held;
  }
  return sum + this->memory.bytes();
}

void TraceCache::clear()
{
  this->key = 0;
  this->memory = ScanMemory();
  std::vector<BeamTrace>().swap(this->beams);
}

std::uint64_t checksumOf(const ScanBeams& beams)
{
  std::uint64_t key = hashOf(beams.ids.data(), beams.ids.size() * sizeof(beams.ids[0]), 0);
  key = hashOf(beams.origins.data(), beams.origins.size() * sizeof(Vec3), key);
  return hashOf(beams.directions.data(), beams.directions.size() * sizeof(Vec3), key);
}

std::uint64_t traceKey(const ScanSetup& setup, const ScanBeams& beams)
{
  const std::uint64_t checksums[] = { setup.tree->checksum,
    beams.checksum != 0 ? beams.checksum : checksumOf(beams) };
  const EchoSettings& s = setup.settings;
  const double numbers[] = { setup.sensor.halfBeamwidth,
    static_cast<double>(setup.sensor.beamProfile), static_cast<double>(s.sampling),
    static_cast<double>(s.raysPerBeam), static_cast<double>(s.seed),
    static_cast<double>(s.precision), s.targetRelativeError,
    static_cast<double>(s.planeIntegration) };
  const std::uint64_t objects = setup.objects ? setup.objects->checksum() : 0;
  return hashOf(numbers, sizeof(numbers), hashOf(checksums, sizeof(checksums), objects));
}
}
