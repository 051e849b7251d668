// SPDX-License-Identifier: BSD-3-Clause
#include "CoordinateSystem.h"
#include "LasFormat.h"
#include "LazFormat.h"

#include <algorithm>
#include <cmath>

namespace avianlidar::formats
{
namespace
{
using Bytes = std::vector<unsigned char>;

constexpr std::size_t ShortestHeader = 227;
constexpr std::size_t EvlrHeaderSize = 60;
constexpr std::uint64_t LongestText = 1 << 24;
constexpr int WktFlag = 16; // of the global encoding

/// An array in the extra bytes.
struct ExtraField
{
  std::string name;
  std::string unit;
  std::size_t offset = 0;
  Scalar type = Scalar::UInt8;
  int components = 1;
  bool scaled = false;
  std::array<double, 3> scale{ { 1.0, 1.0, 1.0 } };
  std::array<double, 3> shift{};
};

struct Header
{
  int minor = 0;
  bool hasWkt = false; ///< it says so
  std::size_t size = 0;
  std::uint64_t points = 0;
  std::uint64_t data = 0;
  std::uint32_t vlrs = 0;
  std::uint64_t evlrsAt = 0;
  std::uint32_t evlrs = 0;
  std::array<LasAxis, 3> axes;
  LasLayout layout;
  bool compressed = false;
  std::uint64_t room = 0; ///< bytes behind the begin of the points, unless compressed
};

std::string textOf(const unsigned char* bytes, std::size_t length)
{
  const unsigned char* end = std::find(bytes, bytes + length, 0);
  return std::string(bytes, end);
}

void readAxes(const Bytes& h, Header& header)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    header.axes[axis].scale = load<double>(h.data() + 131 + 8 * axis);
    header.axes[axis].offset = load<double>(h.data() + 155 + 8 * axis);
    if (!std::isfinite(header.axes[axis].scale) || !std::isfinite(header.axes[axis].offset))
    {
      throw FormatError("a scale or an offset of its coordinates is not finite");
    }
  }
}

Header readHeader(ByteSource& source)
{
  const Bytes h = source.bytes(
    0, std::min<std::uint64_t>(source.size(), static_cast<std::uint64_t>(LasHeaderSize)));
  if (h.size() < ShortestHeader || textOf(h.data(), 4) != "LASF")
  {
    throw FormatError("this is not a LAS file: it does not begin with LASF and a header");
  }
  Header header;
  header.minor = h[25];
  header.hasWkt = (h[6] & WktFlag) != 0;
  if (h[24] != 1 || header.minor > 4)
  {
    throw FormatError("its version is " + std::to_string(h[24]) + "." + std::to_string(h[25]) +
      ", expected 1.0 to 1.4");
  }
  header.size = load<std::uint16_t>(h.data() + 94);
  header.data = load<std::uint32_t>(h.data() + 96);
  header.vlrs = load<std::uint32_t>(h.data() + 100);
  header.compressed = (h[104] & 0xC0) != 0;
  header.layout = layoutOf(h[104] & 0x3F, load<std::uint16_t>(h.data() + 105));
  header.points = load<std::uint32_t>(h.data() + 107);
  readAxes(h, header);
  if (header.minor >= 4 && h.size() == LasHeaderSize && header.size >= LasHeaderSize)
  {
    header.evlrsAt = load<std::uint64_t>(h.data() + 235);
    header.evlrs = load<std::uint32_t>(h.data() + 243);
    // Some writers fill in the number of older versions alone.
    const auto points = load<std::uint64_t>(h.data() + 247);
    header.points = points > 0 ? points : header.points;
  }
  for (const LasAxis& axis : header.axes)
  {
    if (header.points > 0 && axis.scale == 0.0)
    {
      throw FormatError("a scale of its coordinates is 0");
    }
  }
  if (header.compressed)
  {
    return header;
  }
  const std::uint64_t room = header.data <= source.size() ? source.size() - header.data : 0;
  if (header.points > room / header.layout.length)
  {
    throw FormatError("it is cut short: it says that it has " + std::to_string(header.points) +
      " points of " + std::to_string(header.layout.length) + " bytes, and has room for " +
      std::to_string(room / header.layout.length));
  }
  header.room = room;
  return header;
}

