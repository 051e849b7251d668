// SPDX-License-Identifier: BSD-3-Clause
#include "VisiblePolygons.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace avianlidar
{
namespace
{
/// Radii, in half-beamwidths, of the circles in and around the octagon. The disc lies inside it by
/// more than rounding.
constexpr double InRadius = 1.0 + 1e-6;
constexpr double OutRadius = InRadius * 1.0823922002923940; // 1/cos(pi/8)

/// Pieces smaller than this are left out (the disc has pi).
constexpr double LeastArea = 1e-14;

/// Planes whose 1/z differ by less than this part are equally near.
constexpr double SameRange = 1e-12;

PlaneRing octagon()
{
  const double near = InRadius * 0.41421356237309505; // tan(pi/8)
  const double far = InRadius;
  PlaneRing ring;
  for (const PlanePoint& p : { PlanePoint{ far, -near }, PlanePoint{ far, near },
         PlanePoint{ near, far }, PlanePoint{ -near, far }, PlanePoint{ -far, near },
         PlanePoint{ -far, -near }, PlanePoint{ -near, -far }, PlanePoint{ near, -far } })
  {
    ring.add(p);
  }
  return ring;
}

/// A line along `line` with a slope of 1; false if it does not meet the octagon.
bool normalised(const PlaneLine& line, PlaneLine& result)
{
  const double slope = line.slope();
  if (!(slope > 0.0 && std::fabs(line.z) <= OutRadius * slope))
  {
    return false;
  }
  result = { line.x / slope, line.y / slope, line.z / slope };
  return true;
}

/// Least and largest value at the corners of a ring.
struct Interval
{
  double least, most;
};
Interval valuesOf(const PlaneRing& ring, const PlaneLine& line)
{
  Interval values{ line.at(ring.corners[0]), line.at(ring.corners[0]) };
  for (int i = 1; i < ring.size; ++i)
  {
    const double value = line.at(ring.corners[i]);
    values.least = std::min(values.least, value);
    values.most = std::max(values.most, value);
  }
  return values;
}

/// True if a ring has a point in the unit disc.
bool meetsDisc(const PlaneRing& ring)
{
  bool left = true;
  bool right = true;
  for (int i = 0; i < ring.size; ++i)
  {
    const PlanePoint& a = ring.corners[i];
    const PlanePoint& b = ring.corners[(i + 1) % ring.size];
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    const double length2 = dx * dx + dy * dy;
    const double along = length2 > 0.0 ? -(a.x * dx + a.y * dy) / length2 : 0.0;
    const double t = std::clamp(along, 0.0, 1.0);
    const double x = a.x + t * dx;
    const double y = a.y + t * dy;
    if (x * x + y * y < 1.0)
    {
      return true;
    }
    const double side = a.x * b.y - a.y * b.x;
    left = left && side >= 0.0;
    right = right && side <= 0.0;
  }
  return left || right;
}
}

double PlaneRing::area() const
{
  double sum = 0.0;
  for (int i = 2; i < this->size; ++i)
  {
    const PlanePoint& a = this->corners[0];
    const PlanePoint& b = this->corners[i - 1];
    const PlanePoint& c = this->corners[i];
    sum += (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }
  return 0.5 * std::fabs(sum);
}

bool cutRing(const PlaneRing& ring, const PlaneLine& line, PlaneRing& positive, PlaneRing& negative)
{
  double values[PlaneRing::MostCorners];
  bool above = false;
  bool below = false;
  for (int i = 0; i < ring.size; ++i)
  {
    const double value = line.at(ring.corners[i]);
    values[i] = std::fabs(value) <= Snap ? 0.0 : value;
    above = above || values[i] > 0.0;
    below = below || values[i] < 0.0;
  }
  if (!above || !below)
  {
    return false;
  }
  positive.size = negative.size = 0;
  for (int i = 0; i < ring.size; ++i)
  {
    const int j = i + 1 == ring.size ? 0 : i + 1;
    const PlanePoint& p = ring.corners[i];
    if (values[i] >= 0.0)
    {
      positive.add(p);
    }
    if (values[i] <= 0.0)
    {
      negative.add(p);
    }
    if (values[i] * values[j] < 0.0)
    {
      const PlanePoint& q = ring.corners[j];
      const double t = values[i] / (values[i] - values[j]);
      const PlanePoint between{ p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t };
      positive.add(between);
      negative.add(between);
    }
  }
  return true;
}

std::uint32_t VisiblePolygons::triangleAt(const PlanePoint& p) const
{
  constexpr double margin = 1e-12;
  std::uint32_t begin = 0;
  for (const Polygon& polygon : this->polygons)
  {
    bool left = true;
    bool right = true;
    for (std::uint32_t i = begin; i < polygon.end; ++i)
    {
      const PlanePoint& a = this->corners[i];
      const PlanePoint& b = this->corners[i + 1 == polygon.end ? begin : i + 1];
      const double dx = b.x - a.x;
      const double dy = b.y - a.y;
      const double side = dx * (p.y - a.y) - dy * (p.x - a.x);
      const double near = margin * std::sqrt(dx * dx + dy * dy);
      left = left && side >= -near;
      right = right && side <= near;
    }
    if (left || right)
    {
      const PolygonSurface& surface = this->surfaces[polygon.surface];
      return surface.other != NoTriangle && surface.diagonal.at(p) < 0.0 ? surface.other
                                                                         : surface.triangle;
    }
    begin = polygon.end;
  }
  return NoTriangle;
}

//--- candidates -----------------------------------------------------------------------------------

void PolygonFinder::begin(const BeamFrame& frame)
{
  this->Frame = frame;
  this->Map = BeamPlaneMap(frame);
  this->Triangles.begin(*this->Mesh, frame.origin);
  this->Candidates.clear();
}

bool PolygonFinder::add(const std::uint32_t* triangles, std::size_t count)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    Candidate candidate;
    if (this->see(triangles[i], candidate) && this->enters(candidate))
    {
      this->Candidates.push_back(candidate);
    }
  }
  return this->Candidates.size() <= this->MostCandidates;
}

