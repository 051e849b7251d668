// SPDX-License-Identifier: BSD-3-Clause
#include "BeamEchoes.h"

#include "LaneMath.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
AVIANLIDAR_MULTIVERSION void anglesOfAll(double* cosines, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    cosines[i] = lanes::acos(cosines[i]);
  }
}
}

/// True if everything that the beam meets has one object and one material.
bool EchoLabels::meetsOneThing(
  const BeamSamples& samples, const std::vector<SecondaryPath>& paths) const
{
  if (samples.surfaces.empty())
  {
    return false;
  }
  const std::uint32_t first = samples.surfaces[0].triangle;
  const int object = this->Setup.objectId(first);
  const int material = this->Setup.materialId(first);
  const auto isFirst = [&](const auto& met)
  {
    return this->Setup.objectId(met.triangle) == object &&
      this->Setup.materialId(met.triangle) == material;
  };
  return std::all_of(samples.surfaces.begin(), samples.surfaces.end(), isFirst) &&
    std::all_of(paths.begin(), paths.end(), isFirst);
}

void EchoLabels::findAngles(
  const RangeShares& shares, const BeamSamples& samples, const std::vector<SecondaryPath>& paths)
{
  const std::size_t direct = samples.size();
  this->Angles.resize(shares.count);
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::uint32_t c = shares.contribution[s];
    const double cosine = c < direct ? samples.cosine[c] : paths[c - direct].cosIncidence;
    this->Angles[s] = std::min(1.0, cosine);
  }
  anglesOfAll(this->Angles.data(), this->Angles.size());
}

/// Sum the energies by object and material.
void EchoLabels::findLargest(
  const RangeShares& shares, const BeamSamples& samples, const std::vector<SecondaryPath>& paths)
{
  const std::size_t direct = samples.size();
  this->Sums.clear();
  // Neighbouring paths mostly meet the same surface: their energies are summed before they are
  // added to the list.
  std::uint32_t triangle = NoTriangle;
  int object = 0;
  int material = 0;
  double run = 0.0;
  const auto book = [&](std::uint32_t met, double energy)
  {
    if (met != triangle)
    {
      triangle = met;
      const int itsObject = this->Setup.objectId(met);
      const int itsMaterial = this->Setup.materialId(met);
      if (itsObject != object || itsMaterial != material)
      {
        if (run > 0.0)
        {
          this->Sums.add(object, material, run);
        }
        run = 0.0;
        object = itsObject;
        material = itsMaterial;
      }
    }
    run += energy;
  };
  auto surface = samples.surfaces.begin();
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t c = shares.contribution[s];
    while (c < direct && c >= surface->end)
    {
      ++surface;
    }
    book(c < direct ? surface->triangle : paths[c - direct].triangle, shares.energies[s]);
  }
  this->Sums.add(object, material, run);
}

void EchoLabels::label(const RangeShares& shares, const BeamSamples* samples,
  const std::vector<SecondaryPath>& paths, Echo& echo)
{
  echo.incidenceAngle = std::numeric_limits<double>::quiet_NaN();
  if (!samples)
  {
    return;
  }
  this->findAngles(shares, *samples, paths);
  const WeightedSum sum = sumShares(shares, [&](std::size_t s) { return this->Angles[s]; });
  if (!(sum.energy > 0.0))
  {
    return; // a false alarm
  }
  if (this->meetsOneThing(*samples, paths))
  {
    echo.objectId = this->Setup.objectId(samples->surfaces[0].triangle);
    echo.materialId = this->Setup.materialId(samples->surfaces[0].triangle);
    echo.labelShare = 1.0;
  }
  else
  {
    this->findLargest(shares, *samples, paths);
    const LabelSums::Sum& largest = this->Sums.largest();
    echo.objectId = largest.object;
    echo.materialId = largest.material;
    echo.labelShare = largest.energy / this->Sums.total();
  }
  echo.incidenceAngle = sum.moment / sum.energy;
  const WeightedSum ofPaths = sumShares(
    shares, [&](std::size_t s) { return shares.contribution[s] < samples->size() ? 0.0 : 1.0; });
  echo.secondaryShare = ofPaths.moment / sum.energy;
}

BeamEchoes::BeamEchoes(const ScanSetup& setup, BeamLighting& lighting, BeamReceiver& receiver,
  StandardErrorEstimator& ofRays)
  : Setup(setup)
  , Lighting(lighting)
  , Receiver(receiver)
  , Labels(setup)
  , Errors(setup, lighting, ofRays)
{
}

void BeamEchoes::receive(
  std::uint64_t beam, LitBeam* keep, std::vector<Echo>& echoes, BeamReport& report)
{
  this->Receiver.receive(beam, this->Lighting.units().units(), this->Lighting.radiance());
  const auto echoOf = [&](const Return& ret)
  {
    LitBeam::KnownReturn known = this->unitsOf(ret);
    known.echo = this->echoOfLight(ret);
    if (keep && keep->returns.size() < LitBeam::MostReturns && !this->find(*keep, ret))
    {
      keep->returns.push_back(known);
    }
    return known.echo;
  };
  this->finish(
    echoOf, this->Lighting.isOutsideGate(), this->Lighting.samples() != nullptr, echoes, report);
}

