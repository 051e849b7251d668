// SPDX-License-Identifier: BSD-3-Clause
#include "Terrain.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar::scene
{
std::array<Vec2, 2> BoxOf(const Ring& ring)
{
  std::array<Vec2, 2> box{ ring.at(0), ring.at(0) };
  for (const Vec2& p : ring)
  {
    for (int i = 0; i < 2; ++i)
    {
      box[0][i] = std::min(box[0][i], p[i]);
      box[1][i] = std::max(box[1][i], p[i]);
    }
  }
  return box;
}

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
  constexpr double vertical = 1e-6; // of a triangle's area in plan
  Ring corners;
  bool up = false;
  bool down = false;
  for (const auto& [a, b, c] : mesh.triangles)
  {
    const Vec3 &p = mesh.points[a], &q = mesh.points[b], &r = mesh.points[c];
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
    corners.insert(corners.end(), ring.begin(), ring.end());
    const Vec3 plane{ (uz * vy - uy * vz) / twice, (ux * vz - uz * vx) / twice, p[2] };
    this->Planes.push_back({ {}, ring[0], plane });
    if (twice < 0)
    {
      std::swap(ring[1], ring[2]);
    }
    this->Triangles.push_back(std::move(ring));
  }
  if (up && down)
  {
    throw Error(name +
      " has triangles that face up and others that face down, expected a surface "
      "that covers each place in plan once at most");
  }
  if (corners.empty())
  {
    return;
  }
  this->Low = BoxOf(corners)[0];
  this->High = BoxOf(corners)[1];
  this->Size = static_cast<std::size_t>(std::ceil(std::sqrt(this->Triangles.size())));
  this->Cells.resize(this->Size * this->Size);
  for (std::size_t i = 0; i < this->Triangles.size(); ++i)
  {
    this->Insert(i);
  }
}

// Into the cells that it meets: all of its box would be too many of long triangles.
void Terrain::Insert(std::size_t number)
{
  constexpr double rounding = 1e-6; // of a cell
  const Ring& triangle = this->Triangles[number];
  const auto [low, high] = BoxOf(triangle);
  const double width = (this->High[0] - this->Low[0]) / static_cast<double>(this->Size);
  const double height = (this->High[1] - this->Low[1]) / static_cast<double>(this->Size);
  const std::size_t lastY = this->CellOf(high)[1];
  for (std::size_t y = this->CellOf(low)[1]; y <= lastY; ++y)
  {
    const double bottom = this->Low[1] + (static_cast<double>(y) - rounding) * height;
    const double top = this->Low[1] + (static_cast<double>(y + 1) + rounding) * height;
    double left = this->High[0];
    double right = this->Low[0];
    for (std::size_t i = 0; i < 3; ++i)
    {
      const Vec2 &a = triangle[i], &b = triangle[(i + 1) % 3];
      if (a[1] == b[1] || std::max(a[1], b[1]) < bottom || std::min(a[1], b[1]) > top)
      {
        continue;
      }
      for (const double end : { a[1], b[1] })
      {
        const double share = (std::clamp(end, bottom, top) - a[1]) / (b[1] - a[1]);
        left = std::min(left, a[0] + share * (b[0] - a[0]));
        right = std::max(right, a[0] + share * (b[0] - a[0]));
      }
    }
    const std::size_t lastX = this->CellOf({ right + rounding * width, top })[0];
    for (std::size_t x = this->CellOf({ left - rounding * width, top })[0]; x <= lastX; ++x)
    {
      this->Cells[y * this->Size + x].push_back(number);
    }
  }
}

std::array<std::size_t, 2> Terrain::CellOf(const Vec2& p) const
{
  std::array<std::size_t, 2> cell{};
  const auto most = static_cast<double>(this->Size - 1);
  for (int i = 0; i < 2; ++i)
  {
    const double share = (p[i] - this->Low[i]) / (this->High[i] - this->Low[i]);
    cell[i] = static_cast<std::size_t>(
      std::clamp(std::floor(share * static_cast<double>(this->Size)), 0.0, most));
  }
  return cell;
}

std::vector<std::size_t> Terrain::Near(const Vec2& low, const Vec2& high) const
{
  std::vector<std::size_t> found;
  if (this->Cells.empty() || high[0] < this->Low[0] || high[1] < this->Low[1] ||
    low[0] > this->High[0] || low[1] > this->High[1])
  {
    return found;
  }
  const auto [firstX, firstY] = this->CellOf(low);
  const auto [lastX, lastY] = this->CellOf(high);
  for (std::size_t y = firstY; y <= lastY; ++y)
  {
    for (std::size_t x = firstX; x <= lastX; ++x)
    {
      const auto& cell = this->Cells[y * this->Size + x];
      found.insert(found.end(), cell.begin(), cell.end());
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::vector<TerrainPiece> Terrain::Cut(const Polygon& polygon) const
{
  const auto [low, high] = BoxOf(polygon.rings.at(0));
  const std::vector<std::size_t> near = this->Near(low, high);
  std::vector<Ring> triangles;
  for (const std::size_t i : near)
  {
    triangles.push_back(this->Triangles[i]);
  }
  std::vector<TerrainPiece> pieces;
  std::vector<std::vector<Polygon>> shared = CutToTriangles(polygon, triangles);
  for (std::size_t i = 0; i < near.size(); ++i)
  {
    for (Polygon& part : shared[i])
    {
      pieces.push_back(this->Planes[near[i]]);
      pieces.back().polygon = std::move(part);
    }
  }
  return pieces;
}

std::optional<double> Terrain::HeightAt(const Vec2& place) const
{
  for (const std::size_t i : this->Near(place, place))
  {
    const Ring& t = this->Triangles[i];
    if (SignedArea({ t[0], t[1], place }) >= 0 && SignedArea({ t[1], t[2], place }) >= 0 &&
      SignedArea({ t[2], t[0], place }) >= 0)
    {
      return this->Planes[i].HeightAt(place);
    }
  }
  return {};
}
}