/// Set a candidate. @return false if one of its sides separates it from the octagon, or if it is
/// seen edge-on
bool PolygonFinder::see(std::uint32_t triangle, Candidate& c)
{
  const ExactTriangle& exact = this->Triangles[triangle];
  const Corners& t = exact.corners;
  const double determinant = glm::dot(t.c, exact.plane.sides[0].e);
  if (determinant == 0.0 || exact.plane.height == 0.0)
  {
    return false;
  }
  for (int i = 0; i < 3; ++i)
  {
    const BeamEdge edge = this->Map.edge(exact.plane.sides[i], determinant > 0.0 ? 1.0 : -1.0);
    c.crosses[i] = normalised({ edge.x, edge.y, edge.z }, c.sides[i]);
    if (!c.crosses[i] && !(edge.z > 0.0))
    {
      return false;
    }
  }
  c.triangle = triangle;
  c.other = NoTriangle;
  const Vec3& n = exact.plane.normal;
  const double inverse = 1.0 / exact.plane.height;
  c.inverse = { glm::dot(n, this->Map.e1) * inverse, glm::dot(n, this->Map.e2) * inverse,
    glm::dot(n, this->Map.axis) * inverse };
  c.height = std::fabs(exact.plane.height) / std::sqrt(glm::dot(n, n));
  double nearest = std::numeric_limits<double>::infinity();
  double farthest2 = 0.0;
  double depths = 1.0;
  for (const Vec3* corner : { &t.a, &t.b, &t.c })
  {
    const double depth = glm::dot(*corner, this->Map.axis);
    nearest = std::min(nearest, depth);
    depths *= depth;
    farthest2 = std::max(farthest2, glm::dot(*corner, *corner));
  }
  c.leastInverse = 1.0 / std::sqrt(farthest2);
  c.area = nearest > 0.0
    ? 0.5 * std::fabs(determinant) / (depths * this->Frame.tanHalf * this->Frame.tanHalf)
    : std::numeric_limits<double>::infinity();
  c.mostInverse = c.inverse.z + OutRadius * c.inverse.slope();
  if (nearest > 0.0)
  {
    c.mostInverse = std::min(c.mostInverse, 1.0 / nearest);
  }
  return true;
}

bool PolygonFinder::enters(const Candidate& c) const
{
  bool centre = true;
  for (int i = 0; i < 3; ++i)
  {
    centre = centre && (!c.crosses[i] || c.sides[i].z >= 0.0);
  }
  if (centre)
  {
    return true;
  }
  PlaneRing ring = octagon();
  for (int i = 0; i < 3; ++i)
  {
    PlaneRing inside;
    PlaneRing outside;
    if (c.crosses[i] && cutRing(ring, c.sides[i], inside, outside))
    {
      ring = inside;
    }
    else if (c.crosses[i] && valuesOf(ring, c.sides[i]).most <= Snap)
    {
      return false;
    }
  }
  return meetsDisc(ring);
}

