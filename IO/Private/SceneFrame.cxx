// SPDX-License-Identifier: BSD-3-Clause
#include "SceneFrame.h"

#include "GeodeticFrame.h"

#include <ogr_spatialref.h>

namespace avianlidar::scene
{
void MoveToPlace(const Geodetic& origin, const Geodetic& place, std::vector<Vec3>& points)
{
  GeodeticFrame from, to;
  from.setOrigin(place.latitude, place.longitude, place.height);
  to.setOrigin(origin.latitude, origin.longitude, origin.height);
  for (Vec3& p : points)
  {
    p = to.convert(Frame::ECEF, Frame::ENU, from.convert(Frame::ENU, Frame::ECEF, p));
  }
}

struct GeoreferencedPoints::Internals
{
  GeodeticFrame frame;
  // Null where the coordinates are longitude and latitude on WGS84 already.
  std::unique_ptr<OGRCoordinateTransformation> toWgs84;
};

GeoreferencedPoints::GeoreferencedPoints(const Geodetic& origin, const OGRSpatialReference& crs)
  : Data(std::make_unique<Internals>())
{
  this->Data->frame.setOrigin(origin.latitude, origin.longitude, origin.height);
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
    if (!GeodeticFrame::checkPoint(Frame::Geodetic, p).empty())
    {
      throw Error("coordinates lie outside their coordinate reference system");
    }
    p = this->Data->frame.convert(Frame::Geodetic, Frame::ENU, p);
  }
}
}
