// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarAdviceNotes.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

namespace
{
using avianlidar::AdviceAnswer;
using avianlidar::AdviceQuestion;
using avianlidar::AdviceSettings;
using avianlidar::AdviceTrial;
using avianlidar::AdviceVerdict;
using avianlidar::BeamSampleSource;
using avianlidar::DirectEcho;
using avianlidar::EchoError;
using avianlidar::EnergyError;
using avianlidar::ErrorKinds;
using avianlidar::MeasuredError;
using avianlidar::RangeError;

/// A few digits, whatever the locale of the process; what is too little to matter is 0.
std::string Digits(double value, int digits = 2)
{
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(digits) << (std::fabs(value) < 1e-9 ? 0.0 : value);
  return text.str();
}

std::string Whole(double value)
{
  return std::to_string(static_cast<long long>(std::llround(value)));
}

std::string PerCent(double share)
{
  return Digits(100.0 * share, share < 0.995 ? 2 : 3) + " %";
}

std::string Cost(double share)
{
  const double percent = std::round(100.0 * share);
  return Digits(std::fabs(percent), 3) + " % " + (percent < 0.0 ? "less" : "more") + " time";
}

std::string Errors(const std::array<double, ErrorKinds>& e)
{
  return "energy " + PerCent(e[EnergyError]) + " rms, range " + Digits(e[RangeError], 3) +
    " m rms, echoes missed or invented " + PerCent(e[EchoError]);
}

std::string Errors(const std::array<MeasuredError, ErrorKinds>& e)
{
  const std::string none = "not told: fewer than 30 beams have an echo of twice the limit";
  return "energy " + PerCent(e[EnergyError].value) + " (" +
    (std::isinf(e[EnergyError].high) ? none : "at most " + PerCent(e[EnergyError].high)) +
    "), range " + Digits(e[RangeError].value, 3) + " m (" +
    (std::isinf(e[RangeError].high) ? none : Digits(e[RangeError].high, 3)) +
    "), echoes missed or invented " + PerCent(e[EchoError].value) + " (" +
    PerCent(e[EchoError].high) + ")";
}

const char* Samples(const AdviceSettings& settings)
{
  return settings.samples == BeamSampleSource::Cells ? "Cells" : "Rays";
}

std::string Times(const AdviceTrial& trial, const AdviceAnswer& answer)
{
  return Digits(1e6 * trial.seconds, 3) + " us a beam of one core, " +
    Digits(trial.seconds * answer.beams, 3) + " s the scan";
}

std::string Advised(const AdviceAnswer& answer)
{
  const auto missing =
    static_cast<std::size_t>(std::count_if(answer.trials.begin(), answer.trials.end(),
      [](const AdviceTrial& trial) { return trial.verdict == AdviceVerdict::Undecided; }));
  if (answer.advised < 0)
  {
    const AdviceTrial& best = answer.trials[answer.best];
    return "Advised: none of " + std::to_string(answer.trials.size()) +
      " settings surely meets what is asked; the best, " +
      vtkAvianLidarAdviceNotes::InWords(best.settings) + ", has " + Errors(best.errors) +
      (missing > 0 ? "; of " + std::to_string(missing) +
            " these beams cannot tell: measure more beams, or ask for less"
                   : "");
  }
  const AdviceTrial& trial = answer.trials[answer.advised];
  const double now = answer.trials[0].seconds / std::max(trial.seconds, 1e-12);
  return "Advised: " + vtkAvianLidarAdviceNotes::InWords(trial.settings) + ": " +
    Errors(trial.errors) + "; " + Times(trial, answer) + ", " + Digits(now, 3) +
    " times as fast as the settings now";
}

std::string SecondReflections(const AdviceAnswer& a)
{
  if (!a.reflectsTwice)
  {
    return std::string("One reflection is enough: second reflections carry ") +
      (a.secondary > 0.0 ? "less than 1e-6" : "0") + " of the light (measured over " +
      Whole(a.measured) + " beams)" +
      (a.convex ? ": the scene is one convex body, seen from outside, and a convex body cannot "
                  "light itself"
                : "") +
      "; two take " + Cost(a.secondaryCost);
  }
  const bool one = a.advised >= 0 && a.trials[a.advised].settings.reflections == 1;
  return (one ? "One reflection is enough for what is asked: second reflections carry "
              : "Second reflections carry ") +
    PerCent(a.secondary) + " of the light, up to " + PerCent(a.largestSecondary) +
    " of an echo; without them energy errs by " + PerCent(a.withoutSecondary[EnergyError].value) +
    " rms, and " + PerCent(a.withoutSecondary[EchoError].value) +
    " of the echoes are wrong; they take " + Cost(a.secondaryCost);
}

std::string Connections(const AdviceAnswer& a)
{
  return "Connections carry " + PerCent(std::max(0.0, a.connected)) +
    " of the light; without them energy errs by " +
    PerCent(a.withoutConnections[EnergyError].value) + " rms; two take " + Cost(a.connectionCost);
}

/// The fewest rays of a kind that meet what is asked.
std::string Fewest(const AdviceAnswer& a, BeamSampleSource source, const char* name)
{
  const AdviceTrial* fewest = nullptr;
  for (const AdviceTrial& trial : a.trials)
  {
    if (trial.settings.samples == source && trial.verdict == AdviceVerdict::Met &&
      (!fewest || trial.settings.rays < fewest->settings.rays ||
        (trial.settings.rays == fewest->settings.rays && trial.seconds < fewest->seconds)))
    {
      fewest = &trial;
    }
  }
  return fewest ? std::string(name) + " need " + std::to_string(fewest->settings.rays) + " (" +
      Digits(1e6 * fewest->seconds, 3) + " us a beam)"
                : std::string("no number of ") + name + " that was tried is enough";
}

std::string Density(const AdviceAnswer& a)
{
  const auto share = [&a](DirectEcho how)
  { return PerCent(a.direct[static_cast<std::size_t>(how)]); };
  return "Density of rays: of the beams " + share(DirectEcho::Polygons) +
    " are integrated over polygons, " + share(DirectEcho::Cells) + " need cells, " +
    share(DirectEcho::Nothing) + " meet nothing; " + Fewest(a, BeamSampleSource::Cells, "cells") +
    ", " + Fewest(a, BeamSampleSource::Rays, "plain rays");
}

std::string Weather(const avianlidar::ScanSetup& setup, const AdviceAnswer& a)
{
  if (!(setup.settings.attenuationCoefficient > 0.0) && setup.media.empty())
  {
    return "Weather: none";
  }
  const bool scatters = !setup.media.empty();
  const double lost = std::max(0.0, 1.0 - 1.0 / (1.0 + a.lostInAir));
  return "Weather: the air takes " + PerCent(std::max(0.0, 1.0 - 1.0 / (1.0 + a.weakenedByAir))) +
    " of the light and " + PerCent(lost) + " of the echoes; " +
    (scatters ? PerCent(a.pointsOfAir) + " of the points are of the air itself; it takes " +
          Cost(a.airCost)
              : "it sends no light back and costs no time");
}

std::string Processes(const AdviceAnswer& a)
{
  if (!(a.treeSeconds > 0.0))
  {
    return "Processes: not measured, as the scene is large; the tree is the same for all, the "
           "beams are divided";
  }
  const auto gain = [&a](double n)
  { return Digits((a.treeSeconds + a.scanSeconds) / (a.treeSeconds + a.scanSeconds / n), 2); };
  return "Processes: the collision tree (" + Digits(a.treeSeconds, 2) +
    " s of one core) is the same for all, the scan (" + Digits(a.scanSeconds, 2) +
    " s) is divided: 2 gain at most a factor of " + gain(2.0) + ", 8 of " + gain(8.0) +
    "; later scans keep the tree";
}
}

