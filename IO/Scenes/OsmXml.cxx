// SPDX-License-Identifier: BSD-3-Clause
#include "OsmXml.h"

#include "Glob.h"
#include "TextLines.h"

#include <expat.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <iterator>
#include <limits>
#include <memory>
#include <set>
#include <unordered_map>
#include <unordered_set>

namespace avianlidar::scene
{
namespace
{
constexpr std::string_view XmlSpaces = " \t\r\n";
using Id = std::int64_t;

struct Tag
{
  std::string key, value;
};

struct Member
{
  std::string type, role;
  Id ref = 0;

  bool IsRing() const { return this->type == "way" && this->role != "subarea"; }
  bool IsInner() const { return this->role == "inner"; }
};

struct Node
{
  Id id = 0;
  double latitude = 0, longitude = 0; // deg
  std::vector<Tag> tags;

  std::size_t Size() const { return this->tags.size(); }
};

struct Way
{
  Id id = 0;
  std::vector<Id> nodes;
  std::vector<Tag> tags;
  bool isClosed = false;
  bool isCut = false;  // whether nodes of it are missing
  bool isLost = false; // whether too few nodes are left

  std::size_t Size() const { return this->nodes.size() + this->tags.size(); }
};

struct Relation
{
  Id id = 0;
  std::vector<Member> members;
  std::vector<Tag> tags;
  bool isLost = false;

  std::size_t Size() const { return this->members.size() + this->tags.size(); }
};

// Objects in the order of the file, each id once. The larger of two with one id counts.
template <class T>
class Objects
{
public:
  void Add(T one)
  {
    const auto [known, isNew] = this->Index.emplace(one.id, this->All.size());
    if (isNew)
    {
      this->All.push_back(std::move(one));
    }
    else if (one.Size() > this->All[known->second].Size())
    {
      this->All[known->second] = std::move(one);
    }
  }
  const T* Find(Id id) const
  {
    const auto known = this->Index.find(id);
    return known == this->Index.end() ? nullptr : &this->All[known->second];
  }
  auto begin() { return this->All.begin(); }
  auto end() { return this->All.end(); }

private:
  std::vector<T> All;
  std::unordered_map<Id, std::size_t> Index;
};

std::string_view Trimmed(std::string_view text)
{
  text.remove_prefix(std::min(text.find_first_not_of(XmlSpaces), text.size()));
  return text.substr(0, text.find_last_not_of(XmlSpaces) + 1);
}

std::optional<double> ReadDegrees(std::string_view text, double largest)
{
  const std::optional<double> value = parsed<double>(Trimmed(text));
  return value && std::abs(*value) <= largest ? value : std::nullopt;
}

std::string FindTag(const std::vector<Tag>& tags, std::string_view key)
{
  const auto found =
    std::find_if(tags.begin(), tags.end(), [key](const Tag& tag) { return tag.key == key; });
  return found == tags.end() ? std::string() : found->value;
}

// Attributes of an element: names and values in turn, as Expat gives them.
using Attributes = const char* const*;

std::string_view Get(Attributes all, std::string_view name)
{
  for (; *all; all += 2)
  {
    if (name == *all)
    {
      return all[1];
    }
  }
  return {};
}

// Nodes, ways and relations of a file.
struct Map
{
  Objects<Node> nodes;
  Objects<Way> ways;
  Objects<Relation> relations;
  std::vector<std::pair<Id, std::string>> placeless; // nodes, and their ids as written
  Names nameless;
};

// Reads a map from the events of Expat. Expat is not made for exceptions, so that they are kept
// until Expat has returned.
class MapReader
{
public:
  MapReader()
    : Parser(XML_ParserCreate(nullptr), &XML_ParserFree)
  {
    if (!this->Parser)
    {
      throw std::bad_alloc();
    }
    XML_SetUserData(this->Parser.get(), this);
    XML_SetElementHandler(this->Parser.get(), &MapReader::OnStart, &MapReader::OnEnd);
  }

