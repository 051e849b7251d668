// SPDX-License-Identifier: BSD-3-Clause
#include "CoordinateSystem.h"
#include "FieldTable.h"
#include "LasFormat.h"
#include "LazFormat.h"
#include "Sensor.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

namespace avianlidar::formats
{
namespace
{
using Bytes = std::vector<unsigned char>;

constexpr std::size_t ShortestHeader = 227;
constexpr std::uint64_t LongestText = 1 << 24;
constexpr int WktFlag = 16; // bit of the global encoding

/// Array in the extra bytes.
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
  bool hasWkt = false; ///< whether the header says that the system is WKT
  std::size_t size = 0;
  std::uint64_t points = 0;
  std::uint64_t data = 0;
  std::uint32_t vlrs = 0;
  std::uint64_t evlrsAt = 0;
  std::uint32_t evlrs = 0;
  std::array<LasAxis, 3> axes;
  LasLayout layout;
  bool compressed = false;
  int encoding = 0;            ///< bits of the global encoding
  std::uint64_t packetsAt = 0; ///< offset of the header of all waveform packets; 0 if unknown
  std::uint64_t room = 0;      ///< space for uncompressed points in the file, bytes
};

std::string textOf(const unsigned char* bytes, std::size_t length)
{
  const unsigned char* end = std::find(bytes, bytes + length, 0);
  return std::string(bytes, end);
}

Header readHeader(ByteSource& source)
{
  const Bytes h = source.bytes(
    0, std::min<std::uint64_t>(source.size(), static_cast<std::uint64_t>(LasHeaderSize)));
  failIf(h.size() < ShortestHeader || textOf(h.data(), 4) != "LASF",
    "this is not a LAS file: it does not begin with LASF and a header");
  Header header;
  header.minor = h[25];
  header.encoding = h[6];
  header.hasWkt = (h[6] & WktFlag) != 0;
  failIf(h[24] != 1 || header.minor > 4, "its version is ", std::to_string(h[24]), ".",
    std::to_string(h[25]), ", expected 1.0 to 1.4");
  header.size = load<std::uint16_t>(h.data() + 94);
  header.data = load<std::uint32_t>(h.data() + 96);
  header.vlrs = load<std::uint32_t>(h.data() + 100);
  header.compressed = (h[104] & 0xC0) != 0;
  header.layout = layoutOf(h[104] & 0x3F, load<std::uint16_t>(h.data() + 105));
  header.points = load<std::uint32_t>(h.data() + 107);
  if (header.minor >= 3 && std::min(h.size(), header.size) >= ShortestHeader + 8)
  {
    header.packetsAt = load<std::uint64_t>(h.data() + ShortestHeader);
  }
  if (header.minor >= 4 && h.size() == LasHeaderSize && header.size >= LasHeaderSize)
  {
    header.evlrsAt = load<std::uint64_t>(h.data() + 235);
    header.evlrs = load<std::uint32_t>(h.data() + 243);
    // Some writers fill in only the number of points of older versions.
    const auto points = load<std::uint64_t>(h.data() + 247);
    header.points = points > 0 ? points : header.points;
  }
  for (int i = 0; i < 3; ++i)
  {
    LasAxis& axis = header.axes[i];
    axis.scale = load<double>(h.data() + 131 + 8 * i);
    axis.offset = load<double>(h.data() + 155 + 8 * i);
    failIf(!std::isfinite(axis.scale) || !std::isfinite(axis.offset),
      "a scale or an offset of its coordinates is not finite");
    failIf(header.points > 0 && axis.scale == 0.0, "a scale of its coordinates is 0");
  }
  if (header.compressed)
  {
    return header;
  }
  const std::uint64_t room = header.data <= source.size() ? source.size() - header.data : 0;
  failIf(header.points > room / header.layout.length, "it is cut short: it says that it has ",
    header.points, " points of ", header.layout.length, " bytes, and has room for ",
    room / header.layout.length);
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

/// Joins components: the fields "direction [0]", "direction [1]", ... become "direction".
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

/// Reads the arrays that a record of extra bytes describes. Ignores undescribed bytes (type 0).
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

/// Contents of the variable-length records.
struct Records
{
  std::vector<ExtraField> fields;
  Bytes laz;
  Bytes keys, doubles, texts; ///< GeoTIFF keys and their parameters
  std::array<LasDescriptor, LasMostDescriptors + 1> descriptors;
  std::string sampleUnit = "V";
};

void takeRecord(const std::string& user, int record, const std::string& words, const Bytes& content,
  const LasLayout& layout, Cloud& cloud, Records& records)
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
  else if (user == "LASF_Spec" && record > LasDescriptorRecord &&
    record <= LasDescriptorRecord + static_cast<int>(LasMostDescriptors) &&
    content.size() >= LasDescriptorSize)
  {
    const unsigned char* at = content.data();
    records.descriptors[record - LasDescriptorRecord] = { at[0], at[1], load<std::uint32_t>(at + 2),
      load<std::uint32_t>(at + 6), load<double>(at + 10), load<double>(at + 18) };
    const std::string unit = unitOf(words);
    records.sampleUnit = unit.empty() ? records.sampleUnit : unit;
  }
  else if (user == "LASF_Spec" && record == 3)
  {
    cloud.notes.push_back({ "description", "", {}, { textOf(content.data(), content.size()) } });
  }
}

/// Reads the variable-length records, and the extended records after the points of version 1.4.
Records readRecords(ByteSource& source, const Header& header, Cloud& cloud)
{
  Records records;
  std::uint64_t at = header.size;
  for (std::uint64_t i = 0; i < std::uint64_t{ header.vlrs } + header.evlrs; ++i)
  {
    const bool isLong = i >= header.vlrs;
    at = i == header.vlrs ? header.evlrsAt : at;
    const std::size_t size = isLong ? LasEvlrHeaderSize : LasVlrHeaderSize;
    const Bytes h = source.bytes(at, size);
    const std::uint64_t length =
      isLong ? load<std::uint64_t>(h.data() + 20) : load<std::uint16_t>(h.data() + 20);
    const int record = load<std::uint16_t>(h.data() + 18);
    const bool isPackets = isLong && record == LasPacketsRecord;
    if (isPackets && !source.holds(at + size, length))
    {
      break; // Waveforms warns of packets beyond the end of the file
    }
    failIf(length > source.size() && isLong,
      "an extended variable-length record is longer than the file");
    // Long records are not needed here.
    takeRecord(textOf(h.data() + 2, 16), record, textOf(h.data() + (isLong ? 28 : 22), 32),
      source.bytes(at + size, length <= LongestText && !isPackets ? length : 0), header.layout,
      cloud, records);
    at += size + length;
  }
  return records;
}

/// Finds the system of the points, from WKT or GeoTIFF keys. If a file has WKT and keys, the header
/// says whether the WKT is valid.
void findSystem(const Header& header, const Records& records, Cloud& cloud)
{
  if (!records.keys.empty() && (cloud.crs.empty() || !header.hasWkt))
  {
    const std::string wkt = wktOfGeoKeys(records.keys, records.doubles, records.texts);
    cloud.crs = wkt.empty() ? cloud.crs : wkt;
    if (cloud.crs.empty())
    {
      cloud.warnings.emplace_back("GDAL cannot read the coordinate system of its GeoTIFF keys");
    }
  }
  const std::string unit = foreignUnitOf(cloud.crs);
  if (!unit.empty())
  {
    cloud.warnings.push_back(
      "its coordinates are not in metres but in " + unit + ", and are not converted");
  }
}

/// Waveforms of points, each waveform once.
class Waveforms
{
public:
  Waveforms(ByteSource& file, ByteSource* beside, const Header& header, const Records& records)
    : Contents(records)
  {
    const int bits = header.encoding & (LasPacketsInside | LasPacketsBeside);
    const bool isInside = bits == 0 ? header.packetsAt > 0 : bits != LasPacketsBeside;
    this->Source = isInside ? &file : beside;
    this->Begin = isInside ? header.packetsAt : 0;
  }

