// SPDX-License-Identifier: BSD-3-Clause
#include "VisiblePolygons.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
/// Area below which pieces are left out. The disc has the area pi.
constexpr double LeastArea = 1e-14;

/// Relative difference of 1/z below which planes are equally near.
constexpr double SameRange = 1e-12;

}

PlaneRing octagonAround()
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

void VisiblePolygons::add(const PlaneSurface& surface, const PlaneRing& ring)
{
  this->surfaces.push_back(surface);
  this->corners.insert(this->corners.end(), ring.corners, ring.corners + ring.size);
  this->polygons.push_back({ static_cast<std::uint32_t>(this->surfaces.size() - 1),
    static_cast<std::uint32_t>(this->corners.size()) });
}

bool clipRing(PlaneRing& ring, const PlaneLine& line)
{
  double values[PlaneRing::MostCorners];
  bool above = false;
  bool below = false;
  for (int i = 0; i < ring.size; ++i)
  {
    values[i] = line.at(ring.corners[i]);
    above = above || values[i] > 0.0;
    below = below || values[i] < 0.0;
  }
  if (!above || !below || !ring.mayBeCut())
  {
    return above;
  }
  const PlaneRing whole = ring;
  ring.size = 0;
  for (int i = 0; i < whole.size; ++i)
  {
    const int j = i + 1 == whole.size ? 0 : i + 1;
    const PlanePoint& p = whole.corners[i];
    const PlanePoint& q = whole.corners[j];
    if (values[i] >= 0.0)
    {
      ring.add(p);
    }
    if (values[i] * values[j] < 0.0)
    {
      const double t = values[i] / (values[i] - values[j]);
      ring.add({ p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t });
    }
  }
  return true;
}

