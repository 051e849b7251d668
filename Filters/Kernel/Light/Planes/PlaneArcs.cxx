// SPDX-License-Identifier: BSD-3-Clause
#include "PlaneArcs.h"

#include "GaussKronrod.h"
#include "Multiversion.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// The numbers of a disc that every node needs.
struct ArcNumbers
{
  double height, tilt, half;
  double sineTilt, cosTilt;
  double piece;        ///< min(a, t)
  double start;        ///< |a - t|
  double beyond;       ///< 2 max(0, t - a)
  double short_;       ///< 2 max(0, a - t)
  double ahead;        ///< b - a at the start of the arcs
  double density;      ///< of solid angle: 1/(4 pi sin^2(t/2))
  double inverse;      ///< 1/sin^2(t/2)
  double from, length; ///< of the interval, in v
};

ArcNumbers numbersOf(const PlaneDisc& disc)
{
  ArcNumbers n;
  n.height = disc.height;
  n.tilt = disc.tilt;
  n.half = disc.half;
  n.sineTilt = disc.sineTilt;
  n.cosTilt = disc.cosTilt;
  n.piece = std::min(disc.tilt, disc.half);
  n.start = std::fabs(disc.tilt - disc.half);
  n.beyond = 2.0 * std::max(0.0, disc.half - disc.tilt);
  n.short_ = 2.0 * std::max(0.0, disc.tilt - disc.half);
  n.ahead = disc.aheadOfArcs();
  n.inverse = 1.0 / disc.sine2;
  n.density = n.inverse / (4.0 * Pi);
  n.from = 0.0;
  n.length = 0.0;
  return n;
}

/// Where a node lies: angle of incidence, how far ahead of the axis, half-length of its circle's
/// arc, db/dv.
struct ArcPlace
{
  double b, ahead, reach, slope;
};

template <bool Circles>
AVIANLIDAR_ALWAYS_INLINE ArcPlace placeOf(const ArcNumbers& d, double v)
{
  if constexpr (Circles)
  {
    return { v, v - d.tilt, Pi, 1.0 };
  }
  double c = 0.0;
  double s = 0.0;
  lanes::cosSinOfTurns(v * lanes::TurnsPerRadian, c, s);
  const double low = 2.0 * d.piece * (s * s);
  const double high = 2.0 * d.piece * (c * c);
  const double inside = lanes::sineOf(0.5 * (low + d.beyond)) * lanes::sineOf(0.5 * high);
  const double outside =
    lanes::sineOf(0.5 * (low + d.short_)) * lanes::sineOf(d.tilt + d.half - 0.5 * high);
  const double reach = 2.0 *
    lanes::angleOf(
      std::sqrt(outside > 0.0 ? outside : 0.0), std::sqrt(inside > 0.0 ? inside : 0.0));
  return { d.start + low, low + d.ahead, reach, 4.0 * d.piece * (s * c) };
}

struct NodeArrays
{
  const double* variable;
  const double* weight;
  double* range;
  double* cosine;
  double* sine;
  double* sinAhead;
  double* cosAhead;
  double* factor;
  double* reach;
  std::size_t count;
};

template <bool Circles, bool Roots>
AVIANLIDAR_ALWAYS_INLINE void nodesOf(const ArcNumbers& disc, const NodeArrays& arrays)
{
  const ArcNumbers d = disc;
  const NodeArrays a = arrays;
#pragma omp simd
  for (std::size_t i = 0; i < a.count; ++i)
  {
    double v = a.variable[i];
    double slope = 1.0;
    if constexpr (Roots)
    {
      double c = 0.0;
      double s = 0.0;
      lanes::cosSinOfTurns(v * lanes::TurnsPerRadian, c, s);
      v = d.from + d.length * (s * s);
      slope = 2.0 * d.length * (s * c);
    }
    const ArcPlace p = placeOf<Circles>(d, v);
    double cosAhead = 0.0;
    double sinAhead = 0.0;
    lanes::cosSinOfTurns(p.ahead * lanes::TurnsPerRadian, cosAhead, sinAhead);
    const double cosB = d.cosTilt * cosAhead - d.sineTilt * sinAhead;
    const double sinB = d.sineTilt * cosAhead + d.cosTilt * sinAhead;
    a.cosAhead[i] = cosAhead;
    a.sinAhead[i] = sinAhead;
    a.sine[i] = sinB;
    a.range[i] = d.height / cosB;
    a.cosine[i] = cosB < 1.0 ? cosB : 1.0;
    a.reach[i] = p.reach;
    a.factor[i] = a.weight[i] * slope * p.slope * sinB * d.density;
  }
}

AVIANLIDAR_MULTIVERSION void nodesOfAll(
  bool circles, bool roots, const ArcNumbers& disc, const NodeArrays& arrays)
{
  if (circles)
  {
    roots ? nodesOf<true, true>(disc, arrays) : nodesOf<true, false>(disc, arrays);
  }
  else
  {
    roots ? nodesOf<false, true>(disc, arrays) : nodesOf<false, false>(disc, arrays);
  }
}

