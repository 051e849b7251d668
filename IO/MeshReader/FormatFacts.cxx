// SPDX-License-Identifier: BSD-3-Clause
#include "FormatFacts.h"

#include "Json.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
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

/// Returns a list of an object, or an empty list if the object has no such list.
const Json& ListIn(const Json& object, const char* key)
{
  static const Json none = Json::array();
  const auto list = object.is_object() ? object.find(key) : object.end();
  return list != object.end() && list->is_array() ? *list : none;
}

std::vector<std::string> NamesIn(const Json& document, const char* key)
{
  std::vector<std::string> names;
  for (const Json& name : ListIn(document, key))
  {
    if (name.is_string())
    {
      names.push_back(name.get<std::string>());
    }
  }
  return names;
}

std::vector<const Json*> PrimitivesOf(const Json& document)
{
  std::vector<const Json*> primitives;
  for (const Json& mesh : ListIn(document, "meshes"))
  {
    for (const Json& primitive : ListIn(mesh, "primitives"))
    {
      primitives.push_back(&primitive);
    }
  }
  return primitives;
}

/// Positions are numbers of single precision (specification, section 3.7.2.1); Assimp reads others
/// as if they were.
void CheckPositions(const Json& document, const Json& primitive)
{
  constexpr int single = 5126;
  const Json& accessors = ListIn(document, "accessors");
  const auto attributes = primitive.is_object() ? primitive.find("attributes") : primitive.end();
  if (attributes == primitive.end() || !attributes->is_object())
  {
    return;
  }
  const auto position = attributes->find("POSITION");
  if (position == attributes->end() || !position->is_number_unsigned() ||
    position->get<std::size_t>() >= accessors.size())
  {
    return;
  }
  const Json& accessor = accessors[position->get<std::size_t>()];
  const auto type = accessor.is_object() ? accessor.find("componentType") : accessor.end();
  if (type != accessor.end() && type->is_number() && type->get<int>() != single)
  {
    throw Error("has positions of the component type " + std::to_string(type->get<int>()) +
      ", expected 5126, numbers of single precision");
  }
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

/// A STEP file in capital letters, without comments and without what stands in strings.
std::string WithoutComments(const std::string& file)
{
  std::string text;
  text.reserve(file.size());
  for (std::size_t at = 0; at < file.size(); ++at)
  {
    if (file.compare(at, 2, "/*") == 0)
    {
      at = std::min(file.find("*/", at), file.size() - 1) + 1;
    }
    else if (file[at] == '\'')
    {
      at = std::min(file.find('\'', at + 1), file.size());
      text += "''";
    }
    else
    {
      const char byte = file[at];
      text += byte >= 'a' && byte <= 'z' ? static_cast<char>(byte - 'a' + 'A') : byte;
    }
  }
  return text;
}

/// The rest of a STEP statement from a place on, without its end.
std::string_view StatementAt(std::string_view text, std::size_t at)
{
  return text.substr(at, text.find(';', at) - at);
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

/// The value of an attribute in an XML tag, or nothing.
std::string_view ValueOf(std::string_view tag, std::string_view name)
{
  const char* const blanks = " \t\r\n";
  for (std::size_t at = tag.find(name, 1); at != std::string_view::npos;
       at = tag.find(name, at + 1))
  {
    const std::size_t equals = tag.find_first_not_of(blanks, at + name.size());
    if (std::strchr(blanks, tag[at - 1]) && equals != std::string_view::npos && tag[equals] == '=')
    {
      const std::size_t quote = tag.find_first_of("'\"", equals);
      return quote == std::string_view::npos
        ? std::string_view()
        : tag.substr(quote + 1, tag.find(tag[quote], quote + 1) - quote - 1);
    }
  }
  return {};
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
    const char* next = line;
    while (next < end && *next != '\n' && !(*next == '\r' && (next + 1 == end || next[1] != '\n')))
    {
      ++next;
    }
    use(line, next);
    line = std::min(next + 1, end);
  }
}
}

