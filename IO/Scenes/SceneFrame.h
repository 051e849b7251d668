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
 * Transforms points from the tangent frame (east, north, up) of a place to the tangent frame of the
 * origin. The up directions of the two frames differ by 1 degree at a distance of 111 km.
 */
void MoveToPlace(const Geodetic& origin, const Geodetic& place, std::vector<Point3>& points);

/**
 * Transforms coordinates of a reference system to metres east, north and up of an origin. The
 * system is a code ("EPSG:32632"), WKT, PROJJSON or a PROJ string, but not a URL or a file. The
 * axes have the order x or longitude, y or latitude. Heights are taken as heights above the
 * ellipsoid. Other heights are right if the origin has a height of the same kind. Throws Error for
 * an unknown system and for coordinates outside the range of the system.
 */
class GeoreferencedPoints
{
public:
  GeoreferencedPoints(const Geodetic& origin, const std::string& crs);
  GeoreferencedPoints(const Geodetic& origin, const OGRSpatialReference& crs);

  void ToLocal(std::vector<Point3>& points) const;

private:
  GeodeticFrame Frame;
  /// Transformation to longitude and latitude on WGS84. Null if the coordinates are already
  /// longitude and latitude on WGS84.
  std::unique_ptr<OGRCoordinateTransformation> ToWgs84;
};
}

#endif