  // Returns false if the XML is damaged.
  bool Read(const std::string& text, bool isLast)
  {
    const XML_Status status =
      XML_Parse(this->Parser.get(), text.data(), static_cast<int>(text.size()), isLast);
    if (this->Failure)
    {
      std::rethrow_exception(this->Failure);
    }
    return status == XML_STATUS_OK;
  }

  Map& GetMap() { return this->Found; }

private:
  enum class Kind
  {
    None,
    Node,
    Way,
    Relation
  };

  template <class F>
  void Do(const F& work)
  {
    try
    {
      work();
    }
    catch (...)
    {
      this->Failure = std::current_exception();
      XML_StopParser(this->Parser.get(), XML_FALSE);
    }
  }

  static void XMLCALL OnStart(void* self, const char* name, const char** attributes)
  {
    auto& reader = *static_cast<MapReader*>(self);
    reader.Do([&] { reader.Start(name, attributes); });
  }
  static void XMLCALL OnEnd(void* self, const char* name)
  {
    auto& reader = *static_cast<MapReader*>(self);
    reader.Do([&] { reader.End(name); });
  }

  static Kind KindOf(std::string_view name)
  {
    return name == "node"  ? Kind::Node
      : name == "way"      ? Kind::Way
      : name == "relation" ? Kind::Relation
                           : Kind::None;
  }

  void Start(std::string_view name, Attributes own)
  {
    if (this->Current == Kind::None)
    {
      this->StartObject(KindOf(name), own);
    }
    else if (++this->Depth == 1)
    {
      this->AddPart(name, own);
    }
  }

  void StartObject(Kind kind, Attributes own)
  {
    this->Current = kind;
    this->Depth = 0;
    this->IsKept =
      kind != Kind::None && Get(own, "action") != "delete" && Get(own, "visible") != "false";
    if (!this->IsKept)
    {
      return;
    }
    const std::optional<Id> id = parsed<Id>(Trimmed(Get(own, "id")));
    if (!id)
    {
      const char* const words[] = { "", "node ", "way ", "relation " };
      this->Found.nameless.Add(
        words[static_cast<int>(kind)] + ('"' + std::string(Get(own, "id")) + '"'));
      this->IsKept = false;
      return;
    }
    this->OneWay = {};
    this->OneRelation = {};
    this->OneNode = {};
    this->OneNode.id = this->OneWay.id = this->OneRelation.id = *id;
    if (kind == Kind::Node)
    {
      const auto latitude = ReadDegrees(Get(own, "lat"), 90.0);
      const auto longitude = ReadDegrees(Get(own, "lon"), 180.0);
      if (!latitude || !longitude)
      {
        this->Found.placeless.emplace_back(*id, std::string(Trimmed(Get(own, "id"))));
        this->IsKept = false;
        return;
      }
      this->OneNode.latitude = *latitude;
      this->OneNode.longitude = *longitude;
    }
  }

  void AddPart(std::string_view name, Attributes own)
  {
    if (!this->IsKept)
    {
      return;
    }
    if (name == "tag")
    {
      auto& tags = this->Current == Kind::Node ? this->OneNode.tags
        : this->Current == Kind::Way           ? this->OneWay.tags
                                               : this->OneRelation.tags;
      tags.push_back({ std::string(Get(own, "k")), std::string(Get(own, "v")) });
    }
    // A reference that is not a number is one to a missing object.
    const Id ref = parsed<Id>(Trimmed(Get(own, "ref"))).value_or(std::numeric_limits<Id>::min());
    if (name == "nd" && this->Current == Kind::Way)
    {
      this->OneWay.nodes.push_back(ref);
    }
    if (name == "member" && this->Current == Kind::Relation)
    {
      this->OneRelation.members.push_back(
        { std::string(Get(own, "type")), std::string(Get(own, "role")), ref });
    }
  }

