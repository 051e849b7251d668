// SPDX-License-Identifier: BSD-3-Clause
#include "FileLook.h"

#include "Json.h"
#include "LookedBytes.h"
#include "NodeGraph.h"
#include "XmlTags.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <unordered_map>

namespace avianlidar::scene
{
namespace
{
using nlohmann::json;

constexpr std::size_t Everything = std::numeric_limits<std::size_t>::max();

/// The nodes of glTF; all else is passed over.
json NodesOf(const std::string& text)
{
  const auto onlyNodes = [](int depth, json::parse_event_t event, json& parsed)
  {
    RefuseLevel(depth);
    return depth != 1 || event != json::parse_event_t::key || parsed == "nodes";
  };
  const json whole = json::parse(text, onlyNodes, /*allow_exceptions=*/false);
  const auto nodes = whole.is_object() ? whole.find("nodes") : whole.end();
  return nodes != whole.end() && nodes->is_array() ? *nodes : json::array();
}

void LookAtJson(const std::string& text)
{
  const json nodes = NodesOf(text);
  NodeGraph graph;
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    graph.Add();
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    const auto children = nodes[i].is_object() ? nodes[i].find("children") : nodes[i].end();
    if (!nodes[i].is_object() || children == nodes[i].end() || !children->is_array())
    {
      continue;
    }
    for (const json& child : *children)
    {
      if (child.is_number_unsigned() && child.get<std::uint64_t>() < nodes.size())
      {
        graph.Connect(i, child.get<std::size_t>());
      }
    }
  }
  graph.Check();
}

/// glTF in binary: a header of 12 bytes, then the length of the JSON, its mark and the JSON.
void LookAtBinaryGltf(LookedBytes& bytes)
{
  bytes.Text(12);
  std::size_t length = 0;
  for (int shift = 0; shift < 32; shift += 8)
  {
    length |= static_cast<std::size_t>(bytes.Get() & 0xFF) << shift;
  }
  bytes.Text(4);
  LookAtJson(bytes.Text(length));
}

/// Nodes of Collada ("node", placed again by "instance_node"), elements of X3D ("DEF" names one,
/// "USE" places it again).
class XmlNodes
{
public:
  void Take(const XmlTag& tag)
  {
    if (!tag.opens)
    {
      this->Leave();
      return;
    }
    const std::string used =
      tag.name == "instance_node" ? tag.Attribute("url") : tag.Attribute("USE");
    if (!used.empty() && this->Within >= 0)
    {
      const std::size_t mark = tag.name == "instance_node" && used[0] == '#' ? 1 : 0;
      this->Uses.emplace_back(static_cast<std::size_t>(this->Within), used.substr(mark));
    }
    this->Enclosing.push_back(this->Within);
    const std::string defined = tag.Attribute("DEF");
    if (tag.name == "node" || !defined.empty())
    {
      this->Enter(defined.empty() ? tag.Attribute("id") : defined, tag.Attribute("name"));
    }
    if (tag.closes)
    {
      this->Leave();
    }
  }

  void Check()
  {
    for (const auto& [node, name] : this->Uses)
    {
      const auto& from = this->Ids.count(name) ? this->Ids : this->Names;
      for (auto [at, end] = from.equal_range(name); at != end; ++at)
      {
        this->Graph.Connect(node, at->second);
      }
    }
    this->Graph.Check();
  }

private:
  void Enter(const std::string& id, const std::string& name)
  {
    const std::size_t node = this->Graph.Add();
    if (this->Within >= 0)
    {
      this->Graph.Connect(static_cast<std::size_t>(this->Within), node);
    }
    this->Ids.emplace(id, node);
    this->Names.emplace(name, node);
    this->Within = static_cast<std::ptrdiff_t>(node);
  }

  void Leave()
  {
    if (!this->Enclosing.empty())
    {
      this->Within = this->Enclosing.back();
      this->Enclosing.pop_back();
    }
  }

  NodeGraph Graph;
  std::ptrdiff_t Within = -1;            // the node that is open
  std::vector<std::ptrdiff_t> Enclosing; // for each open element the node around it
  std::unordered_multimap<std::string, std::size_t> Ids, Names;
  std::vector<std::pair<std::size_t, std::string>> Uses;
};

void LookAtXml(const std::string& file)
{
  XmlTags tags(file);
  XmlNodes nodes;
  for (XmlTag tag; tags.Next(tag);)
  {
    nodes.Take(tag);
  }
  nodes.Check();
}

/// AC3D: an object ends with "kids n", and n objects follow.
void LookAtAc3d(LookedBytes& bytes)
{
  std::vector<long> missing; // kids of the objects that are open
  std::string word, before;
  for (int byte = 0; byte != LookedBytes::End;)
  {
    byte = bytes.Get();
    if (byte > ' ')
    {
      word.resize(std::min<std::size_t>(word.size(), 32));
      word += static_cast<char>(byte);
      continue;
    }
    const bool counts = before == "kids" && !word.empty();
    const long kids = counts ? std::strtol(word.c_str(), nullptr, 10) : -1;
    if (kids > 0)
    {
      missing.push_back(kids);
      RefuseLevel(static_cast<int>(missing.size()));
    }
    while (kids == 0 && !missing.empty() && --missing.back() == 0)
    {
      missing.pop_back();
    }
    if (!word.empty())
    {
      before = std::move(word);
    }
    word.clear();
  }
}

/// DirectX in text: frames are braces.
void LookAtBraces(LookedBytes& bytes)
{
  int open = 0;
  for (int byte = 0; (byte = bytes.Get()) != LookedBytes::End;)
  {
    open += (byte == '{') - (byte == '}');
    RefuseLevel(open);
  }
}
}

void LookAtAssimpFile(const std::string& file)
{
  LookedBytes bytes(file);
  const std::string start = bytes.Text(16);
  const std::size_t first =
    start.find_first_not_of(std::string(" \t\r\n\xEF\xBB\xBF\xFE\xFF\0", 10));
  const char kind = first == std::string::npos ? ' ' : start[first];
  LookedBytes again(file);
  if (start.compare(0, 4, "glTF") == 0)
  {
    LookAtBinaryGltf(again);
  }
  else if (kind == '{')
  {
    LookAtJson(again.Text(Everything));
  }
  else if (kind == '<')
  {
    LookAtXml(file);
  }
  else if (start.compare(0, 4, "AC3D") == 0)
  {
    LookAtAc3d(again);
  }
  else if (start.compare(0, 4, "xof ") == 0)
  {
    LookAtBraces(again);
  }
}
}
