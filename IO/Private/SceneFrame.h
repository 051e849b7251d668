// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneFrame.h
 * @brief Converts coordinates of any kind to metres east, north and up of the scene's origin, in
 * double precision.
 */
#ifndef AvianLidarSceneFrame_h
#define AvianLidarSceneFrame_h

#include "GeodeticFrame.h"
#include "SceneTypes.h"

#include <ogr_spatialref.h>

#include <memory>

namespace avianlidar::scene
{
/**
 * Points given in the tangent frame (east, north, up) of a place, in the frame of the origin. Far
 * away the place's up leans from the origin's: by 1 degree in 111 km.
 */
void MoveToPlace(const Geodetic& origin, const Geodetic& place, std::vector<Vec3>& points);

/**
 * Coordinates of a reference system to metres about an origin. The system is a code ("EPSG:32632"),
 * WKT, PROJJSON or a PROJ string, but not a URL or a file; axes in the order x or longitude, y or
 * latitude; heights are taken as heights above the ellipsoid, which is right wherever the origin's
 * height is of the same kind. Throws Error for an unknown system and for coordinates that it does
 * not hold.
 */
class GeoreferencedPoints
{
public:
  GeoreferencedPoints(const Geodetic& origin, const std::string& crs);
  GeoreferencedPoints(const Geodetic& origin, const OGRSpatialReference& crs);

  void ToLocal(std::vector<Vec3>& points) const;

private:
  GeodeticFrame Frame;
  /// Null where the coordinates are longitude and latitude on WGS84 already.
  std::unique_ptr<OGRCoordinateTransformation> ToWgs84;
};
}

#endif