std::string unitOf(const std::string& description)
{
  const std::size_t open = description.rfind('['), close = description.rfind(']');
  return open != std::string::npos && close != std::string::npos && open < close
    ? description.substr(open + 1, close - open - 1)
    : std::string();
}

/// Arrays of several components: "direction [0]", "direction [1]", ... become "direction".
void joinComponents(std::vector<ExtraField>& fields)
{
  std::vector<ExtraField> joined;
  for (const ExtraField& field : fields)
  {
    ExtraField* last = joined.empty() ? nullptr : &joined.back();
    const std::string base = field.name.substr(0, field.name.rfind(" ["));
    const int number = last ? last->components : 0;
    const std::string before = number == 1 ? base + " [0]" : base;
    if (last && last->name == before && field.name == base + " [" + std::to_string(number) + "]" &&
      field.components == 1 && field.type == last->type && !field.scaled && !last->scaled &&
      field.offset == last->offset + sizeOf(field.type) * number)
    {
      last->name = base;
      last->components += 1;
      continue;
    }
    joined.push_back(field);
  }
  fields = std::move(joined);
}

/// The arrays that a record of extra bytes describes; what it does not say (type 0) is passed over.
void readExtraFields(const Bytes& content, const LasLayout& layout, std::vector<ExtraField>& fields)
{
  constexpr Scalar types[] = { Scalar::UInt8, Scalar::Int8, Scalar::UInt16, Scalar::Int16,
    Scalar::UInt32, Scalar::Int32, Scalar::UInt64, Scalar::Int64, Scalar::Float32,
    Scalar::Float64 };
  std::size_t offset = layout.core;
  for (std::size_t at = 0; at + LasExtraBytesSize <= content.size(); at += LasExtraBytesSize)
  {
    const unsigned char* entry = content.data() + at;
    const int type = entry[2], options = entry[3];
    ExtraField field;
    field.offset = offset;
    std::size_t bytes = options;
    if (type >= 1 && type <= 30)
    {
      field.type = types[(type - 1) % 10];
      field.components = 1 + (type - 1) / 10;
      bytes = sizeOf(field.type) * field.components;
    }
    offset += bytes;
    if (type < 1 || type > 30 || offset > layout.length)
    {
      continue;
    }
    field.name = textOf(entry + 4, 32);
    field.unit = unitOf(textOf(entry + 160, 32));
    for (int c = 0; c < field.components; ++c)
    {
      field.scale[c] = options & 8 ? load<double>(entry + 112 + 8 * c) : 1.0;
      field.shift[c] = options & 16 ? load<double>(entry + 136 + 8 * c) : 0.0;
      field.scaled |= (options & 24) != 0;
    }
    if (!field.name.empty())
    {
      fields.push_back(field);
    }
  }
  joinComponents(fields);
}

/// What the variable-length records say of the points.
struct Records
{
  std::vector<ExtraField> fields;
  Bytes laz;
  Bytes keys, doubles, texts; ///< GeoTIFF keys and their parameters
};

void takeRecord(const std::string& user, int record, const Bytes& content, const LasLayout& layout,
  Cloud& cloud, Records& records)
{
  if (user == "LASF_Projection" && record == 2112)
  {
    cloud.crs = textOf(content.data(), content.size());
  }
  else if (user == "LASF_Projection" && record >= 34735 && record <= 34737)
  {
    (record == 34735 ? records.keys : record == 34736 ? records.doubles : records.texts) = content;
  }
  else if (user == "LASF_Spec" && record == 4 && records.fields.empty())
  {
    readExtraFields(content, layout, records.fields);
  }
  else if (user == LazUser && record == LazRecord)
  {
    records.laz = content;
  }
  else if (user == "LASF_Spec" && record == 3)
  {
    cloud.notes.push_back({ "description", "", {}, { textOf(content.data(), content.size()) } });
  }
}

