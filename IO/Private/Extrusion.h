// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Extrusion.h
 * @brief Footprints to triangles: closed solids with glazed facades, and flat areas.
 */
#ifndef AvianLidarExtrusion_h
#define AvianLidarExtrusion_h

#include "Polygons.h"
#include "SceneTypes.h"
#include "Terrain.h"

namespace avianlidar::scene
{
/// Material ids of what an extrusion is made of.
struct ExtrusionMaterials
{
  int facade = 0;
  int roof = 0;
  std::optional<Glazing> glazing;
};

/**
 * Add a solid over a valid polygon, from `base` up to `base + height`: roof, floor (of the roof's
 * material, as it is never seen) and facades, normals outwards, closed: every edge belongs to two
 * triangles.
 *
 * A glazed facade of length L has n = max(1, round(L / bay)) bays of equal width, each with one
 * centred strip of glass whose area is `share` of the bay's. Plinth and cornice, min(2 %, (1 -
 * share) / 4) of the height each, stay facade, so that the facade meets roof and ground in whole
 * edges. Share 1: all glass; share 0: none.
 */
void AddSolid(const Polygon& polygon, double base, double height,
  const ExtrusionMaterials& materials, Mesh& mesh);

/// The same between `base` and `base + height` above a terrain: floor and roof follow it.
void AddSolidOn(const std::vector<TerrainPiece>& pieces, double base, double height,
  const ExtrusionMaterials& materials, Mesh& mesh);

/// Add pieces as an area at a height above a terrain.
void AddFlatOn(const std::vector<TerrainPiece>& pieces, double height, int material, Mesh& mesh);

/// Add a valid polygon as a level area at a height, seen from above.
void AddFlat(const Polygon& polygon, double height, int material, Mesh& mesh);
}

#endif
