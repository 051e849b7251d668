// SPDX-License-Identifier: BSD-3-Clause
#include "CoordinateSystem.h"

#include "CloudData.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <ogr_spatialref.h>

#include <cstdlib>

namespace avianlidar::formats
{
namespace
{
std::string wktOf(int code, bool ellipsoidalHeights)
{
  OGRSpatialReference system;
  char* text = nullptr;
  // Without the option WKT 1 has no words for a height above the ellipsoid.
  const char* const options[] = { "FORMAT=WKT1_GDAL",
    "ALLOW_ELLIPSOIDAL_HEIGHT_AS_VERTICAL_CRS=YES", nullptr };
  const bool done = system.importFromEPSG(code) == OGRERR_NONE &&
    (!ellipsoidalHeights || system.PromoteTo3D(nullptr) == OGRERR_NONE) &&
    system.exportToWkt(&text, options) == OGRERR_NONE && text && *text;
  const std::string wkt = done ? text : "";
  CPLFree(text);
  if (!done)
  {
    throw FormatError("GDAL does not know EPSG:" + std::to_string(code) +
      " (is PROJ's database proj.db installed?)");
  }
  return wkt;
}
}

std::string utmWkt(int zone)
{
  return wktOf((zone < 0 ? 32700 : 32600) + std::abs(zone), true);
}

std::string geocentricWkt()
{
  return wktOf(4978, false);
}

int utmZoneOf(const std::string& wkt)
{
  OGRSpatialReference system, world;
  CPLErrorHandlerPusher quiet(CPLQuietErrorHandler);
  if (wkt.empty() || system.importFromWkt(wkt.c_str()) != OGRERR_NONE)
  {
    return 0;
  }
  const char* datum = system.GetAttrValue("DATUM");
  int north = 0;
  const int zone = system.GetUTMZone(&north);
  return datum && std::string(datum) == "WGS_1984" ? (north ? zone : -zone) : 0;
}
}
