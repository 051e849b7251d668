// SPDX-License-Identifier: BSD-3-Clause
#include "Windows.h"

#include "FinishSetup.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace accuracy
{
using namespace avianlidar;

namespace
{
/// Far below what is asked for, so that nothing of it is lost to the light-energy constraint.
constexpr double LimitOfReference = 1e-3; // Qlow

/// The strongest unit of each run of units.
std::vector<Window> strongestUnits(const std::vector<UnitEcho>& echoes)
{
  std::vector<Window> windows;
  std::vector<double> energies;
  for (std::size_t i = 0; i < echoes.size(); ++i)
  {
    const UnitEcho& now = echoes[i];
    const double energy = now.echo.energyReceived;
    const bool goesOn =
      i > 0 && echoes[i - 1].beam == now.beam && echoes[i - 1].unit + 1 == now.unit;
    if (!goesOn)
    {
      windows.emplace_back();
      energies.push_back(0.0);
    }
    if (energy > energies.back())
    {
      energies.back() = energy;
      windows.back().beam = now.beam;
      windows.back().unit = now.unit;
    }
  }
  return windows;
}

/// Share of the beam's energy whose pulse, tau_e wide and centred, reaches into the unit.
double coveredShare(const BeamSamples& samples, const Sensor& sensor, std::int64_t unit)
{
  const double half = 0.5 * sensor.pulseWidth / sensor.samplingInterval;
  const auto inside = [&](double range)
  {
    const double at = range / sensor.rangeUnitLength();
    return at + half > static_cast<double>(unit) && at - half < static_cast<double>(unit + 1);
  };
  double covered = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    covered += inside(samples.range[i]) ? samples.weight[i] : 0.0;
  }
  return covered;
}
}

std::vector<UnitEcho> unitEchoes(ScanSetup setup, const ScanBeams& beams, EchoSettings settings,
  double limit, TraceCache& cache, int threads)
{
  settings.returnMode = ReturnMode::RangeUnits;
  settings.noise = false;
  setup.settings = settings;
  setup.sensor.lowerEnergyLimit = limit;
  setup.sensor.upperEnergyLimit = std::max(limit, setup.sensor.upperEnergyLimit);
  finishSetup(setup);
  ScanResult result;
  simulateScan(setup, beams, threads, cache, std::size_t(2) << 30, {}, result);
  std::vector<UnitEcho> echoes;
  echoes.reserve(result.echoes.size());
  for (std::size_t i = 0; i < result.echoes.size(); ++i)
  {
    const Echo& echo = result.echoes[i];
    echoes.push_back({ result.beamOfEcho[i],
      static_cast<std::int64_t>(std::floor(echo.range / setup.sensor.rangeUnitLength())), echo });
  }
  return echoes;
}

ScanBeams beamsOf(const ScanBeams& beams, const std::vector<std::size_t>& chosen)
{
  ScanBeams some;
  for (const std::size_t beam : chosen)
  {
    some.ids.push_back(beams.ids[beam]);
    some.origins.push_back(beams.origins[beam]);
    some.directions.push_back(beams.directions[beam]);
  }
  return some;
}

std::vector<std::size_t> beamsOf(const std::vector<Window>& windows)
{
  std::vector<std::size_t> beams;
  for (const Window& window : windows)
  {
    if (beams.empty() || beams.back() != window.beam)
    {
      beams.push_back(window.beam);
    }
  }
  return beams;
}

std::vector<Window> findWindows(const AccuracyScene& scene, const EchoSettings& settings, int rays)
{
  const Sensor& sensor = scene.setup.sensor;
  TraceCache first;
  std::vector<Window> windows =
    strongestUnits(unitEchoes(scene.setup, scene.beams, settings, sensor.lowerEnergyLimit, first));
  EchoSettings many = settings;
  many.seed = settings.seed + 1;
  many.raysPerBeam = rays;
  many.sampling = Sampling::Stratified;
  // As many beams at a time as their hits take 300 MB.
  const std::size_t atOnce = std::max<std::size_t>(1, 3000000 / static_cast<std::size_t>(rays));
  const std::vector<std::size_t> beams = beamsOf(windows);
  std::size_t w = 0;
  for (std::size_t begin = 0; begin < beams.size(); begin += atOnce)
  {
    const std::vector<std::size_t> chosen(
      beams.begin() + begin, beams.begin() + std::min(beams.size(), begin + atOnce));
    TraceCache cache;
    std::map<std::pair<std::size_t, std::int64_t>, Echo> truth;
    for (const UnitEcho& echo : unitEchoes(scene.setup, beamsOf(scene.beams, chosen), many,
           LimitOfReference * sensor.lowerEnergyLimit, cache))
    {
      truth[{ chosen[echo.beam], echo.unit }] = echo.echo;
    }
    for (std::size_t k = 0; k < chosen.size(); ++k)
    {
      for (; w < windows.size() && windows[w].beam == chosen[k]; ++w)
      {
        Window& window = windows[w];
        const auto found = truth.find({ window.beam, window.unit });
        if (found != truth.end())
        {
          window.truth = found->second.energyReceived;
          window.truthError = found->second.energyStdError;
          window.secondary = found->second.secondaryShare;
          window.covered = coveredShare(*cache.beams[k].hits, sensor, window.unit);
        }
      }
    }
  }
  const double least = LeastTruth * sensor.lowerEnergyLimit;
  windows.erase(std::remove_if(windows.begin(), windows.end(),
                  [least](const Window& window) { return window.truth < least; }),
    windows.end());
  return windows;
}
}
