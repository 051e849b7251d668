// SPDX-License-Identifier: BSD-3-Clause
#include "FormatFacts.h"

#include "FileNames.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iterator>
#include <regex>
#include <set>
#include <string_view>
#include <utility>

namespace avianlidar::scene
{
namespace
{
/// Returns a STEP file in capital letters, without comments and without the contents of strings.
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

/// Statement of a STEP file, such as "#12=IFCSIUNIT(...)".
struct Entity
{
  std::string_view id;
  std::string_view type;
  std::string_view arguments; ///< arguments with the closing bracket
};

/// Returns the statements of a file without comments, in order.
std::vector<Entity> EntitiesOf(std::string_view text)
{
  static const std::regex start("\\s*(#[0-9]+)\\s*=\\s*([A-Z0-9_]+)\\s*\\(");
  std::vector<Entity> entities;
  for (std::size_t at = 0; at < text.size();)
  {
    const std::string_view statement = text.substr(at, text.find(';', at) - at);
    std::cmatch found;
    if (std::regex_search(statement.data(), statement.data() + statement.size(), found, start,
          std::regex_constants::match_continuous))
    {
      entities.push_back({ statement.substr(found.position(1), found.length(1)),
        statement.substr(found.position(2), found.length(2)), statement.substr(found.length()) });
    }
    at += statement.size() + 1;
  }
  return entities;
}

/// Returns the first entity with an id, or an empty entity if no entity has the id.
Entity EntityOf(const std::vector<Entity>& entities, const std::string& id)
{
  const auto found = std::find_if(
    entities.begin(), entities.end(), [&id](const Entity& entity) { return entity.id == id; });
  return found == entities.end() ? Entity() : *found;
}

/// Returns the ids, such as "#12", that a definition names.
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

/// Returns the factor of an IFCSIUNIT of length, m, or 0 for any other entity.
double SiLength(const Entity& unit)
{
  if (unit.type != "IFCSIUNIT" || unit.arguments.find(".METRE.") == std::string_view::npos)
  {
    return 0.0;
  }
  static const std::pair<const char*, double> prefixes[] = { { ".EXA.", 1e18 }, { ".PETA.", 1e15 },
    { ".TERA.", 1e12 }, { ".GIGA.", 1e9 }, { ".MEGA.", 1e6 }, { ".KILO.", 1e3 }, { ".HECTO.", 1e2 },
    { ".DECA.", 1e1 }, { ".DECI.", 1e-1 }, { ".CENTI.", 1e-2 }, { ".MILLI.", 1e-3 },
    { ".MICRO.", 1e-6 }, { ".NANO.", 1e-9 }, { ".PICO.", 1e-12 }, { ".FEMTO.", 1e-15 },
    { ".ATTO.", 1e-18 } };
  for (const auto& [name, factor] : prefixes)
  {
    if (unit.arguments.find(name) != std::string_view::npos)
    {
      return factor;
    }
  }
  return 1.0;
}

/// Returns the length of the unit of a file, m, or 1 if the file does not give a unit.
double IfcUnit(const std::vector<Entity>& entities)
{
  const auto project = std::find_if(entities.begin(), entities.end(),
    [](const Entity& entity) { return entity.type == "IFCPROJECT"; });
  const std::vector<std::string> of =
    project == entities.end() ? std::vector<std::string>() : IdsIn(project->arguments);
  const Entity units = of.empty() ? Entity() : EntityOf(entities, of.back());
  if (units.type != "IFCUNITASSIGNMENT")
  {
    return 1.0;
  }
  for (const std::string& id : IdsIn(units.arguments))
  {
    const Entity unit = EntityOf(entities, id);
    if (unit.arguments.find(".LENGTHUNIT.") == std::string_view::npos || unit.type == "IFCSIUNIT")
    {
      continue;
    }
    const std::vector<std::string> parts = IdsIn(unit.arguments);
    const std::string_view measure =
      parts.empty() ? "" : EntityOf(entities, parts.back()).arguments;
    const std::vector<std::string> base = IdsIn(measure);
    const double metres = base.empty() ? 0.0 : SiLength(EntityOf(entities, base.back()));
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
    fail("has a unit of length, ", id,
      ", that cannot be read, expected an IFCCONVERSIONBASEDUNIT of metres");
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

/// Returns whether a line of an OBJ file is a vertex, "v x y z". Moves `at` behind the "v" if so.
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

/// Reads the coordinates behind a "v". Returns false if a coordinate cannot be read, or if a weight
/// divides the coordinates.
bool ReadVertex(const char*& at, const char* end, Point3& vertex)
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
  // More than four numbers are coordinates and colours, without a weight.
  return !hasMore || weight == 1.0 || more < end;
}

/// Moves `at` behind the next word. Returns whether the word is a number as Assimp reads numbers,
/// with a decimal point or a decimal comma.
bool SkipNumber(const char*& at, const char* end)
{
  SkipBlanks(at, end);
  at += at < end && *at == '+';
  double number = 0.0;
  const auto [next, error] = std::from_chars(at, end, number);
  at = next < end && *next == ',' ? std::from_chars(next + 1, end, number).ptr : next;
  return error != std::errc::invalid_argument && (at == end || std::strchr(" \t\r#", *at));
}

/// Calls use(begin, end) for each line, without the end of the line.
template <class Use>
void ForEachLine(std::string_view text, const Use& use)
{
  const char* const end = text.data() + text.size();
  for (const char* line = text.data(); line < end;)
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

/// Removes the next line that has words from the text, and returns its words up to a comment (#).
/// Throws Error if the line has too few words, or if no such line follows.
std::vector<std::string_view> TakeRow(std::string_view& text, std::size_t least)
{
  const char* const blanks = " \t";
  std::vector<std::string_view> words;
  words.reserve(8); // of most lines
  while (words.empty())
  {
    failIf(text.empty(), "is cut short: lines are missing at its end");
    const auto* const end = std::find_if(
      text.begin(), text.end(), [](char byte) { return byte == '\n' || byte == '\r'; });
    const std::string_view line = text.substr(0, static_cast<std::size_t>(end - text.begin()));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    std::string_view rest = line.substr(0, line.find('#'));
    for (std::size_t at; (at = rest.find_first_not_of(blanks)) != std::string_view::npos;)
    {
      rest.remove_prefix(at);
      words.push_back(rest.substr(0, rest.find_first_of(blanks)));
      rest.remove_prefix(words.back().size());
    }
    failIf(!words.empty() && words.size() < least, "is cut short or damaged: the line \"",
      line.substr(0, 80), "\" has ", words.size(), " numbers, expected ", least);
  }
  return words;
}

/// Returns the count at the beginning of a word, or 0 if the word does not begin with a count.
std::size_t CountOf(std::string_view word)
{
  std::size_t count = 0;
  std::from_chars(word.data(), word.data() + word.size(), count);
  return count;
}

/// Throws Error if a PLY file in ASCII has fewer rows or numbers than its header declares.
void CheckPlyRows(const std::string& header, std::string_view rows)
{
  static const std::regex declaration("[\n\r](format|element|property)\\s+(\\S+)\\s+(\\S+)");
  std::vector<std::pair<std::size_t, std::vector<bool>>> elements; // rows, and which are lists
  for (std::sregex_iterator at(header.begin(), header.end(), declaration), end; at != end; ++at)
  {
    const std::string key = (*at)[1], word = (*at)[2];
    if (key == "format" && word != "ascii")
    {
      return;
    }
    if (key == "element")
    {
      elements.push_back({ CountOf((*at)[3].str()), {} });
    }
    else if (key == "property" && !elements.empty())
    {
      elements.back().second.push_back(word == "list");
    }
  }
  for (const auto& [count, lists] : elements)
  {
    for (std::size_t row = 0; row < count && !lists.empty(); ++row)
    {
      const std::vector<std::string_view> words = TakeRow(rows, lists.size());
      std::size_t expected = 0;
      for (const bool isList : lists)
      {
        expected += isList && expected < words.size() ? 1 + CountOf(words[expected]) : 1;
      }
      failIf(words.size() < expected, "is cut short or damaged: row ", row + 1,
        " of an element has ", words.size(), " numbers, expected ", expected);
    }
  }
}
}

std::string SchemaOf(const std::string& text)
{
  constexpr std::size_t header = 1u << 16;
  const std::string_view begin = std::string_view(text).substr(0, header);
  const std::size_t named = begin.find("FILE_SCHEMA");
  const std::size_t first = begin.find('\'', std::min(named, begin.size()));
  const std::size_t last = begin.find('\'', std::min(first, begin.size() - 1) + 1);
  return last == std::string_view::npos ? std::string()
                                        : std::string(begin.substr(first + 1, last - first - 1));
}

double ReadIfc(const std::string& file, std::map<std::string, std::size_t>& elements)
{
  const std::string text = WithoutComments(file);
  const std::vector<Entity> entities = EntitiesOf(text);
  std::set<std::string_view> shapes;
  static const std::set<std::string_view> later{ "IFCTRIANGULATEDFACESET", "IFCPOLYGONALFACESET",
    "IFCTRIANGULATEDIRREGULARNETWORK", "IFCINDEXEDPOLYCURVE", "IFCADVANCEDBREP",
    "IFCADVANCEDBREPWITHVOIDS", "IFCADVANCEDFACE", "IFCCYLINDRICALSURFACE",
    "IFCEXTRUDEDAREASOLIDTAPERED", "IFCREVOLVEDAREASOLIDTAPERED", "IFCFIXEDREFERENCESWEPTAREASOLID",
    "IFCSWEPTDISKSOLIDPOLYGONAL", "IFCSECTIONEDSOLIDHORIZONTAL" };
  for (const Entity& entity : entities)
  {
    if (later.count(entity.type) > 0)
    {
      fail("is written in the schema ", SchemaOf(file), " and has a ", entity.type,
        ", which Assimp cannot read: export it as IFC2X3");
    }
    if (entity.type == "IFCPRODUCTDEFINITIONSHAPE")
    {
      shapes.insert(entity.id);
    }
  }
  static const std::set<std::string_view> empty{ "IFCSPACE", "IFCOPENINGELEMENT", "IFCANNOTATION",
    "IFCGRID", "IFCVIRTUALELEMENT", "IFCSHAPEASPECT", "IFCPORT", "IFCDISTRIBUTIONPORT" };
  for (const auto& [id, type, arguments] : entities)
  {
    // The shape is one of the last ids that a product names.
    if (StartsWith(type, "IFC") && StartsWith(arguments, "''") && empty.count(type) == 0)
    {
      const std::vector<std::string> ids = IdsIn(arguments);
      elements[std::string(type)] += std::any_of(ids.begin(), ids.end(),
        [&shapes](const std::string& one) { return shapes.count(one) > 0; });
    }
  }
  return IfcUnit(entities);
}

void CheckPly(const std::string& text)
{
  const char* const end = "end_header";
  for (std::size_t at = text.find(end); at != std::string::npos; at = text.find(end, at + 1))
  {
    const std::size_t before = text.find_last_not_of(" \t", at - 1);
    if (at > 0 && before != std::string::npos && (text[before] == '\n' || text[before] == '\r'))
    {
      static const std::regex strips("[\n\r]element\\s+tristrips\\b");
      const std::string header = text.substr(0, at);
      failIf(std::regex_search(header, strips),
        "has triangle strips, which are not supported: export it with faces");
      CheckPlyRows(header, std::string_view(text).substr(at + std::strlen(end)));
      return;
    }
  }
  fail("is broken: its header has no line end_header");
}

void CheckObj(const std::string& text)
{
  std::size_t line = 0;
  ForEachLine(text,
    [&line](const char* begin, const char* end)
    {
      ++line;
      const char* at = begin;
      // A backslash continues the line.
      if (IsVertex(at, end) && std::find(at, end, '\\') == end)
      {
        failIf(!SkipNumber(at, end) || !SkipNumber(at, end) || !SkipNumber(at, end), "line ", line,
          " is \"", std::string_view(begin, std::min<std::size_t>(end - begin, 80)),
          "\", expected a vertex with three coordinates");
      }
    });
}

Point3 MoveObjToOrigin(std::vector<char>& bytes)
{
  constexpr double farAway = 8192.0; // limit of the rounding below 0.001
  Point3 offset{};
  double farthest = 0.0;
  bool isFirst = true, canMove = true;
  ForEachLine({ bytes.data(), bytes.size() },
    [&](const char* at, const char* end)
    {
      Point3 vertex;
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
  ForEachLine({ bytes.data(), bytes.size() },
    [&](const char* at, const char* end)
    {
      Point3 vertex;
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
