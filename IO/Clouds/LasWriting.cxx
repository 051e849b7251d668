// SPDX-License-Identifier: BSD-3-Clause
#include "LasFormat.h"
#include "LazFormat.h"
#include "vtkAvianLidarNames.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

namespace avianlidar::formats
{
namespace
{
using Bytes = std::vector<unsigned char>;

constexpr double GreatestInteger = 2147483647.0;
constexpr std::uint16_t WktBit = 1 << 4;

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

void encodePoint(const LasOutput& output, const std::array<LasAxis, 3>& axes, std::int64_t index,
  unsigned char* at)
{
  const Point position = output.position(index);
  std::fill_n(at, 30, static_cast<unsigned char>(0));
  for (int axis = 0; axis < 3; ++axis)
  {
    store(axes[axis].encode(position[axis]), at + 4 * axis);
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
  at += 30;
  for (int c = 0; output.colour && c < 3; ++c, at += 2)
  {
    storeAs(Scalar::UInt16, output.colour(index, c) * 257.0, at);
  }
  for (const Field& field : output.extra)
  {
    storeAs(field.type, field.value(index), at);
    at += sizeOf(field.type);
  }
}

LasLayout layoutFor(const LasOutput& output)
{
  std::size_t length = output.colour ? 36 : 30;
  for (const Field& field : output.extra)
  {
    length += sizeOf(field.type);
  }
  return layoutOf(output.colour ? 7 : 6, length);
}

Bytes makeHeader(const LasOutput& output, const LasMeasure& measure, const LasLayout& layout,
  std::size_t vlrs, std::size_t vlrBytes)
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
  return header;
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
    measure.returns[std::max(static_cast<int>(number), 1) - 1] += 1;
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
  return measure;
}

void writeLas(
  OutputFile& file, const LasOutput& output, const LasMeasure& measure, const KeepGoing& keepGoing)
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
  const LasLayout layout = layoutFor(output);
  if (output.compressed)
  {
    add(LazRecord, LazUser, "LASzip", lazRecordOf(layout));
  }
  file.write(makeHeader(output, measure, layout, count, vlrs.size()));
  file.write(vlrs);
  if (output.compressed)
  {
    writeLazRecords(file, LasHeaderSize + vlrs.size(), layout, output.size,
      [&](std::int64_t i, unsigned char* to)
      {
        encodePoint(output, measure.axes, i, to);
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
      encodePoint(output, measure.axes, i, block.data() + (i - first) * layout.length);
    }
    file.write(block);
    goOn(keepGoing, first, output.size, 0.3, 1.0);
  }
}
}
