// SPDX-License-Identifier: BSD-3-Clause
#include "SceneFrame.h"

#include <GeographicLib/LocalCartesian.hpp>

#include <ogr_spatialref.h>

#include <cmath>

namespace avianlidar::scene
{
Vec3 RigidMotion::Apply(const Vec3& v) const
{
  const Mat3& r = this->rotation;
  const Vec3& t = this->translation;
  return { r[0] * v[0] + r[1] * v[1] + r[2] * v[2] + t[0],
    r[3] * v[0] + r[4] * v[1] + r[5] * v[2] + t[1],
    r[6] * v[0] + r[7] * v[1] + r[8] * v[2] + t[2] };
}

RigidMotion LocalFrameAt(const Geodetic& origin, const Geodetic& place)
{
  const GeographicLib::LocalCartesian frame(origin.latitude, origin.longitude, origin.height);
  RigidMotion motion;
  std::vector<double> rotation(9);
  frame.Forward(place.latitude, place.longitude, place.height, motion.translation[0],
    motion.translation[1], motion.translation[2], rotation);
  std::copy(rotation.begin(), rotation.end(), motion.rotation.begin());
  return motion;
}

struct GeoreferencedPoints::Internals
{
  GeographicLib::LocalCartesian frame;
  // Null where the coordinates are longitude and latitude on WGS84 already.
  std::unique_ptr<OGRCoordinateTransformation> toWgs84;
};

GeoreferencedPoints::GeoreferencedPoints(const Geodetic& origin, const OGRSpatialReference& crs)
  : Data(std::make_unique<Internals>())
{
  this->Data->frame.Reset(origin.latitude, origin.longitude, origin.height);
  OGRSpatialReference source(crs);
  source.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  OGRSpatialReference plane, space;
  plane.importFromEPSG(4326);
  plane.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  space.importFromEPSG(4979);
  space.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (!source.IsSame(&plane) && !source.IsSame(&space))
  {
    this->Data->toWgs84.reset(OGRCreateCoordinateTransformation(&source, &space));
    if (!this->Data->toWgs84)
    {
      throw Error("there is no way from its coordinate reference system to WGS84");
    }
  }
}

namespace
{
OGRSpatialReference FromText(const std::string& crs)
{
  OGRSpatialReference reference;
  if (reference.SetFromUserInput(crs.c_str()) != OGRERR_NONE)
  {
    throw Error("unknown coordinate reference system \"" + crs + "\"");
  }
  return reference;
}
}

GeoreferencedPoints::GeoreferencedPoints(const Geodetic& origin, const std::string& crs)
  : GeoreferencedPoints(origin, FromText(crs))
{
}

GeoreferencedPoints::~GeoreferencedPoints() = default;

void GeoreferencedPoints::ToLocal(std::vector<Vec3>& points) const
{
  if (this->Data->toWgs84)
  {
    const std::size_t n = points.size();
    std::vector<double> x(n), y(n), z(n);
    for (std::size_t i = 0; i < n; ++i)
    {
      x[i] = points[i][0];
      y[i] = points[i][1];
      z[i] = points[i][2];
    }
    if (n > 0 && !this->Data->toWgs84->Transform(static_cast<int>(n), x.data(), y.data(), z.data()))
    {
      throw Error("coordinates lie outside their coordinate reference system");
    }
    for (std::size_t i = 0; i < n; ++i)
    {
      points[i] = { x[i], y[i], z[i] };
    }
  }
  for (Vec3& p : points)
  {
    if (!(std::abs(p[1]) <= 90) || !std::isfinite(p[0]) || !std::isfinite(p[2]))
    {
      throw Error("coordinates lie outside their coordinate reference system");
    }
    const Vec3 geodetic = p;
    this->Data->frame.Forward(geodetic[1], geodetic[0], geodetic[2], p[0], p[1], p[2]);
  }
}
}