  /// Takes the packet of a point, or counts the point if the packet cannot be read.
  void take(std::size_t point, const unsigned char* at)
  {
    if (at[0] == 0)
    {
      return;
    }
    const LasDescriptor& kind = this->Contents.descriptors[at[0]];
    const auto offset = load<std::uint64_t>(at + 1);
    const std::uint64_t length = std::uint64_t{ kind.samples } * kind.bits / 8;
    const std::array<float, 4> line = { load<float>(at + 13), load<float>(at + 17),
      load<float>(at + 21), load<float>(at + 25) };
    const Reason problem = !this->Source
      ? Reason("the file with the ending .wdp is missing or cannot be opened", -1)
      : kind.bits == 0 ? Reason("there is no waveform packet descriptor ", at[0])
      : kind.compression != 0
      ? Reason("they are compressed, expected type 0 but found type ", kind.compression)
      : kind.bits % 8 != 0 || kind.bits > 32
      ? Reason("expected samples of 8, 16, 24 or 32 bits but found ", kind.bits)
      : load<std::uint32_t>(at + 9) < length
      ? Reason("their packets are shorter than their samples", -1)
      : this->Begin > this->Source->size() || offset > this->Source->size() - this->Begin ||
        !this->Source->holds(this->Begin + offset, length)
      ? Reason("their packets lie beyond the end of the file", -1)
      : !std::isfinite(line[0] + line[1] + line[2] + line[3])
      ? Reason("their lines are not finite", -1)
      : Reason();
    if (!problem.first.empty())
    {
      ++this->Problems[problem];
      return;
    }
    this->All.try_emplace(this->All.end(), { offset, at[0] }, point, line);
  }