namespace vtkAvianLidarAdviceNotes
{
std::string InWords(const AdviceSettings& s)
{
  const bool strata = s.sampling == avianlidar::Sampling::Stratified;
  return std::to_string(s.rays) + " rays a beam by " + Samples(s) +
    (strata ? "" : " (MonteCarlo)") +
    (s.reflections < 2 ? ", one reflection"
                       : ", two reflections, " +
          (s.connections > 0 ? std::to_string(s.connections) : "no") + " connections");
}

std::vector<std::string> Lines(
  const avianlidar::ScanSetup& setup, const AdviceQuestion& question, const AdviceAnswer& answer)
{
  std::vector<std::string> lines = { "Asked: " + Errors(question.asked) + "; measured on " +
    Whole(answer.measured) + " of " + Whole(answer.beams) + " beams with " + Whole(answer.echoes) +
    " echoes" };
  if (!(answer.echoes > 0.0))
  {
    lines.emplace_back("Advised: nothing, as none of these beams has an echo");
    return lines;
  }
  lines.push_back(Advised(answer));
  lines.push_back(SecondReflections(answer));
  lines.push_back(Connections(answer));
  lines.push_back(Density(answer));
  lines.push_back(Weather(setup, answer));
  lines.push_back(Processes(answer));
  lines.push_back("The reference's own error: " + Errors(answer.own));
  if (answer.advised >= 0)
  {
    const AdviceSettings& s = answer.trials[answer.advised].settings;
    const bool strata = s.sampling == avianlidar::Sampling::Stratified;
    const std::string sampling = strata ? "Stratified" : "MonteCarlo";
    const std::string rays = std::to_string(s.rays), reflections = std::to_string(s.reflections),
                      connections = std::to_string(s.connections);
    lines.push_back("Command: --scan-set preset=Custom --scan-set beam_samples=" +
      std::string(Samples(s)) + " --scan-set rays_per_beam=" + rays +
      " --scan-set sampling=" + sampling + " --scan-set number_of_reflections=" + reflections +
      " --scan-set number_of_connections=" + connections);
    lines.push_back("Python: scan.set(preset=\"Custom\", beam_samples=\"" +
      std::string(Samples(s)) + "\", rays_per_beam=" + rays + ", sampling=\"" + sampling +
      "\", number_of_reflections=" + reflections + ", number_of_connections=" + connections + ")");
    lines.push_back("ParaView: Preset Custom, Beam Samples " + std::string(Samples(s)) +
      ", Rays Per Beam " + rays + ", Sampling " + sampling + ", Number Of Reflections " +
      reflections + ", Number Of Connections " + connections);
  }
  return lines;
}
}