  void End(std::string_view)
  {
    if (this->Current == Kind::None)
    {
      return;
    }
    if (this->Depth > 0)
    {
      --this->Depth;
      return;
    }
    const Kind kind = std::exchange(this->Current, Kind::None);
    if (!this->IsKept)
    {
      return;
    }
    kind == Kind::Node    ? this->Found.nodes.Add(std::move(this->OneNode))
      : kind == Kind::Way ? this->Found.ways.Add(std::move(this->OneWay))
                          : this->Found.relations.Add(std::move(this->OneRelation));
  }

  std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> Parser;
  std::exception_ptr Failure;
  Map Found;
  Kind Current = Kind::None; // the object that is being read
  int Depth = 0;             // number of open elements inside the object
  bool IsKept = false;
  Node OneNode;
  Way OneWay;
  Relation OneRelation;
};

// Asks every 4096 steps whether the work is still wanted.
class Steps
{
public:
  explicit Steps(const std::function<bool()>& keepGoing)
    : KeepGoing(keepGoing)
  {
  }
  void operator()()
  {
    if (++this->Count % 4096 == 0 && !this->KeepGoing())
    {
      throw WorkStopped();
    }
  }

private:
  const std::function<bool()>& KeepGoing;
  std::size_t Count = 0;
};

// Tags that make an area of a closed way in GDAL's OSM driver (osmconf.ini,
// closed_ways_are_polygons).
bool IsArea(const std::vector<Tag>& tags)
{
  static constexpr std::string_view keys[] = { "aeroway", "amenity", "boundary", "building",
    "craft", "geological", "historic", "landuse", "leisure", "military", "natural", "office",
    "place", "shop", "sport", "tourism" };
  const std::string area = FindTag(tags, "area");
  return area == "yes" ||
    (area != "no" &&
      std::any_of(tags.begin(), tags.end(),
        [](const Tag& tag)
        {
          return std::find(std::begin(keys), std::end(keys), tag.key) != std::end(keys) ||
            (tag.value == "platform" && (tag.key == "highway" || tag.key == "public_transport"));
        }));
}

// Finds the faults of a map, and leaves out what has them.
class Faults
{
public:
  Faults(Map& map, const OsmWanted& wanted, const std::function<bool()>& keepGoing)
    : Found(map)
    , Wanted(wanted)
    , AreWanted(wanted.layer == "multipolygons")
    , Step(keepGoing)
  {
  }

  void Find(OsmNotes& notes)
  {
    Names placeless;
    std::unordered_set<Id> counted;
    for (const auto& [id, text] : this->Found.placeless)
    {
      if (!this->Found.nodes.Find(id) && counted.insert(id).second)
      {
        placeless.Add(text);
      }
    }
    for (Way& way : this->Found.ways)
    {
      this->Step();
      this->Cut(way);
    }
    for (Relation& relation : this->Found.relations)
    {
      this->Step();
      const std::string type = FindTag(relation.tags, "type");
      if (type == "multipolygon" || type == "boundary")
      {
        this->Check(relation);
      }
      else if (this->AreWanted && !this->Wanted.filters.empty() &&
        this->Fits(relation.tags, "osm_id", relation.id))
      {
        this->Others.Add("relation " + std::to_string(relation.id));
      }
    }
    for (Way& way : this->Found.ways)
    {
      this->Step();
      this->Count(way);
      this->Turn(way);
    }
    notes = { { "nodes whose place is not in degrees were left out", placeless },
      { "objects without a whole number as id were left out", this->Found.nameless },
      { "relations with missing ways were left out", this->Missing },
      { "relations without ways were left out", this->Empty },
      { "relations whose outer ways do not close were left out", this->Unclosed },
      { "relations lack courtyards whose ways are missing or do not close", this->Filled },
      { "relations that are not multipolygons were left out", this->Others },
      { "relations lack parts that are relations", this->Nested },
      { "ways that are not closed were left out", this->Open },
      { "closed ways that are lines by GDAL's rules were left out", this->Lines },
      { "ways of which too few nodes are in the file were left out", this->Lost },
      { "ways and relations lack corners whose nodes are missing", this->Clipped } };
  }

private:
  // Takes the missing nodes out of a way.
  void Cut(Way& way) const
  {
    way.isClosed = way.nodes.size() > 3 && way.nodes.front() == way.nodes.back();
    const auto isMissing = [this](Id node) { return this->Found.nodes.Find(node) == nullptr; };
    const auto end = std::remove_if(way.nodes.begin(), way.nodes.end(), isMissing);
    way.isCut = end != way.nodes.end();
    way.nodes.erase(end, way.nodes.end());
    way.isLost = way.nodes.size() < 2;
    if (way.isCut && way.isClosed && !way.isLost)
    {
      if (way.nodes.front() != way.nodes.back())
      {
        way.nodes.push_back(way.nodes.front());
      }
      way.isLost = std::set<Id>(way.nodes.begin(), way.nodes.end()).size() < 3;
    }
  }

