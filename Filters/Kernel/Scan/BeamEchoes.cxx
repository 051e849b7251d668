// SPDX-License-Identifier: BSD-3-Clause
#include "BeamEchoes.h"

#include "LaneMath.h"
#include "LaneSums.h"

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
  const int* const objects = this->Setup.objectIds.data();
  const int* const materials = this->Setup.materialIds.data();
  if (samples.surfaces.empty())
  {
    return false;
  }
  const std::uint32_t first = samples.surfaces[0].triangle;
  const auto isFirst = [=](const auto& met) {
    return objects[met.triangle] == objects[first] && materials[met.triangle] == materials[first];
  };
  return std::all_of(samples.surfaces.begin(), samples.surfaces.end(), isFirst) &&
    std::all_of(paths.begin(), paths.end(), isFirst);
}

/// Set the angles, at least of the contributions that have shares.
void EchoLabels::findAngles(
  const RangeShares& shares, const BeamSamples& samples, const std::vector<SecondaryPath>& paths)
{
  const std::size_t direct = samples.size();
  this->Angles.resize(direct + paths.size());
  if (shares.which)
  {
    for (std::size_t s = 0; s < shares.count; ++s)
    {
      const std::uint32_t c = shares.which[s];
      const double cosine = c < direct ? samples.cosine[c] : paths[c - direct].cosIncidence;
      this->Angles[c] = lanes::acos(std::min(1.0, cosine));
    }
    return;
  }
  std::copy(samples.cosine.begin(), samples.cosine.end(), this->Angles.begin());
  for (std::size_t p = 0; p < paths.size(); ++p)
  {
    this->Angles[direct + p] = std::min(1.0, paths[p].cosIncidence);
  }
  anglesOfAll(this->Angles.data(), this->Angles.size());
}

/// Sum the energies by object and material.
void EchoLabels::findLargest(
  const RangeShares& shares, const BeamSamples& samples, const std::vector<SecondaryPath>& paths)
{
  const std::size_t direct = samples.size();
  const int* const objects = this->Setup.objectIds.data();
  const int* const materials = this->Setup.materialIds.data();
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
      if (objects[met] != object || materials[met] != material)
      {
        if (run > 0.0)
        {
          this->Sums.add(object, material, run);
        }
        run = 0.0;
        object = objects[met];
        material = materials[met];
      }
    }
    run += energy;
  };
  auto surface = samples.surfaces.begin();
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t c = shares.contribution(s);
    while (c < direct && c >= surface->end)
    {
      ++surface;
    }
    if (shares.energies[s] > 0.0)
    {
      book(c < direct ? surface->triangle : paths[c - direct].triangle, shares.energies[s]);
    }
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
  const WeightedSum sum = sumShares(shares, this->Angles.data(), 0.0);
  if (!(sum.energy > 0.0))
  {
    return; // a false alarm
  }
  if (this->meetsOneThing(*samples, paths))
  {
    echo.objectId = this->Setup.objectIds[samples->surfaces[0].triangle];
    echo.materialId = this->Setup.materialIds[samples->surfaces[0].triangle];
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
  echo.secondaryShare = paths.empty() ? 0.0 : sumSharesFrom(shares, samples->size()) / sum.energy;
}

BeamEchoes::BeamEchoes(const ScanSetup& setup, BeamLighting& lighting, BeamReceiver& receiver)
  : Setup(setup)
  , Lighting(lighting)
  , Receiver(receiver)
  , Labels(setup)
{
}

void BeamEchoes::receive(std::uint64_t beam, LitBeam* known, const std::function<void()>& light,
  std::vector<Echo>& echoes, BeamReport& report)
{
  this->Receiver.receive(beam, known ? known->units : this->Lighting.units().units());
  for (const Return& ret : this->Receiver.returns())
  {
    echoes.push_back(this->makeEcho(ret, known, light));
  }
  if (const Return* strongest = this->Receiver.strongest())
  {
    const auto same = std::find_if(echoes.end() - this->Receiver.returns().size(), echoes.end(),
      [&](const Echo& echo) { return echo.returnNumber == strongest->returnNumber; });
    report.range =
      same != echoes.end() ? same->range : this->makeEcho(*strongest, known, light).range;
  }
  report.status = this->statusOf(known);
}

Echo BeamEchoes::makeEcho(const Return& ret, LitBeam* known, const std::function<void()>& light)
{
  const auto& units = this->Receiver.units();
  const std::int64_t first = units[ret.firstUnit].index;
  const std::int64_t last = units[ret.lastUnit - 1].index;
  const std::int64_t strongest = units[ret.strongestUnit].index;
  Echo echo;
  echo.incidenceAngle = std::numeric_limits<double>::quiet_NaN();
  echo.range = ret.range;
  if (ret.hasLight)
  {
    const LitBeam::KnownReturn* same = nullptr;
    for (std::size_t r = 0; known && r < known->returns.size() && !same; ++r)
    {
      const LitBeam::KnownReturn& one = known->returns[r];
      same = one.first == first && one.last == last && one.strongest == strongest ? &one : nullptr;
    }
    if (!same)
    {
      light();
    }
    echo = same ? same->echo : this->echoOfLight(ret);
    if (known && !same && known->returns.size() < LitBeam::MostReturns)
    {
      known->returns.push_back({ first, last, strongest, echo });
    }
  }
  echo.energyReceived = ret.energyReceived;
  echo.energy = ret.energy;
  echo.returnEnergy = ret.returnEnergy;
  echo.returnNumber = ret.returnNumber;
  echo.numberOfReturns = ret.numberOfReturns;
  return echo;
}

/// What follows from light alone.
Echo BeamEchoes::echoOfLight(const Return& ret)
{
  const auto& units = this->Receiver.units();
  Echo echo;
  echo.range = this->Receiver.rangeOf(ret, this->Lighting.units());
  this->Labels.label(
    this->Lighting.units().sharesOf(units[ret.firstUnit].index, units[ret.lastUnit - 1].index + 1),
    this->Lighting.samples(), this->Lighting.paths(), echo);
  const ReceivedUnit& strongest = units[ret.strongestUnit];
  echo.energyStdError = this->Lighting.errorOf(strongest.index, strongest.paths);
  return echo;
}

/// Direct echoes alone decide what lies outside the gate: whether paths over two reflections are
/// traced depends on what is kept of the beam.
BeamStatus BeamEchoes::statusOf(const LitBeam* known) const
{
  // Before the return mode chooses: it selects what is shown, not what was received.
  if (const Return* strongest = this->Receiver.strongest())
  {
    return strongest->energyReceived >= this->Setup.sensor.upperEnergyLimit ? BeamStatus::Saturated
                                                                            : BeamStatus::Echo;
  }
  if (!known && !this->Lighting.samples())
  {
    return BeamStatus::NoSurface;
  }
  return (known ? known->beyondGate : this->Lighting.isBeyondGate()) ? BeamStatus::OutsideGate
                                                                     : BeamStatus::BelowLimit;
}
}
