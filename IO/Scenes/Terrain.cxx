// SPDX-License-Identifier: BSD-3-Clause
#include "Terrain.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar::scene
{
double LowestOf(const std::vector<TerrainPiece>& pieces)
{
  double lowest = std::numeric_limits<double>::infinity();
  for (const TerrainPiece& piece : pieces)
  {
    for (const Vec2& p : piece.polygon.rings[0])
    {
      lowest = std::min(lowest, piece.HeightAt(p));
    }
  }
  return lowest;
}

Terrain::Terrain(const std::string& name, const Mesh& mesh)
{
  constexpr double vertical = 1e-6; // greatest share of a vertical triangle's area in plan
  bool up = false;
  bool down = false;
  for (const auto& [a, b, c] : mesh.triangles)
  {
    const Point3 &p = mesh.points[a], &q = mesh.points[b], &r = mesh.points[c];
    const double ux = q[0] - p[0], uy = q[1] - p[1], uz = q[2] - p[2];
    const double vx = r[0] - p[0], vy = r[1] - p[1], vz = r[2] - p[2];
    const double twice = ux * vy - uy * vx;
    const double whole = std::hypot(twice, uy * vz - uz * vy, uz * vx - ux * vz);
    if (std::abs(twice) <= vertical * whole)
    {
      continue;
    }
    (twice > 0 ? up : down) = true;
    Ring ring{ { p[0], p[1] }, { q[0], q[1] }, { r[0], r[1] } };
    const Point3 plane{ (uz * vy - uy * vz) / twice, (ux * vz - uz * vx) / twice, p[2] };
    if (twice < 0)
    {
      std::swap(ring[1], ring[2]);
    }
    this->Faces.push_back({ { { ring } }, ring[0], plane });
  }
  failIf(up && down, name,
    " has triangles that face up and others that face down, expected a surface that covers each "
    "place in plan once at most");
  constexpr std::size_t boxesPerNode = 10;
  GEOSContextHandle_t context = this->Context.Get();
  this->Tree = { GEOSSTRtree_create_r(context, boxesPerNode),
    [context](GEOSSTRtree* tree) { GEOSSTRtree_destroy_r(context, tree); } };
  for (TerrainPiece& face : this->Faces)
  {
    GEOSSTRtree_insert_r(
      context, this->Tree.get(), this->Context.MakePolygon(face.polygon).get(), &face);
  }
}

// Returns the faces near a place, in the order of the mesh.
std::vector<const TerrainPiece*> Terrain::Near(const GEOSGeometry* place) const
{
  std::vector<const TerrainPiece*> found;
  GEOSSTRtree_query_r(
    this->Context.Get(), this->Tree.get(), place,
    [](void* face, void* all)
    {
      static_cast<std::vector<const TerrainPiece*>*>(all)->push_back(
        static_cast<const TerrainPiece*>(face));
    },
    &found);
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<TerrainPiece> Terrain::Cut(const Polygon& polygon) const
{
  constexpr double smallestPiece = 1e-6; // area, m2
  constexpr double smallestWidth = 1e-4; // width, m, at which vertices of pieces merge
  GEOSContextHandle_t context = this->Context.Get();
  const Geos::Geometry whole = this->Context.MakePolygon(polygon);
  const std::unique_ptr<const GEOSPreparedGeometry,
    std::function<void(const GEOSPreparedGeometry*)>>
    prepared(GEOSPrepare_r(context, whole.get()),
      [context](const GEOSPreparedGeometry* p) { GEOSPreparedGeom_destroy_r(context, p); });
  std::vector<TerrainPiece> pieces;
  for (const TerrainPiece* face : this->Near(whole.get()))
  {
    const Geos::Geometry triangle = this->Context.MakePolygon(face->polygon);
    if (GEOSPreparedContainsProperly_r(context, prepared.get(), triangle.get()) == 1)
    {
      pieces.push_back(*face);
      continue;
    }
    if (GEOSPreparedIntersects_r(context, prepared.get(), triangle.get()) == 0)
    {
      continue;
    }
    std::vector<Polygon> shared;
    this->Context.Collect(
      this->Context.Own(GEOSIntersection_r(context, whole.get(), triangle.get())).get(), shared);
    for (const Polygon& part : shared)
    {
      Repairs repairs;
      for (Polygon& piece : MakeValid({ part }, false, repairs))
      {
        if (Area(piece) > std::max(smallestPiece, smallestWidth * Perimeter(piece) / 2))
        {
          pieces.push_back({ std::move(piece), face->center, face->plane });
        }
      }
    }
  }
  return pieces;
}

std::optional<double> Terrain::HeightAt(const Vec2& place) const
{
  const Geos::Geometry point =
    this->Context.Own(GEOSGeom_createPointFromXY_r(this->Context.Get(), place[0], place[1]));
  for (const TerrainPiece* face : this->Near(point.get()))
  {
    const Ring& t = face->polygon.rings[0];
    if (SignedArea({ t[0], t[1], place }) >= 0 && SignedArea({ t[1], t[2], place }) >= 0 &&
      SignedArea({ t[2], t[0], place }) >= 0)
    {
      return face->HeightAt(place);
    }
  }
  return {};
}
}
