// SPDX-License-Identifier: BSD-3-Clause
#include "FormatFacts.h"

#include "Json.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <regex>
#include <string_view>

namespace avianlidar::scene
{
namespace
{
bool StartsWith(std::string_view text, std::string_view start)
{
  return text.substr(0, start.size()) == start;
}

/// The JSON of a glTF file. In binary files it follows a header of 12 bytes, its length and mark.
std::string_view JsonOf(const std::string& text)
{
  constexpr std::size_t header = 12, chunk = 8;
  if (!StartsWith(text, "glTF") || text.size() < header + chunk)
  {
    return text;
  }
  std::uint32_t length = 0;
  std::memcpy(&length, &text[header], sizeof length);
  return std::string_view(text).substr(header + chunk, length);
}

std::vector<std::string> NamesIn(const Json& document, const char* key)
{
  std::vector<std::string> names;
  const auto list = document.is_object() ? document.find(key) : document.end();
  if (list != document.end() && list->is_array())
  {
    for (const Json& name : *list)
    {
      if (name.is_string())
      {
        names.push_back(name.get<std::string>());
      }
    }
  }
  return names;
}

/// Whether the geometry of a file that requires the extension is read right.
bool IsKnown(const std::string& extension)
{
  static const char* const starts[] = { "KHR_draco_mesh_compression", "KHR_materials_",
    "KHR_texture_", "EXT_texture_", "MSFT_texture_", "MSFT_packing_", "KHR_lights_", "EXT_lights_",
    "KHR_xmp", "EXT_mesh_features", "EXT_instance_features", "EXT_structural_metadata" };
  return std::any_of(std::begin(starts), std::end(starts),
    [&](const char* start) { return StartsWith(extension, start); });
}

/// Whether a file that only uses the extension is read wrong.
bool ChangesGeometry(const std::string& extension)
{
  return extension == "EXT_mesh_gpu_instancing" || extension == "KHR_mesh_quantization" ||
    extension == "CESIUM_RTC";
}

/// The definition of a STEP entity, in capital letters as it stands: "IFCSIUNIT(...)".
std::string_view EntityOf(std::string_view text, const std::string& id)
{
  for (std::size_t at = text.find(id); at != std::string_view::npos; at = text.find(id, at + 1))
  {
    const std::size_t equals = text.find_first_not_of(" \t\r\n", at + id.size());
    const std::size_t before = at == 0 ? at : text.find_last_not_of(" \t\r\n", at - 1);
    const bool begins = at == 0 || before == std::string_view::npos || text[before] == ';' ||
      text[before] == '/'; // behind a comment
    if (begins && equals != std::string_view::npos && text[equals] == '=')
    {
      const std::size_t begin =
        std::min(text.find_first_not_of(" \t\r\n", equals + 1), text.size());
      return text.substr(begin, text.find(';', begin) - begin);
    }
  }
  return {};
}

/// The ids, "#12", that a definition names.
std::vector<std::string> IdsIn(std::string_view definition)
{
  static const std::regex id("#[0-9]+");
  std::vector<std::string> ids;
  for (std::cregex_iterator at(definition.begin(), definition.end(), id), end; at != end; ++at)
  {
    ids.push_back(at->str());
  }
  return ids;
}

/// The factor of an IFCSIUNIT of length, m; 0 if it is not one.
double SiLength(std::string_view definition)
{
  if (!StartsWith(definition, "IFCSIUNIT") || definition.find(".METRE.") == std::string_view::npos)
  {
    return 0.0;
  }
  static const struct
  {
    const char* name;
    double factor;
  } prefixes[] = { { ".EXA.", 1e18 }, { ".PETA.", 1e15 }, { ".TERA.", 1e12 }, { ".GIGA.", 1e9 },
    { ".MEGA.", 1e6 }, { ".KILO.", 1e3 }, { ".HECTO.", 1e2 }, { ".DECA.", 1e1 }, { ".DECI.", 1e-1 },
    { ".CENTI.", 1e-2 }, { ".MILLI.", 1e-3 }, { ".MICRO.", 1e-6 }, { ".NANO.", 1e-9 },
    { ".PICO.", 1e-12 }, { ".FEMTO.", 1e-15 }, { ".ATTO.", 1e-18 } };
  for (const auto& prefix : prefixes)
  {
    if (definition.find(prefix.name) != std::string_view::npos)
    {
      return prefix.factor;
    }
  }
  return 1.0;
}

void SkipBlanks(const char*& at, const char* end)
{
  while (at < end && (*at == ' ' || *at == '\t' || *at == '\r'))
  {
    ++at;
  }
}

/// Whether a line of an OBJ file is a vertex, "v x y z"; `at` is behind the "v" then.
bool IsVertex(const char*& at, const char* end)
{
  SkipBlanks(at, end);
  const bool is = end - at > 1 && at[0] == 'v' && (at[1] == ' ' || at[1] == '\t');
  at += is;
  return is;
}

bool ReadNumber(const char*& at, const char* end, double& number)
{
  SkipBlanks(at, end);
  at += at < end && *at == '+';
  const auto [next, error] = std::from_chars(at, end, number);
  at = next;
  return error == std::errc() && std::isfinite(number);
}

/// The coordinates behind a "v"; false where they cannot be read, or a weight divides them.
bool ReadVertex(const char*& at, const char* end, Vec3& vertex)
{
  for (double& coordinate : vertex)
  {
    if (!ReadNumber(at, end, coordinate))
    {
      return false;
    }
  }
  const char* more = at;
  double weight = 1.0;
  const bool hasMore = ReadNumber(more, end, weight);
  SkipBlanks(more, end);
  return !hasMore || weight == 1.0 ||
    more < end; // of more than four numbers the others are colours
}

/// Calls use(begin, end) for each line without its end.
template <class Use>
void ForEachLine(const std::vector<char>& bytes, const Use& use)
{
  const char* const end = bytes.data() + bytes.size();
  for (const char* line = bytes.data(); line < end;)
  {
    const char* const next = std::find(line, end, '\n');
    use(line, next);
    line = std::min(next + 1, end);
  }
}
}

void CheckGltfExtensions(const std::string& text)
{
  const std::string_view json = JsonOf(text);
  const Json document = Json::parse(json.begin(), json.end(), nullptr, /*allow_exceptions=*/false);
  for (const std::string& name : NamesIn(document, "extensionsRequired"))
  {
    if (!IsKnown(name))
    {
      throw Error("requires the glTF extension " + name +
        ", which is not supported: export it without this extension");
    }
  }
  for (const std::string& name : NamesIn(document, "extensionsUsed"))
  {
    if (ChangesGeometry(name))
    {
      throw Error("uses the glTF extension " + name +
        ", which is not supported: export it without this extension");
    }
  }
}

double IfcUnit(const std::string& text)
{
  const std::size_t units = text.find("IFCUNITASSIGNMENT");
  if (units == std::string::npos)
  {
    return 1.0;
  }
  for (const std::string& id :
    IdsIn(std::string_view(text).substr(units, text.find(';', units) - units)))
  {
    const std::string_view unit = EntityOf(text, id);
    if (!StartsWith(unit, "IFCCONVERSIONBASEDUNIT") ||
      unit.find(".LENGTHUNIT.") == std::string_view::npos)
    {
      continue;
    }
    const std::vector<std::string> parts = IdsIn(unit);
    const std::string_view measure = parts.empty() ? "" : EntityOf(text, parts.back());
    const std::vector<std::string> of = IdsIn(measure);
    const double metres = of.empty() ? 0.0 : SiLength(EntityOf(text, of.back()));
    static const std::regex number("MEASURE\\( *\\+?([0-9.]+(?:[eE][-+]?[0-9]+)?) *\\)");
    std::cmatch found;
    if (metres > 0.0 && std::regex_search(measure.begin(), measure.end(), found, number))
    {
      double factor = 0.0;
      std::from_chars(found[1].first, found[1].second, factor);
      if (factor > 0.0)
      {
        return factor * metres;
      }
    }
    throw Error("has a unit of length, " + id +
      ", that cannot be read, expected an IFCCONVERSIONBASEDUNIT of metres");
  }
  return 1.0;
}

double PrintUnit(const std::string& text)
{
  static const struct
  {
    const char* name;
    double length;
  } units[] = { { "micron", 1e-6 }, { "micrometer", 1e-6 }, { "millimeter", 1e-3 },
    { "centimeter", 1e-2 }, { "inch", 0.0254 }, { "foot", 0.3048 }, { "feet", 0.3048 },
    { "meter", 1.0 } };
  static const std::regex root("<(?:[A-Za-z]+:)?(?:model|amf)\\b[^>]*>");
  static const std::regex unit("\\bunit *= *[\"']([^\"']*)");
  std::smatch element, found;
  const std::string start = text.substr(0, 1u << 16);
  if (!std::regex_search(start, element, root))
  {
    return 1e-3;
  }
  const std::string attributes = element.str();
  if (!std::regex_search(attributes, found, unit))
  {
    return 1e-3;
  }
  for (const auto& known : units)
  {
    if (found[1] == known.name)
    {
      return known.length;
    }
  }
  throw Error("has the unit '" + found[1].str() +
    "', expected micron, millimeter, centimeter, inch, foot or meter");
}

Vec3 MoveObjToOrigin(std::vector<char>& bytes)
{
  constexpr double farAway = 8192.0; // single precision keeps 0.001 there
  Vec3 offset{};
  double farthest = 0.0;
  bool isFirst = true, canMove = true;
  ForEachLine(bytes,
    [&](const char* at, const char* end)
    {
      Vec3 vertex;
      if (!IsVertex(at, end))
      {
        return;
      }
      canMove = canMove && ReadVertex(at, end, vertex);
      if (canMove)
      {
        for (int axis = 0; axis < 3; ++axis)
        {
          offset[axis] = isFirst ? std::round(vertex[axis]) : offset[axis];
          farthest = std::max(farthest, std::abs(vertex[axis]));
        }
        isFirst = false;
      }
    });
  if (!canMove || farthest < farAway)
  {
    return {};
  }
  std::vector<char> moved;
  moved.reserve(bytes.size());
  ForEachLine(bytes,
    [&](const char* at, const char* end)
    {
      Vec3 vertex;
      if (IsVertex(at, end) && ReadVertex(at, end, vertex))
      {
        moved.push_back('v');
        for (int axis = 0; axis < 3; ++axis)
        {
          char number[32];
          const auto written =
            std::to_chars(std::begin(number), std::end(number), vertex[axis] - offset[axis]);
          moved.push_back(' ');
          moved.insert(moved.end(), number, written.ptr);
        }
      }
      moved.insert(moved.end(), at, end);
      moved.push_back('\n');
    });
  bytes = std::move(moved);
  return offset;
}
}
