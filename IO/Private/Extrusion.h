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

/// A sheet that follows a terrain: pieces with a common edge share its vertices.
Sheet Join(const std::vector<TerrainPiece>& pieces);

/**
 * Add a solid from `base` to `base + height` above a sheet: roof, floor (of the roof's material, as
 * it is never seen) and facades, normals outwards, closed: every edge belongs to two triangles.
 *
 * A glazed facade of length L has n = max(1, round(L / bay)) bays of equal width, each with one
 * centred strip of glass whose area is `share` of the bay's. Plinth and cornice, min(2 %, (1 -
 * share) / 4) of the height each, stay facade, so that the facade meets roof and ground in whole
 * edges. Share 1: all glass; share 0: none.
 */
void AddSolid(
  const Sheet& sheet, double base, double height, const ExtrusionMaterials& materials, Mesh& mesh);

/// Add a sheet, raised, as an area seen from above.
void AddFlat(const Sheet& sheet, double height, int material, Mesh& mesh);
}

#endif