  /// Adds the waveforms to a cloud. Times are those after the pulse if `distance_m` is known, else
  /// after the first sample.
  void addTo(Cloud& cloud, const KeepGoing& keepGoing) const
  {
    for (const auto& [reason, count] : this->Problems)
    {
      cloud.warnings.push_back(joined("the waveforms of ", count, " points are left out: ",
        reason.first, reason.second < 0 ? "" : std::to_string(reason.second)));
    }
    if (this->All.empty())
    {
      return;
    }
    double size = 0.0;
    for (const auto& [key, line] : this->All)
    {
      size += this->Contents.descriptors[key.second].samples;
    }
    try
    {
      constexpr double bytesOfSample = 110.0; // in Cloud and in VTK's arrays
      requireMemory(size, "samples of waveforms", size * bytesOfSample);
    }
    catch (const MemoryError& error)
    {
      cloud.warnings.push_back("its waveforms are left out: " + std::string(error.what()));
      return;
    }
    const auto found = std::find_if(cloud.columns.begin(), cloud.columns.end(),
      [](const Column& column) { return column.name == "distance_m" && column.unit == "m"; });
    const auto* ranges =
      found == cloud.columns.end() ? nullptr : std::get_if<std::vector<double>>(&found->values);
    Cloud waves;
    std::vector<double> times, distances, samples;
    for (const auto& [key, one] : this->All)
    {
      const auto& [point, line] = one;
      const LasDescriptor& kind = this->Contents.descriptors[key.second];
      const std::size_t width = kind.bits / 8;
      const unsigned char* at = this->Source->at(this->Begin + key.first, kind.samples * width);
      const double pulse = ranges ? 2e12 / SpeedOfLight * (*ranges)[point] - line[0] : 0.0; // ps
      for (std::uint32_t k = 0; k < kind.samples; ++k, at += width)
      {
        const double time = static_cast<double>(k) * kind.spacing;
        for (std::size_t axis = 0; axis < 3; ++axis)
        {
          waves.points.push_back(
            cloud.points[3 * point + axis] + (time - line[0]) * line[axis + 1]);
        }
        std::uint32_t raw = 0;
        for (std::size_t b = width; b-- > 0;)
        {
          raw = raw << 8 | at[b];
        }
        samples.push_back(kind.offset + kind.gain * raw);
        times.push_back(1e-12 * (pulse + time));
        distances.push_back(0.5 * SpeedOfLight * times.back());
      }
      cloud.lineEnds.push_back(samples.size());
      cloud.linePoints.push_back(point);
      goOn(keepGoing, 1.0);
    }
    waves.columns.push_back({ "sample_time", "s", 1, std::move(times) });
    if (ranges)
    {
      waves.columns.push_back({ "distance_m", "m", 1, std::move(distances) });
    }
    waves.columns.push_back({ "sample", this->Contents.sampleUnit, 1, std::move(samples) });
    cloud.waveforms.push_back(std::move(waves));
  }

private:
  using Reason = std::pair<std::string_view, int>; // words, and the number after them or -1

