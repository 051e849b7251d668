// SPDX-License-Identifier: BSD-3-Clause
#include "Scan.h"

#include "ScanProgress.h"

#include <algorithm>
#include <atomic>

namespace avianlidar
{
namespace
{
/// Rays with hits between two looks at the wish to stop: milliseconds.
constexpr std::size_t RaysBetweenLooks = 1600;

/// A beam that is integrated takes the time of about so many.
constexpr std::size_t RaysLikeAPatch = 50;

/// What became of the beams of a block.
struct Block
{
  std::vector<Echo> echoes;
  std::vector<std::size_t> beamOfEcho;
  std::vector<std::uint32_t> lit;     ///< beams that meet something; in a run that starts afresh
  std::vector<BeamOutcome> outcomes;  ///< theirs
  std::vector<std::uint32_t> changed; ///< beams with new reports; in a run that goes on
  std::vector<std::size_t> again;     ///< of the beams that met something, those to be lit again
  std::uint64_t raysTraced = 0;
  std::size_t beamsLit = 0;
};

template <class T>
void append(const std::vector<T>& more, std::vector<T>& all)
{
  all.insert(all.end(), more.begin(), more.end());
}

void collect(const std::vector<Block>& blocks, ScanMemory& memory, ScanResult& result)
{
  std::size_t count = 0;
  for (const Block& block : blocks)
  {
    count += block.echoes.size();
  }
  result.echoes.clear();
  result.beamOfEcho.clear();
  result.changed.clear();
  result.raysTraced = 0;
  result.beamsLit = 0;
  result.echoes.reserve(count);
  result.beamOfEcho.reserve(count);
  for (const Block& block : blocks)
  {
    append(block.echoes, result.echoes);
    append(block.beamOfEcho, result.beamOfEcho);
    append(block.lit, memory.lit);
    append(block.outcomes, memory.outcomes);
    append(block.changed, result.changed);
    result.raysTraced += block.raysTraced;
    result.beamsLit += block.beamsLit;
  }
  std::size_t echo = 0;
  for (BeamOutcome& outcome : memory.outcomes)
  {
    outcome.firstEcho = echo;
    echo += outcome.echoes;
  }
}

std::uint64_t nextRun()
{
  static std::atomic<std::uint64_t> last{ 0 };
  return ++last;
}
}

std::size_t ScanResult::bytes() const
{
  return this->echoes.capacity() * (sizeof(Echo) + sizeof(std::size_t)) +
    this->reports.capacity() * sizeof(BeamReport) +
    this->changed.capacity() * sizeof(std::uint32_t);
}

namespace
{
/// One run over all beams, or over those that met something in the run before.
class Run
{
public:
  Run(const ScanSetup& setup, const ScanBeams& beams, int threads, TraceCache& cache,
    std::size_t maximumBytes, const KeepGoing& keepGoing, ScanResult& result)
    : Setup(setup)
    , Beams(beams)
    , Threads(threads)
    , Cache(cache)
    , Maximum(maximumBytes)
    , Result(result)
    , Again(mayGoOn(setup, cache, result))
    , Count(this->Again ? cache.memory.lit.size() : beams.size())
    , Size(this->Again ? LitPerBlock : beamsPerBlock(setup.settings.raysPerBeam))
    , Progress(this->Count, keepGoing)
    , Blocks((this->Count + this->Size - 1) / this->Size)
    , Simulators(loopThreads(threads))
  {
  }

  /// @return false if it was stopped
  bool go()
  {
    this->begin();
    const auto body = [this](std::size_t begin, std::size_t end, int thread)
    {
      auto& simulator = this->Simulators[thread];
      if (!simulator)
      {
        simulator = std::make_unique<BeamSimulator>(this->Setup, this->Beams, this->Cache.shading,
          [this, thread] { return this->Progress.goOn(thread); });
      }
      Block& block = this->Blocks[begin / this->Size];
      if (this->Again)
      {
        this->lightAgain(begin, end, *simulator, block, thread);
      }
      else
      {
        this->scan(begin, end, *simulator, block, thread);
      }
    };
    bool finished = false;
    try
    {
      finished = parallelFor(this->Count, this->Size, this->Threads, body,
        [this](double fraction) { return this->Progress.report(fraction); });
    }
    catch (const WorkStopped&)
    {
    }
    if (finished)
    {
      this->finish();
    }
    return finished;
  }

private:
  /// Beams to a block that is lit again.
  static constexpr std::size_t LitPerBlock = 128;

