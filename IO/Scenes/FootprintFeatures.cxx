// SPDX-License-Identifier: BSD-3-Clause
#include "FootprintFeatures.h"

#include "FileNames.h"
#include "Glob.h"
#include "LengthText.h"
#include "RegularFile.h"
#include "SceneFrame.h"
#include "VirtualFiles.h"

#include <cpl_vsi.h>
#include <ogrsf_frmts.h>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string_view>

namespace avianlidar::scene
{
namespace
{
// Greatest plausible heights and widths, and elevations above the sea, m.
constexpr double LargestLength = 1000;
constexpr double HighestElevation = 9000;

// Finds a value in the list "key"=>"value","key"=>"value" that GDAL's OSM driver gives for tags
// without a column.
std::optional<std::string> FindOtherTag(const std::string& tags, const std::string& key)
{
  const std::string start = "\"" + key + "\"=>\"";
  std::size_t at = tags.find(start);
  if (at == std::string::npos)
  {
    return {};
  }
  std::string value;
  for (at += start.size(); at < tags.size() && tags[at] != '"'; ++at)
  {
    at += tags[at] == '\\';
    value += at < tags.size() ? std::string(1, tags[at]) : std::string();
  }
  return value;
}

std::optional<std::string> FindAttribute(const OGRFeature& feature, const std::string& name)
{
  const int field = feature.GetFieldIndex(name.c_str());
  if (field >= 0 && feature.IsFieldSetAndNotNull(field))
  {
    return feature.GetFieldAsString(field);
  }
  const int other = feature.GetFieldIndex("other_tags");
  return other >= 0 && feature.IsFieldSetAndNotNull(other)
    ? FindOtherTag(feature.GetFieldAsString(other), name)
    : std::nullopt;
}

// Returns whether JSON gives true or false for a key. GDAL hands these values over as 1 and 0.
bool HasTruthValue(std::string_view json, const std::string& name)
{
  const std::string key = '"' + name + '"';
  for (std::size_t at = json.find(key); at != std::string_view::npos; at = json.find(key, at + 1))
  {
    const std::string_view blanks = " \t\r\n";
    std::size_t value = json.find_first_not_of(blanks, at + key.size());
    if (value == std::string_view::npos || json[value] != ':')
    {
      continue;
    }
    value = json.find_first_not_of(blanks, value + 1);
    if (value != std::string_view::npos &&
      (json.compare(value, 4, "true") == 0 || json.compare(value, 5, "false") == 0))
    {
      return true;
    }
  }
  return false;
}

// Returns the text of a number, or an empty text for an attribute that cannot be a number. If one
// feature has a list, GDAL makes lists of all values; a list of one value counts as this value.
std::string FindNumber(const OGRFeature& feature, const std::string& name)
{
  const int field = name.empty() ? -1 : feature.GetFieldIndex(name.c_str());
  if (field >= 0 && feature.IsFieldSetAndNotNull(field))
  {
    const OGRFieldDefn& column = *feature.GetFieldDefnRef(field);
    const OGRFieldType type = column.GetType();
    const char* const json = feature.GetNativeData();
    if (column.GetSubType() == OFSTBoolean || (json && HasTruthValue(json, name)))
    {
      return {};
    }
    if (type == OFTIntegerList || type == OFTInteger64List || type == OFTRealList ||
      type == OFTStringList) // "(1:12)"
    {
      const std::string text = feature.GetFieldAsString(field);
      return text.rfind("(1:", 0) == 0 ? text.substr(3, text.size() - 4) : std::string();
    }
    if (type != OFTString && type != OFTInteger && type != OFTInteger64 && type != OFTReal)
    {
      return {};
    }
  }
  return name.empty() ? std::string() : FindAttribute(feature, name).value_or("");
}

// Returns the name of a feature, or the name of the object and a number.
std::string FindName(const OGRFeature& feature, const Object& object, std::size_t number)
{
  const std::string name = FindAttribute(feature, object.footprints.nameAttribute).value_or("");
  return name.empty() ? object.name + " " + std::to_string(number) : name;
}

Ring GetRing(const OGRSimpleCurve& curve)
{
  Ring ring;
  for (int i = 0; i < curve.getNumPoints(); ++i)
  {
    ring.push_back({ curve.getX(i), curve.getY(i) });
  }
  return ring;
}

// Adds the parts of a geometry to a feature. Returns whether parts were left out: solids and other
// surfaces in space.
bool CollectGeometry(const OGRGeometry& geometry, FootprintFeature& feature)
{
  bool left = false;
  switch (wkbFlatten(geometry.getGeometryType()))
  {
    case wkbPolygon:
    {
      Polygon polygon;
      for (const OGRLinearRing* ring : *geometry.toPolygon())
      {
        polygon.rings.push_back(GetRing(*ring));
      }
      feature.polygons.push_back(std::move(polygon));
      break;
    }
    case wkbLineString:
      feature.lines.push_back(GetRing(*geometry.toLineString()));
      break;
    case wkbMultiPolygon:
    case wkbMultiLineString:
    case wkbMultiPoint:
    case wkbGeometryCollection:
      for (const OGRGeometry* part : *geometry.toGeometryCollection())
      {
        left = CollectGeometry(*part, feature) || left;
      }
      break;
    case wkbPoint:
      feature.points.push_back({ geometry.toPoint()->getX(), geometry.toPoint()->getY() });
      break;
    default:
      left = true;
  }
  return left;
}

bool Passes(const OGRFeature& feature, const std::vector<AttributeFilter>& filters)
{
  return std::all_of(filters.begin(), filters.end(),
    [&](const AttributeFilter& filter)
    {
      const auto value = FindAttribute(feature, filter.attribute);
      return value && globMatches(filter.pattern, *value);
    });
}

// Drivers of GDAL that are allowed. Other drivers open further files or servers that a file names.
const char* const Drivers[] = { "GeoJSON", "GeoJSONSeq", "TopoJSON", "ESRIJSON", "ESRI Shapefile",
  "GPKG", "FlatGeobuf", "OSM", "GML", "KML", "LIBKML", "GPX", "CSV", "DXF", "MapInfo File",
  nullptr };

void RequireRegularNeighbour(const std::filesystem::path& neighbour)
{
  std::error_code ignored;
  const std::string irregular = whyNotRegular(neighbour.string());
  failIf(!irregular.empty() && !std::filesystem::is_directory(neighbour, ignored),
    "belongs together with ", neighbour.filename().string(), ", and ", irregular);
}

// Checks files of the same name, such as .dbf and .prj for .shp, because GDAL opens them too.
void RequireRegularNeighbours(const std::filesystem::path& file)
{
  namespace fs = std::filesystem;
  std::error_code problem;
  for (fs::directory_iterator entry(file.parent_path(), problem), end; !problem && entry != end;
       entry.increment(problem))
  {
    if (entry->path().stem() == file.stem())
    {
      RequireRegularNeighbour(entry->path());
    }
  }
  if (problem) // a folder that cannot be listed may be searched by name
  {
    for (const char* ending : { ".shx", ".dbf", ".prj", ".cpg", ".qix", ".sbn", ".csvt", ".gfs",
           ".xsd", ".mid", ".dat", ".map", ".id", ".ind" })
    {
      RequireRegularNeighbour(fs::path(file).replace_extension(ending));
    }
  }
}

// Returns the first bytes of a file. @param source VirtualName() of the file
std::string StartOf(const std::string& source)
{
  std::string start(4096, '\0');
  VSILFILE* stream = VSIFOpenL(source.c_str(), "rb");
  start.resize(stream ? VSIFReadL(start.data(), 1, start.size(), stream) : 0);
  if (stream)
  {
    VSIFCloseL(stream);
  }
  return start;
}

// Returns whether a file begins as CityJSON does. The allowed drivers do not read CityJSON.
bool IsCityJson(const std::string& start)
{
  return start.find("\"CityJSON") != std::string::npos;
}

// Returns whether a GeoJSON file has a truth value in place of a height or a width.
bool HasTruthValues(const std::string& file, const FootprintOptions& options)
{
  constexpr std::size_t chunk = std::size_t(1) << 20, overlap = 4096; // bytes
  const std::unique_ptr<VSILFILE, decltype(&VSIFCloseL)> stream(
    VSIFOpenL(VirtualName(file).c_str(), "rb"), &VSIFCloseL);
  const std::string* const names[] = { &options.heightAttribute, &options.minHeightAttribute,
    &options.widthAttribute };
  std::string text;
  for (std::size_t got = chunk; stream && got == chunk;)
  {
    text.erase(0, text.size() - std::min(text.size(), overlap));
    const std::size_t begin = text.size();
    text.resize(begin + chunk);
    got = VSIFReadL(&text[begin], 1, chunk, stream.get());
    text.resize(begin + got);
    if (std::any_of(std::begin(names), std::end(names),
          [&](const std::string* name) { return !name->empty() && HasTruthValue(text, *name); }))
    {
      return true;
    }
  }
  return false;
}

// OpenStreetMap's XML in memory, as GDAL reads it.
class OsmFile
{
public:
  // @param source VirtualName() of the file
  OsmFile(const std::string& source, const FootprintOptions& options, OsmNotes& notes,
    const std::function<bool()>& keepGoing)
    : Name("/vsimem/avian_lidar_" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + ".osm")
  {
    constexpr std::size_t chunk = std::size_t(1) << 20;
    const std::unique_ptr<VSILFILE, decltype(&VSIFCloseL)> stream(
      VSIFOpenL(source.c_str(), "rb"), &VSIFCloseL);
    const auto read = [&stream](std::string& piece)
    {
      piece.resize(chunk);
      piece.resize(stream ? VSIFReadL(piece.data(), 1, chunk, stream.get()) : 0);
      return piece.size() == chunk;
    };
    std::optional<std::string> text =
      InOrder(read, { options.layer, options.filters }, notes, keepGoing);
    if (text)
    {
      this->Text = std::move(*text);
      VSIFCloseL(VSIFileFromMemBuffer(
        this->Name.c_str(), reinterpret_cast<GByte*>(this->Text.data()), this->Text.size(), FALSE));
    }
  }
  ~OsmFile() { VSIUnlink(this->Name.c_str()); }
  OsmFile(const OsmFile&) = delete;
  OsmFile& operator=(const OsmFile&) = delete;