  const Way* FindWay(const Member& member) const
  {
    const Way* const way = this->Found.ways.Find(member.ref);
    return way && !way->isLost ? way : nullptr;
  }

  // Returns a number of the place of a node, to 1e-7 degrees as in GDAL: in relations, ends of ways
  // meet if they have one place.
  std::int64_t PlaceOf(Id node) const
  {
    const Node& found = *this->Found.nodes.Find(node);
    return std::llround(1e7 * found.latitude) * (std::int64_t(1) << 32) +
      std::llround(1e7 * found.longitude);
  }

  bool IsOpen(const Way& way) const
  {
    return this->PlaceOf(way.nodes.front()) != this->PlaceOf(way.nodes.back());
  }

  // Takes repeated ways and incomplete courtyards out of an area, or leaves the area out.
  void Check(Relation& relation)
  {
    std::vector<Member>& members = relation.members;
    const bool fits = this->AreWanted && this->Fits(this->TagsOf(relation), "osm_id", relation.id);
    if (this->AreWanted && !fits)
    {
      // GDAL draws no outer way of a relation by itself, even if only the way is wanted.
      relation.isLost = true;
      return;
    }
    std::unordered_set<Id> ways;
    members.erase(
      std::remove_if(members.begin(), members.end(),
        [&](const Member& one) { return one.IsRing() && !ways.insert(one.ref).second; }),
      members.end());
    this->OfRelations.insert(ways.begin(), ways.end());
    const std::string name = "relation " + std::to_string(relation.id);
    Names ignored;
    const auto leave = [&](Names& names)
    {
      relation.isLost = true;
      (fits ? names : ignored).Add(name);
    };
    if (ways.empty())
    {
      leave(this->Empty);
      return;
    }
    if (std::any_of(members.begin(), members.end(),
          [](const Member& one) { return one.type == "relation" && one.role != "subarea"; }))
    {
      this->Nested.Add(name);
    }
    const auto isMissing = [this](const Member& one)
    { return one.IsRing() && !this->FindWay(one); };
    if (std::any_of(members.begin(), members.end(),
          [&](const Member& one) { return isMissing(one) && !one.IsInner(); }))
    {
      leave(this->Missing);
      return;
    }
    const auto missing = std::remove_if(members.begin(), members.end(), isMissing);
    bool isFilled = missing != members.end();
    members.erase(missing, members.end());
    if (!this->DoClose(members, [](const Member&) { return true; }))
    {
      if (!this->DoClose(members, [](const Member& one) { return !one.IsInner(); }))
      {
        leave(this->Unclosed);
        return;
      }
      isFilled = true;
      members.erase(std::remove_if(members.begin(), members.end(),
                      [this](const Member& one) {
                        return one.IsRing() && one.IsInner() && this->IsOpen(*this->FindWay(one));
                      }),
        members.end());
    }
    if (isFilled && fits)
    {
      this->Filled.Add(name);
    }
    if (fits &&
      std::any_of(members.begin(), members.end(),
        [this](const Member& one) { return one.IsRing() && this->FindWay(one)->isCut; }))
    {
      this->Clipped.Add(name);
    }
  }