  /// True if the result at hand can be brought up to date.
  static bool mayGoOn(const ScanSetup& setup, const TraceCache& cache, const ScanResult& result)
  {
    const ScanMemory& memory = cache.memory;
    return memory.run != 0 && memory.run == result.run && leavesMemories(setup) &&
      memory.smallestTarget == setup.needs.smallestTarget;
  }

  /// True if outcomes of beams tell what they would be with other limits and in other air, and may
  /// be used.
  static bool leavesMemories(const ScanSetup& setup)
  {
    return !setup.noise.active && setup.settings.targetRelativeError <= 0.0 &&
      !refinesNearLimit(setup.settings) && !setup.settings.fullModel;
  }

  void begin()
  {
    ScanMemory& memory = this->Cache.memory;
    if (this->Again)
    {
      this->Same = memory.circumstances.areThoseOf(this->Setup);
      // Where faint paths are not dropped, silent beams are followed in full: nothing is left out.
      this->BoundsChange = dropsFaintPaths(this->Setup.settings) &&
        (memory.attenuation != this->Setup.settings.attenuationCoefficient ||
          (memory.perceivableRange != this->Setup.needs.perceivableRange &&
            std::min(memory.perceivableRange, this->Setup.needs.perceivableRange) <
              this->Setup.sensor.rangeGate));
      for (std::size_t b = 0; this->Result.raysTraced > 0 && b < this->Beams.size(); ++b)
      {
        this->Result.reports[b].raysTracedNow = 0;
      }
    }
    else
    {
      memory = ScanMemory();
      this->Result = ScanResult{};
      this->Result.reports.resize(this->Beams.size());
    }
    this->Held =
      this->Again ? memory.held : this->Cache.bytes() - this->Beams.size() * sizeof(BeamTrace);
  }

  void finish()
  {
    ScanMemory& memory = this->Cache.memory;
    collect(this->Blocks, memory, this->Result);
    this->Result.before = this->Again ? this->Result.run : 0;
    this->Result.run = nextRun();
    memory.resultBytes = this->Result.bytes();
    memory.held = this->Held;
    const bool known = leavesMemories(this->Setup) && memory.held + memory.bytes() <= this->Maximum;
    if (!known)
    {
      memory = ScanMemory();
      return;
    }
    memory.run = this->Result.run;
    memory.smallestTarget = this->Setup.needs.smallestTarget;
    memory.perceivableRange = this->Setup.needs.perceivableRange;
    memory.attenuation = this->Setup.settings.attenuationCoefficient;
    memory.circumstances = Circumstances(this->Setup);
  }

  /// Trace what is not known, and light all.
  void scan(std::size_t begin, std::size_t end, BeamSimulator& simulator, Block& block, int thread)
  {
    const std::vector<BeamTrace>& traces = this->Cache.beams;
    std::size_t heldBefore = 0;
    for (std::size_t b = begin; b < end; ++b)
    {
      heldBefore += traces[b].held;
    }
    this->Held -= heldBefore;
    simulator.trace(begin, end, this->Cache.beams);
    std::size_t rays = 0;
    for (std::size_t b = begin; b < end; ++b)
    {
      BeamOutcome outcome;
      this->light(b, simulator, block, outcome);
      if (traces[b].meetsSomething())
      {
        block.lit.push_back(static_cast<std::uint32_t>(b));
        block.outcomes.push_back(outcome);
      }
      this->lookUp(b, thread, rays);
      this->keep(b);
    }
  }

  /// Light those of some beams of the run before that do not stay as they are.
  void lightAgain(
    std::size_t begin, std::size_t end, BeamSimulator& simulator, Block& block, int thread)
  {
    ScanMemory& memory = this->Cache.memory;
    std::vector<BeamTrace>& traces = this->Cache.beams;
    const auto beamOf = [&memory](std::size_t k) { return memory.lit[k]; };
    for (std::size_t k = begin; k < end; ++k)
    {
      if (!this->Same || !simulator.isLit(traces[beamOf(k)], memory.outcomes[k]))
      {
        block.again.push_back(k);
      }
    }
    std::size_t rays = 0;
    std::size_t next = 0; // of those to be lit again
    for (std::size_t k = begin; k < end; ++k)
    {
      const std::uint32_t b = beamOf(k);
      BeamOutcome& outcome = memory.outcomes[k];
      if (next == block.again.size() || block.again[next] != k)
      {
        this->copy(b, outcome, simulator, block);
        this->Progress.beamDone();
        continue;
      }
      ++next;
      if (next + 3 < block.again.size())
      {
        fetchBeam(traces[beamOf(block.again[next + 3])]);
        fetchParts(traces[beamOf(block.again[next + 1])]);
        fetchArrays(traces[beamOf(block.again[next])]);
      }
      this->Held -= traces[b].held;
      simulator.trace(b, b + 1, traces);
      this->light(b, simulator, block, outcome);
      block.changed.push_back(b);
      this->lookUp(b, thread, rays);
      this->keep(b);
    }
  }

