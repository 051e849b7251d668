// SPDX-License-Identifier: BSD-3-Clause
#include "Scan.h"

#include "AvailableMemory.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <utility>

namespace avianlidar
{
namespace
{
/// Number of rays with hits between two checks for an abort. These rays take milliseconds.
constexpr std::size_t RaysBetweenChecks = 1600;

/// Cost of one beam integrated over polygons, measured in rays.
constexpr std::size_t CostOfPolygonsInRays = 100;
/// Rays of a beam's cells that cost as much as one traced ray.
constexpr double CellRaysPerTracedRay = 32.0;

/// Largest number of rays per beam of a sampler that is kept between runs.
constexpr int MostRaysOfKeptSampler = 10000;

/// Results of one block of beams.
struct Block : BeamResults
{
  std::vector<std::size_t> beamOfEcho;
  std::uint64_t raysTraced = 0;
  std::uint64_t beamsTraced = 0;
  std::uint64_t beamsTouched = 0;
  std::vector<MoverLight> sights;
  std::vector<SeenPlane> planes;
};

/// Simulators of one thread.
struct Worker
{
  BeamSimulator simulator;
  std::unique_ptr<MovedBeams> moved; ///< null if nothing moves
  // Memory of the beams before.
  BeamSimulator::Traced traced;
  BeamLight light;

  Worker(const ScanSetup& setup, const ScanAir& air, const ScanBeams& beams, bool keepsLight,
    BeamSampler& sampler, const std::function<bool()>& wanted, bool sights)
    : simulator(setup, air, beams, { keepsLight, false }, sampler, wanted)
    , light(setup.sensor)
  {
    if (setup.movers && !setup.movers->empty())
    {
      this->moved = std::make_unique<MovedBeams>(setup, air, beams, sampler, wanted, sights);
    }
  }
};

template <class T>
void append(const std::vector<T>& more, std::vector<T>& all)
{
  all.insert(all.end(), more.begin(), more.end());
}

/// Progress of a scan. It is reported between blocks and within beams, on the calling thread only.
class ScanProgress
{
public:
  ScanProgress(std::size_t beams, const KeepGoing& keepGoing)
    : Beams(beams)
    , Continue(keepGoing)
  {
  }

  void beamDone() { ++this->Done; }

  /// Report the progress, which never decreases, on the calling thread. @return false to stop
  bool report(double fraction)
  {
    this->Last = std::max(this->Last, fraction);
    if (this->Continue && !this->Stopped && !this->Continue(this->Last))
    {
      this->Stopped = true;
    }
    return !this->Stopped;
  }

  /// Check for an abort, on any thread. @return false to stop
  bool shouldContinue(int thread)
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

/// One run over all beams.
class Run
{
public:
  Run(const ScanSetup& setup, const ScanBeams& beams, int threads, TraceCache& cache,
    std::size_t maximumBytes, const KeepGoing& keepGoing, ScanResult& result, bool sights)
    : Setup(setup)
    , Air(setup.sensor, setup.air())
    , Beams(beams)
    , Threads(threads)
    , Cache(cache)
    , Maximum(maximumBytes)
    , Result(result)
    , Sights(sights)
    , Size(beamsPerBlock(setup.settings.raysPerBeam))
    , CostOfCellsInRays(static_cast<std::size_t>(
        densityOfCells(setup.settings.raysPerBeam).rays() / CellRaysPerTracedRay))
    , Progress(beams.size(), keepGoing)
    , Blocks((beams.size() + this->Size - 1) / this->Size)
    , Workers(loopThreads(threads))
    , BytesHeld(cache.bytes() - beams.size() * sizeof(KeptBeam))
  {
    this->Result.reports.resize(beams.size());
    const std::uint32_t rays = tracedRaysOf(setup.settings);
    while (cache.samplers.size() < this->Workers.size())
    {
      cache.samplers.push_back(
        std::make_unique<BeamSampler>(setup.sensor, setup.settings.sampling, rays));
    }
  }

