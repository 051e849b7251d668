// SPDX-License-Identifier: BSD-3-Clause
#include "Scan.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <atomic>

namespace avianlidar
{
namespace
{
/// Rays in a block of beams: they stay in the cache between the stages, and neighbouring beams
/// can be traced together.
constexpr int RaysPerBlock = 16384;

std::size_t beamsPerBlock(const EchoSettings& settings)
{
  return static_cast<std::size_t>(std::clamp(RaysPerBlock / settings.raysPerBeam, 1, 256));
}

/// Rays with hits between two looks at the wish to stop: milliseconds.
constexpr std::size_t RaysBetweenLooks = 1600;

struct Block
{
  std::vector<Echo> echoes;
  std::vector<std::size_t> beamOfEcho;
};

/// Progress and the wish to stop, heard between blocks and within beams, on the calling thread
/// only.
class StopWatch
{
public:
  StopWatch(std::size_t beams, const KeepGoing& keepGoing)
    : Beams(beams)
    , Continue(keepGoing)
  {
  }

  void beamDone() { ++this->Done; }

  /// On the calling thread. Never falls.
  bool report(double fraction)
  {
    this->Last = std::max(this->Last, fraction);
    if (this->Continue && !this->Stopped && !this->Continue(this->Last))
    {
      this->Stopped = true;
    }
    return !this->Stopped;
  }

  /// On any thread.
  bool goOn(int thread)
  {
    return thread == 0
      ? this->report(static_cast<double>(this->Done) / static_cast<double>(this->Beams))
      : !this->Stopped;
  }

private:
  std::size_t Beams;
  const KeepGoing& Continue;
  std::atomic<std::size_t> Done{ 0 };
  std::atomic<bool> Stopped{ false };
  double Last = 0.0;
};

void collect(std::vector<Block>& blocks, ScanResult& result)
{
  std::size_t count = 0;
  for (const Block& block : blocks)
  {
    count += block.echoes.size();
  }
  result.echoes.reserve(count);
  result.beamOfEcho.reserve(count);
  for (const Block& block : blocks)
  {
    result.echoes.insert(result.echoes.end(), block.echoes.begin(), block.echoes.end());
    result.beamOfEcho.insert(
      result.beamOfEcho.end(), block.beamOfEcho.begin(), block.beamOfEcho.end());
  }
}
}

std::size_t TraceCache::bytes() const
{
  std::size_t sum = 0;
  for (const BeamTrace& trace : this->beams)
  {
    sum += sizeof(BeamTrace) + trace.held;
  }
  return sum;
}

void TraceCache::clear()
{
  this->key = 0;
  std::vector<BeamTrace>().swap(this->beams);
}

std::uint64_t traceKey(const ScanSetup& setup, const ScanBeams& beams)
{
  const auto hash = [](const void* data, std::size_t bytes, std::uint64_t seed)
  { return static_cast<std::uint64_t>(XXH3_64bits_withSeed(data, bytes, seed)); };
  std::uint64_t key = setup.tree->checksum;
  key = hash(beams.ids.data(), beams.ids.size() * sizeof(beams.ids[0]), key);
  key = hash(beams.origins.data(), beams.origins.size() * sizeof(Vec3), key);
  key = hash(beams.directions.data(), beams.directions.size() * sizeof(Vec3), key);
  const EchoSettings& s = setup.settings;
  const double numbers[] = { setup.sensor.halfBeamwidth,
    static_cast<double>(setup.sensor.beamProfile), static_cast<double>(s.sampling),
    static_cast<double>(s.raysPerBeam), static_cast<double>(s.seed),
    static_cast<double>(s.precision), s.targetRelativeError };
  return hash(numbers, sizeof(numbers), key);
}

bool simulateScan(const ScanSetup& setup, const ScanBeams& beams, int threads, TraceCache& cache,
  std::size_t maximumBytes, const KeepGoing& keepGoing, ScanResult& result)
{
  const std::uint64_t key = traceKey(setup, beams);
  if (cache.key != key || cache.beams.size() != beams.size())
  {
    cache.clear();
    cache.beams.resize(beams.size());
    cache.key = key;
  }
  cache.shading.follow(setup);
  result = ScanResult{};
  result.reports.resize(beams.size());
  const std::size_t size = beamsPerBlock(setup.settings);
  std::vector<Block> blocks((beams.size() + size - 1) / size);
  std::vector<std::unique_ptr<BeamSimulator>> simulators(loopThreads(threads));
  std::atomic<std::size_t> held{ cache.bytes() - beams.size() * sizeof(BeamTrace) };
  std::atomic<std::uint64_t> traced{ 0 };

  StopWatch watch(beams.size(), keepGoing);
  const auto body = [&](std::size_t begin, std::size_t end, int thread)
  {
    if (!simulators[thread])
    {
      simulators[thread] = std::make_unique<BeamSimulator>(
        setup, beams, cache.shading, [&watch, thread] { return watch.goOn(thread); });
    }
    BeamSimulator& simulator = *simulators[thread];
    Block& block = blocks[begin / size];
    std::size_t heldBefore = 0;
    for (std::size_t b = begin; b < end; ++b)
    {
      heldBefore += cache.beams[b].held;
    }
    held -= heldBefore;
    simulator.trace(begin, end, cache.beams);
    std::size_t rays = 0;
    std::uint64_t tracedHere = 0;
    for (std::size_t b = begin; b < end; ++b)
    {
      BeamTrace& trace = cache.beams[b];
      simulator.light(b, trace, block.echoes, result.reports[b]);
      block.beamOfEcho.resize(block.echoes.size(), b);
      tracedHere += result.reports[b].raysTracedNow;
      watch.beamDone();
      const std::size_t bytes = trace.held;
      if (bytes == 0)
      {
        continue;
      }
      if (held.fetch_add(bytes) + bytes > maximumBytes)
      {
        trace = BeamTrace{};
        held -= bytes;
      }
      rays += result.reports[b].counters.raysTraced;
      if (rays > RaysBetweenLooks)
      {
        rays = 0;
        if (!watch.goOn(thread))
        {
          throw WorkStopped();
        }
      }
    }
    traced += tracedHere;
  };
  bool finished = false;
  try
  {
    finished = parallelFor(beams.size(), size, threads, body,
      [&watch](double fraction) { return watch.report(fraction); });
  }
  catch (const WorkStopped&)
  {
  }
  catch (...)
  {
    cache.clear();
    result = ScanResult{};
    throw;
  }
  if (!finished)
  {
    cache.clear();
    result = ScanResult{};
    return false;
  }
  result.raysTraced = traced;
  collect(blocks, result);
  return true;
}
}
