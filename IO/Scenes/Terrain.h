// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Terrain.h
 * @brief Surface of triangles on which footprints stand.
 */
#ifndef AvianLidarTerrain_h
#define AvianLidarTerrain_h

#include "Polygons.h"
#include "SceneTypes.h"

namespace avianlidar::scene
{
/// Intersection, in plan, of a polygon with a triangle of a terrain, and the plane of the triangle:
/// z = a x + b y + c, with x and y relative to `center`.
struct TerrainPiece
{
  Polygon polygon;
  Vec2 center{};
  Point3 plane{};

  double HeightAt(const Vec2& p) const
  {
    return this->plane[0] * (p[0] - this->center[0]) + this->plane[1] * (p[1] - this->center[1]) +
      this->plane[2];
  }
};

/// Triangles that cover each place in plan at most once. Vertical triangles are ignored. GEOS's STR
/// tree finds the triangles near a place.
class Terrain
{
public:
  /// Throws Error if some triangles face up and others face down, as in a closed body.
  Terrain(const std::string& name, const Mesh& mesh);

  /// Cuts a valid polygon along the edges of the terrain. Leaves out the part beyond the terrain,
  /// and pieces smaller than 1e-6 m2 or narrower than 1e-4 m (area over half the perimeter).
  std::vector<TerrainPiece> Cut(const Polygon& polygon) const;
  /// Returns the height at a place, m, or no value beyond the terrain.
  std::optional<double> HeightAt(const Vec2& place) const;

private:
  std::vector<const TerrainPiece*> Near(const GEOSGeometry* place) const;

  Geos Context;
  std::vector<TerrainPiece> Faces; ///< whole triangles, anticlockwise in plan
  std::unique_ptr<GEOSSTRtree, std::function<void(GEOSSTRtree*)>> Tree;
};

/// Returns the height of the lowest point of the pieces, m. There must be at least one piece.
double LowestOf(const std::vector<TerrainPiece>& pieces);
}

#endif
