// SPDX-License-Identifier: BSD-3-Clause
#include "SceneFrame.h"

#include "VirtualFiles.h"

#include <regex>

namespace avianlidar::scene
{
void MoveToPlace(const Geodetic& origin, const Geodetic& place, std::vector<Point3>& points)
{
  GeodeticFrame from, to;
  from.setOrigin(place.latitude, place.longitude, place.height);
  to.setOrigin(origin.latitude, origin.longitude, origin.height);
  for (Point3& p : points)
  {
    p = to.convert(avianlidar::Frame::ECEF, avianlidar::Frame::ENU,
      from.convert(avianlidar::Frame::ENU, avianlidar::Frame::ECEF, p));
  }
}

namespace
{
// Throws Error if a system names a grid file with a folder, because PROJ would open any such file.
// Grid files in the folders of PROJ have names without a folder.
void RequireGridsOfProj(const std::string& text)
{
  static const std::regex gridInFolder(
    R"re((grids=|PARAMETERFILE\["[^"]*",")[^ "]*/)re", std::regex::icase);
  failIf(std::regex_search(text, gridInFolder),
    "its coordinate reference system names a grid file with a folder, expected the name of a grid "
    "that PROJ has");
}

OGRSpatialReference FromText(const std::string& crs)
{
  RequireGridsOfProj(crs); // before PROJ reads the text
  OGRSpatialReference reference;
  failIf(reference.SetFromUserInput(
           crs.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) != OGRERR_NONE,
    "unknown coordinate reference system \"", crs, "\"");
  return reference;
}
}

GeoreferencedPoints::GeoreferencedPoints(const Geodetic& origin, const OGRSpatialReference& crs)
{
  RequireGridsOfProj(WktOf(crs, "FORMAT=WKT2_2019"));
  this->Frame.setOrigin(origin.latitude, origin.longitude, origin.height);
  OGRSpatialReference source(crs);
  source.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  OGRSpatialReference plane, space;
  plane.importFromEPSG(4326);
  plane.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  space.importFromEPSG(4979);
  space.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (!source.IsSame(&plane) && !source.IsSame(&space))
  {
    this->ToWgs84.reset(OGRCreateCoordinateTransformation(&source, &space));
    failIf(!this->ToWgs84, "its coordinate reference system cannot be transformed to WGS84");
  }
}

GeoreferencedPoints::GeoreferencedPoints(const Geodetic& origin, const std::string& crs)
  : GeoreferencedPoints(origin, FromText(crs))
{
}

void GeoreferencedPoints::ToLocal(std::vector<Point3>& points) const
{
  if (this->ToWgs84)
  {
    const std::size_t n = points.size();
    std::vector<double> x(n), y(n), z(n);
    for (std::size_t i = 0; i < n; ++i)
    {
      x[i] = points[i][0];
      y[i] = points[i][1];
      z[i] = points[i][2];
    }
    failIf(n > 0 && !this->ToWgs84->Transform(static_cast<int>(n), x.data(), y.data(), z.data()),
      "coordinates lie outside their coordinate reference system");
    for (std::size_t i = 0; i < n; ++i)
    {
      points[i] = { x[i], y[i], z[i] };
    }
  }
  for (Point3& p : points)
  {
    failIf(!GeodeticFrame::checkPoint(avianlidar::Frame::Geodetic, p).empty(),
      "coordinates lie outside their coordinate reference system");
    p = this->Frame.convert(avianlidar::Frame::Geodetic, avianlidar::Frame::ENU, p);
  }
}
}
