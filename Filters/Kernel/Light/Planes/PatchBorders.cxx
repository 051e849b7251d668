// SPDX-License-Identifier: BSD-3-Clause
#include "PatchBorders.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
constexpr double Infinity = std::numeric_limits<double>::infinity();

/// Along the line, of a corner in homogeneous coordinates; of one behind the apex the end of the
/// line on its side.
double alongLine(double n, double z, double otherN, double otherZ)
{
  return z > 0.0 ? n / z : std::copysign(Infinity, otherZ * n - z * otherN);
}

double asinOf(double sine)
{
  return std::copysign(lanes::asin(std::min(1.0, std::fabs(sine))), sine);
}
}

Corners PatchBorders::cornersOf(std::size_t triangle) const
{
  return cornersFrom(*this->Mesh, this->Patch->triangles[triangle], this->Frame->origin);
}

void PatchBorders::set(const TriangleMesh& mesh, const BeamFrame& frame, const VisiblePatch& patch,
  const std::vector<std::uint8_t>& surfaces, const PlaneDisc& disc)
{
  this->Mesh = &mesh;
  this->Frame = &frame;
  this->Patch = &patch;
  this->Surfaces = &surfaces;
  this->Disc = disc;
  this->Rounding = 0.0;
  this->Borders.clear();
  for (const PatchSeam& seam : patch.seams)
  {
    if (surfaces[seam.one] != surfaces[seam.two])
    {
      this->add(seam);
    }
  }
}

void PatchBorders::add(const PatchSeam& seam)
{
  const Corners corners = this->cornersOf(seam.one);
  const Vec3* const v[3] = { &corners.a, &corners.b, &corners.c };
  const double determinant = glm::dot(corners.c, edgeVector(corners.a, corners.b).e);
  const BeamEdge edge =
    BeamPlaneMap(*this->Frame)
      .edge(edgeVector(*v[seam.side], *v[(seam.side + 1) % 3]), determinant > 0.0 ? 1.0 : -1.0);
  const double reach = std::sqrt(edge.x * edge.x + edge.y * edge.y);
  const double x = edge.x / reach;
  const double y = edge.y / reach;
  const auto& turn = this->Disc.turn;
  PatchBorder border;
  border.alpha = turn[0][0] * x + turn[0][1] * y;
  border.beta = turn[1][0] * x + turn[1][1] * y;
  border.gamma = edge.z / reach;
  border.inside = (*this->Surfaces)[seam.one];
  border.outside = (*this->Surfaces)[seam.two];
  // Its ends, and which of them lie in the disc.
  const Vec3 p = this->Frame->toPlane(*v[seam.side]);
  const Vec3 q = this->Frame->toPlane(*v[(seam.side + 1) % 3]);
  const double np = p.y * x - p.x * y;
  const double nq = q.y * x - q.x * y;
  const double sp = alongLine(np, p.z, nq, q.z);
  const double sq = alongLine(nq, q.z, np, p.z);
  const double radius = 1.0 - rimOf(*this->Frame);
  const double half = std::sqrt(std::max(0.0, radius * radius - border.gamma * border.gamma));
  border.from = std::min(sp, sq) > -half ? std::min(sp, sq) : -Infinity;
  border.to = std::max(sp, sq) < half ? std::max(sp, sq) : Infinity;
  this->Rounding += edge.tolerance / reach;
  border.gamma *= this->Frame->tanHalf;
  this->Borders.push_back(border);
}

bool PatchBorders::contains(const PatchBorder& border, double x, double y, double margin) const
{
  const double along = border.alpha * y - border.beta * x;
  return along > border.from - margin && along < border.to + margin;
}

void PatchBorders::addEvents(
  bool circles, double from, double to, std::vector<PatchEvent>& events) const
{
  const PlaneDisc& d = this->Disc;
  const auto add = [&](double ahead, bool root)
  {
    if (ahead > from && ahead < to)
    {
      events.push_back({ ahead, root });
    }
  };
  for (const PatchBorder& b : this->Borders)
  {
    const double gamma = b.gamma / d.tanHalf;
    const auto point = [&](double along)
    { return d.aheadOf(-gamma * b.alpha - along * b.beta, -gamma * b.beta + along * b.alpha); };
    const double half = std::sqrt(std::max(0.0, 1.0 - gamma * gamma));
    for (const double end : { b.from, b.to })
    {
      const bool inside = std::fabs(end) < half;
      add(point(inside ? end : std::copysign(half, end)), false);
    }
    // Where it touches a circle: sin b = |m . N| of the unit normal m of its plane.
    const double along = b.alpha * d.cosTilt + b.gamma * d.sineTilt;
    const double foot = b.gamma * d.cosTilt - b.alpha * d.sineTilt;
    const double across = std::sqrt(along * along + b.beta * b.beta);
    const double length = std::sqrt(1.0 + b.gamma * b.gamma);
    const double sine = b.gamma *
        (b.gamma * (d.cosTilt - d.sineTilt) * (d.cosTilt + d.sineTilt) -
          2.0 * b.alpha * d.sineTilt * d.cosTilt) -
      d.sineTilt * d.sineTilt * b.beta * b.beta;
    const double ahead =
      asinOf(sine / (length * (std::fabs(foot) * d.cosTilt + across * d.sineTilt)));
    if (ahead > from && ahead < to)
    {
      // The direction of contact is N less its component along m.
      const double z = d.cosTilt - foot * b.gamma / (length * length);
      const double x = (-d.sineTilt - foot * b.alpha / (length * length)) / d.tanHalf;
      const double y = -foot * b.beta / (length * length) / d.tanHalf;
      constexpr double margin = 0.25;
      if (z > 0.0 && x * x + y * y < (1.0 + margin) * z * z &&
        this->contains(b, x / z, y / z, margin))
      {
        events.push_back({ ahead, true });
      }
    }
    if (circles && b.alpha != 0.0)
    {
      // A + 2C = 0: alpha sin(a + b) = gamma tan t cos(a + b).
      add(asinOf(b.gamma / b.alpha / std::sqrt(1.0 + b.gamma / b.alpha * (b.gamma / b.alpha))) -
          2.0 * d.tilt,
        false);
    }
  }
}

