// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Extrusion.h
 * @brief Raises footprints to triangles: closed solids with glazed facades, and flat areas.
 */
#ifndef AvianLidarExtrusion_h
#define AvianLidarExtrusion_h

#include "Polygons.h"
#include "SceneTypes.h"
#include "Terrain.h"

namespace avianlidar::scene
{
/// Material ids of the surfaces of a solid.
struct ExtrusionMaterials
{
  int facade = 0;
  int roof = 0;
  std::optional<Glazing> glazing;
};

/// Joins pieces of a terrain to one sheet. Pieces with a common edge share the vertices of this
/// edge.
Sheet Join(const std::vector<TerrainPiece>& pieces);

/**
 * Adds a solid from `base` to `base + height`, m, above a sheet, with roof, facades and floor. The
 * floor has the roof's material, because beams do not reach the floor. The normals point outwards.
 * The solid is closed: every edge belongs to two triangles.
 *
 * A glazed facade of length L has n = max(1, round(L / bay)) bays of equal width. Each bay has one
 * centred strip of glass that covers `share` of its area. Plinth and cornice, each min(2 %, (1 -
 * share) / 4) of the height, have the facade's material, so that the facade meets roof and ground
 * in whole edges. With share 1 the facade is all glass. With share 0 the facade has no glass.
 */
void AddSolid(
  const Sheet& sheet, double base, double height, const ExtrusionMaterials& materials, Mesh& mesh);

/// Adds a sheet, raised by `height`, m, as an area that faces up.
void AddFlat(const Sheet& sheet, double height, int material, Mesh& mesh);
}

#endif