  const Records& Contents;
  ByteSource* Source;  ///< file of the packets, or null
  std::uint64_t Begin; ///< offset of the header of all packets, bytes
  /// A point and its line for each packet, by offset and descriptor.
  std::map<std::pair<std::uint64_t, int>, std::pair<std::size_t, std::array<float, 4>>> All;
  std::map<Reason, std::size_t> Problems; ///< number of points
};

/// Returns the flags of a point record: 1 synthetic, 2 key-point, 4 withheld, 8 overlap (formats 6
/// to 10).
int flagsOf(const unsigned char* record, bool isNew)
{
  return isNew ? record[15] & 15 : record[15] >> 5;
}

/// Columns of a cloud, at first all zeros, and the functions that fill the columns from a record.
class Columns
{
public:
  Columns(const Header& header, const std::vector<ExtraField>& extra, Cloud& to)
    : To(to)
    , Size(header.points)
  {
    using Bits = const unsigned char*;
    const LasLayout& record = header.layout;
    const bool isNew = record.extended;
    to.points.resize(3 * this->Size);
    this->Fill.push_back(
      [axes = header.axes, points = to.points.data()](std::size_t i, Bits at)
      {
        for (int axis = 0; axis < 3; ++axis)
        {
          points[3 * i + axis] = axes[axis].decode(load<std::int32_t>(at + 4 * axis));
        }
      });
    this->add("intensity", "1",
      [](Bits at, int) { return load<std::uint16_t>(at + 12) * LasIntensityStep; });
    this->addByte("return_number", "1", [isNew](Bits at) { return at[14] & (isNew ? 15 : 7); });
    this->addByte("number_of_returns", "1",
      [isNew](Bits at) { return isNew ? at[14] >> 4 : (at[14] >> 3) & 7; });
    this->addByte(LasClassification, "", [isNew](Bits at) { return isNew ? at[16] : at[15] & 31; });
    this->addByte(LasFlags, "", [isNew](Bits at) { return flagsOf(at, isNew); });
    this->addByte(LasUserData, "", [](Bits at) { return at[17]; });
    this->add(LasScanAngle, "deg",
      [isNew](Bits at, int) -> double {
        return isNew ? LasScanAngleStep * load<std::int16_t>(at + 18) : load<std::int8_t>(at + 16);
      });
    this->add(LasPointSource, "",
      [isNew](Bits at, int) { return load<std::uint16_t>(at + (isNew ? 20 : 18)); });
    if (record.time >= 0)
    {
      this->add("timestamp", "us",
        [place = record.time](Bits at, int) { return 1e6 * load<double>(at + place); });
    }
    if (record.rgb >= 0)
    {
      this->Rgb = to.columns.size();
      this->add(
        "rgb", "1",
        [place = record.rgb](Bits at, int c) { return load<std::uint16_t>(at + place + 2 * c); },
        3);
    }
    if (record.nir >= 0)
    {
      this->add("near_infrared", "",
        [place = record.nir](Bits at, int) { return load<std::uint16_t>(at + place); });
    }
    for (const ExtraField& field : extra)
    {
      this->addExtra(field);
    }
  }

  void take(std::size_t i, const unsigned char* bytes)
  {
    for (const auto& fill : this->Fill)
    {
      fill(i, bytes);
    }
  }

  /// Converts colours of 16 bits to 8 bits. The specification stores 8-bit colours as c * 256. Some
  /// writers store c instead, and then no channel of the file is above 255.
  void finish()
  {
    if (!this->Rgb)
    {
      return;
    }
    Values& values = this->To.columns[*this->Rgb].values;
    const auto colours = std::move(std::get<std::vector<std::uint16_t>>(values));
    const bool small =
      std::all_of(colours.begin(), colours.end(), [](std::uint16_t c) { return c < 256; });
    std::vector<std::uint8_t> bytes(colours.size());
    std::transform(colours.begin(), colours.end(), bytes.begin(),
      [small](std::uint16_t c) { return static_cast<std::uint8_t>(small ? c : c >> 8); });
    values = std::move(bytes);
  }

private:
  /// @param value function that gives the value of a record and a component
  template <class F>
  void add(const std::string& name, const std::string& unit, F value, int components = 1)
  {
    using T = decltype(value(nullptr, 0));
    this->To.columns.push_back({ name, unit, components, std::vector<T>(this->Size * components) });
    T* into = std::get<std::vector<T>>(this->To.columns.back().values).data();
    this->Fill.push_back(
      [=](std::size_t i, const unsigned char* bytes)
      {
        for (int c = 0; c < components; ++c)
        {
          into[i * components + c] = value(bytes, c);
        }
      });
  }