  // Returns whether the XML is not damaged.
  bool IsWhole() const { return !this->Text.empty(); }
  const std::string& GetName() const { return this->Name; }

private:
  std::string Name;
  std::string Text;
};

OGRLayer& OpenLayer(GDALDataset& data, const std::string& wanted)
{
  if (!wanted.empty())
  {
    OGRLayer* layer = data.GetLayerByName(wanted.c_str());
    failIf(!layer, "has no layer \"", wanted, "\"");
    return *layer;
  }
  std::string names;
  for (OGRLayer* layer : data.GetLayers())
  {
    names += (names.empty() ? "" : ", ") + std::string(layer->GetName());
  }
  failIf(data.GetLayerCount() != 1, "has not one layer but ", data.GetLayerCount(), " (", names,
    "); name one as layer");
  return *data.GetLayer(0);
}

// Returns the unit of heights whose unit is not given, m. The FAA's Digital Obstacle File is in
// feet.
double HeightUnit(OGRLayer& layer, const std::string& attribute)
{
  const OGRFeatureDefn& columns = *layer.GetLayerDefn();
  const bool isObstacleFile = columns.GetFieldIndex("OAS") >= 0 &&
    columns.GetFieldIndex("LATDEC") >= 0 && columns.GetFieldIndex("AGL") >= 0;
  return isObstacleFile && (attribute == "AGL" || attribute == "AMSL") ? 0.3048 : 1.0;
}

// Returns whether a text says that an object begins at the ground.
bool IsNone(const std::string& text)
{
  return text.find_first_not_of("0. m") == std::string::npos;
}

FootprintFeature ReadFeature(const OGRFeature& source, const OGRGeometry& geometry,
  const Object& object, double unit, std::size_t number, FootprintCounts& counts)
{
  const FootprintOptions& options = object.footprints;
  FootprintFeature feature;
  feature.name = FindName(source, object, number);
  feature.heightText = FindNumber(source, options.heightAttribute);
  const bool isElevation = options.heightAttribute == "AMSL";
  feature.height =
    ReadLength(feature.heightText, unit, isElevation ? HighestElevation : LargestLength);
  const std::string under = FindNumber(source, options.minHeightAttribute);
  feature.minHeight = ReadLength(under, 1, LargestLength);
  if (!feature.minHeight && !IsNone(under))
  {
    counts.lowest.Add(feature.name + " (\"" + under + "\")");
  }
  feature.width = ReadLength(FindNumber(source, options.widthAttribute), 1, LargestLength);
  // Arcs are replaced by chords.
  const std::unique_ptr<OGRGeometry> straight(geometry.getLinearGeometry());
  if (CollectGeometry(straight ? *straight : geometry, feature))
  {
    counts.surfaces.Add(feature.name);
  }
  return feature;
}

std::vector<FootprintFeature> ReadFeatures(OGRLayer& layer, const Object& object,
  FootprintCounts& counts, const std::function<bool()>& keepGoing)
{
  const FootprintOptions& options = object.footprints;
  std::vector<FootprintFeature> features;
  const double unit = HeightUnit(layer, options.heightAttribute);
  layer.ResetReading();
  for (auto& source : layer)
  {
    if (!keepGoing())
    {
      throw WorkStopped();
    }
    if (!Passes(*source, options.filters))
    {
      ++counts.filtered;
      continue;
    }
    const OGRGeometry* geometry = source->GetGeometryRef();
    if (!geometry || geometry->IsEmpty())
    {
      counts.placeless.Add(
        FindAttribute(*source, options.nameAttribute).value_or("feature without a name"));
      continue;
    }
    features.push_back(ReadFeature(*source, *geometry, object, unit, features.size() + 1, counts));
  }
  return features;
}

void ToLocal(Ring& ring, const GeoreferencedPoints& frame, double height)
{
  std::vector<Point3> points;
  for (const Vec2& p : ring)
  {
    points.push_back({ p[0], p[1], height });
  }
  frame.ToLocal(points);
  for (std::size_t i = 0; i < ring.size(); ++i)
  {
    ring[i] = { points[i][0], points[i][1] };
  }
}

void ToLocal(FootprintFeature& feature, const GeoreferencedPoints& frame, double height)
{
  for (Polygon& polygon : feature.polygons)
  {
    for (Ring& ring : polygon.rings)
    {
      ToLocal(ring, frame, height);
    }
  }
  for (Ring& line : feature.lines)
  {
    ToLocal(line, frame, height);
  }
  ToLocal(feature.points, frame, height);
}

// Transforms plans to local metres. Heights from GDAL are ignored. A feature outside the reference
// system loses its plan.
void ToLocal(std::vector<FootprintFeature>& features, const OGRLayer& layer, const Object& object,
  const Scene& scene, FootprintCounts& counts)
{
  if (object.crs == "local")
  {
    return;
  }
  const OGRSpatialReference* own = const_cast<OGRLayer&>(layer).GetSpatialRef();
  failIf(object.crs.empty() && !own,
    "does not say its coordinate reference system; give crs, or \"local\" for metres east and "
    "north");
  failIf(!scene.origin, "is georeferenced, so the scene needs an origin");
  failIf(object.placement.geodetic.has_value(), "is georeferenced, so geodetic cannot place it");
  const GeoreferencedPoints frame = object.crs.empty()
    ? GeoreferencedPoints(*scene.origin, *own)
    : GeoreferencedPoints(*scene.origin, object.crs);
  for (FootprintFeature& feature : features)
  {
    try
    {
      ToLocal(feature, frame, scene.origin->height);
    }
    catch (const Error& error)
    {
      counts.AddFailure(feature.name, error.what());
      feature.polygons.clear();
      feature.lines.clear();
      feature.points.clear();
    }
  }
}

// Returns whether an error of GDAL concerns one feature, which then has no geometry.
bool IsOfOneFeature(GDALDataset& data, const std::string& reason)
{
  const std::string driver = data.GetDriverName();
  return driver.rfind("GeoJSON", 0) == 0 && reason.rfind(": Invalid ", 0) == 0;
}
}

std::string FaultsOf(const FootprintCounts& counts)
{
  std::string text;
  for (const auto& [what, names] : counts.map)
  {
    text += names.GetCount() > 0 ? joined("; ", names.GetCount(), " ", what, ": ", names.GetText())
                                 : std::string();
  }
  return text;
}

std::vector<FootprintFeature> ReadFootprintFeatures(const Object& object, const Scene& scene,
  FootprintCounts& counts, std::vector<std::string>& notes, const std::function<bool()>& keepGoing)
{
  const QuietGdal quiet;
  // OSM files from editors have negative ids, in any order.
  const CPLConfigOptionSetter indexing("OSM_USE_CUSTOM_INDEXING", "NO", false);
  GDALAllRegister();
  RequireRegularNeighbours(object.file);
  const char* const columns[] = { "X_POSSIBLE_NAMES=x,lon*", "Y_POSSIBLE_NAMES=y,lat*", nullptr };
  const std::string ending = vtksys::SystemTools::LowerCase(
    std::filesystem::path(UncompressedName(object.file)).extension());
  const bool isTable = ending == ".csv";
  const bool keepsJson =
    ending.find("json") != std::string::npos && HasTruthValues(object.file, object.footprints);
  const char* const whole[] = { "NATIVE_DATA=YES", nullptr };
  std::string source = VirtualName(object.file);
  const std::string start = StartOf(source);
  std::optional<OsmFile> xml;
  failIf(start.find("<osmChange") != std::string::npos,
    "is a change of OpenStreetMap's data, expected a map");
  if (IsOsmXml(start))
  {
    xml.emplace(source, object.footprints, counts.map, keepGoing);
    source = xml->IsWhole() ? xml->GetName() : source;
  }
  const GDALDatasetUniquePtr data(
    GDALDataset::Open(source.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, Drivers,
      isTable       ? columns
        : keepsJson ? whole
                    : nullptr));
  failIf(!data && IsCityJson(start),
    "is CityJSON, which is not read: convert it to a mesh or to footprints in GeoJSON");
  failIf(!data, "GDAL cannot read it", quiet.Reason());
  OGRLayer& layer = OpenLayer(*data, object.footprints.layer);
  std::vector<FootprintFeature> features = ReadFeatures(layer, object, counts, keepGoing);
  failIf(quiet.Failed() && !IsOfOneFeature(*data, quiet.Reason()), "GDAL cannot read all of it",
    quiet.Reason());
  const int placeless = counts.placeless.GetCount();
  failIf(features.empty() && placeless > 0, "none of its ", placeless, " features",
    (object.footprints.filters.empty() ? "" : " that fit the filter"), " has a geometry",
    (isTable ? ": a table needs the columns x and y, or longitude and latitude, with numbers"
             : ""));
  failIf(features.empty(),
    counts.filtered == 0
      ? "holds no features"
      : "none of its " + std::to_string(counts.filtered) + " features fits the filter",
    FaultsOf(counts));
  const bool isNested = std::string(data->GetDriverName()) == "OSM";
  for (FootprintFeature& feature : features)
  {
    feature.isNested = isNested;
  }
  if (isNested && !xml)
  {
    notes.push_back(object.name +
      ": incomplete ways and relations of this map are left out, and "
      "only OpenStreetMap's XML (.osm) lets them be counted");
  }
  ToLocal(features, layer, object, scene, counts);
  return features;
}
}