bool BeamEchoes::receiveAgain(
  std::uint64_t beam, const LitBeam& known, std::vector<Echo>& echoes, BeamReport& report)
{
  BeamAir& air = this->Lighting.air();
  air.beginOutside();
  air.take(known.surfaces);
  this->Receiver.receive(beam, known.units, known.radiance);
  const auto isKnown = [&](const Return& ret) { return !ret.hasLight || this->find(known, ret); };
  const std::vector<Return>& returns = this->Receiver.returns();
  const Return* strongest = this->Receiver.strongest();
  if (!std::all_of(returns.begin(), returns.end(), isKnown) || (strongest && !isKnown(*strongest)))
  {
    return false;
  }
  this->finish([&](const Return& ret) { return this->find(known, ret)->echo; }, known.outsideGate,
    true, echoes, report);
  report.lost = known.lost;
  report.skipped = known.skipped;
  return true;
}

/// Make echoes of the returns. @param echoOf gives the part of an echo that follows from light
/// @param outsideGate see BeamLighting::isOutsideGate(). The value follows from direct echoes
/// alone, as the cache may change which paths with two reflections are traced. @param meets true if
/// the beam meets a surface
template <class F>
void BeamEchoes::finish(
  F echoOf, bool outsideGate, bool meets, std::vector<Echo>& echoes, BeamReport& report)
{
  const auto make = [&](const Return& ret)
  {
    Echo echo;
    echo.incidenceAngle = std::numeric_limits<double>::quiet_NaN();
    echo.range = ret.range;
    if (ret.hasLight)
    {
      echo = echoOf(ret);
    }
    if (ret.leaves > 0.0)
    {
      this->addLeaves(ret, echo);
    }
    if (!ret.hasLight && ret.air > std::max(0.5 * ret.returnEnergy, ret.leaves))
    {
      echo.objectId = ObjectOfAir;
      echo.labelShare = std::min(1.0, ret.air / ret.returnEnergy);
    }
    echo.range = this->Receiver.measured(ret, echo.range);
    echo.background = this->Receiver.radiance();
    echo.energyReceived = ret.energyReceived;
    echo.energy = ret.energy;
    echo.returnEnergy = ret.returnEnergy;
    echo.returnNumber = ret.returnNumber;
    echo.numberOfReturns = ret.numberOfReturns;
    return echo;
  };
  for (const Return& ret : this->Receiver.returns())
  {
    echoes.push_back(make(ret));
  }
  // The return mode selects what is shown, not what is received.
  const Return* const strongest = this->Receiver.strongest();
  if (!strongest)
  {
    report.status = !meets ? BeamStatus::NoSurface
      : outsideGate        ? BeamStatus::OutsideGate
                           : BeamStatus::BelowLimit;
    return;
  }
  const auto same = std::find_if(echoes.end() - this->Receiver.returns().size(), echoes.end(),
    [&](const Echo& echo) { return echo.returnNumber == strongest->returnNumber; });
  report.range = same != echoes.end() ? same->range : make(*strongest).range;
  report.status = strongest->energyReceived >= this->Setup.sensor.upperEnergyLimit
    ? BeamStatus::Saturated
    : BeamStatus::Echo;
}

/// Include the light of leaves in the range and the label of an echo.
void BeamEchoes::addLeaves(const Return& ret, Echo& echo) const
{
  const double share = std::clamp(ret.leaves / ret.returnEnergy, 0.0, 1.0);
  if (ret.hasLight)
  {
    echo.range += share * (ret.rangeOfLeaves - echo.range);
    echo.labelShare *= 1.0 - share;
  }
  if (share > (ret.hasLight ? echo.labelShare : 0.5))
  {
    echo.objectId = ret.medium;
    echo.materialId = -1;
    echo.labelShare = share;
  }
}

/// The known values of a return; null if there are no known values.
const LitBeam::KnownReturn* BeamEchoes::find(const LitBeam& known, const Return& ret) const
{
  const LitBeam::KnownReturn wanted = this->unitsOf(ret);
  const auto found = std::find_if(known.returns.begin(), known.returns.end(),
    [&](const LitBeam::KnownReturn& one)
    {
      return one.first == wanted.first && one.last == wanted.last &&
        one.strongest == wanted.strongest;
    });
  return found == known.returns.end() ? nullptr : &*found;
}

LitBeam::KnownReturn BeamEchoes::unitsOf(const Return& ret) const
{
  const auto& units = this->Receiver.units();
  return { units[ret.firstUnit].index, units[ret.lastUnit - 1].index,
    units[ret.strongestUnit].index, {} };
}

/// The part of an echo that follows from light alone.
Echo BeamEchoes::echoOfLight(const Return& ret)
{
  const auto& units = this->Receiver.units();
  Echo echo;
  echo.range = this->Receiver.rangeOf(ret, this->Lighting.units());
  this->Labels.label(
    this->Lighting.units().sharesOf(units[ret.firstUnit].index, units[ret.lastUnit - 1].index + 1),
    this->Lighting.samples(), this->Lighting.paths(), echo);
  const ReceivedUnit& strongest = units[ret.strongestUnit];
  echo.energyStdError = this->Errors.of(
    this->Lighting.units().sharesOf(strongest.index, strongest.index + 1), strongest.paths);
  return echo;
}
}
