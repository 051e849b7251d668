// SPDX-License-Identifier: BSD-3-Clause
#include "PolygonTriangulation.h"

#include "Figures.h"

#include <GL/glu.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace avianlidar
{
namespace
{
// Area of a polygon without area, as a share of the square of the perimeter.
constexpr double NoArea = 1e-14;
// Greatest coordinate of a polygon that is divided; GLU accepts 1e150.
constexpr double Most = 1e30;
// Greatest number of flips of edges for each triangle, so that the time is linear.
constexpr std::size_t MostFlips = 32;
// Greatest number of polygons that a sentence names.
constexpr std::int64_t ListedPolygons = 5;

// GLU passes a corner as a pointer, and null for no corner.
void* ToPointer(std::size_t corner)
{
  return reinterpret_cast<void*>(corner + 1);
}

std::size_t FromPointer(void* pointer)
{
  return reinterpret_cast<std::size_t>(pointer) - 1;
}

// Calls f(from, to) for each edge of the rings.
template <class F>
void ForEdges(const std::vector<std::size_t>& ends, F f)
{
  std::size_t begin = 0;
  for (const std::size_t end : ends)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      f(i, i + 1 < end ? i + 1 : begin);
    }
    begin = end;
  }
}

double TwiceArea(const Vec3& a, const Vec3& b, const Vec3& c)
{
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// An edge between two triangles: number of a triangle, and of the edge's first corner.
struct Side
{
  std::int64_t triangle = -1;
  int corner = 0;
};

// Triangles beyond the edges of triangles.
class Neighbours
{
public:
  explicit Neighbours(const std::vector<PolygonTriangulation::Triangle>& triangles)
    : Beyond(triangles.size())
  {
    std::vector<std::pair<std::array<std::int64_t, 2>, Side>> edges;
    for (std::size_t t = 0; t < triangles.size(); ++t)
    {
      for (int k = 0; k < 3; ++k)
      {
        const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
        edges.push_back({ { low, high }, { static_cast<std::int64_t>(t), k } });
      }
    }
    std::sort(edges.begin(), edges.end(),
      [](const auto& a, const auto& b)
      {
        return std::tie(a.first, a.second.triangle, a.second.corner) <
          std::tie(b.first, b.second.triangle, b.second.corner);
      });
    for (std::size_t i = 0, end = 0; i < edges.size(); i = end)
    {
      while (end < edges.size() && edges[end].first == edges[i].first)
      {
        ++end;
      }
      const auto from = [&](const Side& side) { return triangles[side.triangle][side.corner]; };
      if (end - i == 2 && from(edges[i].second) != from(edges[i + 1].second))
      {
        this->Join(edges[i].second, edges[i + 1].second); // other edges are on the outline
      }
    }
  }

  Side& operator[](const Side& side) { return this->Beyond[side.triangle][side.corner]; }

  void Join(const Side& one, const Side& other)
  {
    (*this)[one] = other;
    if (other.triangle >= 0)
    {
      (*this)[other] = one;
    }
  }

private:
  std::vector<std::array<Side, 3>> Beyond;
};

// Returns whether the edge ab between the triangles abc and bad must be flipped: the sum of the
// angles at c and d exceeds pi, and the new triangles have areas.
bool MustFlip(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d)
{
  constexpr double least = 1e-12; // sine, so that rounding does not flip an edge for ever
  const auto scalar = [](const Vec3& o, const Vec3& p, const Vec3& q)
  { return (p.x - o.x) * (q.x - o.x) + (p.y - o.y) * (q.y - o.y); };
  const double sc = TwiceArea(c, a, b), cc = scalar(c, a, b);
  const double sd = TwiceArea(d, b, a), cd = scalar(d, b, a);
  return sc * cd + cc * sd < -least * std::hypot(sc, cc) * std::hypot(sd, cd) &&
    TwiceArea(c, a, d) > 0.0 && TwiceArea(d, b, c) > 0.0;
}
}

