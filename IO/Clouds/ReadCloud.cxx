// SPDX-License-Identifier: BSD-3-Clause
#include "ReadCloud.h"

#include "CloudNotes.h"
#include "KittiFormat.h"
#include "LasFormat.h"
#include "PcdFormat.h"
#include "PlyFormat.h"
#include "ValueError.h"
#include "Vector.h"
#include "vtkAvianLidarNames.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>

namespace avianlidar::formats
{
namespace fs = std::filesystem;

namespace
{
/// Returns whether a name has a unit in this project.
bool hasUnit(const std::string& name)
{
  const auto& all = vtkAvianLidarArrays::CloudArrays;
  return std::any_of(std::begin(all), std::end(all),
    [&](const vtkAvianLidarArrays::Name& known)
    { return name == known.name && *known.unit && known.unit != std::string("1"); });
}

Column* find(Cloud& cloud, const std::string& name)
{
  const auto found = std::find_if(cloud.columns.begin(), cloud.columns.end(),
    [&](const Column& column) { return column.name == name; });
  return found == cloud.columns.end() ? nullptr : &*found;
}

/// Takes units and field data from a comment or text area that a writer of this project wrote.
void takeNotes(Cloud& cloud)
{
  std::vector<Note> kept;
  CloudNotes own;
  for (Note& note : cloud.notes)
  {
    if (note.texts.size() != 1 || !fromText(note.texts[0], own))
    {
      kept.push_back(std::move(note));
    }
  }
  kept.insert(kept.end(), own.notes.begin(), own.notes.end());
  cloud.notes = std::move(kept);
  for (Column& column : cloud.columns)
  {
    const auto unit = own.units.find(column.name);
    column.unit = unit == own.units.end() ? column.unit : unit->second;
  }
}

/// Unpacks colours 0x00RRGGBB from four bytes of any type.
void unpackColours(Cloud& cloud)
{
  for (const char* name : { "rgb", "rgba" })
  {
    Column* packed = find(cloud, name);
    if (!packed || packed->components != 1 || sizeOf(packed->values) != cloud.size())
    {
      continue;
    }
    std::vector<std::uint8_t> colours;
    const bool known = std::visit(
      [&colours](const auto& values)
      {
        constexpr bool isPacked = sizeof(values[0]) == 4;
        colours.reserve(isPacked ? 3 * values.size() : 0);
        for (std::size_t i = 0; isPacked && i < values.size(); ++i)
        {
          unsigned char bytes[8];
          store(values[i], bytes);
          colours.insert(colours.end(), { bytes[2], bytes[1], bytes[0] });
        }
        return isPacked;
      },
      packed->values);
    if (known)
    {
      *packed = { "rgb", "1", 3, std::move(colours) };
    }
  }
}

/// Joins the three columns of bytes of a PLY file to `rgb`.
void joinColours(Cloud& cloud)
{
  std::vector<std::uint8_t> colours(3 * cloud.size());
  const char* const names[] = { "red", "green", "blue" };
  for (std::size_t c = 0; c < 3; ++c)
  {
    const Column* column = find(cloud, names[c]);
    const auto* bytes = column ? std::get_if<std::vector<std::uint8_t>>(&column->values) : nullptr;
    if (!bytes || bytes->size() != cloud.size())
    {
      return;
    }
    for (std::size_t i = 0; i < bytes->size(); ++i)
    {
      colours[3 * i + c] = (*bytes)[i];
    }
  }
  for (const char* name : names)
  {
    cloud.columns.erase(cloud.columns.begin() + (find(cloud, name) - cloud.columns.data()));
  }
  cloud.columns.push_back({ "rgb", "1", 3, std::move(colours) });
}

void rename(Cloud& cloud)
{
  for (const char* alias : { "ring", "channel" })
  {
    Column* column = find(cloud, alias);
    if (column && column->components == 1 && !find(cloud, "laser_id"))
    {
      column->name = "laser_id";
    }
  }
  std::set<std::string> taken;
  for (Column& column : cloud.columns)
  {
    column.name = cleaned(column.name);
    column.unit = cleaned(column.unit);
    if (column.name == "intensity")
    {
      column.unit = "1";
    }
    if (column.unit.empty() && hasUnit(column.name))
    {
      column.name = "file_" + column.name;
    }
    while (!taken.insert(column.name).second)
    {
      column.name = "file_" + column.name;
    }
  }
}

/// Adds range and angles of the points in the sensor's frame.
void addPolar(Cloud& cloud)
{
  const std::size_t n = cloud.size();
  std::vector<double> distance(n), azimuth(n), elevation(n);
  for (std::size_t i = 0; i < n; ++i)
  {
    const double x = cloud.points[3 * i] - (*cloud.sensor)[0];
    const double y = cloud.points[3 * i + 1] - (*cloud.sensor)[1];
    const double z = cloud.points[3 * i + 2] - (*cloud.sensor)[2];
    const double turned = DegreesPerRadian * std::atan2(x, y);
    const double hundredths = 100.0 * (turned < 0.0 ? turned + 360.0 : turned);
    distance[i] = std::hypot(x, y, z);
    azimuth[i] = hundredths < 36000.0 ? hundredths : 0.0;
    elevation[i] = DegreesPerRadian * std::atan2(z, std::hypot(x, y));
  }
  const auto add = [&](const char* name, const char* unit, std::vector<double>&& values)
  {
    if (!find(cloud, name))
    {
      cloud.columns.push_back({ name, unit, 1, std::move(values) });
    }
  };
  add("distance_m", "m", std::move(distance));
  add("azimuth", "0.01 deg", std::move(azimuth));
  add("vertical_angle", "deg", std::move(elevation));
}

Cloud readFirstTurn(ByteSource& file, const KeepGoing& keepGoing)
{
  return readTurn(file, indexPackets(file, {}, keepGoing), 0, keepGoing);
}

template <Cloud (*Read)(ByteSource&, const KeepGoing&)>
Cloud withoutLabels(ByteSource& file, ByteSource*, const KeepGoing& keepGoing)
{
  return Read(file, keepGoing);
}

/// Returns the file of the waveform packets of a LAS file: the same name with .wdp or .WDP. Returns
/// an empty text if this file cannot be opened.
std::string packetFileOf(const std::string& fileName)
{
  for (const char* ending : { ".wdp", ".WDP" })
  {
    const fs::path beside = fs::path(fileName).replace_extension(ending);
    std::error_code ignored;
    if (endingOf(fileName) == ".las" && fs::is_regular_file(beside, ignored) &&
      std::ifstream(beside))
    {
      return beside.string();
    }
  }
  return std::string();
}

}

std::string endingOf(const std::string& fileName)
{
  return vtksys::SystemTools::LowerCase(fs::path(fileName).extension().string());
}

const std::vector<CloudFormat>& cloudFormats()
{
  static const std::vector<CloudFormat> all = {
    { { ".las", ".laz" },
      [](ByteSource& file) { return std::memcmp(file.at(0, 4), "LASF", 4) == 0; }, readLas },
    { { ".pcd" }, [](ByteSource& file) { return !readPcdHeader(file).fields.empty(); },
      withoutLabels<readPcd> },
    { { ".ply" }, [](ByteSource& file) { return !readPlyHeader(file).hasFaces; },
      withoutLabels<readPly> },
    { { ".bin" }, mayBeKitti, readKitti, true },
    { { ".pcap", ".pcapng" }, hasPackets, withoutLabels<readFirstTurn>, false, true },
  };
  return all;
}

const CloudFormat* formatOf(const std::string& fileName)
{
  const std::string ending = endingOf(fileName);
  const std::vector<CloudFormat>& all = cloudFormats();
  const auto found = std::find_if(all.begin(), all.end(),
    [&](const CloudFormat& format)
    { return std::count(format.endings.begin(), format.endings.end(), ending) > 0; });
  return found == all.end() ? nullptr : &*found;
}

std::string knownEndings()
{
  std::vector<std::string> all;
  for (const CloudFormat& format : cloudFormats())
  {
    all.insert(all.end(), format.endings.begin(), format.endings.end());
  }
  return anyOf(all);
}

std::string labelFileOf(const std::string& fileName)
{
  std::error_code ignored;
  for (fs::path beside :
    { fs::path(fileName), fs::canonical(fileName, ignored) }) // of a link, both
  {
    beside.replace_extension(".label");
    const fs::path apart =
      fs::absolute(beside, ignored).parent_path().parent_path() / "labels" / beside.filename();
    for (const fs::path& candidate : { beside, apart })
    {
      if (fs::is_regular_file(candidate, ignored))
      {
        return candidate.string();
      }
    }
  }
  return std::string();
}

Cloud readCloud(const std::string& fileName, const KeepGoing& keepGoing, const PacketIndex* packets,
  std::size_t turn)
{
  FileSource source(fileName);
  const CloudFormat* const format = formatOf(fileName);
  failIf(!format, "its name does not end with ", knownEndings());
  const std::string second = format->hasLabels ? labelFileOf(fileName) : packetFileOf(fileName);
  std::optional<FileSource> beside;
  if (!second.empty())
  {
    beside.emplace(second);
  }
  Cloud cloud = packets ? readTurn(source, *packets, turn, keepGoing)
                        : format->read(source, beside ? &*beside : nullptr, keepGoing);
  harmonise(cloud);
  return cloud;
}

void harmonise(Cloud& cloud)
{
  for (Note& note : cloud.notes)
  {
    std::transform(note.texts.begin(), note.texts.end(), note.texts.begin(), cleaned);
  }
  cloud.crs = cleaned(cloud.crs);
  takeNotes(cloud);
  unpackColours(cloud);
  joinColours(cloud);
  rename(cloud);
  if (cloud.sensor)
  {
    addPolar(cloud);
  }
}
}