AVIANLIDAR_MULTIVERSION void turnsOfAll(const BorderLine& border, const double* sine,
  const double* sinAhead, const double* cosAhead, double* turns, std::size_t count)
{
  const BorderLine line = border;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    turns[i] = turnOf(line, sine[i], sinAhead[i], cosAhead[i]);
  }
}

/// Integral of the Gaussian profile along the arc from phi = 0 to a turn, relative to its mean over
/// the cone. @param first u at phi = 0 @param rise so that u = first + rise sin^2(phi/2)
AVIANLIDAR_ALWAYS_INLINE double gaussianArc(double arc, double first, double rise)
{
  constexpr double norm = 2.0 / 0.86466471676338730811; // 2/(1 - e^-2)
  double sum = 0.0;
  for (int k = 0; k < GaussPoints; ++k)
  {
    const double s = lanes::sineOf(0.5 * arc * GaussPlace[k]);
    sum += GaussWeight[k] * lanes::exp(-2.0 * (first + rise * (s * s)));
  }
  return norm * arc * sum;
}

/// Turns into integrals of the profile.
AVIANLIDAR_MULTIVERSION void gaussianOfAll(double inverse, double sineTilt, const double* sine,
  const double* first, double* turns, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    turns[i] = gaussianArc(turns[i], first[i], sine[i] * sineTilt * inverse);
  }
}

AVIANLIDAR_MULTIVERSION void firstsOfAll(
  double inverse, const double* sinAhead, const double* cosAhead, double* first, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    // sin^2(x/2), without cancellation.
    first[i] = 0.5 * inverse * (sinAhead[i] * sinAhead[i]) / (1.0 + cosAhead[i]);
  }
}

/// @param signs of the rim, where there is no crossing to begin or end at
void sharesOfAll(const double* factor, const double* from, double signFrom, const double* to,
  double* shares, std::size_t count)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    shares[i] = factor[i] * (to[i] - signFrom * from[i]);
  }
}

/// v of b = least + (most - least) sin^2 v.
AVIANLIDAR_MULTIVERSION void placesOfAll(
  double least, double most, const double* angles, double* places, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double below = angles[i] - least;
    const double above = most - angles[i];
    places[i] =
      lanes::angleOf(std::sqrt(above > 0.0 ? above : 0.0), std::sqrt(below > 0.0 ? below : 0.0));
  }
}
}

double PlaneArcs::incidence(bool circles, double v) const
{
  return circles ? placeOf<true>(numbersOf(this->Disc), v).b
                 : placeOf<false>(numbersOf(this->Disc), v).b;
}

IncidenceCircle PlaneArcs::circleOf(bool circles, double v) const
{
  const ArcPlace p =
    circles ? placeOf<true>(numbersOf(this->Disc), v) : placeOf<false>(numbersOf(this->Disc), v);
  IncidenceCircle circle;
  circle.sine = lanes::sineOf(p.b);
  lanes::cosSinOfTurns(p.ahead * lanes::TurnsPerRadian, circle.cosAhead, circle.sinAhead);
  circle.reach = p.reach;
  return circle;
}

double PlaneArcs::variableOf(bool circles, double ahead) const
{
  if (circles)
  {
    return ahead + this->Disc.tilt;
  }
  const double low = ahead - this->Disc.aheadOfArcs();
  const double high = this->Disc.half - ahead;
  return lanes::angleOf(std::sqrt(std::max(0.0, high)), std::sqrt(std::max(0.0, low)));
}

bool PlaneArcs::set(const PlaneDisc& disc, PatchBorders& borders)
{
  this->Disc = disc;
  this->Borders = &borders;
  this->Fits = true;
  this->Uncertain = 0.0;
  this->Intervals.clear();
  this->Crossings.clear();
  this->Arcs.clear();
  if (disc.tilt < disc.half)
  {
    this->addIntervals(true, -disc.tilt, disc.aheadOfArcs());
  }
  if (disc.tilt > 0.0)
  {
    this->addIntervals(false, disc.aheadOfArcs(), disc.half);
  }
  return this->Fits;
}

/// Between the events. @param from, to b - a
void PlaneArcs::addIntervals(bool circles, double from, double to)
{
  this->Events.clear();
  this->Borders->addEvents(circles, from, to, this->Events);
  std::sort(this->Events.begin(), this->Events.end(),
    [](const PatchEvent& one, const PatchEvent& two) { return one.ahead < two.ahead; });
  this->Events.push_back({ to, false });
  constexpr double same = 1e-13;
  const double near = same * this->Disc.half;
  double lower = circles ? 0.0 : this->variableOf(circles, from);
  double lowerAhead = from;
  bool root = false;
  for (std::size_t k = 0; k < this->Events.size(); ++k)
  {
    const PatchEvent& event = this->Events[k];
    const bool last = k + 1 == this->Events.size();
    const double upper =
      last ? (circles ? to + this->Disc.tilt : 0.5 * Pi) : this->variableOf(circles, event.ahead);
    if (upper > lower && event.ahead - lowerAhead > near)
    {
      this->Fits = this->addInterval(circles, lower, upper, root || event.root) && this->Fits;
      lower = upper;
      lowerAhead = event.ahead;
      root = event.root;
    }
    else
    {
      root = root || event.root;
    }
  }
}