std::vector<std::string> CheckGltf(const std::string& text)
{
  std::string json(JsonOf(text));
  // Names in other encodings, which Assimp takes; none is looked at here.
  std::replace_if(
    json.begin(), json.end(), [](char byte) { return (byte & 0x80) != 0; }, '?');
  json.erase(0, std::min(json.find('{'), json.size())); // a mark of the byte order
  const Json document = Json::parse(json, nullptr, /*allow_exceptions=*/false);
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
  for (const Json* primitive : PrimitivesOf(document))
  {
    CheckPositions(document, *primitive);
  }
  std::vector<std::string> warnings;
  if (ListIn(document, "skins").size() > 0)
  {
    warnings.push_back("it has skins, which are left out: it is read in the pose of its vertices");
  }
  for (const char* list : { "nodes", "meshes" })
  {
    for (const Json& one : ListIn(document, list))
    {
      const Json& weights = ListIn(one, "weights");
      if (std::any_of(weights.begin(), weights.end(),
            [](const Json& weight) { return weight.is_number() && weight.get<double>() != 0.0; }))
      {
        warnings.push_back("it has weights of morph targets, which are left out");
        return warnings;
      }
    }
  }
  return warnings;
}

double IfcUnit(const std::string& file)
{
  const std::string text = WithoutComments(file);
  const std::size_t project = text.find("IFCPROJECT(");
  const std::vector<std::string> of =
    project == std::string::npos ? std::vector<std::string>() : IdsIn(StatementAt(text, project));
  const std::string_view units = of.empty() ? "" : EntityOf(text, of.back());
  if (!StartsWith(units, "IFCUNITASSIGNMENT"))
  {
    return 1.0;
  }
  for (const std::string& id : IdsIn(units))
  {
    const std::string_view unit = EntityOf(text, id);
    if (unit.find(".LENGTHUNIT.") == std::string_view::npos || StartsWith(unit, "IFCSIUNIT"))
    {
      continue;
    }
    const std::vector<std::string> parts = IdsIn(unit);
    const std::string_view measure = parts.empty() ? "" : EntityOf(text, parts.back());
    const std::vector<std::string> base = IdsIn(measure);
    const double metres = base.empty() ? 0.0 : SiLength(EntityOf(text, base.back()));
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

/// Refuses 3MF files that require other extensions than that of materials.
void CheckPrintExtensions(const std::string& attributes)
{
  static const std::regex required("\\brequiredextensions *= *[\"']([^\"']*)");
  std::smatch found;
  if (!std::regex_search(attributes, found, required))
  {
    return;
  }
  std::istringstream prefixes(found[1].str());
  for (std::string prefix; prefixes >> prefix;)
  {
    std::smatch space;
    const bool isNamed =
      std::regex_search(attributes, space, std::regex("xmlns:" + prefix + " *= *[\"']([^\"']*)"));
    if (!isNamed || space[1].str().find("/material/") == std::string::npos)
    {
      throw Error("requires the 3MF extension " + (isNamed ? space[1].str() : prefix) +
        ", which is not supported: export it without this extension");
    }
  }
}

std::map<std::string, std::size_t> IfcElements(const std::string& file)
{
  const std::string text = WithoutComments(file);
  std::vector<std::pair<std::string, std::string_view>> statements;
  std::set<std::string> shapes;
  static const std::regex entity("\\s*(#[0-9]+)\\s*=\\s*([A-Z0-9_]+)\\s*\\(");
  for (std::size_t at = 0; at < text.size();)
  {
    const std::string_view statement = StatementAt(text, at);
    std::cmatch found;
    if (std::regex_search(statement.data(), statement.data() + statement.size(), found, entity,
          std::regex_constants::match_continuous))
    {
      if (found[2] == "IFCPRODUCTDEFINITIONSHAPE")
      {
        shapes.insert(found[1]);
      }
      else
      {
        statements.emplace_back(found[2], statement.substr(found.length()));
      }
    }
    at += statement.size() + 1;
  }
  std::map<std::string, std::size_t> elements;
  static const std::set<std::string> empty{ "IFCSPACE", "IFCOPENINGELEMENT", "IFCANNOTATION",
    "IFCGRID", "IFCVIRTUALELEMENT", "IFCSHAPEASPECT", "IFCPORT", "IFCDISTRIBUTIONPORT" };
  for (const auto& [type, arguments] : statements)
  {
    // Of the ids that a product names the shape is one of the last.
    if (StartsWith(type, "IFC") && StartsWith(arguments, "''") && empty.count(type) == 0)
    {
      const std::vector<std::string> ids = IdsIn(arguments);
      elements[type] += std::any_of(
        ids.begin(), ids.end(), [&shapes](const std::string& id) { return shapes.count(id) > 0; });
    }
  }
  return elements;
}

double X3dUnit(const std::string& text)
{
  static const std::regex unit("<unit\\b[^>]*category *= *[\"']length[\"'][^>]*>");
  static const std::regex factor("conversionFactor *= *[\"']([^\"']+)");
  const std::string begin = text.substr(0, text.find("<Scene"));
  std::smatch element, found;
  if (!std::regex_search(begin, element, unit))
  {
    return 1.0;
  }
  const std::string attributes = element.str();
  const double metres =
    std::regex_search(attributes, found, factor) ? std::atof(found[1].str().c_str()) : 0.0;
  if (!(metres > 0.0))
  {
    throw Error("has a unit of length without a positive conversionFactor");
  }
  return metres;
}

double OpenGexUnit(const std::string& text, char& upAxis)
{
  static const std::regex metric("Metric[^{]*\"(distance|up)\"[^{]*\\{[^{]*\\{\\s*\"?([^\"}\\s]+)");
  double metres = 1.0;
  const std::string begin = text.substr(0, 1u << 14);
  for (std::sregex_iterator at(begin.begin(), begin.end(), metric), end; at != end; ++at)
  {
    const std::string value = (*at)[2];
    if ((*at)[1] == "up")
    {
      upAxis = value == "y" ? 'y' : 'z';
    }
    else if (metres = std::atof(value.c_str()); !(metres > 0.0))
    {
      throw Error("has the distance '" + value + "' in its Metric, expected metres above 0");
    }
  }
  return metres;
}

void CheckPly(const std::string& text)
{
  if (text.empty())
  {
    return; // Assimp reports that the file cannot be opened
  }
  const char* const end = "end_header";
  for (std::size_t at = text.find(end); at != std::string::npos; at = text.find(end, at + 1))
  {
    const std::size_t before = text.find_last_not_of(" \t", at - 1);
    if (at > 0 && before != std::string::npos && (text[before] == '\n' || text[before] == '\r'))
    {
      static const std::regex strips("[\n\r]element\\s+tristrips\\b");
      if (std::regex_search(text.substr(0, at), strips))
      {
        throw Error("has triangle strips, which are not supported: export it with faces");
      }
      return;
    }
  }
  throw Error("is broken: its header has no line end_header");
}

std::vector<std::string> Check3mf(const std::string& text)
{
  std::set<std::string> held;
  std::vector<std::string> named;
  std::size_t painted = 0;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1))
  {
    std::string_view tag = std::string_view(text).substr(at + 1, text.find('>', at) - at - 1);
    const std::size_t nameEnd = std::min(tag.find_first_of(" \t\r\n/"), tag.size());
    const std::size_t space = tag.substr(0, nameEnd).find(':');
    const std::string_view name =
      tag.substr(0, nameEnd).substr(space == std::string_view::npos ? 0 : space + 1);
    tag.remove_prefix(nameEnd);
    if (name == "triangle")
    {
      painted += !ValueOf(tag, "pid").empty() || !ValueOf(tag, "p1").empty();
    }
    else if (name == "object")
    {
      held.emplace(ValueOf(tag, "id"));
    }
    else if (name == "item" || name == "component")
    {
      named.emplace_back(ValueOf(tag, "objectid"));
    }
  }
  for (const std::string& name : named)
  {
    if (held.count(name) == 0)
    {
      throw Error("is broken: it builds the object " + name + ", which it does not hold");
    }
  }
  return painted == 0 ? std::vector<std::string>()
                      : std::vector<std::string>{ "materials of " + std::to_string(painted) +
                          " triangles are left out: they have that of their object" };
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
  static const std::regex comment("<!--[^]*?-->");
  const std::string start = std::regex_replace(text.substr(0, 1u << 16), comment, "");
  if (!std::regex_search(start, element, root))
  {
    return 1e-3;
  }
  const std::string attributes = element.str();
  CheckPrintExtensions(attributes);
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

void CheckAmf(const std::string& text)
{
  for (const char* turn : { "<rx>", "<ry>", "<rz>" })
  {
    if (text.find(turn) != std::string::npos)
    {
      throw Error(std::string("turns objects of a constellation (") + turn +
        "), which is not supported: export it with the objects turned");
    }
  }
  const auto count = [&text](const char* element)
  {
    std::size_t found = 0;
    for (std::size_t at = text.find(element); at != std::string::npos;
         at = text.find(element, at + 1))
    {
      ++found;
    }
    return found;
  };
  if (count("<volume") > count("<mesh"))
  {
    throw Error("has meshes of several volumes, which are not supported: export each volume as an "
                "object");
  }
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