  void light(std::size_t b, BeamSimulator& simulator, Block& block, BeamOutcome& outcome)
  {
    const std::size_t before = block.echoes.size();
    simulator.light(b, this->Cache.beams[b], block.echoes, this->Result.reports[b], outcome);
    block.beamOfEcho.resize(block.echoes.size(), b);
    outcome.echoes = static_cast<std::uint32_t>(block.echoes.size() - before);
    block.raysTraced += this->Result.reports[b].raysTracedNow;
    ++block.beamsLit;
    this->Progress.beamDone();
  }

  /// The echoes of the run before; Qhigh alone may have changed.
  void copy(
    std::uint32_t b, const BeamOutcome& outcome, const BeamSimulator& simulator, Block& block)
  {
    if (outcome.echoes == 0)
    {
      if (this->BoundsChange)
      {
        this->boundAgain(b, outcome, block);
      }
      return;
    }
    const Sensor& sensor = this->Setup.sensor;
    const auto first = this->Result.echoes.begin() + outcome.firstEcho;
    for (auto echo = first; echo != first + outcome.echoes; ++echo)
    {
      block.echoes.push_back(*echo);
      block.echoes.back().energy =
        perceivedEnergy(echo->energyReceived, sensor.lowerEnergyLimit, sensor.upperEnergyLimit);
      block.beamOfEcho.push_back(b);
    }
    const BeamStatus status = simulator.statusOfEcho(outcome.loudest);
    if (this->Result.reports[b].status != status)
    {
      this->Result.reports[b].status = status;
      block.changed.push_back(b);
    }
  }

  /// A beam that stays without echoes was not looked at: what it can bring back now.
  void boundAgain(std::uint32_t b, const BeamOutcome& outcome, Block& block)
  {
    BeamReport& report = this->Result.reports[b];
    const bool beyond = 0.5 * outcome.shortest > this->Setup.needs.perceivableRange;
    report.skipped = SkippedBeam | (beyond ? SkippedBeyondRange : SkippedPart{});
    report.lost = outcome.loudestIn(this->Setup.settings.attenuationCoefficient);
    block.changed.push_back(b);
  }

  /// Forget what is known of a beam that there is no room for.
  void keep(std::size_t b)
  {
    BeamTrace& trace = this->Cache.beams[b];
    const std::size_t bytes = trace.held;
    if (bytes > 0 && this->Held.fetch_add(bytes) + bytes > this->Maximum)
    {
      trace = BeamTrace{};
      this->Held -= bytes;
    }
  }

  /// Now and then, see whether the result is still wanted.
  void lookUp(std::size_t b, int thread, std::size_t& rays)
  {
    const BeamTrace& trace = this->Cache.beams[b];
    rays +=
      trace.hits ? this->Result.reports[b].counters.raysTraced : (trace.patch ? RaysLikeAPatch : 0);
    if (rays > RaysBetweenLooks)
    {
      rays = 0;
      if (!this->Progress.goOn(thread))
      {
        throw WorkStopped();
      }
    }
  }

  const ScanSetup& Setup;
  const ScanBeams& Beams;
  const int Threads;
  TraceCache& Cache;
  const std::size_t Maximum; ///< bytes
  ScanResult& Result;
  const bool Again;          ///< the result is that of the run before
  bool Same = false;         ///< and the circumstances, too
  bool BoundsChange = false; ///< of beams without echoes
  const std::size_t Count;   ///< beams to look at
  const std::size_t Size;    ///< of a block
  ScanProgress Progress;
  std::vector<Block> Blocks;
  std::vector<std::unique_ptr<BeamSimulator>> Simulators;
  std::atomic<std::size_t> Held{ 0 }; ///< bytes
};
}

bool simulateScan(const ScanSetup& setup, const ScanBeams& beams, int threads, TraceCache& cache,
  std::size_t maximumBytes, const KeepGoing& keepGoing, ScanResult& result)
{
  bool finished = false;
  try
  {
    cache.follow(setup, beams, maximumBytes);
    finished = Run(setup, beams, threads, cache, maximumBytes, keepGoing, result).go();
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
