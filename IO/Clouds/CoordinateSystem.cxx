// SPDX-License-Identifier: BSD-3-Clause
#include "CoordinateSystem.h"

#include "CloudData.h"
#include "VirtualFiles.h"

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <cstdlib>
#include <utility>

namespace avianlidar::formats
{
namespace
{
std::string wktOf(int code, bool ellipsoidalHeights)
{
  const QuietGdal quiet;
  OGRSpatialReference system;
  const bool isKnown = system.importFromEPSG(code) == OGRERR_NONE &&
    (!ellipsoidalHeights || system.PromoteTo3D(nullptr) == OGRERR_NONE);
  // Without the option GDAL cannot write heights above the ellipsoid as WKT 1.
  constexpr const char* option = "ALLOW_ELLIPSOIDAL_HEIGHT_AS_VERTICAL_CRS=YES";
  const std::string wkt = isKnown ? WktOf(system, "FORMAT=WKT1_GDAL", option) : "";
  failIf(wkt.empty(), "GDAL does not know EPSG:", code, " (is PROJ's database proj.db installed?)",
    quiet.Reason());
  return wkt;
}

/// Returns the system of a WKT, or an empty system if GDAL cannot read the text.
OGRSpatialReference systemOf(const std::string& wkt)
{
  OGRSpatialReference system;
  if (!wkt.empty() && system.importFromWkt(wkt.c_str()) != OGRERR_NONE)
  {
    system.Clear();
  }
  return system;
}

using Bytes = std::vector<unsigned char>;

/// Returns a TIFF of one pixel with the GeoTIFF keys and their parameters.
Bytes imageWith(const Bytes& keys, const Bytes& doubles, const Bytes& texts)
{
  constexpr std::size_t dataAt = 160; // offset of the data, after 12 tags, bytes
  Bytes tags, data;
  std::uint16_t count = 0;
  const auto append = [](Bytes& to, auto value)
  {
    to.resize(to.size() + sizeof value);
    store(value, &to[to.size() - sizeof value]);
  };
  const auto addTag =
    [&](std::uint16_t tag, std::uint16_t type, std::size_t values, std::size_t value)
  {
    append(tags, tag);
    append(tags, type);
    append(tags, static_cast<std::uint32_t>(values));
    append(tags, static_cast<std::uint32_t>(value));
    ++count;
  };
  // Tags of a pixel: width, height, bits, no compression, black is 0, and one strip of one byte.
  constexpr std::pair<int, unsigned> pixel[] = { { 256, 1 }, { 257, 1 }, { 258, 8 }, { 259, 1 },
    { 262, 1 }, { 273, 0 }, { 277, 1 }, { 278, 1 }, { 279, 1 } };
  for (const auto& [tag, value] : pixel)
  {
    addTag(static_cast<std::uint16_t>(tag), 4, 1, value);
  }
  // Adds a tag with all whole values of a type of TIFF.
  const auto add = [&](std::uint16_t tag, std::uint16_t type, std::size_t size, const Bytes& values)
  {
    const std::size_t whole = values.size() / size;
    if (whole * size > 4)
    {
      addTag(tag, type, whole, dataAt + data.size());
      data.insert(data.end(), values.begin(), values.begin() + whole * size);
      data.resize((data.size() + 7) / 8 * 8);
    }
  };
  constexpr std::uint16_t shorts = 3, reals = 12, ascii = 2; // codes of types of TIFF
  add(34735, shorts, 2, keys);
  add(34736, reals, 8, doubles);
  add(34737, ascii, 1, texts);
  Bytes image{ 'I', 'I', 42, 0, 8, 0, 0, 0 };
  append(image, count);
  image.insert(image.end(), tags.begin(), tags.end());
  image.resize(dataAt);
  image.insert(image.end(), data.begin(), data.end());
  return image;
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

std::string wktOfGeoKeys(const Bytes& keys, const Bytes& doubles, const Bytes& texts)
{
  Bytes bytes = imageWith(keys, doubles, texts);
  const QuietGdal quiet;
  const OfflineGdal offline;
  const CPLConfigOptionSetter heights("GTIFF_REPORT_COMPD_CS", "YES", false);
  GDALAllRegister();
  const std::string name = "/vsimem/avian_lidar_keys_" +
    std::to_string(reinterpret_cast<std::uintptr_t>(bytes.data())) + ".tif";
  VSIFCloseL(VSIFileFromMemBuffer(name.c_str(), bytes.data(), bytes.size(), FALSE));
  std::string wkt;
  {
    const char* const drivers[] = { "GTiff", nullptr };
    const GDALDatasetUniquePtr data(GDALDataset::Open(name.c_str(), GDAL_OF_RASTER, drivers));
    const OGRSpatialReference* system = data ? data->GetSpatialRef() : nullptr;
    for (const char* format : { "FORMAT=WKT1_GDAL", "FORMAT=WKT2_2019" })
    {
      wkt = wkt.empty() && system ? WktOf(*system, format) : wkt;
    }
  }
  VSIUnlink(name.c_str());
  return wkt.compare(0, 8, "LOCAL_CS") == 0 ? std::string() : wkt;
}

std::string foreignUnitOf(const std::string& wkt)
{
  const QuietGdal quiet;
  const OGRSpatialReference system = systemOf(wkt);
  if (system.IsEmpty())
  {
    return {};
  }
  const auto isMetre = [](double factor) { return std::abs(factor - 1.0) < 1e-12; };
  const char* plan = "degree";
  const bool planIsMetre = !system.IsGeographic() && isMetre(system.GetLinearUnits(&plan));
  const char* up = nullptr;
  const bool upIsMetre =
    !system.IsCompound() || isMetre(system.GetTargetLinearUnits("COMPD_CS|VERT_CS", &up));
  const std::string name = planIsMetre ? "metre" : plan;
  return planIsMetre && upIsMetre ? std::string() : up && name != up ? name + " and " + up : name;
}

bool hasDegrees(const std::string& wkt)
{
  const QuietGdal quiet;
  return systemOf(wkt).IsGeographic();
}

int utmZoneOf(const std::string& wkt)
{
  const QuietGdal quiet;
  const OGRSpatialReference system = systemOf(wkt);
  const char* datum = system.GetAttrValue("DATUM");
  int north = 0;
  const int zone = system.GetUTMZone(&north);
  return datum && std::string(datum) == "WGS_1984" ? (north ? zone : -zone) : 0;
}
}