/// Make one candidate of the halves of each quadrilateral, list the lines of all, and sort them,
/// nearest first.
void PolygonFinder::joinHalves()
{
  std::vector<Candidate>& all = this->Candidates;
  std::vector<std::uint32_t>& order = this->Numbers;
  order.resize(all.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
    [&](std::uint32_t a, std::uint32_t b) { return all[a].triangle < all[b].triangle; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    Candidate& c = all[order[i]];
    c.count = 0;
    const bool joined = i + 1 < order.size() && this->join(c, all[order[i + 1]]);
    for (int k = 0; k < 3 && !joined; ++k)
    {
      if (c.crosses[k])
      {
        c.lines[c.count++] = c.sides[k];
      }
    }
    order[kept++] = order[i];
    i += joined ? 1 : 0;
  }
  order.resize(kept);
  std::sort(order.begin(), order.end(),
    [&](std::uint32_t a, std::uint32_t b)
    {
      return all[a].mostInverse > all[b].mostInverse ||
        (all[a].mostInverse == all[b].mostInverse && all[a].triangle < all[b].triangle);
    });
  this->Ordered.clear();
  for (const std::uint32_t number : order)
  {
    this->Ordered.push_back(all[number]);
  }
  all.swap(this->Ordered);
}

/// Join two triangles if they have consecutive numbers, a side and a plane in common, and together
/// are convex. @return true if they were joined
bool PolygonFinder::join(Candidate& one, const Candidate& two)
{
  if (two.triangle != one.triangle + 1)
  {
    return false;
  }
  const ExactTriangle first = this->Triangles[one.triangle];
  const ExactTriangle second = this->Triangles[two.triangle];
  const Vec3* const p[] = { &first.corners.a, &first.corners.b, &first.corners.c };
  const Vec3* const q[] = { &second.corners.a, &second.corners.b, &second.corners.c };
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      const Vec3& a = *p[i];
      const Vec3& b = *p[(i + 1) % 3];
      const Vec3& c = *q[j];
      const Vec3& d = *q[(j + 1) % 3];
      if (!(a == d && b == c) && !(a == c && b == d))
      {
        continue;
      }
      const Vec3& farOne = *p[(i + 2) % 3];
      const Vec3& farTwo = *q[(j + 2) % 3];
      const Vec3& n = first.plane.normal;
      // In scene coordinates far from their origin corners are rounded, and a scene that was moved
      // there is to be seen as before.
      constexpr double flat = 1e-13;
      constexpr double rounding = 1e-15;
      const double aside = std::sqrt(glm::dot(n, n)) *
        (flat * std::sqrt(std::max(first.plane.longestSquared, second.plane.longestSquared)) +
          rounding * (safeLength(this->Frame.origin) + safeLength(farTwo)));
      const auto inside = [](const ExactTriangle& t, int side, const Vec3& v)
      { return (t.plane.height > 0.0) == (glm::dot(t.plane.sides[side].e, v) > 0.0); };
      const int i1 = (i + 1) % 3;
      const int i2 = (i + 2) % 3;
      const int j1 = (j + 1) % 3;
      const int j2 = (j + 2) % 3;
      if (!(std::fabs(glm::dot(n, farTwo) - first.plane.height) <= aside) ||
        inside(first, i, farTwo) || !inside(first, i1, farTwo) || !inside(first, i2, farTwo) ||
        !inside(second, j1, farOne) || !inside(second, j2, farOne))
      {
        return false;
      }
      for (const auto& [candidate, side] :
        { std::pair<const Candidate*, int>{ &one, i1 }, { &one, i2 }, { &two, j1 }, { &two, j2 } })
      {
        if (candidate->crosses[side])
        {
          one.lines[one.count++] = candidate->sides[side];
        }
      }
      one.other = two.triangle;
      one.diagonal = one.crosses[i] ? one.sides[i] : PlaneLine{ 0.0, 0.0, 1.0 };
      one.area += two.area;
      one.mostInverse = std::max(one.mostInverse, two.mostInverse);
      one.leastInverse = std::min(one.leastInverse, two.leastInverse);
      return true;
    }
  }
  return false;
}

//--- pieces ---------------------------------------------------------------------------------------