//------------------------------------------------------------------------------
PolygonTriangulation::PolygonTriangulation()
  : Tessellator(gluNewTess(), &gluDeleteTess)
{
  if (!this->Tessellator)
  {
    throw std::bad_alloc();
  }
  using Self = PolygonTriangulation;
  using Callback = void (*)();
  const auto set = [this](GLenum which, auto* callback)
  { gluTessCallback(this->Tessellator.get(), which, reinterpret_cast<Callback>(callback)); };
  set(
    GLU_TESS_VERTEX_DATA,
    +[](void* corner, void* self)
    {
      try
      {
        static_cast<Self*>(self)->Swept.push_back(FromPointer(corner));
      }
      catch (...)
      {
        static_cast<Self*>(self)->Failure = std::current_exception();
      }
    });
  set(
    GLU_TESS_COMBINE_DATA,
    +[](GLdouble* place, void** near, GLfloat* weights, void** point, void* self)
    {
      *point = near[0];
      try
      {
        static_cast<Self*>(self)->AddPoint(place, near, weights, point);
      }
      catch (...)
      {
        static_cast<Self*>(self)->Failure = std::current_exception();
      }
    });
  set(
    GLU_TESS_ERROR_DATA,
    +[](GLenum error, void* self) { static_cast<Self*>(self)->ErrorOfGlu = error; });
  // With this callback, even an empty one, GLU gives triangles instead of strips and fans.
  set(
    GLU_TESS_EDGE_FLAG_DATA, +[](GLboolean, void*) {});
  gluTessProperty(this->Tessellator.get(), GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_ODD);
  gluTessNormal(this->Tessellator.get(), 0.0, 0.0, 1.0);
}

//------------------------------------------------------------------------------
void PolygonTriangulation::Divide(
  const std::vector<Vec3>& corners, const std::vector<std::size_t>& ends)
{
  this->Triangles.clear();
  this->Added.clear();
  this->OutlineArea = this->TriangleArea = 0.0;
  if (!this->Project(corners, ends))
  {
    return;
  }
  if (ends.size() > 1 || corners.size() != 4 || !this->DivideQuadrilateral())
  {
    this->Sweep(ends);
    this->FlipEdges();
  }
  for (const Triangle& t : this->Triangles)
  {
    this->TriangleArea +=
      0.5 * std::abs(TwiceArea(this->Plane[t[0]], this->Plane[t[1]], this->Plane[t[2]]));
  }
}

//------------------------------------------------------------------------------
/// Projects the corners onto the mean plane, whose normal is that of the vector area. Returns false
/// if there is nothing to divide.
bool PolygonTriangulation::Project(
  const std::vector<Vec3>& corners, const std::vector<std::size_t>& ends)
{
  if (corners.size() < 3)
  {
    return false;
  }
  this->Origin = corners[0];
  Vec3 area(0.0);
  this->Perimeter = this->Largest = 0.0;
  ForEdges(ends,
    [&](std::size_t i, std::size_t next)
    {
      const Vec3 p = corners[i] - this->Origin;
      const Vec3 q = corners[next] - this->Origin;
      area += 0.5 * cross(p, q);
      this->Perimeter += safeLength(q - p);
      this->Largest = std::max(
        { this->Largest, std::abs(corners[i].x), std::abs(corners[i].y), std::abs(corners[i].z) });
    });
  if (!isFinite(area) || !std::isfinite(this->Perimeter * this->Perimeter) || this->Largest > Most)
  {
    this->Perimeter = this->Largest = 0.0;
    for (std::size_t i = 2; i < corners.size(); ++i)
    {
      const auto corner = static_cast<std::int64_t>(i);
      this->Triangles.push_back({ 0, corner - 1, corner });
    }
    return false;
  }
  this->OutlineArea = safeLength(area);
  const double least = NoArea * this->Perimeter * this->Perimeter;
  if (this->OutlineArea <= least)
  {
    // The corners lie on a line, or parts of opposite sense cancel. The plane is that of the corner
    // farthest from the first, and of the corner farthest from the line through these two.
    const auto farthest = [&](auto distance)
    {
      return *std::max_element(corners.begin(), corners.end(),
        [&](const Vec3& a, const Vec3& b) { return distance(a) < distance(b); });
    };
    const Vec3 first =
      farthest([&](const Vec3& p) { return safeLength(p - this->Origin); }) - this->Origin;
    const Vec3 second =
      farthest([&](const Vec3& p) { return safeLength(cross(first, p - this->Origin)); });
    area = cross(first, second - this->Origin);
    if (safeLength(area) <= least)
    {
      this->OutlineArea = 0.0;
      return false;
    }
  }
  const Vec3 normal = unitVector(area);
  int axis = 0; // the coordinate axis that is farthest from the normal
  for (int k = 1; k < 3; ++k)
  {
    axis = std::abs(normal[k]) < std::abs(normal[axis]) ? k : axis;
  }
  Vec3 along(0.0);
  along[axis] = 1.0;
  along = unitVector(along - normal[axis] * normal);
  this->Axes = { along, cross(normal, along), normal };
  this->Plane.resize(corners.size());
  std::transform(corners.begin(), corners.end(), this->Plane.begin(),
    [this](const Vec3& corner)
    {
      const Vec3 p = corner - this->Origin;
      return Vec3(dot(p, this->Axes[0]), dot(p, this->Axes[1]), dot(p, this->Axes[2]));
    });
  return true;
}