  // Returns whether the ends of some ways of a relation meet in pairs.
  template <class F>
  bool DoClose(const std::vector<Member>& members, const F& isChosen) const
  {
    std::unordered_set<std::int64_t> odd;
    for (const Member& one : members)
    {
      if (!one.IsRing() || !isChosen(one))
      {
        continue;
      }
      const std::vector<Id>& nodes = this->FindWay(one)->nodes;
      for (const std::int64_t end : { this->PlaceOf(nodes.front()), this->PlaceOf(nodes.back()) })
      {
        if (const auto [at, isNew] = odd.insert(end); !isNew)
        {
          odd.erase(at);
        }
      }
    }
    return odd.empty();
  }

  // Returns the tags of a relation. Without own tags it has those of its first outer way.
  const std::vector<Tag>& TagsOf(const Relation& relation) const
  {
    const bool hasOwn = std::any_of(
      relation.tags.begin(), relation.tags.end(), [](const Tag& tag) { return tag.key != "type"; });
    const auto outer = std::find_if(relation.members.begin(), relation.members.end(),
      [this](const Member& one)
      { return one.type == "way" && one.role == "outer" && this->Found.ways.Find(one.ref); });
    return hasOwn || outer == relation.members.end() ? relation.tags
                                                     : this->Found.ways.Find(outer->ref)->tags;
  }

  // The rule of the filter of features.
  bool Fits(const std::vector<Tag>& tags, std::string_view idName, Id id) const
  {
    return std::all_of(this->Wanted.filters.begin(), this->Wanted.filters.end(),
      [&](const AttributeFilter& filter)
      {
        const std::string value =
          filter.attribute == idName ? std::to_string(id) : FindTag(tags, filter.attribute);
        return !value.empty() && globMatches(filter.pattern, value);
      });
  }

  // Counts a way that is or would be drawn by itself.
  void Count(const Way& way)
  {
    const bool isArea = IsArea(way.tags);
    const bool areLines = this->Wanted.layer == "lines" && !way.tags.empty();
    const bool isDrawn = way.isClosed && isArea ? this->AreWanted : areLines;
    // Without a filter all areas are wanted, and many open ways with tags of areas are lines.
    const bool isOpen = this->AreWanted && isArea && !way.isClosed &&
      !this->Wanted.filters.empty() && this->OfRelations.count(way.id) == 0;
    if ((isOpen || (isDrawn && way.isCut)) &&
      this->Fits(way.tags, this->AreWanted ? "osm_way_id" : "osm_id", way.id))
    {
      Names& names = isOpen ? this->Open : way.isLost ? this->Lost : this->Clipped;
      names.Add("way " + std::to_string(way.id));
    }
  }

  // Draws a closed way that is wanted as a line as a line, although it has a tag of areas. Names a
  // closed way that is wanted as an area, and is a line by its tags.
  void Turn(Way& way)
  {
    if (this->Wanted.filters.empty() || !way.isClosed || way.isLost ||
      !this->Fits(way.tags, this->AreWanted ? "osm_way_id" : "osm_id", way.id))
    {
      return;
    }
    const bool isArea = IsArea(way.tags);
    if (this->AreWanted && !isArea && this->OfRelations.count(way.id) == 0)
    {
      this->Lines.Add("way " + std::to_string(way.id));
    }
    if (this->Wanted.layer == "lines" && isArea)
    {
      const auto area = std::find_if(
        way.tags.begin(), way.tags.end(), [](const Tag& tag) { return tag.key == "area"; });
      if (area == way.tags.end())
      {
        way.tags.push_back({ "area", "no" });
      }
      else
      {
        area->value = "no";
      }
    }
  }

  Map& Found;
  const OsmWanted& Wanted;
  const bool AreWanted; // whether areas are wanted
  Steps Step;
  std::unordered_set<Id> OfRelations; // ways that are rings of relations
  Names Missing, Empty, Unclosed, Filled, Others, Nested, Open, Lines, Lost, Clipped;
};

// Writes a map as XML.
class Writer
{
public:
  explicit Writer(const std::function<bool()>& keepGoing)
    : Step(keepGoing)
  {
  }

