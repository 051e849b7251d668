// SPDX-License-Identifier: BSD-3-Clause
#include "CloudNotes.h"

#include "Json.h"

#include <algorithm>

namespace avianlidar::formats
{
namespace
{
using nlohmann::json;

constexpr const char* Key = "avian_lidar";

json valueOf(const Note& note)
{
  json entry = note.texts.empty() ? json(note.numbers) : json(note.texts);
  return note.unit.empty() ? json{ { "value", entry } }
                           : json{ { "value", entry }, { "unit", note.unit } };
}

std::string textOf(const json& holder, const char* key)
{
  const auto found = holder.find(key);
  return found != holder.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// Adds a note of numbers or of texts. Ignores entries of other types.
void addNote(const std::string& name, const json& entry, CloudNotes& notes)
{
  const auto value = entry.is_object() ? entry.find("value") : entry.end();
  if (!entry.is_object() || value == entry.end() || !value->is_array())
  {
    return;
  }
  Note note;
  note.name = name;
  note.unit = textOf(entry, "unit");
  for (const json& one : *value)
  {
    if (one.is_number())
    {
      note.numbers.push_back(one.get<double>());
    }
    else if (one.is_string())
    {
      note.texts.push_back(one.get<std::string>());
    }
  }
  if (note.numbers.empty() != note.texts.empty())
  {
    notes.notes.push_back(note);
  }
}
}

std::string cleaned(const std::string& text)
{
  const std::string quoted = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
  std::string valid = json::parse(quoted).get<std::string>();
  std::replace_if(
    valid.begin(), valid.end(), [](unsigned char c) { return c < ' ' && c != '\n'; }, '?');
  return valid;
}

std::string toText(const CloudNotes& notes, std::size_t longest, std::vector<std::string>& left)
{
  json fields = json::object();
  for (const Note& note : notes.notes)
  {
    fields[note.name] = valueOf(note);
  }
  json whole = { { Key, { { "units", notes.units }, { "field_data", fields } } } };
  std::string text = asciiLine(whole);
  while (text.size() > longest && !fields.empty())
  {
    const auto most = std::max_element(fields.begin(), fields.end(),
      [](const json& a, const json& b) { return asciiLine(a).size() < asciiLine(b).size(); });
    left.push_back(most.key());
    fields.erase(most);
    whole[Key]["field_data"] = fields;
    text = asciiLine(whole);
  }
  return text;
}

bool fromText(const std::string& text, CloudNotes& notes)
{
  const std::size_t begin = text.find('{');
  if (begin == std::string::npos || text.find(Key) == std::string::npos)
  {
    return false;
  }
  const json whole = json::parse(text.begin() + static_cast<std::ptrdiff_t>(begin), text.end(),
    nullptr, /*allow_exceptions=*/false);
  if (!whole.is_object() || !whole.contains(Key) || !whole[Key].is_object())
  {
    return false;
  }
  const json& own = whole[Key];
  if (own.contains("units") && own["units"].is_object())
  {
    for (const auto& [name, unit] : own["units"].items())
    {
      if (unit.is_string())
      {
        notes.units[name] = unit.get<std::string>();
      }
    }
  }
  if (own.contains("field_data") && own["field_data"].is_object())
  {
    for (const auto& [name, entry] : own["field_data"].items())
    {
      addNote(name, entry, notes);
    }
  }
  return true;
}
}
