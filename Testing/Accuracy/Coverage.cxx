// SPDX-License-Identifier: BSD-3-Clause
#include "Coverage.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace accuracy
{
using namespace avianlidar;

void Coverage::add(double truth, double energy, double standardError)
{
  const double error = energy - truth;
  const double width = 1.96 * standardError;
  ++this->estimates;
  // A billionth more for sums in another order, where one plane fills the beam.
  this->held += std::abs(error) <= width + 1e-9 * truth;
  this->widths += width / truth;
  this->squares += error * error / (truth * truth);
  this->errors += error / truth;
}

void Coverage::add(const Coverage& other)
{
  this->estimates += other.estimates;
  this->held += other.held;
  this->unseen += other.unseen;
  this->widths += other.widths;
  this->squares += other.squares;
  this->errors += other.errors;
}

double Coverage::share() const
{
  return static_cast<double>(this->held) / static_cast<double>(this->estimates);
}

double Coverage::shareOfSeen() const
{
  return static_cast<double>(this->held) / static_cast<double>(this->estimates - this->unseen);
}

double Coverage::width() const
{
  return this->widths / static_cast<double>(this->estimates);
}

double Coverage::rms() const
{
  return std::sqrt(this->squares / static_cast<double>(this->estimates));
}

double Coverage::bias() const
{
  return this->errors / static_cast<double>(this->estimates);
}

double CoverageTable::leastDecile(std::size_t fewest) const
{
  double least = 1.0;
  for (std::size_t d = 0; d < this->deciles.size(); ++d)
  {
    least = this->windows[d] >= fewest ? std::min(least, this->deciles[d].share()) : least;
  }
  return least;
}

CoverageTable measureCoverage(const AccuracyScene& scene, const std::vector<Window>& windows,
  EchoSettings settings, int first, int seeds)
{
  std::vector<Coverage> each(windows.size());
  const std::vector<std::size_t> chosen = beamsOf(windows);
  const ScanBeams beams = beamsOf(scene.beams, chosen);
  const double limit = 1e-3 * scene.setup.sensor.lowerEnergyLimit;
  for (int seed = first; seed < first + seeds; ++seed)
  {
    settings.seed = seed;
    std::map<std::pair<std::size_t, std::int64_t>, Echo> found;
    TraceCache cache;
    for (const UnitEcho& echo : unitEchoes(scene.setup, beams, settings, limit, cache))
    {
      found[{ chosen[echo.beam], echo.unit }] = echo.echo;
    }
    for (std::size_t w = 0; w < windows.size(); ++w)
    {
      const auto echo = found.find({ windows[w].beam, windows[w].unit });
      each[w].add(windows[w].truth, echo == found.end() ? 0.0 : echo->second.energyReceived,
        echo == found.end() ? 0.0 : echo->second.energyStdError);
      each[w].unseen += echo == found.end();
    }
  }
  CoverageTable table;
  for (std::size_t w = 0; w < windows.size(); ++w)
  {
    const auto decile =
      std::min<std::size_t>(9, static_cast<std::size_t>(10.0 * windows[w].covered));
    const bool secondary = windows[w].secondary > CoverageTable::SecondaryFrom;
    table.deciles[decile].add(each[w]);
    table.all.add(each[w]);
    (secondary ? table.secondary : table.direct).add(each[w]);
    ++table.windows[decile];
  }
  return table;
}
}