//------------------------------------------------------------------------------
/// Divides a quadrilateral along the shorter diagonal inside. Returns false without such diagonal.
bool PolygonTriangulation::DivideQuadrilateral()
{
  const auto& p = this->Plane;
  const auto square = [&p](std::size_t a, std::size_t b)
  { return std::pow(p[b].x - p[a].x, 2) + std::pow(p[b].y - p[a].y, 2); };
  const std::int64_t shorter = square(1, 3) <= square(0, 2);
  for (const std::int64_t k : { shorter, 1 - shorter }) // the diagonal begins at this corner
  {
    const Triangle first{ k, k + 1, k + 2 };
    const Triangle second{ k, k + 2, (k + 3) % 4 };
    if (TwiceArea(p[first[0]], p[first[1]], p[first[2]]) > 0.0 &&
      TwiceArea(p[second[0]], p[second[1]], p[second[2]]) > 0.0)
    {
      this->Triangles = { first, second };
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
void PolygonTriangulation::Sweep(const std::vector<std::size_t>& ends)
{
  this->Swept.clear();
  this->Failure = nullptr;
  this->ErrorOfGlu = 0;
  GLUtesselator* tessellator = this->Tessellator.get();
  gluTessBeginPolygon(tessellator, this);
  std::size_t corner = 0;
  for (const std::size_t end : ends)
  {
    gluTessBeginContour(tessellator);
    for (; corner < end; ++corner)
    {
      GLdouble place[3] = { this->Plane[corner].x, this->Plane[corner].y, 0.0 };
      gluTessVertex(tessellator, place, ToPointer(corner));
    }
    gluTessEndContour(tessellator);
  }
  gluTessEndPolygon(tessellator);
  if (this->Failure)
  {
    std::rethrow_exception(this->Failure);
  }
  if (this->ErrorOfGlu == GLU_OUT_OF_MEMORY)
  {
    throw std::bad_alloc();
  }
  if (this->ErrorOfGlu != 0)
  {
    throw std::runtime_error(
      "GLU cannot divide a polygon: error " + std::to_string(this->ErrorOfGlu));
  }
  for (std::size_t i = 0; i + 2 < this->Swept.size(); i += 3)
  {
    Triangle triangle;
    std::copy_n(this->Swept.begin() + static_cast<std::ptrdiff_t>(i), 3, triangle.begin());
    if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
    {
      this->Triangles.push_back(triangle);
    }
  }
}

//------------------------------------------------------------------------------
/// Flips edges until the triangles are Delaunay. Polygons of many corners may keep some edges.
void PolygonTriangulation::FlipEdges()
{
  Neighbours beyond(this->Triangles);
  std::vector<Side> edges;
  for (std::size_t t = 0; t < this->Triangles.size(); ++t)
  {
    for (int k = 0; k < 3; ++k)
    {
      edges.push_back({ static_cast<std::int64_t>(t), k });
    }
  }
  std::size_t left = MostFlips * this->Triangles.size();
  while (!edges.empty() && left > 0)
  {
    const Side one = edges.back();
    edges.pop_back();
    const Side other = beyond[one];
    if (other.triangle < 0)
    {
      continue;
    }
    Triangle& first = this->Triangles[one.triangle];
    Triangle& second = this->Triangles[other.triangle];
    const auto next = [](const Side& side, int steps) {
      return Side{ side.triangle, (side.corner + steps) % 3 };
    };
    const std::int64_t a = first[one.corner], b = first[(one.corner + 1) % 3];
    const std::int64_t c = first[(one.corner + 2) % 3], d = second[(other.corner + 2) % 3];
    if (!MustFlip(this->Plane[a], this->Plane[b], this->Plane[c], this->Plane[d]))
    {
      continue;
    }
    --left;
    const Side bc = beyond[next(one, 1)], ca = beyond[next(one, 2)];
    const Side ad = beyond[next(other, 1)], db = beyond[next(other, 2)];
    first = { c, a, d };
    second = { d, b, c };
    beyond.Join({ one.triangle, 0 }, ca);
    beyond.Join({ one.triangle, 1 }, ad);
    beyond.Join({ one.triangle, 2 }, { other.triangle, 2 });
    beyond.Join({ other.triangle, 0 }, db);
    beyond.Join({ other.triangle, 1 }, bc);
    for (const std::int64_t t : { one.triangle, other.triangle })
    {
      edges.push_back({ t, 0 });
      edges.push_back({ t, 1 });
    }
  }
}

//------------------------------------------------------------------------------
/// Gives GLU the corner in the place where edges meet, or a new point. @param near up to four
/// corners near the place, then null
void PolygonTriangulation::AddPoint(
  const double* place, void* const* near, const float* weights, void** point)
{
  double height = 0.0;
  for (int k = 0; k < 4 && near[k]; ++k)
  {
    const Vec3& p = this->Plane[FromPointer(near[k])];
    if (p.x == place[0] && p.y == place[1])
    {
      *point = near[k];
      return;
    }
    height += weights[k] * p.z;
  }
  *point = ToPointer(this->Plane.size());
  this->Plane.emplace_back(place[0], place[1], height);
  this->Added.push_back(
    this->Origin + place[0] * this->Axes[0] + place[1] * this->Axes[1] + height * this->Axes[2]);
}

//------------------------------------------------------------------------------
bool PolygonTriangulation::IsWhole(double rounding) const
{
  constexpr double tolerance = 1e-6;
  const double own = std::numeric_limits<double>::epsilon() * this->Largest;
  // A corner beside the edge on which it should lie adds slivers on both sides of the edge.
  return std::abs(this->TriangleArea - this->OutlineArea) <=
    tolerance * this->OutlineArea + 2.0 * (rounding + own) * this->Perimeter;
}

//------------------------------------------------------------------------------
void LostAreas::Check(const PolygonTriangulation& polygon, std::int64_t name, double rounding)
{
  if (polygon.IsWhole(rounding))
  {
    return;
  }
  this->Names += this->Count < ListedPolygons ? (this->Count > 0 ? ", " : "") + std::to_string(name)
                                              : std::string();
  if (this->Count++ == 0)
  {
    const double triangles = polygon.GetTriangleArea(), outline = polygon.GetOutlineArea();
    this->Share = figures(100.0 * std::abs(triangles - outline) / std::max(triangles, outline), 2);
  }
}

//------------------------------------------------------------------------------
std::string LostAreas::Sentence(const std::string& kind) const
{
  if (this->Count == 0)
  {
    return {};
  }
  const bool one = this->Count == 1;
  const bool all = this->Count <= ListedPolygons;
  return (one ? "polygon " : std::to_string(this->Count) + " polygons ") + "(" + kind +
    (one ? " " : "s ") + this->Names + (all ? "" : ", ...") + ")" +
    (one ? " crosses or overlaps itself: " : " cross or overlap themselves: ") +
    "the areas of the outline and of the triangles of the first polygon differ by " + this->Share +
    " % of the larger area. What an outline surrounds twice is taken as a hole";
}
}