  template <class F>
  void addByte(const char* name, const char* unit, F value)
  {
    this->add(name, unit,
      [value](const unsigned char* bytes, int) { return static_cast<std::uint8_t>(value(bytes)); });
  }

  void addExtra(const ExtraField& field)
  {
    withType(field.type,
      [&](auto kind)
      {
        using T = decltype(kind);
        const auto value = [offset = field.offset](const unsigned char* bytes, int c)
        { return load<T>(bytes + offset + sizeof(T) * c); };
        if (!field.scaled)
        {
          this->add(field.name, field.unit, value, field.components);
          return;
        }
        this->add(
          field.name, field.unit,
          [value, scale = field.scale, shift = field.shift](const unsigned char* bytes, int c)
          { return static_cast<double>(value(bytes, c)) * scale[c] + shift[c]; },
          field.components);
      });
  }

  Cloud& To;
  std::size_t Size;
  std::optional<std::size_t> Rgb; ///< index of the column of colours
  std::vector<std::function<void(std::size_t, const unsigned char*)>> Fill;
};
}

LasLayout layoutOf(int format, std::size_t length)
{
  constexpr LasLayout layouts[] = { { 20, -1, -1, -1, false }, { 28, 20, -1, -1, false },
    { 26, -1, 20, -1, false }, { 34, 20, 28, -1, false }, { 57, 20, -1, -1, true },
    { 63, 20, 28, -1, true }, { 30, 22, -1, -1, false }, { 36, 22, 30, -1, false },
    { 38, 22, 30, 36, false }, { 59, 22, -1, -1, true }, { 67, 22, 30, 36, true } };
  failIf(
    format < 0 || format > 10, "its point data record format is ", format, ", expected 0 to 10");
  LasLayout layout = layouts[format];
  layout.format = format;
  layout.extended = format >= 6;
  layout.length = length;
  failIf(length < layout.core, "its points have ", length, " bytes, expected at least ",
    layout.core, " for the point data record format ", format);
  return layout;
}

Cloud readLas(ByteSource& source, ByteSource* packets, const KeepGoing& keepGoing)
{
  const Header header = readHeader(source);
  Cloud cloud;
  const Records records = readRecords(source, header, cloud);
  findSystem(header, records, cloud);
  const bool hasWaveforms = header.layout.waveforms;
  failIf(hasWaveforms && header.compressed, "its points have waveforms (point data record format ",
    header.layout.format, "), which are read from LAS, not from LAZ");
  const std::uint64_t length = header.layout.length;
  if (header.room >= (header.points + 1) * length && header.evlrs == 0 && !hasWaveforms)
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
  requireMemoryFor(header.points, length);
  Columns columns(header, records.fields, cloud);
  std::vector<std::uint64_t> withheld;
  Waveforms waveforms(source, packets, header, records);
  const auto take = [&](std::uint64_t i, const unsigned char* bytes)
  {
    columns.take(i, bytes);
    if ((flagsOf(bytes, header.layout.extended) & LasWithheld) != 0)
    {
      withheld.push_back(i);
    }
    else if (hasWaveforms)
    {
      waveforms.take(i - withheld.size(), bytes + header.layout.core - LasPacketSize);
    }
    goOn(keepGoing, i, header.points);
  };
  if (header.compressed)
  {
    forEachLazRecord(source, laz, take);
  }
  else
  {
    forEachRecord(source, header.data, length, header.points, take);
  }
  columns.finish();
  if (!withheld.empty())
  {
    std::vector<std::size_t> kept;
    auto next = withheld.begin();
    for (std::uint64_t i = 0; i < header.points; ++i)
    {
      if (next != withheld.end() && *next == i)
      {
        ++next;
        continue;
      }
      kept.push_back(i);
    }
    keepPoints(cloud, kept);
    const bool one = withheld.size() == 1;
    cloud.warnings.push_back(std::to_string(withheld.size()) +
      (one ? " point that is" : " points that are") +
      " flagged as withheld, which means deleted, " + (one ? "is" : "are") + " left out");
  }
  waveforms.addTo(cloud, keepGoing);
  return cloud;
}
}
