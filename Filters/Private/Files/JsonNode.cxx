// SPDX-License-Identifier: BSD-3-Clause
#include "JsonNode.h"

#include "RegularFile.h"

#include <fstream>
#include <set>

namespace avianlidar
{
namespace
{
// Largest depth of nested values, far more than any key needs. The limit protects the stack,
// because values are copied and destroyed recursively.
constexpr int DeepestNesting = 100;

// Rejects input that the parser accepts: values nested without limit, and a key that stands twice
// in an object.
class Strictness
{
public:
  bool operator()(int depth, Json::parse_event_t event, Json& parsed)
  {
    failIf(depth >= DeepestNesting, "it is nested more than ", DeepestNesting, " deep");
    if (event == Json::parse_event_t::object_start)
    {
      this->Open.emplace_back();
    }
    else if (event == Json::parse_event_t::object_end)
    {
      this->Open.pop_back();
    }
    else if (event == Json::parse_event_t::key &&
      !this->Open.back().insert(parsed.get<std::string>()).second)
    {
      throw FileError("the key \"" + parsed.get<std::string>() + "\" stands twice in one object");
    }
    return true;
  }

private:
  std::vector<std::set<std::string>> Open;
};

template <class Input>
Json Parse(Input& input, const std::string& file)
try
{
  return Json::parse(input, Strictness());
}
catch (const Json::exception& e)
{
  throw FileError(file + ": is not JSON: " + e.what());
}
catch (const FileError& e)
{
  throw FileError(file + ": " + e.what());
}
}

Json ReadJson(const std::string& file)
{
  const std::string irregular = whyNotRegular(file);
  failIf(!irregular.empty(), file, ": ", irregular);
  std::ifstream stream(file, std::ios::binary);
  failIf(!stream, file, ": cannot be opened");
  return Parse(stream, file);
}

Json ParseJson(const std::string& text, const std::string& file)
{
  return Parse(text, file);
}

void JsonNode::Fail(const std::string& message) const
{
  fail(this->File, ": ", this->Path.empty() ? "the whole" : this->Path, ": ", message);
}

bool JsonNode::Has(const char* key) const
{
  return this->Value.is_object() && this->Value.contains(key);
}

JsonNode JsonNode::Get(const std::string& key) const
{
  const std::string path = this->Path.empty() ? key : this->Path + "." + key;
  this->FailIf(!this->Value.is_object(), "must be an object {...}");
  const auto found = this->Value.find(key);
  failIf(found == this->Value.end(), this->File, ": ", path, ": is missing");
  return JsonNode(*found, path, this->File);
}

void JsonNode::RequireKeys(const std::vector<std::string>& known) const
{
  for (const auto& member : this->Members())
  {
    bool found = false;
    std::string list;
    for (const std::string& key : known)
    {
      found = found || member.first == key;
      list += (list.empty() ? "" : ", ") + key;
    }
    if (!found)
    {
      member.second.Fail("unknown key; known here: " + list);
    }
  }
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::Members() const
{
  this->FailIf(!this->Value.is_object(), "must be an object {...}");
  std::vector<std::pair<std::string, JsonNode>> members;
  for (const auto& item : this->Value.items())
  {
    this->RequireNoNul(item.key());
    members.emplace_back(item.key(), this->Get(item.key()));
  }
  return members;
}

std::vector<JsonNode> JsonNode::Items(std::size_t size) const
{
  this->FailIf(!this->Value.is_array() || (size && this->Value.size() != size),
    "must be an array [...]", size ? " of " + std::to_string(size) : std::string());
  std::vector<JsonNode> items;
  for (std::size_t i = 0; i < this->Value.size(); ++i)
  {
    items.emplace_back(this->Value[i], this->Path + "[" + std::to_string(i) + "]", this->File);
  }
  return items;
}

double JsonNode::Number() const
{
  this->FailIf(!this->Value.is_number(), "must be a number");
  return this->Value.get<double>(); // JSON has no infinity
}

double JsonNode::NumberIn(double lowest, double highest) const
{
  const double value = this->Number();
  this->FailIf(
    value < lowest || value > highest, "must be from ", lowest, " to ", highest, ", is ", value);
  return value;
}

double JsonNode::PositiveNumber() const
{
  const double value = this->Number();
  this->FailIf(!(value > 0), "must be greater than 0, is ", value);
  return value;
}

bool JsonNode::Bool() const
{
  this->FailIf(!this->Value.is_boolean(), "must be true or false");
  return this->Value.get<bool>();
}

void JsonNode::RequireNoNul(const std::string& text) const
{
  this->FailIf(text.find('\0') != std::string::npos,
    "must hold no NUL character, where names of files and blocks would end");
}

std::string JsonNode::String() const
{
  this->FailIf(!this->Value.is_string(), "must be a string");
  const std::string text = this->Value.get<std::string>();
  this->RequireNoNul(text);
  return text;
}

std::string JsonNode::Name() const
{
  const std::string name = this->String();
  this->FailIf(name.empty(), "must not be empty");
  return name;
}

std::array<double, 3> JsonNode::Vector() const
{
  const auto items = this->Items(3);
  return { items[0].Number(), items[1].Number(), items[2].Number() };
}

std::vector<std::string> JsonNode::Strings() const
{
  if (this->Value.is_string())
  {
    return { this->String() };
  }
  std::vector<std::string> strings;
  for (const auto& item : this->Items())
  {
    strings.push_back(item.String());
  }
  return strings;
}
}