namespace
{
/// Least value at the corners of a ring.
double leastOf(const PlaneRing& ring, const PlaneLine& line)
{
  double least = line.at(ring.corners[0]);
  for (int i = 1; i < ring.size; ++i)
  {
    least = std::min(least, line.at(ring.corners[i]));
  }
  return least;
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

double PlaneRing::signedArea() const
{
  double sum = 0.0;
  for (int i = 2; i < this->size; ++i)
  {
    const PlanePoint& a = this->corners[0];
    const PlanePoint& b = this->corners[i - 1];
    const PlanePoint& c = this->corners[i];
    sum += (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }
  return 0.5 * sum;
}

SideOfLine cutRing(
  const PlaneRing& ring, const PlaneLine& line, PlaneRing& positive, PlaneRing& negative)
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
    return above ? SideOfLine::Positive : SideOfLine::Negative;
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
  return SideOfLine::Both;
}

std::uint32_t VisiblePolygons::triangleAt(const PlanePoint& p) const
{
  constexpr double margin = 1e-12;
  std::uint32_t begin = 0;
  for (const Polygon& polygon : this->polygons)
  {
    bool left = true;
    bool right = true;
    for (std::uint32_t i = begin; i < polygon.end && (left || right); ++i)
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
      return this->surfaces[polygon.surface].triangleAt(p);
    }
    begin = polygon.end;
  }
  return NoTriangle;
}

//--- pieces ---------------------------------------------------------------------------------------

SeenByBeam PolygonFinder::find(std::unique_ptr<VisiblePolygons>& found)
{
  const std::size_t number = this->Entering.finish();
  if (number > this->MostCandidates)
  {
    return SeenByBeam::TooMuch;
  }
  if (number == 0)
  {
    return SeenByBeam::Nothing;
  }
  const std::vector<const Candidate*>& candidates = this->Entering.sort();
  if (number > this->MostTriangles)
  {
    return SeenByBeam::TooMuch;
  }
  this->Pieces.assign(1, { { 0.0, 0.0 }, OutRadius, 0.0, Open });
  this->Rings.assign(1, octagonAround());
  this->PiecesOpen = 1;
  this->LostArea = 0.0;
  for (std::uint32_t nearest = 0; nearest < candidates.size(); ++nearest)
  {
    if (this->PiecesOpen == 0 && this->isBehindAll(*candidates[nearest]))
    {
      break;
    }
    if (!this->insert(nearest))
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

/// True if a candidate and all candidates after it lie behind all pieces.
bool PolygonFinder::isBehindAll(const Candidate& candidate) const
{
  constexpr double inOrder =
    1.0 + 4.0 * RoundOffSingle; // candidates are sorted in single precision
  return std::all_of(this->Pieces.begin(), this->Pieces.end(),
    [&](const Piece& piece) { return inOrder * candidate.sortInverse < piece.leastInverse; });
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

/// Let a candidate hide a part of a piece. @return false if the part has too many corners
bool PolygonFinder::meet(std::size_t k, std::uint32_t number)
{
  const Candidate& c = *this->candidates()[number];
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
  PlaneRing parts[2];
  const PlaneRing* inner = &this->Rings[k];
  this->NumberOutside = 0;
  for (int i = 0; i < c.count; ++i)
  {
    if (distances[i] >= piece.radius)
    {
      continue;
    }
    if (!inner->mayBeCut())
    {
      return false;
    }
    PlaneRing& inside = inner == &parts[0] ? parts[1] : parts[0];
    const SideOfLine side = cutRing(*inner, c.lines[i], inside, this->Outside[this->NumberOutside]);
    if (side == SideOfLine::Negative)
    {
      return true;
    }
    if (side == SideOfLine::Both)
    {
      ++this->NumberOutside;
      inner = &inside;
    }
  }
  PlaneRing& nearer = inner == &parts[0] ? parts[1] : parts[0];
  if (seen != Open && !this->isNearer(c, *this->candidates()[seen], inner, nearer))
  {
    return true;
  }
  if (!inner->mayBeCut())
  {
    return false;
  }
  const double area = inner->area();
  if (area < LeastArea)
  {
    this->LostArea += area;
    return true;
  }
  this->PiecesOpen -= seen == Open ? 1 : 0;
  this->keepPiece(*inner, number, k);
  for (int i = 0; i < this->NumberOutside; ++i)
  {
    this->keepPiece(this->Outside[i], seen, this->Pieces.size());
  }
  return true;
}

/// True if candidate `one` lies before `two` in a ring or in a part of it. @param inner the ring;
/// set to the part @param nearer room for the part
bool PolygonFinder::isNearer(
  const Candidate& one, const Candidate& two, const PlaneRing*& inner, PlaneRing& nearer)
{
  const PlaneLine apart{ one.inverse.x - two.inverse.x, one.inverse.y - two.inverse.y,
    one.inverse.z - two.inverse.z };
  double most = 0.0; // largest difference beyond rounding
  double least = 0.0;
  for (int i = 0; i < inner->size; ++i)
  {
    const PlanePoint& p = inner->corners[i];
    const double same = SameRange * (std::fabs(one.inverse.at(p)) + std::fabs(two.inverse.at(p)));
    most = std::max(most, apart.at(p) - same);
    least = std::min(least, apart.at(p) + same);
  }
  if (most <= 0.0)
  {
    return least >= 0.0 && one.triangle < two.triangle;
  }
  const double slope = apart.slope();
  if (least < 0.0 && inner->mayBeCut() && slope > 0.0 &&
    cutRing(*inner, { apart.x / slope, apart.y / slope, apart.z / slope }, nearer,
      this->Outside[this->NumberOutside]) == SideOfLine::Both)
  {
    ++this->NumberOutside;
    inner = &nearer;
    return true;
  }
  // If the candidates meet in a side alone, one of the two signs is due to rounding.
  return most > -least;
}

/// Set the circle to the circle around the ring's box.
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

/// Put a piece into a place, or leave it out if it is new and too small.
void PolygonFinder::keepPiece(const PlaneRing& ring, std::uint32_t candidate, std::size_t place)
{
  const bool isNew = place == this->Pieces.size();
  if (isNew && ring.area() < LeastArea)
  {
    this->LostArea += ring.area();
    return;
  }
  this->PiecesOpen += candidate == Open ? 1 : 0;
  const double least = candidate == Open ? 0.0
                                         : std::max(this->candidates()[candidate]->leastInverse,
                                             leastOf(ring, this->candidates()[candidate]->inverse));
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
  this->Numbers.assign(this->candidates().size(), Open);
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
      number = static_cast<std::uint32_t>(found.surfaces.size());
      found.surfaces.push_back(*this->candidates()[piece.candidate]);
    }
    found.corners.insert(found.corners.end(), ring.corners, ring.corners + ring.size);
    found.polygons.push_back({ number, static_cast<std::uint32_t>(found.corners.size()) });
  }
  found.lost = this->LostArea / Pi;
  found.facing = this->isFacing(found);
}

PolygonFinder::Facet PolygonFinder::facetOf(const PlaneSurface& surface)
{
  Facet facet;
  facet.size = 0;
  const auto add = [&](const Corners& t)
  {
    for (const Vec3* corner : { &t.a, &t.b, &t.c })
    {
      facet.corners[facet.size++] = *corner;
    }
  };
  const Corners corners = this->Entering.cornersOf(surface.triangle);
  const TrianglePlane plane = planeOf(corners);
  add(corners);
  facet.normal = (plane.height > 0.0 ? -1.0 : 1.0) /
    std::sqrt(glm::dot(plane.normal, plane.normal)) * plane.normal;
  facet.height = surface.height;
  if (surface.other != NoTriangle)
  {
    add(this->Entering.cornersOf(surface.other));
  }
  return facet;
}

/// True if each of two visible surfaces has a corner before the plane of the other.
bool PolygonFinder::isFacing(const VisiblePolygons& found)
{
  this->Facets.clear();
  for (const PlaneSurface& surface : found.surfaces)
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