SeenByBeam PolygonFinder::find(std::unique_ptr<VisiblePolygons>& found)
{
  const std::size_t number = this->Candidates.size();
  if (number > this->MostCandidates)
  {
    this->Candidates.clear();
    return SeenByBeam::TooMuch;
  }
  if (number == 0)
  {
    return SeenByBeam::Nothing;
  }
  this->joinHalves();
  if (number > this->MostTriangles)
  {
    return SeenByBeam::TooMuch;
  }
  this->Pieces.assign(1, { { 0.0, 0.0 }, OutRadius, 0.0, Open });
  this->Rings.assign(1, octagon());
  this->PiecesOpen = 1;
  this->LostArea = 0.0;
  for (std::uint32_t number = 0; number < this->Candidates.size(); ++number)
  {
    if (this->PiecesOpen == 0 && this->isBehindAll(this->Candidates[number]))
    {
      break;
    }
    if (!this->insert(number))
    {
      return SeenByBeam::TooMuch;
    }
  }
  auto polygons = std::make_unique<VisiblePolygons>();
  this->collect(*polygons);
  if (polygons->polygons.empty())
  {
    return SeenByBeam::Nothing;
  }
  found = std::move(polygons);
  return SeenByBeam::Polygons;
}

/// True if a candidate, and all after it, lies behind all pieces.
bool PolygonFinder::isBehindAll(const Candidate& candidate) const
{
  return std::all_of(this->Pieces.begin(), this->Pieces.end(),
    [&](const Piece& piece) { return candidate.mostInverse < piece.leastInverse; });
}

/// Insert a candidate. @return false if there are too many pieces or corners
bool PolygonFinder::insert(std::uint32_t number)
{
  const std::size_t before = this->Pieces.size();
  for (std::size_t k = 0; k < before; ++k)
  {
    if (!this->meet(k, number))
    {
      return false;
    }
  }
  return this->Pieces.size() <= 3 * this->MostTriangles;
}

/// Let a candidate hide a part of a piece. @return false if it gets too many corners
bool PolygonFinder::meet(std::size_t k, std::uint32_t number)
{
  const Candidate& c = this->Candidates[number];
  const std::uint32_t seen = this->Pieces[k].candidate;
  if (seen != Open && this->Pieces[k].leastInverse > c.mostInverse)
  {
    return true;
  }
  const Piece& piece = this->Pieces[k];
  double distances[4];
  for (int i = 0; i < c.count; ++i)
  {
    distances[i] = c.lines[i].at(piece.centre);
    if (distances[i] <= Snap - piece.radius)
    {
      return true;
    }
  }
  PlaneRing inner = this->Rings[k];
  this->NumberOutside = 0;
  for (int i = 0; i < c.count; ++i)
  {
    if (distances[i] >= piece.radius)
    {
      continue;
    }
    PlaneRing inside;
    if (!inner.mayBeCut())
    {
      return false;
    }
    if (cutRing(inner, c.lines[i], inside, this->Outside[this->NumberOutside]))
    {
      ++this->NumberOutside;
      inner = inside;
    }
    else if (valuesOf(inner, c.lines[i]).most <= Snap)
    {
      return true;
    }
  }
  if (seen != Open && !this->isNearer(c, this->Candidates[seen], inner))
  {
    return true;
  }
  if (!inner.mayBeCut())
  {
    return false;
  }
  if (inner.area() < LeastArea)
  {
    this->LostArea += inner.area();
    return true;
  }
  this->PiecesOpen -= seen == Open ? 1 : 0;
  this->keepPiece(inner, number, k);
  for (int i = 0; i < this->NumberOutside; ++i)
  {
    this->keepPiece(this->Outside[i], seen, this->Pieces.size());
  }
  return true;
}

/// True if a candidate lies before another in a ring, or in the part of it to which the ring is
/// reduced then.
bool PolygonFinder::isNearer(const Candidate& one, const Candidate& two, PlaneRing& inner)
{
  const PlaneLine apart{ one.inverse.x - two.inverse.x, one.inverse.y - two.inverse.y,
    one.inverse.z - two.inverse.z };
  double most = 0.0; // beyond rounding
  double least = 0.0;
  for (int i = 0; i < inner.size; ++i)
  {
    const PlanePoint& p = inner.corners[i];
    const double same = SameRange * (std::fabs(one.inverse.at(p)) + std::fabs(two.inverse.at(p)));
    most = std::max(most, apart.at(p) - same);
    least = std::min(least, apart.at(p) + same);
  }
  if (most <= 0.0)
  {
    return least >= 0.0 && one.triangle < two.triangle;
  }
  const double slope = apart.slope();
  PlaneRing nearer;
  if (least < 0.0 && inner.mayBeCut() && slope > 0.0 &&
    cutRing(inner, { apart.x / slope, apart.y / slope, apart.z / slope }, nearer,
      this->Outside[this->NumberOutside]))
  {
    ++this->NumberOutside;
    inner = nearer;
    return true;
  }
  // Where they meet in a side alone, one of the two signs is rounding.
  return most > -least;
}

