// SPDX-License-Identifier: BSD-3-Clause
#include "PlanePanels.h"

#include "Multiversion.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Angles of incidence at which a plane has these ranges.
AVIANLIDAR_MULTIVERSION void incidenceOfAll(
  double height, const double* ranges, double* angles, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double beyond = ranges[i] - height;
    const double across = (beyond > 0.0 ? beyond : 0.0) * (ranges[i] + height);
    angles[i] = lanes::angleOf(height, std::sqrt(across));
  }
}

double fraction(double x)
{
  return x - std::floor(x);
}
}

PlanePanels::PlanePanels(const ScanSetup& setup)
  : Setup(setup)
  , UnitLength(setup.sensor.rangeUnitLength())
{
  const double half = 0.5 * setup.sensor.pulseWidth / setup.sensor.samplingInterval;
  this->Offsets[0] = fraction(half);
  this->Offsets[1] = fraction(-half);
  constexpr double same = 1e-9; // of a unit
  const double apart = std::fabs(this->Offsets[0] - this->Offsets[1]);
  this->NumberOfOffsets = apart < same || apart > 1.0 - same ? 1 : 2;
}

bool PlanePanels::mayFit(double footprint) const
{
  // The footprint on another triangle of the plane may be a little shorter.
  constexpr double surely = 1.0 - 1e-3;
  return this->bordersOf(surely * footprint) < static_cast<double>(MostUnitBorders);
}

/// Most borders of range units in a footprint of this length, m.
double PlanePanels::bordersOf(double footprint) const
{
  return this->NumberOfOffsets * (footprint / this->UnitLength + 1.0);
}

double PlanePanels::fewestPanels(double footprint) const
{
  return this->NumberOfOffsets * (footprint / this->UnitLength - 1.0);
}

bool PlanePanels::fits(const PlaneDisc& disc) const
{
  // Beyond MaximumGateUnits, rounding does not resolve whole numbers of units.
  return disc.cosMost > 0.0 && disc.farthest() < MaximumGateUnits * this->UnitLength &&
    this->bordersOf(disc.farthest() - disc.nearest()) < static_cast<double>(MostUnitBorders);
}

bool PlanePanels::isParted(double from, double to) const
{
  for (int k = 0; k < this->NumberOfOffsets; ++k)
  {
    if (std::floor(from / this->UnitLength - this->Offsets[k]) !=
      std::floor(to / this->UnitLength - this->Offsets[k]))
    {
      return true;
    }
  }
  return false;
}

void PlanePanels::set(const PlaneDisc& disc, const std::vector<PatchSurface>& surfaces)
{
  this->Disc = disc;
  this->Surfaces = &surfaces;
  this->Borders.clear();
  this->addUnitBorders();
  for (std::size_t k = 0; k < surfaces.size(); ++k)
  {
    const Material& material = surfaces[k].material;
    if (std::none_of(surfaces.begin(), surfaces.begin() + static_cast<std::ptrdiff_t>(k),
          [&](const PatchSurface& other) { return hasSameLobe(other.material, material); }))
    {
      this->addLobeBorders(material);
    }
  }
  this->addPoleBorders();
  std::sort(this->Borders.begin(), this->Borders.end());
}

void PlanePanels::addUnitBorders()
{
  this->Ranges.clear();
  const double from = this->Disc.nearest() / this->UnitLength;
  const double to = this->Disc.farthest() / this->UnitLength;
  for (int k = 0; k < this->NumberOfOffsets; ++k)
  {
    const double offset = this->Offsets[k];
    for (double unit = std::floor(from - offset) + 1.0; unit + offset < to; unit += 1.0)
    {
      this->Ranges.push_back((unit + offset) * this->UnitLength);
    }
  }
  this->Borders.resize(this->Ranges.size());
  incidenceOfAll(this->Disc.height, this->Ranges.data(), this->Borders.data(), this->Ranges.size());
}

