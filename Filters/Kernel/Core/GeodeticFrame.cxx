// SPDX-License-Identifier: BSD-3-Clause
#include "GeodeticFrame.h"

#include "ValueError.h"

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/Math.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <GeographicLib/UTMUPS.hpp>

#include <cmath>
#include <cstdlib>
#include <vector>

namespace avianlidar
{
namespace
{
using Point = std::array<double, 3>;

constexpr double FalseEasting = 500e3;
constexpr double FalseNorthing = 10000e3;
// Greatest easting, m, for which the series of the transverse Mercator projection hold to 5 nm, and
// greatest northing, a little beyond the poles.
constexpr double GreatestEasting = 3900e3;
constexpr double GreatestNorthing = 10500e3;

bool isOnEllipsoid(Frame frame)
{
  return frame == Frame::Geodetic || frame == Frame::UTM;
}
}

struct GeodeticFrame::Implementation
{
  const GeographicLib::Geocentric& Earth = GeographicLib::Geocentric::WGS84();
  const GeographicLib::TransverseMercator& Mercator = GeographicLib::TransverseMercator::UTM();
  Point Origin{ { 0.0, 0.0, 0.0 } }; // origin in ECEF, m
  // Columns are east, north, up in ECEF, stored row by row.
  std::vector<double> Axes = std::vector<double>(9);
  double CentralMeridian = 3.0;
  double NorthingOffset = 0.0;

  Point ecefFromEnu(const Point& p) const
  {
    Point ecef;
    for (int row = 0; row < 3; ++row)
    {
      const double* axes = this->Axes.data() + 3 * row;
      ecef[row] = this->Origin[row] + (axes[0] * p[0] + axes[1] * p[1] + axes[2] * p[2]);
    }
    return ecef;
  }

  Point enuFromEcef(const Point& p) const
  {
    const Point d{ { p[0] - this->Origin[0], p[1] - this->Origin[1], p[2] - this->Origin[2] } };
    Point enu;
    for (int column = 0; column < 3; ++column)
    {
      enu[column] =
        this->Axes[column] * d[0] + this->Axes[3 + column] * d[1] + this->Axes[6 + column] * d[2];
    }
    return enu;
  }

  Point geodeticFromUtm(const Point& p) const
  {
    double latitude, longitude;
    this->Mercator.Reverse(
      this->CentralMeridian, p[0] - FalseEasting, p[1] - this->NorthingOffset, latitude, longitude);
    return { { longitude, latitude, p[2] } };
  }

  Point utmFromGeodetic(const Point& p) const
  {
    double x, y;
    this->Mercator.Forward(this->CentralMeridian, p[1], p[0], x, y);
    return { { x + FalseEasting, y + this->NorthingOffset, p[2] } };
  }
};

GeodeticFrame::GeodeticFrame()
  : Impl(new Implementation)
{
  this->setOrigin(0.0, 0.0, 0.0);
}

GeodeticFrame::~GeodeticFrame() = default;

std::string GeodeticFrame::checkOrigin(double latitude, double longitude, double height)
{
  if (!(std::abs(latitude) <= 90.0))
  {
    return valueError("latitude", latitude, "degrees within [-90, 90]");
  }
  if (!(std::abs(longitude) <= 360.0))
  {
    return valueError("longitude", longitude, "degrees within [-360, 360]");
  }
  if (!std::isfinite(height))
  {
    return valueError("height", height, "metres above the ellipsoid");
  }
  return std::string();
}

void GeodeticFrame::setOrigin(double latitude, double longitude, double height)
{
  Point& o = this->Impl->Origin;
  this->Impl->Earth.Forward(latitude, longitude, height, o[0], o[1], o[2], this->Impl->Axes);
}

int GeodeticFrame::zoneOf(double latitude, double longitude)
{
  const int zone =
    GeographicLib::UTMUPS::StandardZone(latitude, longitude, GeographicLib::UTMUPS::UTM);
  return latitude < 0.0 ? -zone : zone;
}

void GeodeticFrame::setZone(int zone)
{
  this->Impl->CentralMeridian = 6.0 * std::abs(zone) - 183.0;
  this->Impl->NorthingOffset = zone < 0 ? FalseNorthing : 0.0;
}

std::string GeodeticFrame::checkPoint(Frame frame, const Point& point)
{
  if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2]))
  {
    return "a coordinate is not finite";
  }
  if (frame == Frame::Geodetic)
  {
    return std::abs(point[1]) <= 90.0
      ? std::string()
      : valueError("latitude (y)", point[1], "degrees within [-90, 90]");
  }
  if (frame == Frame::UTM)
  {
    if (!(std::abs(point[0] - FalseEasting) <= GreatestEasting))
    {
      return valueError(
        "UTM easting", point[0], "at most 3900 km from the central meridian of the zone");
    }
    if (!(point[1] >= -GreatestNorthing && point[1] <= FalseNorthing + GreatestNorthing))
    {
      return valueError("UTM northing", point[1], "a place between the poles");
    }
  }
  return std::string();
}

std::array<double, 3> GeodeticFrame::convert(Frame from, Frame to, const Point& point) const
{
  if (from == to && from != Frame::Geodetic)
  {
    return point;
  }
  // A rotation converts between ENU and ECEF. A projection converts between geodetic and UTM. The
  // ellipsoid converts between these pairs.
  Point p = point;
  if (isOnEllipsoid(from))
  {
    Point geodetic = from == Frame::UTM ? this->Impl->geodeticFromUtm(p) : p;
    if (isOnEllipsoid(to))
    {
      geodetic[0] = GeographicLib::Math::AngNormalize(geodetic[0]);
      return to == Frame::UTM ? this->Impl->utmFromGeodetic(geodetic) : geodetic;
    }
    this->Impl->Earth.Forward(geodetic[1], geodetic[0], geodetic[2], p[0], p[1], p[2]);
    return to == Frame::ENU ? this->Impl->enuFromEcef(p) : p;
  }
  const Point ecef = from == Frame::ENU ? this->Impl->ecefFromEnu(p) : p;
  if (!isOnEllipsoid(to))
  {
    return to == Frame::ENU ? this->Impl->enuFromEcef(ecef) : ecef;
  }
  Point geodetic;
  this->Impl->Earth.Reverse(ecef[0], ecef[1], ecef[2], geodetic[1], geodetic[0], geodetic[2]);
  return to == Frame::UTM ? this->Impl->utmFromGeodetic(geodetic) : geodetic;
}
}