/// Set centre and radius: those of the box around it.
void PolygonFinder::Piece::findCircle(const PlaneRing& ring)
{
  PlanePoint low = ring.corners[0];
  PlanePoint high = low;
  for (int i = 1; i < ring.size; ++i)
  {
    const PlanePoint& p = ring.corners[i];
    low = { std::min(low.x, p.x), std::min(low.y, p.y) };
    high = { std::max(high.x, p.x), std::max(high.y, p.y) };
  }
  this->centre = { 0.5 * (low.x + high.x), 0.5 * (low.y + high.y) };
  const double x = high.x - this->centre.x;
  const double y = high.y - this->centre.y;
  constexpr double surely = 1.0 + 1e-12;
  this->radius = surely * std::sqrt(x * x + y * y);
}

/// Put a piece into a place, or leave it out.
void PolygonFinder::keepPiece(const PlaneRing& ring, std::uint32_t candidate, std::size_t place)
{
  const bool isNew = place == this->Pieces.size();
  if (isNew && ring.area() < LeastArea)
  {
    this->LostArea += ring.area();
    return;
  }
  this->PiecesOpen += candidate == Open ? 1 : 0;
  const double least = candidate == Open
    ? 0.0
    : std::max(this->Candidates[candidate].leastInverse,
        valuesOf(ring, this->Candidates[candidate].inverse).least);
  if (isNew)
  {
    this->Pieces.emplace_back();
    this->Rings.emplace_back();
  }
  Piece& piece = this->Pieces[place];
  this->Rings[place] = ring;
  piece.candidate = candidate;
  piece.leastInverse = least;
  piece.findCircle(ring);
}

//--- result ---------------------------------------------------------------------------------------

void PolygonFinder::collect(VisiblePolygons& found)
{
  this->Numbers.assign(this->Candidates.size(), Open);
  for (std::size_t k = 0; k < this->Pieces.size(); ++k)
  {
    const Piece& piece = this->Pieces[k];
    const PlaneRing& ring = this->Rings[k];
    if (piece.candidate == Open || !meetsDisc(ring))
    {
      continue;
    }
    std::uint32_t& number = this->Numbers[piece.candidate];
    if (number == Open)
    {
      const Candidate& c = this->Candidates[piece.candidate];
      number = static_cast<std::uint32_t>(found.surfaces.size());
      found.surfaces.push_back(
        { c.triangle, c.other, c.diagonal, c.inverse, c.height, c.leastInverse });
    }
    found.corners.insert(found.corners.end(), ring.corners, ring.corners + ring.size);
    found.polygons.push_back({ number, static_cast<std::uint32_t>(found.corners.size()) });
  }
  found.lost = this->LostArea / Pi;
  found.facing = this->isFacing(found);
}

PolygonFinder::Facet PolygonFinder::facetOf(const PolygonSurface& surface)
{
  Facet facet;
  const ExactTriangle& t = this->Triangles[surface.triangle];
  facet.size = 0;
  for (const Vec3* corner : { &t.corners.a, &t.corners.b, &t.corners.c })
  {
    facet.corners[facet.size++] = *corner;
  }
  facet.normal = (t.plane.height > 0.0 ? -1.0 : 1.0) /
    std::sqrt(glm::dot(t.plane.normal, t.plane.normal)) * t.plane.normal;
  facet.height = surface.height;
  if (surface.other != NoTriangle)
  {
    const ExactTriangle& two = this->Triangles[surface.other];
    for (const Vec3* corner : { &two.corners.a, &two.corners.b, &two.corners.c })
    {
      facet.corners[facet.size++] = *corner;
    }
  }
  return facet;
}

/// True if each of two visible surfaces has a corner before the plane of the other.
bool PolygonFinder::isFacing(const VisiblePolygons& found)
{
  this->Facets.clear();
  for (const PolygonSurface& surface : found.surfaces)
  {
    this->Facets.push_back(this->facetOf(surface));
  }
  const auto isBefore = [](const Facet& facet, const Facet& other)
  {
    constexpr double onPlane = 1e-12;
    for (int i = 0; i < facet.size; ++i)
    {
      const Vec3& v = facet.corners[i];
      const double size = other.height + glm::dot(glm::abs(v), Vec3(1.0));
      if (glm::dot(other.normal, v) + other.height > onPlane * size)
      {
        return true;
      }
    }
    return false;
  };
  for (std::size_t one = 1; one < this->Facets.size(); ++one)
  {
    for (std::size_t two = 0; two < one; ++two)
    {
      if (isBefore(this->Facets[one], this->Facets[two]) &&
        isBefore(this->Facets[two], this->Facets[one]))
      {
        return true;
      }
    }
  }
  return false;
}
}
