// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSensorFile.h"

#include "JsonNode.h"
#include "vtkAvianLidarBuiltInTexts.h"

#include <stdexcept>

namespace
{
using avianlidar::Json;
using avianlidar::JsonNode;

vtkAvianLidarSensorFile::Entry EntryOf(const std::string& name, const JsonNode& node)
{
  node.RequireKeys({ "value", "unit", "source" });
  vtkAvianLidarSensorFile::Entry entry;
  entry.name = name;
  const JsonNode value = node.Get("value");
  if (value.IsArray())
  {
    for (const JsonNode& item : value.Items())
    {
      entry.values.push_back(item.Number());
    }
  }
  else
  {
    entry.values.push_back(value.Number());
  }
  if (entry.values.empty())
  {
    value.Fail("must have values");
  }
  entry.unit = node.Get("unit").Name();
  entry.source = node.Get("source").Name();
  return entry;
}

vtkAvianLidarSensorFile Parse(const Json& json, const std::string& file)
{
  const JsonNode root(json, "", file);
  root.RequireKeys({ "format", "name", "maker", "model", "comment", "source", "data_sheet", "sheet",
    "range_interval", "values" });
  if (root.Get("format").String() != "lidarsensor 1")
  {
    root.Get("format").Fail("must be \"lidarsensor 1\"");
  }
  vtkAvianLidarSensorFile sensor;
  sensor.file = file;
  sensor.text = json.dump();
  root.Get("name").Name(); // checked, but not used
  for (const char* key : { "maker", "model", "comment", "source" })
  {
    root.Find(key, &JsonNode::String); // checked, but not used
  }
  if (root.Has("data_sheet"))
  {
    for (const auto& [name, node] : root.Get("data_sheet").Members())
    {
      EntryOf(name, node); // not a property of the beam source
    }
  }
  if (root.Has("sheet"))
  {
    root.Get("sheet").Members(); // used only by programs that fit the receiver
  }
  if (root.Has("range_interval"))
  {
    const JsonNode node = root.Get("range_interval");
    const std::vector<double> factors = EntryOf("range_interval", node).values;
    if (factors.size() != 2 || !(factors[0] > 0.0 && factors[0] <= 1.0 && factors[1] >= 1.0))
    {
      node.Fail("must have a factor of at most 1 and a factor of at least 1");
    }
  }
  for (const auto& [name, node] : root.Get("values").Members())
  {
    sensor.entries.push_back(EntryOf(name, node));
  }
  return sensor;
}
}

//------------------------------------------------------------------------------
vtkAvianLidarSensorFile vtkAvianLidarSensorFile::Read(const std::string& file)
{
  return Parse(avianlidar::ReadJson(file), file);
}

//------------------------------------------------------------------------------
vtkAvianLidarSensorFile vtkAvianLidarSensorFile::Preset(const std::string& name)
{
  return OfText(vtkAvianLidarBuiltInText(name + ".lidarsensor.json"), name);
}

//------------------------------------------------------------------------------
vtkAvianLidarSensorFile vtkAvianLidarSensorFile::OfText(
  const std::string& text, const std::string& name)
{
  return Parse(avianlidar::ParseJson(text, name), name);
}

//------------------------------------------------------------------------------
void vtkAvianLidarSensorFile::Fail(const Entry& entry, const std::string& message) const
{
  throw std::runtime_error(this->file + ": values." + entry.name + ": " + message);
}