  /// @return false if the run was stopped
  bool go()
  {
    const auto body = [this](std::size_t begin, std::size_t end, int thread)
    {
      auto& worker = this->Workers[thread];
      if (!worker)
      {
        worker = std::make_unique<Worker>(
          this->Setup, this->Air, this->Beams, this->Cache.stays, *this->Cache.samplers[thread],
          [this, thread] { return this->Progress.shouldContinue(thread); }, this->Sights);
      }
      this->scan(begin, end, *worker, this->Blocks[begin / this->Size], thread);
    };
    bool finished = false;
    try
    {
      finished = parallelFor(this->Beams.size(), this->Size, this->Threads, body,
        [this](double fraction) { return this->Progress.report(fraction); });
    }
    catch (const WorkStopped&)
    {
    }
    if (this->Setup.settings.raysPerBeam > MostRaysOfKeptSampler)
    {
      this->Cache.samplers.clear(); // samplers are large, and fast to make again
    }
    if (finished)
    {
      this->collect();
    }
    return finished;
  }

private:
  /// Trace the beams of a block that are not kept, and light all of them.
  void scan(std::size_t begin, std::size_t end, Worker& worker, Block& block, int thread)
  {
    std::vector<KeptBeam>& kept = this->Cache.beams;
    std::size_t heldBefore = 0;
    for (std::size_t b = begin; b < end; ++b)
    {
      heldBefore += kept[b].held;
    }
    this->BytesHeld -= heldBefore;
    if (worker.moved)
    {
      worker.moved->find(begin, end);
    }
    const auto isTouched = [&](std::size_t b)
    { return worker.moved && worker.moved->isTouched(b); };
    BeamSimulator::Traced& traced = worker.traced;
    traced = worker.simulator.trace(begin, end, kept, isTouched, std::move(traced));
    block.beamsTraced += traced.size();
    std::size_t raysSince = 0;
    for (std::size_t b = begin; b < end; ++b)
    {
      BeamReport& report = this->Result.reports[b];
      BeamView moved; // what another run has kept of a touched beam must not count
      if (isTouched(b))
      {
        ++block.beamsTouched;
        MovedBeams::Followed followed =
          worker.moved->simulate(b, block, report, block.sights, std::move(worker.light));
        moved = std::move(followed.view);
        worker.light = std::move(followed.light);
      }
      else
      {
        worker.light =
          worker.simulator.follow(b, traced.of(b), kept[b], block, report, std::move(worker.light));
      }
      block.beamOfEcho.resize(block.echoes.size(), b);
      if (!this->Setup.tree->planeOwners.empty())
      {
        addSeenPlanes(*this->Setup.tree, isTouched(b) ? moved : kept[b].view, b, block.planes);
      }
      block.raysTraced += report.raysTracedNow;
      this->Progress.beamDone();
      this->checkForAbort(b, thread, raysSince);
      this->keep(kept[b]);
    }
    sortSeenPlanes(block.planes);
    const auto samples = static_cast<double>(this->Samples += block.waveforms.signal.size());
    requireMemory(samples, "samples of waveforms", samples * Waveforms::BytesOfSample);
  }

  /// Keep a beam only as far as memory allows.
  void keep(KeptBeam& beam)
  {
    if (beam.lit && this->BytesHeld + beam.held > this->Maximum)
    {
      beam.lit.reset(); // hits save more time than light
      beam.held = beam.heldBytes();
    }
    const std::size_t bytes = beam.held;
    if (bytes > 0 && this->BytesHeld.fetch_add(bytes) + bytes > this->Maximum)
    {
      beam = KeptBeam{};
      this->BytesHeld -= bytes;
    }
  }

  /// Check for an abort once `rays`, the cost since the last check, is large enough.
  void checkForAbort(std::size_t b, int thread, std::size_t& rays)
  {
    const BeamView& view = this->Cache.beams[b].view;
    rays += view.hits ? this->Result.reports[b].counters.raysTraced
                      : (view.polygons() ? CostOfPolygonsInRays : 0);
    rays += view.cells() ? this->CostOfCellsInRays : 0;
    if (rays > RaysBetweenChecks)
    {
      rays = 0;
      if (!this->Progress.shouldContinue(thread))
      {
        throw WorkStopped();
      }
    }
  }

  void collect()
  {
    std::size_t count = 0;
    for (const Block& block : this->Blocks)
    {
      count += block.echoes.size();
    }
    std::vector<SeenPlane> planes;
    this->Result.echoes.reserve(count);
    this->Result.beamOfEcho.reserve(count);
    for (Block& block : this->Blocks)
    {
      append(block.echoes, this->Result.echoes);
      this->Result.waveforms.append(block.waveforms);
      block.waveforms = {};
      append(block.beamOfEcho, this->Result.beamOfEcho);
      append(block.sights, this->Result.sights);
      append(block.planes, planes);
      this->Result.raysTraced += block.raysTraced;
      this->Result.beamsTraced += block.beamsTraced;
      this->Result.beamsTouched += block.beamsTouched;
    }
    sortSeenPlanes(planes);
    this->Result.coincident = findCoincidentObjects(this->Setup, this->Beams, planes);
  }

  const ScanSetup& Setup;
  const ScanAir Air;
  const ScanBeams& Beams;
  const int Threads;
  TraceCache& Cache;
  const std::size_t Maximum; ///< most memory for kept beams, bytes
  ScanResult& Result;
  const bool Sights;
  const std::size_t Size;              ///< number of beams of a block
  const std::size_t CostOfCellsInRays; ///< cost of a beam in cells, in rays
  ScanProgress Progress;
  std::vector<Block> Blocks;
  std::vector<std::unique_ptr<Worker>> Workers;
  std::atomic<std::size_t> Samples{ 0 }; ///< samples of the waveforms so far
  std::atomic<std::size_t> BytesHeld;    ///< memory of kept beams, bytes
};
}

bool simulateScan(const ScanSetup& setup, const ScanBeams& beams, int threads, TraceCache& cache,
  std::size_t maximumBytes, const KeepGoing& keepGoing, ScanResult& result, bool sights)
{
  bool finished = false;
  result = ScanResult{};
  try
  {
    cache.follow(setup, beams, maximumBytes);
    finished = Run(setup, beams, threads, cache, maximumBytes, keepGoing, result, sights).go();
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
  }
  return finished;
}
}
