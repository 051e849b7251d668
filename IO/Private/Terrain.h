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
/// What a polygon and a triangle of a terrain share in plan, and the triangle's plane:
/// z = a x + b y + c, less `center`.
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

/// Triangles that cover each place in plan once at most; vertical triangles are ignored. GEOS's
/// tree of boxes finds triangles near a place.
class Terrain
{
public:
  /// Throws Error where some triangles face up and others down, as those of a closed body.
  Terrain(const std::string& name, const Mesh& mesh);

  /// A valid polygon, cut along the edges of the terrain, without its part beyond the terrain and
  /// pieces below 1e-6 m2 or narrower than 1e-4 m (area over half the perimeter).
  std::vector<TerrainPiece> Cut(const Polygon& polygon) const;
  /// The height at a place; none beyond the terrain.
  std::optional<double> HeightAt(const Vec2& place) const;

private:
  std::vector<const TerrainPiece*> Near(const GEOSGeometry* place) const;

  Geos Context;
  std::vector<TerrainPiece> Faces; ///< whole triangles, anticlockwise
  std::unique_ptr<GEOSSTRtree, std::function<void(GEOSSTRtree*)>> Tree;
};

/// The lowest point of pieces, of which there is one at least.
double LowestOf(const std::vector<TerrainPiece>& pieces);
}

#endif