double PatchBorders::placeOn(
  const PatchBorder& border, const IncidenceCircle& circle, double turn) const
{
  const double half = lanes::sineOf(0.5 * turn);
  const double off = 2.0 * circle.sine * (half * half);
  const double z = this->Disc.tanHalf * (circle.cosAhead - this->Disc.sineTilt * off);
  const double x = circle.sinAhead - this->Disc.cosTilt * off;
  const double y = circle.sine * lanes::sineOf(turn);
  return (border.alpha * y - border.beta * x) / z;
}

void PatchBorders::findCrossings(const IncidenceCircle& circle)
{
  this->Crossings.clear();
  for (std::size_t k = 0; k < this->Borders.size(); ++k)
  {
    const PatchBorder& border = this->Borders[k];
    for (const bool rising : { false, true })
    {
      const BorderLine line = lineOf(border, this->Disc, rising);
      if (!(discriminantOf(line, circle.sine, circle.sinAhead, circle.cosAhead) > 0.0))
      {
        continue;
      }
      const double turn = turnOf(line, circle.sine, circle.sinAhead, circle.cosAhead);
      if (!(std::fabs(turn) < circle.reach))
      {
        continue;
      }
      const double along = this->placeOn(border, circle, turn);
      if (along > border.from && along < border.to)
      {
        this->Crossings.push_back({ turn, { static_cast<std::uint32_t>(k), rising } });
      }
    }
  }
  std::sort(this->Crossings.begin(), this->Crossings.end(),
    [](const Found& a, const Found& b) { return a.turn < b.turn; });
}

bool PatchBorders::follow(
  const IncidenceCircle& circle, std::vector<PatchCrossing>& crossings, std::vector<PatchArc>& arcs)
{
  this->findCrossings(circle);
  if (this->Crossings.empty())
  {
    arcs.push_back({ this->surfaceAhead(circle), PatchArc::Rim, PatchArc::Rim });
    return true;
  }
  const auto before = [this](const PatchCrossing& c)
  { return c.rising ? this->Borders[c.border].outside : this->Borders[c.border].inside; };
  const auto after = [this](const PatchCrossing& c)
  { return c.rising ? this->Borders[c.border].inside : this->Borders[c.border].outside; };
  std::uint8_t surface = before(this->Crossings.front().crossing);
  if (circle.reach >= Pi && after(this->Crossings.back().crossing) != surface)
  {
    return false;
  }
  std::uint32_t from = PatchArc::Rim;
  for (const Found& found : this->Crossings)
  {
    if (before(found.crossing) != surface)
    {
      return false;
    }
    const auto to = static_cast<std::uint32_t>(crossings.size());
    arcs.push_back({ surface, from, to });
    crossings.push_back(found.crossing);
    surface = after(found.crossing);
    from = to;
  }
  arcs.push_back({ surface, from, PatchArc::Rim });
  return true;
}

std::uint8_t PatchBorders::surfaceAhead(const IncidenceCircle& circle)
{
  const double along = circle.sinAhead / (circle.cosAhead * this->Disc.tanHalf);
  const double x = along * this->Disc.turn[0][0];
  const double y = along * this->Disc.turn[0][1];
  const BeamPlaneMap map(*this->Frame);
  double best = -Infinity;
  std::uint8_t surface = Elsewhere;
  for (std::size_t k = 0; k < this->Patch->triangles.size(); ++k)
  {
    BeamTriangle triangle;
    if (!triangle.set(map, this->cornersOf(k)))
    {
      continue;
    }
    double slack = Infinity;
    for (const BeamEdge& e : triangle.edges)
    {
      const double reach = std::sqrt(e.x * e.x + e.y * e.y);
      const double value = (e.x * x + e.y * y) + e.z;
      slack = std::min(slack, reach > 0.0 ? value / reach : value);
    }
    if (slack > best)
    {
      best = slack;
      surface = (*this->Surfaces)[k];
    }
  }
  return surface;
}
}
