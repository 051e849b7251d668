// SPDX-License-Identifier: BSD-3-Clause
#include "LasFormat.h"
#include "LazFormat.h"
#include "vtkAvianLidarNames.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <set>

namespace avianlidar::formats
{
namespace
{
using Bytes = std::vector<unsigned char>;

constexpr double GreatestInteger = 2147483647.0;
constexpr std::uint16_t WktBit = 1 << 4;
constexpr int MostLegacyReturns = 7;
constexpr const char* PacketWords = "Waveform samples [J]";

template <class T>
void put(Bytes& bytes, std::size_t at, T value)
{
  store(value, bytes.data() + at);
}

/// Returns the whole characters of a text in UTF-8 that `length` bytes can hold.
std::string cutText(const std::string& text, std::size_t length)
{
  const auto continues = [&](std::size_t i)
  { return (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80; };
  while (length > 0 && length < text.size() && continues(length))
  {
    --length;
  }
  return text.substr(0, length);
}

/// Writes a text from the byte `at` on, cut to `length` bytes. The bytes must be zeros before.
void putText(Bytes& bytes, std::size_t at, std::size_t length, const std::string& text)
{
  const std::string whole = cutText(text, length);
  std::copy(whole.begin(), whole.end(), bytes.begin() + at);
}

void append(Bytes& to, const Bytes& more)
{
  to.insert(to.end(), more.begin(), more.end());
}

/// Returns a variable-length record, with header and contents.
Bytes makeVlr(int record, const char* user, const char* description, const Bytes& content)
{
  failIf(content.size() > LasLongestVlr, description, " needs more than 65535 bytes");
  Bytes vlr(LasVlrHeaderSize);
  putText(vlr, 2, 16, user);
  put(vlr, 18, static_cast<std::uint16_t>(record));
  put(vlr, 20, static_cast<std::uint16_t>(content.size()));
  putText(vlr, 22, 31, description);
  append(vlr, content);
  return vlr;
}

/// Returns the code of a type in the record of extra bytes.
int typeCode(Scalar type)
{
  constexpr int codes[] = { 2, 1, 4, 3, 6, 5, 8, 7, 9, 10 };
  return codes[static_cast<int>(type)];
}

/// Returns a description of an array of this project in a few words.
const char* wordsFor(const std::string& name)
{
  for (const vtkAvianLidarArrays::Name& known : vtkAvianLidarArrays::CloudArrays)
  {
    if (name == known.name)
    {
      return known.words;
    }
  }
  return "";
}

/// Returns the description of an array for the extra bytes of a file: words and [unit], at most 31
/// bytes.
std::string describeExtraBytes(const Field& field)
{
  constexpr std::size_t room = 31;
  const std::string unit = field.unit.empty() ? "" : "[" + field.unit + "]";
  std::string words = wordsFor(field.name);
  const std::size_t space = unit.size() + 1 < room ? room - unit.size() - 1 : 0;
  words = words.substr(0, space);
  return cutText(words.empty() || unit.empty() ? words + unit : words + " " + unit, room);
}

Bytes describeAll(const std::vector<Field>& fields)
{
  Bytes all(fields.size() * LasExtraBytesSize);
  for (std::size_t i = 0; i < fields.size(); ++i)
  {
    const std::size_t at = i * LasExtraBytesSize;
    all[at + 2] = static_cast<unsigned char>(typeCode(fields[i].type));
    putText(all, at + 4, LasLongestName, fields[i].name);
    putText(all, at + 160, 31, describeExtraBytes(fields[i]));
  }
  return all;
}

double coreValue(const LasOutput& output, int field, std::int64_t index)
{
  return std::clamp(output.core[field](index), LasCore[field].low, LasCore[field].high);
}

bool isLegacy(const LasOutput& output)
{
  return output.waveforms && output.waveforms->legacy;
}

/// Turns the first 30 bytes of format 6 into the 28 bytes of format 1. Returns their end.
unsigned char* toLegacy(unsigned char* at)
{
  const double angle = load<std::int16_t>(at + 18) * LasScanAngleStep;
  at[14] = static_cast<unsigned char>(
    std::min(at[14] & 15, MostLegacyReturns) | std::min(at[14] >> 4, MostLegacyReturns) << 3);
  // Classes above 31 become 1, unclassified.
  at[15] = static_cast<unsigned char>((at[16] < 32 ? at[16] : 1) | (at[15] & 7) << 5);
  storeAs(Scalar::Int8, std::clamp(angle, -90.0, 90.0), at + 16);
  std::copy(at + 20, at + 30, at + 18);
  return at + 28;
}

void encodePacket(
  const LasWaveforms& waveforms, const LasMeasure& measure, std::int64_t point, unsigned char* at)
{
  std::fill_n(at, LasPacketSize, static_cast<unsigned char>(0));
  const std::int64_t stretch = waveforms.ofPoint[point];
  if (stretch >= 0)
  {
    const auto [offset, index] = measure.packets[stretch];
    at[0] = static_cast<unsigned char>(index + 1);
    store(offset, at + 1);
    store(measure.lengths[index] * static_cast<std::uint32_t>(measure.levels.bits / 8), at + 9);
    const std::array<float, 4> line = waveforms.line(point, stretch);
    for (std::size_t i = 0; i < line.size(); ++i)
    {
      store(line[i], at + 13 + 4 * i);
    }
  }
}

void encodePoint(
  const LasOutput& output, const LasMeasure& measure, std::int64_t index, unsigned char* at)
{
  const Point position = output.position(index);
  std::fill_n(at, 30, static_cast<unsigned char>(0));
  for (int axis = 0; axis < 3; ++axis)
  {
    store(measure.axes[axis].encode(position[axis]), at + 4 * axis);
  }
  for (int i = 0; i < LasCoreSize; ++i)
  {
    const LasCoreField& field = LasCore[i];
    unsigned char bytes[8];
    storeAs(field.type, coreValue(output, i, index) / field.step, bytes);
    for (std::size_t b = 0; b < sizeOf(field.type); ++b)
    {
      at[field.offset + b] |= bytes[b];
    }
  }
  at = isLegacy(output) ? toLegacy(at) : at + 30;
  for (int c = 0; output.colour && c < 3; ++c, at += 2)
  {
    storeAs(Scalar::UInt16, output.colour(index, c) * 257.0, at);
  }
  if (output.waveforms)
  {
    const int infrared = output.colour && !isLegacy(output) ? 2 : 0; // bytes
    at = std::fill_n(at, infrared, static_cast<unsigned char>(0));
    encodePacket(*output.waveforms, measure, index, at);
    at += LasPacketSize;
  }
  for (const Field& field : output.extra)
  {
    storeAs(field.type, field.value(index), at);
    at += sizeOf(field.type);
  }
}

LasLayout layoutFor(const LasOutput& output)
{
  const int format = (isLegacy(output) ? 4 : output.waveforms ? 9 : 6) + (output.colour ? 1 : 0);
  std::size_t length = layoutOf(format, std::numeric_limits<std::uint16_t>::max()).core;
  for (const Field& field : output.extra)
  {
    length += sizeOf(field.type);
  }
  return layoutOf(format, length);
}

Bytes makeHeader(const LasOutput& output, const LasMeasure& measure, const LasLayout& layout,
  std::size_t vlrs, std::size_t vlrBytes, bool isBeside)
{
  const auto& axes = measure.axes;
  Bytes header(LasHeaderSize);
  putText(header, 0, 4, "LASF");
  put(header, 4, static_cast<std::uint16_t>(output.sourceId));
  put(header, 6, WktBit);
  header[24] = 1;
  header[25] = 4;
  putText(header, 26, 31, output.simulated ? "SIMULATION" : "OTHER");
  putText(header, 58, 31, output.software);
  const std::time_t now = std::time(nullptr);
  if (const std::tm* day = std::gmtime(&now))
  {
    put(header, 90, static_cast<std::uint16_t>(day->tm_yday + 1));
    put(header, 92, static_cast<std::uint16_t>(day->tm_year + 1900));
  }
  put(header, 94, static_cast<std::uint16_t>(LasHeaderSize));
  put(header, 96, static_cast<std::uint32_t>(LasHeaderSize + vlrBytes));
  put(header, 100, static_cast<std::uint32_t>(vlrs));
  header[104] = static_cast<unsigned char>(layout.format | (output.compressed ? LazFlag : 0));
  put(header, 105, static_cast<std::uint16_t>(layout.length));
  for (int axis = 0; axis < 3; ++axis)
  {
    put(header, 131 + 8 * axis, axes[axis].scale);
    put(header, 155 + 8 * axis, axes[axis].offset);
    put(header, 179 + 16 * axis, axes[axis].high);
    put(header, 187 + 16 * axis, axes[axis].low);
  }
  put(header, 247, static_cast<std::uint64_t>(output.size));
  for (int i = 0; i < LasMostReturns; ++i)
  {
    put(header, 255 + 8 * i, measure.returns[i]);
  }
  if (isLegacy(output) && output.size <= std::numeric_limits<std::uint32_t>::max())
  {
    put(header, 107, static_cast<std::uint32_t>(output.size));
    for (int i = 0; i < 5; ++i)
    {
      put(header, 111 + 4 * i, static_cast<std::uint32_t>(measure.returns[i]));
    }
  }
  if (output.waveforms)
  {
    const int inside = isBeside ? 0 : 1;
    const std::uint64_t begin = LasHeaderSize + vlrBytes + output.size * layout.length;
    header[6] |= isBeside ? LasPacketsBeside : LasPacketsInside;
    put(header, 227, begin * inside);
    put(header, 235, begin * inside);
    put(header, 243, static_cast<std::uint32_t>(inside));
  }
  return header;
}

/// Chooses the levels of the stored samples and the places of the packets. The levels are those of
/// the digitiser if all samples have such a level, else 32 bits from the least to the greatest.
void measureWaveforms(const LasWaveforms& from, LasMeasure& measure, const KeepGoing& keepGoing)
{
  LasDescriptor& levels = measure.levels = from.levels;
  double low = 0.0, high = 0.0; // with 0 J, for padding
  for (std::size_t i = 0; i < from.stretches.size(); ++i)
  {
    for (std::uint32_t k = 0; k < from.stretches[i].second; ++k)
    {
      const double sample = from.sample(from.stretches[i].first + k);
      failIf(!std::isfinite(sample), "a sample of the waveforms is not finite");
      const double code = (sample - levels.offset) / levels.gain, nearest = std::nearbyint(code);
      levels.bits =
        std::abs(code - nearest) < 1e-3 && nearest >= 0.0 && nearest < std::exp2(levels.bits)
        ? levels.bits
        : 0;
      low = std::min(low, sample);
      high = std::max(high, sample);
    }
    goOn(keepGoing, 256 * i, 256 * from.stretches.size(), 0.3, 0.5);
  }
  if (levels.bits == 0)
  {
    const double most = std::numeric_limits<std::uint32_t>::max();
    levels.bits = 32;
    levels.gain = high > low ? (high - low) / most : 1.0;
    levels.offset = low;
  }
  levels.bits = levels.bits <= 8 ? 8 : levels.bits <= 16 ? 16 : 32;

  std::set<std::uint32_t> lengths;
  std::uint32_t multiple = 1;
  const auto padded = [&](std::uint32_t size)
  { return (size + multiple - 1) / multiple * multiple; };
  for (;; multiple *= 2)
  {
    lengths.clear();
    for (const auto& [first, size] : from.stretches)
    {
      lengths.insert(padded(size));
    }
    if (lengths.size() <= LasMostDescriptors)
    {
      break;
    }
  }
  measure.lengths.assign(lengths.begin(), lengths.end());
  for (const auto& [first, size] : from.stretches)
  {
    const auto index = std::distance(lengths.begin(), lengths.find(padded(size)));
    measure.packets.emplace_back(measure.packetsEnd, static_cast<std::uint8_t>(index));
    measure.packetsEnd += std::uint64_t{ padded(size) } * levels.bits / 8;
  }
}

Bytes makeDescriptor(const LasDescriptor& levels, std::uint32_t samples)
{
  Bytes content(LasDescriptorSize);
  content[0] = static_cast<unsigned char>(levels.bits);
  put(content, 2, samples);
  put(content, 6, levels.spacing);
  put(content, 10, levels.gain);
  put(content, 18, levels.offset);
  return content;
}

void writePackets(
  OutputFile& file, const LasWaveforms& from, const LasMeasure& measure, const KeepGoing& keepGoing)
{
  const LasDescriptor& levels = measure.levels;
  const Scalar type = *scalarOf('U', levels.bits / 8);
  Bytes bytes(LasEvlrHeaderSize);
  putText(bytes, 2, 16, "LASF_Spec");
  put(bytes, 18, static_cast<std::uint16_t>(LasPacketsRecord));
  put(bytes, 20, measure.packetsEnd - LasEvlrHeaderSize);
  putText(bytes, 28, 31, PacketWords);
  file.write(bytes);
  for (std::size_t i = 0; i < from.stretches.size(); ++i)
  {
    const auto [first, size] = from.stretches[i];
    const std::uint32_t padded = measure.lengths[measure.packets[i].second];
    bytes.resize(padded * sizeOf(type));
    for (std::uint32_t k = 0; k < padded; ++k)
    {
      const double sample = k < size ? from.sample(first + k) : 0.0;
      storeAs(type, (sample - levels.offset) / levels.gain, &bytes[k * sizeOf(type)]);
    }
    file.write(bytes);
    goOn(keepGoing, 256 * i, 256 * from.stretches.size(), 0.7, 1.0);
  }
}
}

std::string cutName(const std::string& name, const std::string& ending)
{
  return cutText(name, LasLongestName - ending.size()) + ending;
}

std::int32_t LasAxis::encode(double coordinate) const
{
  return static_cast<std::int32_t>(std::nearbyint((coordinate - this->offset) / this->scale));
}

double LasAxis::bound() const
{
  const double largest = std::max(std::abs(this->low), std::abs(this->high));
  return 0.5 * this->scale + 2.0 * largest * std::numeric_limits<double>::epsilon();
}

LasAxis chooseAxis(double low, double high, int decimals)
{
  LasAxis axis;
  axis.scale = 1.0 / std::pow(10.0, decimals);
  axis.offset = std::nearbyint(0.5 * (low + high));
  const double reach = std::max(high - axis.offset, axis.offset - low);
  // Scales below 1 are computed as 1 / 10^k, which gives the double nearest to 1e-5, for example.
  for (int k = decimals; reach > axis.scale * (GreatestInteger - 1.0); --k)
  {
    axis.scale = k > 0 ? 1.0 / std::pow(10.0, k - 1) : axis.scale * 10.0;
  }
  axis.low = axis.decode(axis.encode(low));
  axis.high = axis.decode(axis.encode(high));
  return axis;
}

LasMeasure measureLas(const LasOutput& output, const KeepGoing& keepGoing)
{
  LasMeasure measure;
  Point low, high;
  low.fill(output.size > 0 ? std::numeric_limits<double>::infinity() : 0.0);
  high.fill(output.size > 0 ? -std::numeric_limits<double>::infinity() : 0.0);
  for (std::int64_t i = 0; i < output.size; ++i)
  {
    const Point p = output.position(i);
    const double number = coreValue(output, LasReturnNumberIndex, i);
    const int most = isLegacy(output) ? MostLegacyReturns : LasMostReturns;
    measure.returns[std::clamp(static_cast<int>(number), 1, most) - 1] += 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      failIf(!(std::abs(p[axis]) <= LasGreatestCoordinate), "point ", i,
        " has a coordinate that is not finite or beyond 1e15 m");
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
    goOn(keepGoing, i, output.size, 0.0, 0.3);
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    measure.axes[axis] = chooseAxis(low[axis], high[axis], output.degrees && axis < 2 ? 9 : 6);
  }
  if (output.waveforms)
  {
    measureWaveforms(*output.waveforms, measure, keepGoing);
  }
  return measure;
}

void writeLas(OutputFile& file, OutputFile* packets, const LasOutput& output,
  const LasMeasure& measure, const KeepGoing& keepGoing)
{
  Bytes vlrs;
  std::size_t count = 0;
  const auto add = [&](int record, const char* user, const char* description, const Bytes& content)
  {
    append(vlrs, makeVlr(record, user, description, content));
    ++count;
  };
  if (!output.crs.empty())
  {
    // The WKT ends with a zero byte.
    add(2112, "LASF_Projection", "OGC coordinate system WKT",
      Bytes(output.crs.c_str(), output.crs.c_str() + output.crs.size() + 1));
  }
  if (!output.extra.empty())
  {
    add(4, "LASF_Spec", "Extra bytes", describeAll(output.extra));
  }
  if (!output.description.empty())
  {
    add(3, "LASF_Spec", "Text area description",
      Bytes(output.description.begin(), output.description.end()));
  }
  for (std::size_t i = 0; i < measure.lengths.size(); ++i)
  {
    add(LasDescriptorRecord + 1 + static_cast<int>(i), "LASF_Spec", PacketWords,
      makeDescriptor(measure.levels, measure.lengths[i]));
  }
  const LasLayout layout = layoutFor(output);
  if (output.compressed)
  {
    add(LazRecord, LazUser, "LASzip", lazRecordOf(layout));
  }
  file.write(makeHeader(output, measure, layout, count, vlrs.size(), packets != nullptr));
  file.write(vlrs);
  if (output.compressed)
  {
    writeLazRecords(file, LasHeaderSize + vlrs.size(), layout, output.size,
      [&](std::int64_t i, unsigned char* to)
      {
        encodePoint(output, measure, i, to);
        goOn(keepGoing, i, output.size, 0.3, 1.0);
      });
    return;
  }

  Bytes block;
  for (std::int64_t first = 0; first < output.size; first += PointsPerBlock)
  {
    const std::int64_t end = std::min(output.size, first + PointsPerBlock);
    block.assign(static_cast<std::size_t>(end - first) * layout.length, 0);
    for (std::int64_t i = first; i < end; ++i)
    {
      encodePoint(output, measure, i, block.data() + (i - first) * layout.length);
    }
    file.write(block);
    goOn(keepGoing, first, output.size, output.waveforms ? 0.5 : 0.3, output.waveforms ? 0.7 : 1.0);
  }
  if (output.waveforms)
  {
    writePackets(packets ? *packets : file, *output.waveforms, measure, keepGoing);
  }
}
}
