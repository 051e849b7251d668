// SPDX-License-Identifier: BSD-3-Clause
#include "GeoJsonFormat.h"

#include "Json.h"

#include <charconv>
#include <cmath>

namespace avianlidar::formats
{
namespace
{
using nlohmann::json;

void appendFixed(std::string& text, double value, int decimals)
{
  char digits[400];
  text.append(digits,
    std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals).ptr);
}

void appendNumber(std::string& text, const Field& field, double value)
{
  char digits[40];
  if (!std::isfinite(value))
  {
    text += "null";
    return;
  }
  // Integers without an exponent, which would make them floating-point numbers for readers.
  const auto end = isFloat(field.type)
    ? std::to_chars(digits, digits + sizeof digits, value)
    : std::to_chars(digits, digits + sizeof digits, static_cast<std::int64_t>(value));
  text.append(digits, end.ptr);
}

std::string quoted(const std::string& text)
{
  return json(text).dump(-1, ' ', true, json::error_handler_t::replace);
}

std::string featureOf(const GeoJsonOutput& output, std::int64_t i)
{
  const Point place = output.place(i);
  std::string text = R"({"type":"Feature","geometry":{"type":"Point","coordinates":[)";
  appendFixed(text, place[0], 9);
  text += ",";
  appendFixed(text, place[1], 9);
  text += ",";
  appendFixed(text, place[2], 4);
  text += R"(]},"properties":{)";
  const char* separator = "";
  for (const Field& field : output.fields)
  {
    text += separator + quoted(field.name) + ":";
    appendNumber(text, field, field.value(i));
    separator = ",";
  }
  for (const TextField& field : output.texts)
  {
    text += separator + quoted(field.name) + ":" + quoted(field.value(i));
    separator = ",";
  }
  return text + "}}";
}

std::string headOf(const GeoJsonOutput& output)
{
  json units = json::object();
  for (const Field& field : output.fields)
  {
    if (!field.unit.empty())
    {
      units[field.name] = field.unit;
    }
  }
  return R"({"type":"FeatureCollection",)"
         "\n"
         R"("description":)" +
    quoted(output.description) + ",\n" + R"("units":)" +
    units.dump(-1, ' ', true, json::error_handler_t::replace) + ",\n" + R"("features":[)";
}
}

std::int64_t writeGeoJson(OutputFile& file, const GeoJsonOutput& output, const KeepGoing& keepGoing)
{
  file.write(headOf(output));
  std::int64_t written = 0;
  for (std::int64_t i = 0; i < output.size; ++i)
  {
    if (output.wanted(i))
    {
      file.write((written > 0 ? ",\n" : "\n") + featureOf(output, i));
      ++written;
    }
    goOn(keepGoing, i, output.size, 0.0, 1.0);
  }
  file.write("\n]}\n");
  return written;
}
}
