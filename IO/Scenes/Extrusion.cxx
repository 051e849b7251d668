// SPDX-License-Identifier: BSD-3-Clause
#include "Extrusion.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace avianlidar::scene
{
namespace
{
using Index = std::int64_t;

void AddTriangle(Mesh& mesh, Index a, Index b, Index c, int material)
{
  mesh.triangles.push_back({ a, b, c });
  mesh.materials.push_back(material);
}

Index AddPoint(Mesh& mesh, const Point3& p)
{
  mesh.points.push_back(p);
  return static_cast<Index>(mesh.points.size()) - 1;
}

// Adds the vertices of a sheet, raised by `height`, m. Returns the index of the first vertex.
Index AddRaised(const Sheet& sheet, double height, Mesh& mesh)
{
  const auto first = static_cast<Index>(mesh.points.size());
  for (const Point3& p : sheet.points)
  {
    mesh.points.push_back({ p[0], p[1], p[2] + height });
  }
  return first;
}

// Corners of a facade, seen from outside.
struct Facade
{
  Index bottomLeft, bottomRight, topLeft, topRight;
};

// Adds triangles between a long edge and a row of opposite vertices. Each vertex of the row is
// joined to the nearer end of the edge. With `turn` the row lies below the edge, seen with the
// first vertex of the row on the left, and the sense of the triangles is reversed.
void AddBand(
  Index left, Index right, const std::vector<Index>& row, bool turn, int material, Mesh& mesh)
{
  const std::size_t middle = row.size() / 2;
  for (std::size_t i = 0; i + 1 < row.size(); ++i)
  {
    const Index corner = i < middle ? left : right;
    turn ? AddTriangle(mesh, corner, row[i], row[i + 1], material)
         : AddTriangle(mesh, corner, row[i + 1], row[i], material);
  }
  turn ? AddTriangle(mesh, left, row[middle], right, material)
       : AddTriangle(mesh, left, right, row[middle], material);
}

// Returns the number of bays of a facade. Throws Error if the number is above 100,000.
int BaysOf(double length, double bay)
{
  constexpr int most = 100000;
  const double bays = std::round(length / bay);
  failIf(!(bays <= most), "a facade of ", length, " m has more than ", most, " bays of ", bay,
    " m: a coordinate or 'bay' is wrong");
  return std::max(1, static_cast<int>(bays));
}

void AddGlazedFacade(const Facade& f, int wall, const Glazing& glazing, Mesh& mesh)
{
  const Point3 p = mesh.points[f.bottomLeft], q = mesh.points[f.bottomRight],
               top = mesh.points[f.topLeft];
  const double margin = std::min(0.02, (1 - glazing.share) / 4);
  const double strip = glazing.share / (1 - 2 * margin);
  const double length = std::hypot(q[0] - p[0], q[1] - p[1]);
  const int bays = BaysOf(length, glazing.bay);
  const double low = p[2] + margin * (top[2] - p[2]);
  const double high = top[2] - margin * (top[2] - p[2]);
  // Vertices on both sides of each strip of glass. The four edges of the facade are not divided,
  // because neighbours share whole edges.
  std::vector<Index> lower, upper;
  for (int bay = 0; bay < bays; ++bay)
  {
    for (const double side : { -0.5, 0.5 })
    {
      const double t = (bay + 0.5 + side * strip) / bays;
      const double x = p[0] + t * (q[0] - p[0]), y = p[1] + t * (q[1] - p[1]);
      lower.push_back(AddPoint(mesh, { x, y, low }));
      upper.push_back(AddPoint(mesh, { x, y, high }));
    }
  }
  AddBand(f.bottomLeft, f.bottomRight, lower, false, wall, mesh);
  AddBand(f.topLeft, f.topRight, upper, true, wall, mesh);
  for (std::size_t i = 0; i + 1 < lower.size(); ++i)
  {
    const int material = i % 2 == 0 ? glazing.material : wall;
    AddTriangle(mesh, lower[i], lower[i + 1], upper[i + 1], material);
    AddTriangle(mesh, lower[i], upper[i + 1], upper[i], material);
  }
  AddTriangle(mesh, f.bottomLeft, lower.front(), upper.front(), wall);
  AddTriangle(mesh, f.bottomLeft, upper.front(), f.topLeft, wall);
  AddTriangle(mesh, f.bottomRight, f.topRight, upper.back(), wall);
  AddTriangle(mesh, f.bottomRight, upper.back(), lower.back(), wall);
}

void AddFacade(const Facade& f, const ExtrusionMaterials& materials, Mesh& mesh)
{
  const double share = materials.glazing ? materials.glazing->share : 0.0;
  if (share > 0 && share < 1)
  {
    AddGlazedFacade(f, materials.facade, *materials.glazing, mesh);
    return;
  }
  const int material = share > 0 ? materials.glazing->material : materials.facade;
  AddTriangle(mesh, f.bottomLeft, f.bottomRight, f.topRight, material);
  AddTriangle(mesh, f.bottomLeft, f.topRight, f.topLeft, material);
}
}

Sheet Join(const std::vector<TerrainPiece>& pieces)
{
  constexpr double same = 1e-4; // distance of vertices that are merged, m
  Sheet sheet;
  std::map<std::array<std::int64_t, 2>, Index> known;
  for (const TerrainPiece& piece : pieces)
  {
    const Sheet plan = Triangulate(piece.polygon);
    std::vector<Index> ids;
    for (const Point3& p : plan.points)
    {
      const auto found = known.emplace(
        std::array<std::int64_t, 2>{ std::llround(p[0] / same), std::llround(p[1] / same) },
        static_cast<Index>(sheet.points.size()));
      if (found.second)
      {
        sheet.points.push_back({ p[0], p[1], piece.HeightAt({ p[0], p[1] }) });
      }
      ids.push_back(found.first->second);
    }
    for (const auto& t : plan.triangles)
    {
      const Index a = ids[t[0]], b = ids[t[1]], c = ids[t[2]];
      if (a != b && b != c && c != a)
      {
        sheet.triangles.push_back({ a, b, c });
      }
    }
  }
  AddOutline(sheet);
  return sheet;
}

void AddSolid(
  const Sheet& sheet, double base, double height, const ExtrusionMaterials& materials, Mesh& mesh)
{
  const Index bottom = AddRaised(sheet, base, mesh);
  const Index top = AddRaised(sheet, base + height, mesh);
  for (const auto& [a, b, c] : sheet.triangles)
  {
    AddTriangle(mesh, top + a, top + b, top + c, materials.roof);
    AddTriangle(mesh, bottom + a, bottom + c, bottom + b, materials.roof);
  }
  for (const auto& [left, right] : sheet.outline)
  {
    AddFacade({ bottom + left, bottom + right, top + left, top + right }, materials, mesh);
  }
}

void AddFlat(const Sheet& sheet, double height, int material, Mesh& mesh)
{
  const Index first = AddRaised(sheet, height, mesh);
  for (const auto& [a, b, c] : sheet.triangles)
  {
    AddTriangle(mesh, first + a, first + b, first + c, material);
  }
}
}
