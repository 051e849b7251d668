// SPDX-License-Identifier: BSD-3-Clause
#include "EffectiveArea.h"

#include "BeamTracer.h"
#include "CollisionTreeBuilder.h"
#include "Random.h"
#include "VisiblePolygons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace avianlidar
{
namespace
{
/// What is shown, and where: second moments of its place about the center, weighted by it.
struct SideShown
{
  double area = 0.0;       ///< m^2
  double horizontal = 0.0; ///< m^4, across the line of sight
  double vertical = 0.0;   ///< m^4, likewise
  double depth = 0.0;      ///< m^4, along it
};

/// Mean of the square of a linear function over a triangle that has these values at its corners.
double meanSquare(double a, double b, double c)
{
  return (a * a + b * b + c * c + (a + b + c) * (a + b + c)) / 12.0;
}

/// The cone about the sphere of an object. @return false if there is none, or a wide one
bool frameOf(const Vec3& center, double radius, const Vec3& observer, BeamFrame& frame)
{
  const Vec3 to = center - observer;
  const double distance = safeLength(to);
  if (!(radius < distance))
  {
    return false;
  }
  const double half = std::asin(radius / distance);
  frame = makeBeamFrame(observer, to, half);
  return half > 0.0 && half < Pi / 3.0;
}

SideShown shownOf(const std::shared_ptr<const TriangleMesh>& mesh, const Vec3& center,
  double radius, const Vec3& observer)
{
  const SideShown nothing{ std::numeric_limits<double>::quiet_NaN() };
  BeamFrame frame;
  if (!frameOf(center, radius, observer, frame))
  {
    return nothing;
  }
  const Vec3 to = center - observer;
  const double distance = safeLength(to);
  CollisionTree tree;
  tree.mesh = mesh;
  constexpr std::size_t few = 16; // pieces of a few triangles may be more than three times as many
  PolygonFinder finder(tree, mesh->size() + few);
  std::vector<std::uint32_t> triangles(mesh->size());
  std::iota(triangles.begin(), triangles.end(), 0u);
  finder.begin(frame);
  finder.add(triangles.data(), triangles.size());
  std::unique_ptr<VisiblePolygons> seen;
  const SeenByBeam found = finder.find(seen);
  if (found != SeenByBeam::Polygons)
  {
    return found == SeenByBeam::Nothing ? SideShown() : nothing;
  }
  const Vec3 axis = to / distance;
  const Vec3 across = glm::cross(axis, Vec3(0.0, 0.0, 1.0));
  const Vec3 right = glm::dot(across, across) > 0.0 ? unitVector(across) : frame.e1;
  const Vec3 up = glm::cross(right, axis);
  SideShown sum;
  seen->forEach(
    [&](const PlaneSurface& surface, const PlaneRing& ring)
    {
      PlanePoint middle{ 0.0, 0.0 };
      for (int i = 0; i < ring.size; ++i)
      {
        middle.x += ring.corners[i].x / ring.size;
        middle.y += ring.corners[i].y / ring.size;
      }
      const double away = safeLength(frame.direction(middle.x, middle.y));
      const double range = away / surface.inverse.at(middle);
      const double solidAngle = ring.area() * frame.tanHalf * frame.tanHalf / (away * away * away);
      const double area = range * range * solidAngle * (std::fabs(surface.height) / range);
      sum.area += area;
      // Where on the object, by a fan of triangles about the middle.
      const auto placeOf = [&](const PlanePoint& p)
      {
        const Vec3 d = frame.direction(p.x, p.y);
        const double far = safeLength(d) / surface.inverse.at(p);
        return Vec3(distance * glm::dot(d, right), distance * glm::dot(d, up), far - distance);
      };
      const Vec3 m = placeOf(middle);
      for (int i = 0; i < ring.size; ++i)
      {
        const PlanePoint& p = ring.corners[i];
        const PlanePoint& q = ring.corners[(i + 1) % ring.size];
        const double part = 0.5 *
          std::fabs((p.x - middle.x) * (q.y - middle.y) - (q.x - middle.x) * (p.y - middle.y));
        const double share = area * part / ring.area();
        const Vec3 a = placeOf(p);
        const Vec3 b = placeOf(q);
        sum.horizontal += share * meanSquare(m.x, a.x, b.x);
        sum.vertical += share * meanSquare(m.y, a.y, b.y);
        sum.depth += share * meanSquare(m.z, a.z, b.z);
      }
    });
  return sum;
}

/// Sums what rays see of an object, one in each cell of a rectangle of the plane about it.
class AreaByRays
{
public:
  AreaByRays(std::shared_ptr<const CollisionTree> tree, const BeamFrame& frame)
    : Tree(std::move(tree))
    , Tracer(*this->Tree)
    , Frame(frame)
  {
    for (const Vec3& point : this->Tree->mesh->points)
    {
      const Vec3 p = frame.toPlane(point - frame.origin);
      this->Low = { std::min(this->Low.x, p.x / p.z), std::min(this->Low.y, p.y / p.z) };
      this->High = { std::max(this->High.x, p.x / p.z), std::max(this->High.y, p.y / p.z) };
    }
  }

  double sum(const std::function<bool()>& wanted)
  {
    double area = 0.0;
    for (int row = 0; row < Aside; row += Tile)
    {
      if (wanted && !wanted())
      {
        throw WorkStopped();
      }
      area += this->sumOfRows(row);
    }
    const double cell =
      (this->High.x - this->Low.x) * (this->High.y - this->Low.y) / (Aside * Aside);
    return area * cell * this->Frame.tanHalf * this->Frame.tanHalf;
  }

private:
  static constexpr int Aside = 512; ///< cells
  static constexpr int Tile = 8;    ///< likewise, of the rays of a packet

  /// The sum of range^2 cos(incidence) / |direction|^3 over the cells of `Tile` rows.
  double sumOfRows(int row)
  {
    this->Rays.resize(0);
    for (int place = 0; place < Aside * Tile; ++place)
    {
      const int i = place / (Tile * Tile) * Tile + place % Tile;
      const int j = row + place / Tile % Tile;
      const auto u =
        uniformPair(0, 0, static_cast<std::uint64_t>(j) * Aside + i, RandomPurpose::Rays);
      const double x = this->Low.x + (this->High.x - this->Low.x) * (i + u[0]) / Aside;
      const double y = this->Low.y + (this->High.y - this->Low.y) * (j + u[1]) / Aside;
      if (x * x + y * y < 1.0)
      {
        this->Rays.x.push_back(x);
        this->Rays.y.push_back(y);
      }
    }
    const auto count = static_cast<std::uint32_t>(this->Rays.size());
    const BeamBlock block{ &this->Frame, 1, count,
      [this](std::size_t) -> const BeamRays& { return this->Rays; }, nullptr, true };
    const std::uint32_t* const hits =
      count > 0 ? this->Tracer.traceBlock(block, TraceMode::Automatic).triangles[0] : nullptr;
    double sum = 0.0;
    for (std::uint32_t k = 0; hits && k < count; ++k)
    {
      sum += hits[k] == NoTriangle ? 0.0 : this->shownBy(hits[k], this->Rays.x[k], this->Rays.y[k]);
    }
    return sum;
  }

  double shownBy(std::uint32_t triangle, double x, double y)
  {
    if (triangle != this->Number)
    {
      this->Number = triangle;
      this->Seen = seeTriangle(*this->Tree->mesh, triangle, this->Frame.origin);
    }
    const Vec3 along = this->Frame.direction(x, y);
    const double away = safeLength(along);
    const Vec3 d = along / away;
    const double range = rangeOnTriangle(this->Seen, this->Frame, d);
    return range * range * std::fabs(glm::dot(this->Seen.normal, d)) / (away * away * away);
  }

  std::shared_ptr<const CollisionTree> Tree;
  BeamTracer Tracer;
  const BeamFrame Frame;
  PlanePoint Low{ 1.0, 1.0 };
  PlanePoint High{ -1.0, -1.0 };
  BeamRays Rays;
  std::uint32_t Number = NoTriangle;
  SeenTriangle Seen;
};
}

double effectiveArea(const std::shared_ptr<const TriangleMesh>& mesh, const Vec3& center,
  double radius, const Vec3& observer, const std::function<bool()>& wanted)
{
  const double exact = mesh->size() <= MostTrianglesExact
    ? shownOf(mesh, center, radius, observer).area
    : std::numeric_limits<double>::quiet_NaN();
  BeamFrame frame;
  if (!std::isnan(exact) || !frameOf(center, radius, observer, frame))
  {
    return exact;
  }
  const auto tree = buildCollisionTree(
    mesh, TreeOptions{}, [&](double) { return !wanted || wanted(); }, 1);
  if (!tree)
  {
    throw WorkStopped();
  }
  return AreaByRays(tree, frame).sum(wanted);
}

BirdAreas effectiveAreas(const BirdShape& shape, bool gliding)
{
  // The left is as the right: half a turn holds all headings.
  constexpr int headings = 24;
  constexpr int phases = 24;
  constexpr int parts = 24;
  const double radius = 0.5 * shape.bodyLength + shape.bodyDiameter + shape.wingLength;
  const double distance = 1000.0 * radius;
  const double elevation = 3.0 * Pi / 180.0;
  std::vector<SideShown> all;
  for (int phase = 0; phase < (gliding ? 1 : phases); ++phase)
  {
    const auto bird =
      std::make_shared<TriangleMesh>(wholeBird(shape, wingAngle((phase + 0.5) / phases, gliding)));
    for (int heading = 0; heading < headings; ++heading)
    {
      const double angle = Pi * (heading + 0.5) / headings;
      const Vec3 observer = distance *
        Vec3(std::cos(elevation) * std::sin(angle), std::cos(elevation) * std::cos(angle),
          -std::sin(elevation));
      all.push_back(shownOf(bird, Vec3(0.0), radius, observer));
    }
  }
  std::sort(all.begin(), all.end(),
    [](const SideShown& a, const SideShown& b)
    { return std::isnan(b.area) ? !std::isnan(a.area) : a.area < b.area; });
  BirdAreas result{};
  for (const SideShown& shown : all)
  {
    result.mean += shown.area / static_cast<double>(all.size());
  }
  const std::size_t each = all.size() / parts;
  for (std::size_t part = 0; part < parts; ++part)
  {
    SideShown sum;
    for (std::size_t i = part * each; i < (part + 1) * each; ++i)
    {
      sum.area += all[i].area;
      sum.horizontal += all[i].horizontal;
      sum.vertical += all[i].vertical;
      sum.depth += all[i].depth;
    }
    result.poses.push_back(
      { sum.area / (static_cast<double>(each) * result.mean), std::sqrt(sum.horizontal / sum.area),
        std::sqrt(sum.vertical / sum.area), std::sqrt(sum.depth / sum.area) });
  }
  return result;
}
}
