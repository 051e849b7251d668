// SPDX-License-Identifier: BSD-3-Clause
#include "Advice.h"

#include "CollisionTreeBuilder.h"
#include "ConvexBody.h"
#include "Random.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <numeric>

namespace avianlidar
{
namespace
{
constexpr double Coarse = 0.25; ///< of an error asked: the reference of a beam is made finer
constexpr int FinerScans = 8;
constexpr int MostTurns = 5;
constexpr double FarSlower = 1.5; ///< than the fastest that is good: no further turns
constexpr double AsFast = 1.03;   ///< within what times vary by
constexpr std::size_t CandidatesPerBeam = 50;
constexpr std::size_t RunLength = 32; ///< neighbouring beams that are timed together
constexpr std::size_t TimedRuns = 32;
constexpr std::size_t MostTimedTree = 1000000; ///< triangles of a tree that is built to time it
constexpr std::size_t MostConvex = 20000;      ///< triangles that are looked at

/// Seeds of the reference and of the plain rays; those of trials are counted from another.
constexpr std::int32_t ReferenceSeeds[] = { 1000003, 1000033 };
constexpr std::int32_t WitnessSeeds[] = { 1000037, 1000039 };

double threadSeconds()
{
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// `wanted` of `count` items, ascending: one at a random place of each of as many parts.
std::vector<std::size_t> pick(std::size_t count, std::size_t wanted, std::uint64_t purpose)
{
  wanted = std::min(count, wanted);
  std::vector<std::size_t> picked(wanted);
  for (std::size_t i = 0; i < wanted; ++i)
  {
    const double at = uniformPair(0, purpose, i, RandomPurpose::Patterns)[0];
    const double place = (static_cast<double>(i) + at) * static_cast<double>(count);
    picked[i] = std::min(static_cast<std::size_t>(place / static_cast<double>(wanted)), count - 1);
  }
  if (wanted == count)
  {
    std::iota(picked.begin(), picked.end(), std::size_t{ 0 });
  }
  return picked;
}

ScanBeams someOf(const ScanBeams& beams, const std::vector<std::size_t>& which)
{
  ScanBeams some;
  for (const std::size_t b : which)
  {
    some.ids.push_back(beams.ids[b]);
    some.origins.push_back(beams.origins[b]);
    some.directions.push_back(beams.directions[b]);
    if (!beams.times.empty())
    {
      some.times.push_back(beams.times[b]);
    }
  }
  return some;
}

/// What follows from the settings of a trial while it is measured.
struct Measuring
{
  std::vector<CountedErrors> counted; ///< by beam
  std::vector<double> seconds;        ///< of a beam, each turn
};

class Advisor
{
public:
  Advisor(const ScanSetup& setup, const ScanBeams& beams, const AdviceQuestion& question,
    const AdviceHost& host, AdviceAnswer& answer)
    : Setup(setup)
    , All(beams)
    , Question(question)
    , Host(host)
    , Answer(answer)
    , Reference(setup.sensor.rangeUnitLength() + 0.5 * SpeedOfLight * setup.sensor.pulseWidth,
        2.0 * setup.sensor.lowerEnergyLimit)
    , Errors(this->Weights, host.sum)
  {
    this->Setup.settings.noise = false;
  }

  bool go()
  {
    this->Answer.beams = this->Host.sum(static_cast<double>(this->All.size()));
    return this->Host.together([this] { this->choose(); }) &&
      this->Host.together([this] { this->refer(); }) && this->judgeReference() && this->tryAll() &&
      this->Host.together([this] { this->lookAtScene(); }) && this->conclude();
  }

private:
  /// Scan some beams with some settings. @param timed one thread
  ScanResult scan(const AdviceSettings& settings, std::int32_t seed, const ScanBeams& beams,
    TraceCache& cache, bool timed = false, bool air = true, bool sights = false)
  {
    ScanSetup setup = this->Setup;
    settings.apply(setup.settings);
    setup.settings.seed = seed;
    if (!air)
    {
      setup.settings.attenuationCoefficient = 0.0;
      setup.media.clear();
    }
    planModel(setup);
    ScanResult result;
    const auto goOn = [this](double) { return this->Host.keepGoing(this->Done); };
    if (!simulateScan(
          setup, beams, timed ? 1 : this->Question.threads, cache, 0, goOn, result, sights))
    {
      throw WorkStopped{};
    }
    return result;
  }

  ScanResult scan(const AdviceSettings& settings, std::int32_t seed, const ScanBeams& beams)
  {
    TraceCache cache;
    return this->scan(settings, seed, beams, cache);
  }

  /// Draw the beams to measure on.
  void choose()
  {
    const std::size_t count = this->All.size();
    const double part = static_cast<double>(count) / std::max(1.0, this->Answer.beams);
    const auto wanted = static_cast<std::size_t>(std::ceil(this->Question.beams * part));
    this->Candidates = pick(count, CandidatesPerBeam * wanted, 1);
    const ScanBeams candidates = someOf(this->All, this->Candidates);
    TraceCache cache;
    const ScanResult seen =
      this->scan({}, this->Setup.settings.seed, candidates, cache, false, true, true);
    this->Done = 0.1;
    std::array<std::vector<std::size_t>, 4> kinds; // a mover, nothing, no echo, echo
    std::vector<char> moves(candidates.size(), 0);
    for (const MoverSight& sight : seen.sights)
    {
      moves[sight.beam] = moves[sight.beam] || sight.energy > 0.0;
    }
    this->Direct.fill(0.0);
    for (std::size_t c = 0; c < candidates.size(); ++c)
    {
      const BeamReport& report = seen.reports[c];
      const bool echo = report.status == BeamStatus::Echo || report.status == BeamStatus::Saturated;
      kinds[moves[c] ? 0 : report.status == BeamStatus::NoSurface ? 1 : echo ? 3 : 2].push_back(c);
      this->Direct[static_cast<std::size_t>(report.direct)] += 1.0;
    }
    this->draw(kinds, wanted);
    std::vector<std::size_t> timed;
    for (const std::size_t run : pick((count + RunLength - 1) / RunLength, TimedRuns, 2))
    {
      for (std::size_t b = run * RunLength; b < std::min(count, (run + 1) * RunLength); ++b)
      {
        timed.push_back(b);
      }
    }
    this->Timed = someOf(this->All, timed);
  }

  void draw(const std::array<std::vector<std::size_t>, 4>& kinds, std::size_t wanted)
  {
    std::array<std::size_t, 4> numbers{};
    std::size_t left = wanted;
    for (std::size_t k = 0; k < 4; ++k)
    {
      const std::size_t most = k == 3 ? left : wanted / (k == 1 ? 8 : 4);
      // One at least of each, also of a few beams: else its weight were lost.
      numbers[k] = std::min(kinds[k].size(), std::max(std::size_t{ 1 }, std::min(most, left)));
      left -= std::min(left, numbers[k]);
    }
    numbers[2] += std::min(left, kinds[2].size() - numbers[2]);
    std::vector<std::size_t> which;
    const double all = static_cast<double>(this->All.size());
    for (std::size_t k = 0; k < 4; ++k)
    {
      for (const std::size_t c : pick(kinds[k].size(), numbers[k], 3 + k))
      {
        which.push_back(this->Candidates[kinds[k][c]]);
        const double weight = static_cast<double>(kinds[k].size()) /
          static_cast<double>(numbers[k]) * all / static_cast<double>(this->Candidates.size());
        this->Weights.push_back(weight);
      }
    }
    this->Sample = someOf(this->All, which);
  }

  /// Scan the reference, and what it is held against.
  void refer()
  {
    const AdviceSettings finest{ BeamSampleSource::Cells, ReferenceRays, 2, 8 };
    const AdviceSettings plain{ BeamSampleSource::Rays, WitnessRays, 2, 2 };
    std::array<EchoesByBeam, 2> reference, witness;
    for (int i = 0; i < 2; ++i)
    {
      const ScanResult one = this->scan(finest, ReferenceSeeds[i], this->Sample);
      this->Done += 0.1;
      reference[i] = byBeam(one);
      witness[i] = byBeam(this->scan(plain, WitnessSeeds[i], this->Sample));
      this->Done += 0.1;
      if (i == 0)
      {
        this->addShares(one);
      }
    }
    this->Reference.resize(this->Sample.size());
    for (std::size_t b = 0; b < this->Sample.size(); ++b)
    {
      this->Reference.average(b, { reference[0][b], reference[1][b] });
    }
    this->refine();
    for (std::size_t b = 0; b < this->Sample.size(); ++b)
    {
      this->Reference.compare(b, witness);
    }
    this->addConnections(this->scan(
      { BeamSampleSource::Cells, ReferenceRays, 2, 0 }, ReferenceSeeds[0], this->Sample));
    TraceCache cache;
    this->addAir(this->scan(finest, ReferenceSeeds[0], this->Sample, cache, false, false));
    this->Done = 0.55;
  }

  void addShares(const ScanResult& result)
  {
    for (std::size_t e = 0; e < result.echoes.size(); ++e)
    {
      const Echo& echo = result.echoes[e];
      const double weight = this->Weights[result.beamOfEcho[e]];
      this->Energy += weight * echo.returnEnergy;
      this->Secondary += weight * echo.returnEnergy * echo.secondaryShare;
      this->LargestSecondary = std::max(this->LargestSecondary, echo.secondaryShare);
      this->Echoes += weight;
      this->OfAir += echo.objectId == ObjectOfAir ? weight : 0.0;
    }
  }

  void addConnections(const ScanResult& without)
  {
    this->Connected = this->Energy;
    for (std::size_t e = 0; e < without.echoes.size(); ++e)
    {
      this->Connected -= this->Weights[without.beamOfEcho[e]] * without.echoes[e].returnEnergy;
    }
  }

  void addAir(const ScanResult& without)
  {
    for (std::size_t e = 0; e < without.echoes.size(); ++e)
    {
      const double weight = this->Weights[without.beamOfEcho[e]];
      this->EchoesWithoutAir += weight;
      this->EnergyWithoutAir += weight * without.echoes[e].returnEnergy;
    }
  }

  /// More and finer scans of beams of which two differ by much: rare paths that carry much light.
  void refine()
  {
    std::vector<std::size_t> which;
    for (std::size_t b = 0; b < this->Sample.size(); ++b)
    {
      const CountedErrors& spread = this->Reference.spread()[b];
      if (spread.x[EnergyError] > std::pow(Coarse * this->Question.asked[EnergyError], 2) ||
        spread.x[RangeError] > std::pow(Coarse * this->Question.asked[RangeError], 2))
      {
        which.push_back(b);
      }
    }
    const AdviceSettings finer{ BeamSampleSource::Cells, 4 * ReferenceRays, 2, 8 };
    std::vector<EchoesByBeam> scans;
    for (int i = 0; i < FinerScans && !which.empty(); ++i)
    {
      const std::int32_t seed = ReferenceSeeds[0] + 100 + i;
      scans.push_back(byBeam(this->scan(finer, seed, someOf(this->Sample, which))));
    }
    for (std::size_t k = 0; k < which.size(); ++k)
    {
      EchoesByBeam of;
      for (const EchoesByBeam& scan : scans)
      {
        of.push_back(scan[k]);
      }
      this->Reference.average(which[k], of);
    }
  }

  bool judgeReference()
  {
    AdviceAnswer& a = this->Answer;
    a.own = this->Errors.ownErrors(this->Reference);
    a.measured = this->Host.sum(static_cast<double>(this->Sample.size()));
    a.echoes = this->Host.sum(static_cast<double>(this->Reference.numberOfEchoes()));
    const double energy = std::max(this->Host.sum(this->Energy), 1e-300);
    const double number = std::max(this->Host.sum(this->Echoes), 1e-300);
    a.secondary = this->Host.sum(this->Secondary) / energy;
    a.connected = this->Host.sum(this->Connected) / energy;
    a.lostInAir = this->Host.sum(this->EchoesWithoutAir) / number - 1.0;
    a.weakenedByAir = this->Host.sum(this->EnergyWithoutAir) / energy - 1.0;
    a.pointsOfAir = this->Host.sum(this->OfAir) / number;
    a.largestSecondary = this->Host.largest(this->LargestSecondary);
    double looked = 0.0;
    for (std::size_t k = 0; k < a.direct.size(); ++k)
    {
      a.direct[k] = this->Host.sum(this->Direct[k]);
      looked += a.direct[k];
    }
    for (double& share : a.direct)
    {
      share /= std::max(1.0, looked);
    }
    return true;
  }

  AdviceVerdict verdictOf(const std::array<MeasuredError, ErrorKinds>& errors) const
  {
    AdviceVerdict verdict = AdviceVerdict::Met;
    for (int error = 0; error < ErrorKinds; ++error)
    {
      const double asked = this->Question.asked[error];
      const AdviceVerdict one = errors[error].high <= asked ? AdviceVerdict::Met
        : errors[error].low > asked                         ? AdviceVerdict::NotMet
                                                            : AdviceVerdict::Undecided;
      verdict = std::min(verdict, one);
    }
    return verdict;
  }

  /// A turn: errors are those of the first, as times decide how many there are.
  void measure(const AdviceSettings& settings, int turn, Measuring& measuring)
  {
    TraceCache cache; // keeps patterns of rays, which a whole scan makes once
    const auto seed = static_cast<std::int32_t>(
      static_cast<std::uint32_t>(this->Setup.settings.seed) + static_cast<std::uint32_t>(turn + 1));
    if (turn == 0)
    {
      this->Reference.count(this->scan(settings, seed, this->Sample, cache), measuring.counted);
    }
    else
    {
      std::vector<std::size_t> few(std::min(this->Sample.size(), RunLength));
      std::iota(few.begin(), few.end(), std::size_t{ 0 });
      this->scan(settings, seed, someOf(this->Sample, few), cache);
    }
    measuring.seconds.push_back(this->timeOf(settings, seed, cache));
  }

  double timeOf(
    const AdviceSettings& settings, std::int32_t seed, TraceCache& cache, bool air = true)
  {
    const double before = threadSeconds();
    this->scan(settings, seed, this->Timed, cache, true, air);
    return threadSeconds() - before;
  }

  double secondsOf(const Measuring& measuring) const
  {
    std::vector<double> sorted = measuring.seconds;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t middle = sorted.size() / 2;
    const double median = sorted.empty() ? 0.0
      : sorted.size() % 2                ? sorted[middle]
                                         : 0.5 * (sorted[middle - 1] + sorted[middle]);
    return this->Host.sum(median) /
      std::max(1.0, this->Host.sum(static_cast<double>(this->Timed.size())));
  }

  std::vector<AdviceSettings> ladder() const
  {
    const EchoSettings& now = this->Setup.settings;
    std::vector<AdviceSettings> all = { { now.beamSamples, now.raysPerBeam, now.numberOfReflections,
      now.numberOfConnections, now.sampling } };
    for (const int rays : { 8, 25, 100, 400, 1600 })
    {
      all.push_back({ BeamSampleSource::Cells, rays, 1, 0 });
      all.push_back({ BeamSampleSource::Cells, rays, 2, 0 });
      all.push_back({ BeamSampleSource::Cells, rays, 2, 2 });
      if (rays >= 100)
      {
        all.push_back({ BeamSampleSource::Cells, rays, 2, 8 });
      }
    }
    for (const int rays : { 8, 25, 100, 400, 1600, 6400 })
    {
      all.push_back({ BeamSampleSource::Rays, rays, 1, 0 });
      all.push_back({ BeamSampleSource::Rays, rays, 2, 0 });
      all.push_back({ BeamSampleSource::Rays, rays, 2, 2 });
    }
    return all;
  }

  static bool isDefault(const AdviceSettings& s)
  {
    return s.samples == BeamSampleSource::Cells && s.rays == 100 && s.connections <= 2;
  }

  bool tryAll()
  {
    std::vector<AdviceTrial>& trials = this->Answer.trials;
    for (const AdviceSettings& settings : this->ladder())
    {
      trials.emplace_back().settings = settings;
    }
    std::vector<Measuring> measuring(trials.size());
    for (int turn = 0; turn < MostTurns; ++turn)
    {
      const double fastest = this->fastestOf(trials);
      for (std::size_t t = 0; t < trials.size(); ++t)
      {
        AdviceTrial& trial = trials[t];
        const bool wanted = turn == 0 || t == 0 || isDefault(trial.settings) ||
          (trial.verdict != AdviceVerdict::NotMet && trial.seconds < FarSlower * fastest);
        if (!wanted)
        {
          continue;
        }
        if (!this->Host.together([&] { this->measure(trial.settings, turn, measuring[t]); }))
        {
          return false;
        }
        this->Done = 0.55 + 0.4 * (turn > 0 ? 0.6 + 0.1 * turn : 0.6 * t / trials.size());
        ++trial.turns;
        trial.seconds = this->secondsOf(measuring[t]);
        if (turn == 0)
        {
          trial.errors = this->Errors.errorsOf(measuring[t].counted, this->Answer.own);
          trial.verdict = this->verdictOf(trial.errors);
        }
      }
    }
    return this->Host.together([this] { this->leaveOut(); });
  }

  double fastestOf(const std::vector<AdviceTrial>& trials) const
  {
    double fastest = std::numeric_limits<double>::infinity();
    for (const AdviceTrial& trial : trials)
    {
      if (trial.verdict == AdviceVerdict::Met)
      {
        fastest = std::min(fastest, trial.seconds);
      }
    }
    return fastest;
  }

  /// What is wrong without second reflections, and without connections, at the finest.
  void leaveOut()
  {
    for (int reflections : { 1, 2 })
    {
      this->Reference.count(this->scan({ BeamSampleSource::Cells, ReferenceRays, reflections, 0 },
                              ReferenceSeeds[0], this->Sample),
        this->Without[reflections - 1]);
    }
    if (!this->Setup.media.empty())
    {
      for (int turn = 0; turn < MostTurns; ++turn)
      {
        TraceCache with, without;
        this->TimesWithAir.seconds.push_back(this->timeOf({}, turn, with));
        this->TimesWithoutAir.seconds.push_back(this->timeOf({}, turn, without, false));
      }
    }
  }

  void lookAtScene()
  {
    const TriangleMesh& mesh = *this->Setup.tree->mesh;
    this->Done = 0.97;
    if (mesh.size() <= MostTimedTree)
    {
      const double before = threadSeconds();
      const auto goOn = [this](double) { return this->Host.keepGoing(this->Done); };
      if (!buildCollisionTree(this->Setup.tree->mesh, TreeOptions{}, goOn, 1))
      {
        throw WorkStopped{};
      }
      this->TreeSeconds = threadSeconds() - before;
    }
    this->Convex = mesh.size() > 0 && mesh.size() <= MostConvex && this->All.size() > 0 &&
      !(this->Setup.movers && !this->Setup.movers->empty()) &&
      isConvexBody(mesh, this->All.origins[0]);
  }

  bool conclude()
  {
    AdviceAnswer& a = this->Answer;
    a.withoutSecondary = this->Errors.errorsOf(this->Without[0], this->Answer.own);
    a.withoutConnections = this->Errors.errorsOf(this->Without[1], this->Answer.own);
    const auto timeOfDefault = [&](int reflections, int connections)
    {
      for (const AdviceTrial& trial : a.trials)
      {
        const AdviceSettings& s = trial.settings;
        if (isDefault(s) && s.reflections == reflections && s.connections == connections &&
          s.sampling == Sampling::Stratified)
        {
          return std::max(trial.seconds, 1e-12);
        }
      }
      return 1e-12;
    };
    a.secondaryCost = timeOfDefault(2, 2) / timeOfDefault(1, 0) - 1.0;
    a.connectionCost = timeOfDefault(2, 2) / timeOfDefault(2, 0) - 1.0;
    const double without = this->secondsOf(this->TimesWithoutAir);
    const double with = this->secondsOf(this->TimesWithAir);
    a.airCost = without > 0.0 ? with / without - 1.0 : 0.0;
    a.convex = this->Host.sum(this->Convex) > 0.0;
    a.treeSeconds = this->Host.sum(this->TreeSeconds) / std::max(1.0, this->Host.sum(1.0));
    a.reflectsTwice = !(a.secondary < 1e-6 && a.withoutSecondary[EnergyError].value < 1e-4 &&
      a.withoutSecondary[EchoError].value <= 0.0);
    this->pickOne();
    a.scanSeconds = a.beams * (a.advised < 0 ? timeOfDefault(2, 2) : a.trials[a.advised].seconds);
    return true;
  }

  /// The fastest that meets all, with second reflections only if there are any; of those that are
  /// as fast the most accurate.
  void pickOne()
  {
    AdviceAnswer& a = this->Answer;
    const auto fits = [&a](const AdviceTrial& trial)
    {
      return trial.verdict == AdviceVerdict::Met &&
        (a.reflectsTwice || trial.settings.reflections == 1);
    };
    double fastest = std::numeric_limits<double>::infinity();
    for (const AdviceTrial& trial : a.trials)
    {
      fastest = fits(trial) ? std::min(fastest, trial.seconds) : fastest;
    }
    const auto part = [this](const AdviceTrial& trial)
    {
      double largest = 0.0;
      for (int error = 0; error < ErrorKinds; ++error)
      {
        largest = std::max(
          largest, trial.errors[error].high / std::max(this->Question.asked[error], 1e-300));
      }
      return largest;
    };
    for (std::size_t t = 0; t < a.trials.size() && a.echoes > 0.0; ++t)
    {
      const AdviceTrial& trial = a.trials[t];
      if (a.best < 0 || part(trial) < part(a.trials[a.best]))
      {
        a.best = static_cast<int>(t);
      }
      if (fits(trial) && trial.seconds <= AsFast * fastest &&
        (a.advised < 0 || part(trial) < part(a.trials[a.advised])))
      {
        a.advised = static_cast<int>(t);
      }
    }
  }

  ScanSetup Setup;
  const ScanBeams& All;
  const AdviceQuestion& Question;
  const AdviceHost& Host;
  AdviceAnswer& Answer;
  EchoReference Reference;
  SampledErrors Errors;
  double Done = 0.0; ///< of the work
  std::vector<std::size_t> Candidates;
  ScanBeams Sample;            ///< of which errors are measured
  std::vector<double> Weights; ///< beams of the scan for each of them
  ScanBeams Timed;
  std::array<double, 5> Direct{};
  std::array<std::vector<CountedErrors>, 2> Without; ///< second reflections, connections
  Measuring TimesWithAir, TimesWithoutAir;
  double Energy = 0.0, Secondary = 0.0, Connected = 0.0, Echoes = 0.0, OfAir = 0.0;
  double LargestSecondary = 0.0, EchoesWithoutAir = 0.0, EnergyWithoutAir = 0.0;
  double TreeSeconds = 0.0;
  bool Convex = false;
};
}

void AdviceSettings::apply(EchoSettings& settings) const
{
  settings.beamSamples = this->samples;
  settings.raysPerBeam = this->rays;
  settings.numberOfReflections = this->reflections;
  settings.numberOfConnections = this->connections;
  settings.sampling = this->sampling;
}

bool advise(const ScanSetup& setup, const ScanBeams& beams, const AdviceQuestion& question,
  const AdviceHost& host, AdviceAnswer& answer)
{
  return Advisor(setup, beams, question, host, answer).go();
}
}