bool PlaneArcs::addInterval(bool circles, double from, double to, bool roots)
{
  PlaneInterval interval;
  interval.circles = circles;
  interval.roots = roots;
  interval.from = from;
  interval.to = to;
  interval.crossings[0] = static_cast<std::uint32_t>(this->Crossings.size());
  interval.arcs[0] = static_cast<std::uint32_t>(this->Arcs.size());
  bool fits = true;
  if (this->Borders->empty())
  {
    this->Arcs.push_back({ 0, PatchArc::Rim, PatchArc::Rim });
  }
  else
  {
    const IncidenceCircle middle = this->circleOf(circles, 0.5 * (from + to));
    if (!this->Borders->follow(middle, this->Crossings, this->Arcs))
    {
      this->Crossings.resize(interval.crossings[0]);
      this->Arcs.resize(interval.arcs[0]);
      this->Arcs.push_back({ this->Borders->surfaceAhead(middle), PatchArc::Rim, PatchArc::Rim });
      // Whatever the profile, a ring of the disc, or a strip, holds at most 2 times its width, in
      // half-beamwidths.
      const double width = this->incidence(circles, to) - this->incidence(circles, from);
      const double share = 2.0 * width / this->Disc.half;
      this->Uncertain += share;
      constexpr double negligible = 1e-6;
      fits = share < negligible;
    }
  }
  interval.crossings[1] = static_cast<std::uint32_t>(this->Crossings.size());
  interval.arcs[1] = static_cast<std::uint32_t>(this->Arcs.size());
  this->Intervals.push_back(interval);
  return fits;
}

void PlaneArcs::placesOf(
  const PlaneInterval& interval, const double* angles, double* places, std::size_t count) const
{
  if (interval.circles)
  {
    std::copy(angles, angles + count, places);
  }
  else
  {
    placesOfAll(
      std::fabs(this->Disc.tilt - this->Disc.half), this->Disc.most, angles, places, count);
  }
  if (interval.roots)
  {
    placesOfAll(interval.from, interval.to, places, places, count);
  }
}

void PlaneArcs::place(const PlaneInterval& interval, bool gaussian, ArcNodes& nodes) const
{
  const std::size_t count = nodes.size();
  const std::size_t crossings = interval.crossings[1] - interval.crossings[0];
  const std::size_t arcs = interval.arcs[1] - interval.arcs[0];
  for (std::vector<double>* v :
    { &nodes.range, &nodes.cosine, &nodes.sine, &nodes.sinAhead, &nodes.cosAhead, &nodes.factor })
  {
    v->resize(count);
  }
  nodes.turns.resize((crossings + 1) * count);
  nodes.shares.resize(arcs * count);
  ArcNumbers numbers = numbersOf(this->Disc);
  numbers.from = interval.from;
  numbers.length = interval.to - interval.from;
  double* const rim = nodes.turns.data() + crossings * count;
  nodesOfAll(interval.circles, interval.roots, numbers,
    { nodes.variable.data(), nodes.weight.data(), nodes.range.data(), nodes.cosine.data(),
      nodes.sine.data(), nodes.sinAhead.data(), nodes.cosAhead.data(), nodes.factor.data(), rim,
      count });
  for (std::size_t k = 0; k < crossings; ++k)
  {
    const PatchCrossing& crossing = this->Crossings[interval.crossings[0] + k];
    turnsOfAll(lineOf((*this->Borders)[crossing.border], this->Disc, crossing.rising),
      nodes.sine.data(), nodes.sinAhead.data(), nodes.cosAhead.data(),
      nodes.turns.data() + k * count, count);
  }
  if (gaussian)
  {
    nodes.first.resize(count);
    firstsOfAll(
      numbers.inverse, nodes.sinAhead.data(), nodes.cosAhead.data(), nodes.first.data(), count);
    for (std::size_t k = 0; k <= crossings; ++k)
    {
      gaussianOfAll(numbers.inverse, this->Disc.sineTilt, nodes.sine.data(), nodes.first.data(),
        nodes.turns.data() + k * count, count);
    }
  }
  for (std::size_t k = 0; k < arcs; ++k)
  {
    const PatchArc& arc = this->Arcs[interval.arcs[0] + k];
    const auto turn = [&](std::uint32_t crossing) -> const double*
    {
      return crossing == PatchArc::Rim
        ? rim
        : nodes.turns.data() + (crossing - interval.crossings[0]) * count;
    };
    sharesOfAll(nodes.factor.data(), turn(arc.from), arc.from == PatchArc::Rim ? -1.0 : 1.0,
      turn(arc.to), nodes.shares.data() + k * count, count);
  }
}
}