  std::string Write(Map& map)
  {
    this->Text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<osm version=\"0.6\">\n";
    for (const Node& node : map.nodes)
    {
      this->Start("node", node.id);
      this->Text += " lat=\"";
      this->Put(node.latitude);
      this->Text += "\" lon=\"";
      this->Put(node.longitude);
      this->Finish("\"", "node", node.tags);
    }
    for (const Way& way : map.ways)
    {
      if (!way.isLost)
      {
        this->Start("way", way.id);
        this->Text += ">";
        for (const Id node : way.nodes)
        {
          this->Start("nd", node, "ref");
          this->Text += "/>";
        }
        this->Finish("", "way", way.tags);
      }
    }
    for (const Relation& relation : map.relations)
    {
      if (!relation.isLost)
      {
        this->Start("relation", relation.id);
        this->Text += ">";
        for (const Member& one : relation.members)
        {
          this->Start("member", one.ref, "ref");
          this->Attribute("type", one.type);
          this->Attribute("role", one.role);
          this->Text += "/>";
        }
        this->Finish("", "relation", relation.tags);
      }
    }
    return std::move(this->Text += "</osm>\n");
  }

private:
  template <class T>
  void Put(T number)
  {
    char text[40];
    this->Text.append(text, std::to_chars(std::begin(text), std::end(text), number).ptr);
  }

  void Start(const char* element, Id id, const char* name = "id")
  {
    this->Step();
    ((((this->Text += "<") += element) += " ") += name) += "=\"";
    this->Put(id);
    this->Text += "\"";
  }

  void Attribute(const char* name, const std::string& value)
  {
    ((this->Text += " ") += name) += "=\"";
    for (const char c : value)
    {
      if (std::strchr("&<>\"\t\n\r", c))
      {
        this->Text += "&#";
        this->Put(static_cast<int>(c));
        this->Text += ";";
      }
      else
      {
        this->Text += c;
      }
    }
    this->Text += "\"";
  }

  // Ends an element after its tags. @param open text that ends its first mark
  void Finish(const char* open, const char* element, const std::vector<Tag>& tags)
  {
    this->Text += open;
    this->Text += *open ? ">" : "";
    for (const Tag& tag : tags)
    {
      this->Text += "<tag";
      this->Attribute("k", tag.key);
      this->Attribute("v", tag.value);
      this->Text += "/>";
    }
    ((this->Text += "</") += element) += ">\n";
  }

  std::string Text;
  Steps Step;
};
}

bool IsOsmXml(std::string_view start)
{
  const auto skip = [&start](std::string_view mark, std::string_view end)
  {
    const bool isThere = start.substr(0, mark.size()) == mark;
    start.remove_prefix(
      isThere ? std::min(start.find(end), start.size() - end.size()) + end.size() : 0);
    return isThere;
  };
  skip("\xEF\xBB\xBF", "\xBF"); // byte-order mark
  do
  {
    start.remove_prefix(std::min(start.find_first_not_of(XmlSpaces), start.size()));
  } while (skip("<?", "?>") || skip("<!--", "-->") || skip("<!DOCTYPE", ">"));
  return start.substr(0, 4) == "<osm" && start.size() > 4 &&
    (XmlSpaces.find(start[4]) != std::string_view::npos || start[4] == '>' || start[4] == '/');
}

std::optional<std::string> InOrder(const std::function<bool(std::string&)>& read,
  const OsmWanted& wanted, OsmNotes& notes, const std::function<bool()>& keepGoing)
{
  MapReader reader;
  std::string piece;
  for (bool isLast = false; !isLast;)
  {
    if (!keepGoing())
    {
      throw WorkStopped();
    }
    piece.clear();
    isLast = !read(piece);
    if (!reader.Read(piece, isLast))
    {
      return {};
    }
  }
  Faults(reader.GetMap(), wanted, keepGoing).Find(notes);
  return Writer(keepGoing).Write(reader.GetMap());
}
}