/// Add borders so that the lobe falls by at most e^6 in a panel (Microfacet: so that panels are not
/// wider than their distance from the lobe's poles).
void PlanePanels::addLobeBorders(const Material& material)
{
  const double width2 = lobeWidth2(material);
  if (width2 == 0.0)
  {
    return;
  }
  if (this->Setup.settings.reflectanceModel == ReflectanceModel::Microfacet)
  {
    for (double b = std::sqrt(width2); b < this->Disc.most; b *= 2.0)
    {
      this->Borders.push_back(b);
    }
    return;
  }
  constexpr double step = 6.0;
  const double first = this->Disc.least * this->Disc.least / width2;
  const double last = this->Disc.most * this->Disc.most / width2;
  if (first > NoLobe && material.isMatt())
  {
    return;
  }
  for (double e = first + step; e < std::min(last, first + NoLobe); e += step)
  {
    this->Borders.push_back(std::sqrt(e * width2));
  }
}

/// Where the cone just misses the normal, and near the grazing direction, panels shrink towards the
/// pole.
void PlanePanels::addPoleBorders()
{
  const PlaneDisc& disc = this->Disc;
  const double length = disc.most - disc.least;
  const double gap = std::fabs(disc.tilt - disc.half);
  constexpr double ratio = 4.0;
  constexpr double near = 0.25;
  constexpr double least = 1e-7;
  for (double b = ratio * std::max(gap, least * length); b < near * length && gap < near * length;
       b *= ratio)
  {
    this->Borders.push_back(b);
  }
  const double rest = 0.5 * Pi - disc.most;
  for (double c = ratio * rest; c < 0.5 * Pi - disc.least && rest < near * length; c *= ratio)
  {
    this->Borders.push_back(0.5 * Pi - c);
  }
}

/// @param width of the panel in v @param from, to its borders, b, rad
const GaussKronrodRule& PlanePanels::ruleFor(double width, double from, double to) const
{
  int need = 0;
  const auto atLeast = [&need](double value, double second, double third)
  { need = std::max(need, value > third ? 2 : (value > second ? 1 : 0)); };
  atLeast(width, 0.06, 0.28);
  // How far the lobe falls, and how range and cosine change, in the panel.
  for (const PatchSurface& surface : *this->Surfaces)
  {
    const Material& m = surface.material;
    const double width2 = lobeWidth2(m);
    if (width2 == 0.0)
    {
      continue;
    }
    if (this->Setup.settings.reflectanceModel == ReflectanceModel::Microfacet)
    {
      atLeast((to * to - from * from) / (width2 + from * from), 0.1, 1.0);
    }
    else if (from * from < NoLobe * width2 || !m.isMatt())
    {
      atLeast((to * to - from * from) / width2, 0.1, 1.0);
    }
  }
  atLeast((to - from) / (0.5 * Pi - to), 0.1, 0.4);
  return need == 2 ? Kronrod15 : (need == 1 ? Kronrod7 : Kronrod5);
}

/// Panels between the borders inside an interval.
void PlanePanels::add(
  const PlaneArcs& arcs, const PlaneInterval& interval, std::vector<PlanePanel>& panels)
{
  double from = arcs.incidence(interval.circles, interval.from);
  const double to = arcs.incidence(interval.circles, interval.to);
  const auto begin = std::upper_bound(this->Borders.begin(), this->Borders.end(), from);
  const auto end = std::lower_bound(begin, this->Borders.end(), to);
  const std::size_t inner = end - begin;
  this->Places.resize(inner);
  arcs.placesOf(
    interval, this->Borders.data() + (begin - this->Borders.begin()), this->Places.data(), inner);
  // Circles: as wide as arcs.
  const double unit =
    interval.circles && !interval.roots ? 0.5 * Pi / (this->Disc.half - this->Disc.tilt) : 1.0;
  double lower = interval.lower();
  for (std::size_t k = 0; k <= inner; ++k)
  {
    const double upper = k < inner ? this->Places[k] : interval.upper();
    const double next = k < inner ? begin[static_cast<std::ptrdiff_t>(k)] : to;
    constexpr double nothing = 1e-15;
    if (upper - lower <= nothing * upper)
    {
      continue;
    }
    const GaussKronrodRule& rule = this->ruleFor(unit * (upper - lower), from, next);
    panels.push_back({ lower, upper, &rule, 0 });
    lower = upper;
    from = next;
  }
}
}