/// Variable-length records, and the extended ones of 1.4 behind the points.
Records readRecords(ByteSource& source, const Header& header, Cloud& cloud)
{
  Records records;
  std::uint64_t at = header.size;
  for (std::uint32_t i = 0; i < header.vlrs; ++i)
  {
    const Bytes h = source.bytes(at, LasVlrHeaderSize);
    const std::uint64_t length = load<std::uint16_t>(h.data() + 20);
    takeRecord(textOf(h.data() + 2, 16), load<std::uint16_t>(h.data() + 18),
      source.bytes(at + LasVlrHeaderSize, length), header.layout, cloud, records);
    at += LasVlrHeaderSize + length;
  }
  at = header.evlrsAt;
  for (std::uint32_t i = 0; i < header.evlrs; ++i)
  {
    const Bytes h = source.bytes(at, EvlrHeaderSize);
    const std::uint64_t length = load<std::uint64_t>(h.data() + 20);
    if (length > source.size())
    {
      throw FormatError("an extended variable-length record is longer than the file");
    }
    // Waveforms, say, are long and none of ours.
    const std::uint64_t wanted = length <= LongestText ? length : 0;
    takeRecord(textOf(h.data() + 2, 16), load<std::uint16_t>(h.data() + 18),
      source.bytes(at + EvlrHeaderSize, wanted), header.layout, cloud, records);
    at += EvlrHeaderSize + length;
  }
  return records;
}

/// The system of the points: a text, or keys of GeoTIFF, which count where both are there and the
/// header does not say that the text does.
void findSystem(const Header& header, const Records& records, Cloud& cloud)
{
  if (!records.keys.empty() && (cloud.crs.empty() || !header.hasWkt))
  {
    const std::string wkt = wktOfGeoKeys(records.keys, records.doubles, records.texts);
    cloud.crs = wkt.empty() ? cloud.crs : wkt;
    if (cloud.crs.empty())
    {
      cloud.warnings.emplace_back("its GeoTIFF keys name no coordinate system that GDAL knows");
    }
  }
  const std::string unit = foreignUnitOf(cloud.crs);
  if (!unit.empty())
  {
    cloud.warnings.push_back(
      "its coordinates are not in metres but in " + unit + ", and stay as they are");
  }
}

/// The columns of a cloud of that layout, all zeros, and how a record fills them.
class Columns
{
public:
  Columns(const Header& header, const std::vector<ExtraField>& extra, Cloud& to)
    : Axes(header.axes)
    , Record(header.layout)
    , Extra(extra)
    , To(to)
  {
    const std::size_t n = header.points;
    to.points.resize(3 * n);
    this->Intensity = this->add("intensity", "1", Scalar::Float64, n);
    this->ReturnNumber = this->add("return_number", "1", Scalar::UInt8, n);
    this->Returns = this->add("number_of_returns", "1", Scalar::UInt8, n);
    this->Class = this->add(LasClassification, "", Scalar::UInt8, n);
    this->Flags = this->add(LasFlags, "", Scalar::UInt8, n);
    this->User = this->add(LasUserData, "", Scalar::UInt8, n);
    this->Angle = this->add(LasScanAngle, "deg", Scalar::Float64, n);
    this->SourceId = this->add(LasPointSource, "", Scalar::UInt16, n);
    if (this->Record.time >= 0)
    {
      this->Time = this->add("timestamp", "us", Scalar::Float64, n);
    }
    if (this->Record.rgb >= 0)
    {
      this->Rgb = this->add("rgb", "1", Scalar::UInt8, n, 3);
      this->Colours.resize(3 * n);
    }
    if (this->Record.nir >= 0)
    {
      this->Nir = this->add("near_infrared", "", Scalar::UInt16, n);
    }
    for (const ExtraField& field : extra)
    {
      this->FirstExtra.push_back(this->add(
        field.name, field.unit, field.scaled ? Scalar::Float64 : field.type, n, field.components));
    }
  }

