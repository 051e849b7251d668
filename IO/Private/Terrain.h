// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Terrain.h
 * @brief A surface of triangles that footprints stand on.
 */
#ifndef AvianLidarTerrain_h
#define AvianLidarTerrain_h

#include "Polygons.h"
#include "SceneTypes.h"

namespace avianlidar::scene
{
/// What a polygon and a triangle of a terrain share in plan, and the triangle's plane: z = a x + b
/// y
/// + c, less `center`.
struct TerrainPiece
{
  Polygon polygon;
  Vec2 center{};
  Vec3 plane{};

  double HeightAt(const Vec2& p) const
  {
    return this->plane[0] * (p[0] - this->center[0]) + this->plane[1] * (p[1] - this->center[1]) +
      this->plane[2];
  }
};

/**
 * Triangles that cover each place in plan once at most; vertical triangles are ignored. A grid with
 * about one cell per triangle finds triangles near a place.
 */
class Terrain
{
public:
  /// Throws Error where some triangles face up and others down, as those of a closed body.
  Terrain(const std::string& name, const Mesh& mesh);

  /// A valid polygon, cut along the edges of the terrain, without its part beyond the terrain.
  std::vector<TerrainPiece> Cut(const Polygon& polygon) const;
  /// The height at a place; none beyond the terrain.
  std::optional<double> HeightAt(const Vec2& place) const;

private:
  void Insert(std::size_t number);
  std::array<std::size_t, 2> CellOf(const Vec2& p) const;
  std::vector<std::size_t> Near(const Vec2& low, const Vec2& high) const;

  std::vector<Ring> Triangles; // anticlockwise
  std::vector<TerrainPiece> Planes;
  Vec2 Low{};
  Vec2 High{};
  std::size_t Size = 1; // cells along each side
  std::vector<std::vector<std::size_t>> Cells;
};

/// Least and greatest coordinates.
std::array<Vec2, 2> BoxOf(const Ring& ring);
/// The lowest point of pieces, of which there is one at least.
double LowestOf(const std::vector<TerrainPiece>& pieces);
}

#endif
