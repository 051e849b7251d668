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

/// The sum over visible polygons; NaN if there are too many.
double shownOf(const std::shared_ptr<const TriangleMesh>& mesh, const Vec3& center, double radius,
  const Vec3& observer)
{
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  BeamFrame frame;
  if (!frameOf(center, radius, observer, frame))
  {
    return unknown;
  }
  CollisionTree tree;
  tree.mesh = mesh;
  constexpr std::size_t few = 16; // pieces of a few triangles may be more than three times as many
  const SceneTriangles scene(tree);
  PolygonFinder finder(scene, mesh->size() + few);
  std::vector<std::uint32_t> triangles(mesh->size());
  std::iota(triangles.begin(), triangles.end(), 0u);
  finder.begin(frame);
  finder.add(triangles.data(), triangles.size());
  std::unique_ptr<VisiblePolygons> seen;
  const SeenByBeam found = finder.find(seen);
  if (found != SeenByBeam::Polygons)
  {
    return found == SeenByBeam::Nothing ? 0.0 : unknown;
  }
  double sum = 0.0;
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
      sum += range * range * solidAngle * (std::fabs(surface.height) / range);
    });
  return sum;
}

/// Sums what rays see of an object, one in each cell of a rectangle of the plane about it.
class AreaByRays
{
public:
  AreaByRays(std::shared_ptr<const CollisionTree> tree, const BeamFrame& frame)
    : Tree(std::move(tree))
    , Scene(*this->Tree)
    , Tracer(this->Scene)
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
      [this](std::size_t) -> const BeamRays& { return this->Rays; }, true };
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
      this->Seen = seeTriangle(this->Scene, triangle, this->Frame.origin);
    }
    const Vec3 along = this->Frame.direction(x, y);
    const double away = safeLength(along);
    const Vec3 d = along / away;
    const double range = rangeOnTriangle(this->Seen, this->Frame, d);
    return range * range * std::fabs(glm::dot(this->Seen.normal, d)) / (away * away * away);
  }

  std::shared_ptr<const CollisionTree> Tree;
  const SceneTriangles Scene;
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
    ? shownOf(mesh, center, radius, observer)
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

double meanEffectiveArea(const BirdShape& shape, bool gliding)
{
  // The left is as the right: half a turn holds all headings.
  constexpr int headings = 24;
  constexpr int phases = 24;
  const double radius = 0.5 * shape.bodyLength + shape.bodyDiameter + shape.wingLength;
  const double distance = 1000.0 * radius;
  const double elevation = 3.0 * Pi / 180.0;
  double sum = 0.0;
  int count = 0;
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
      sum += shownOf(bird, Vec3(0.0), radius, observer);
      ++count;
    }
  }
  return sum / count;
}
}