  void take(std::size_t i, const unsigned char* bytes)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->To.points[3 * i + axis] = this->Axes[axis].decode(load<std::int32_t>(bytes + 4 * axis));
    }
    this->at<double>(this->Intensity)[i] = load<std::uint16_t>(bytes + 12) * LasIntensityStep;
    this->Record.extended ? this->takeNew(i, bytes) : this->takeOld(i, bytes);
    if (this->Record.time >= 0)
    {
      this->at<double>(this->Time)[i] = 1e6 * load<double>(bytes + this->Record.time);
    }
    for (int c = 0; this->Record.rgb >= 0 && c < 3; ++c)
    {
      this->Colours[3 * i + c] = load<std::uint16_t>(bytes + this->Record.rgb + 2 * c);
    }
    if (this->Record.nir >= 0)
    {
      this->at<std::uint16_t>(this->Nir)[i] = load<std::uint16_t>(bytes + this->Record.nir);
    }
    this->takeExtra(i, bytes);
  }

  /// Colours of 16 bits become 8. The specification wants 8-bit colours as c * 256; some writers
  /// leave them as they are, so no channel of the file is above 255.
  void finish()
  {
    const bool small = std::all_of(
      this->Colours.begin(), this->Colours.end(), [](std::uint16_t c) { return c < 256; });
    for (std::size_t k = 0; k < this->Colours.size(); ++k)
    {
      this->at<std::uint8_t>(this->Rgb)[k] =
        static_cast<std::uint8_t>(small ? this->Colours[k] : this->Colours[k] >> 8);
    }
  }

private:
  std::size_t add(const std::string& name, const std::string& unit, Scalar type, std::size_t n,
    int components = 1)
  {
    this->To.columns.push_back({ name, unit, components, makeValues(type, n * components) });
    return this->To.columns.size() - 1;
  }

  template <class T>
  std::vector<T>& at(std::size_t column)
  {
    return std::get<std::vector<T>>(this->To.columns[column].values);
  }

  void takeOld(std::size_t i, const unsigned char* bytes)
  {
    this->at<std::uint8_t>(this->ReturnNumber)[i] = bytes[14] & 7;
    this->at<std::uint8_t>(this->Returns)[i] = (bytes[14] >> 3) & 7;
    this->at<std::uint8_t>(this->Class)[i] = bytes[15] & 31;
    this->at<std::uint8_t>(this->Flags)[i] = bytes[15] >> 5;
    this->at<double>(this->Angle)[i] = load<std::int8_t>(bytes + 16);
    this->at<std::uint8_t>(this->User)[i] = bytes[17];
    this->at<std::uint16_t>(this->SourceId)[i] = load<std::uint16_t>(bytes + 18);
  }

  void takeNew(std::size_t i, const unsigned char* bytes)
  {
    this->at<std::uint8_t>(this->ReturnNumber)[i] = bytes[14] & 15;
    this->at<std::uint8_t>(this->Returns)[i] = bytes[14] >> 4;
    this->at<std::uint8_t>(this->Flags)[i] = bytes[15] & 15;
    this->at<std::uint8_t>(this->Class)[i] = bytes[16];
    this->at<std::uint8_t>(this->User)[i] = bytes[17];
    this->at<double>(this->Angle)[i] = LasScanAngleStep * load<std::int16_t>(bytes + 18);
    this->at<std::uint16_t>(this->SourceId)[i] = load<std::uint16_t>(bytes + 20);
  }

  void takeExtra(std::size_t i, const unsigned char* bytes)
  {
    for (std::size_t f = 0; f < this->Extra.size(); ++f)
    {
      const ExtraField& field = this->Extra[f];
      Values& values = this->To.columns[this->FirstExtra[f]].values;
      for (int c = 0; c < field.components; ++c)
      {
        const unsigned char* from = bytes + field.offset + sizeOf(field.type) * c;
        if (field.scaled)
        {
          std::get<std::vector<double>>(values)[i * field.components + c] =
            loadAs(field.type, from) * field.scale[c] + field.shift[c];
        }
        else
        {
          setFromBytes(values, i * field.components + c, from);
        }
      }
    }
  }

  std::array<LasAxis, 3> Axes;
  LasLayout Record;
  const std::vector<ExtraField>& Extra;
  Cloud& To;
  std::size_t Intensity, ReturnNumber, Returns, Class, Flags, User, Angle, SourceId;
  std::size_t Time = 0, Rgb = 0, Nir = 0;
  std::vector<std::size_t> FirstExtra;
  std::vector<std::uint16_t> Colours;
};
}

LasLayout layoutOf(int format, std::size_t length)
{
  // Bytes of the core, and where time, colours and near infrared are.
  struct Place
  {
    std::size_t core;
    int time, rgb, nir;
    bool waveforms;
  };
  constexpr Place places[] = { { 20, -1, -1, -1, false }, { 28, 20, -1, -1, false },
    { 26, -1, 20, -1, false }, { 34, 20, 28, -1, false }, { 57, 20, -1, -1, true },
    { 63, 20, 28, -1, true }, { 30, 22, -1, -1, false }, { 36, 22, 30, -1, false },
    { 38, 22, 30, 36, false }, { 59, 22, -1, -1, true }, { 67, 22, 30, 36, true } };
  if (format < 0 || format > 10)
  {
    throw FormatError(
      "its point data record format is " + std::to_string(format) + ", expected 0 to 10");
  }
  const Place& place = places[format];
  const LasLayout layout = { format, format >= 6, place.core, length, place.time, place.rgb,
    place.nir, place.waveforms };
  if (length < layout.core)
  {
    throw FormatError("its points have " + std::to_string(length) + " bytes, expected at least " +
      std::to_string(layout.core) + " for the point data record format " + std::to_string(format));
  }
  return layout;
}

Cloud readLas(ByteSource& source, const KeepGoing& keepGoing)
{
  const Header header = readHeader(source);
  Cloud cloud;
  const Records records = readRecords(source, header, cloud);
  findSystem(header, records, cloud);
  if (header.layout.waveforms)
  {
    if (header.compressed)
    {
      throw FormatError("its points have waveforms (point data record format " +
        std::to_string(header.layout.format) + "), which are read from LAS, not from LAZ");
    }
    cloud.warnings.emplace_back("its waveforms are left out");
  }
  const std::uint64_t length = header.layout.length;
  if (header.room >= (header.points + 1) * length && header.evlrs == 0 && !header.layout.waveforms)
  {
    cloud.warnings.push_back("its header says that it has " +
      (header.points > 0 ? std::to_string(header.points) : std::string("no")) + " points, though " +
      std::to_string(header.room - header.points * length) + " bytes follow");
  }
  const LazPoints laz{ header.data, header.points, header.layout, records.laz };
  if (header.compressed)
  {
    checkLaz(source, laz);
  }
  requireMemoryFor(header.points, header.layout.length);
  Columns columns(header, records.fields, cloud);
  const auto take = [&](std::uint64_t i, const unsigned char* bytes)
  {
    columns.take(i, bytes);
    goOn(
      keepGoing, static_cast<std::int64_t>(i), static_cast<std::int64_t>(header.points), 0.0, 1.0);
  };
  if (header.compressed)
  {
    forEachLazRecord(source, laz, take);
  }
  else
  {
    forEachRecord(source, header.data, header.layout.length, header.points, take);
  }
  columns.finish();
  return cloud;
}
}
