// SPDX-License-Identifier: BSD-3-Clause
#include "SceneDescription.h"

#include "JsonNode.h"
#include "ObjectDescription.h"
#include "vtkAvianLidarNamedMaterials.h"

#include <vtksys/SystemTools.hxx>

#include <sstream>

namespace avianlidar::scene
{
namespace
{
avianlidar::Material ParseCoefficients(const JsonNode& node)
{
  std::vector<std::string> keys;
  for (const MaterialCoefficient& coefficient : MaterialCoefficients)
  {
    keys.push_back(coefficient.name);
  }
  keys.push_back("comment");
  node.RequireKeys(keys);
  avianlidar::Material material = Material().coefficients;
  for (const MaterialCoefficient& coefficient : MaterialCoefficients)
  {
    if (coefficient.isNeeded(material) || node.Has(coefficient.name))
    {
      material.*coefficient.member = node.Get(coefficient.name).NumberIn(0, coefficient.most);
    }
  }
  const std::string problem = checkMaterial(material);
  if (!problem.empty())
  {
    node.Fail(problem);
  }
  return material;
}

void ParseMaterials(const JsonNode& root, Scene& scene)
{
  using namespace vtkAvianLidarMaterials;
  for (int i = 0; i < NumberOfStandardMaterials; ++i)
  {
    scene.materials.push_back({ NamedMaterials[i].name, NamedMaterials[i].material });
  }
  if (!root.Has("materials"))
  {
    return;
  }
  for (const auto& [name, node] : root.Get("materials").Members())
  {
    if (name.empty())
    {
      node.Fail("a material must have a name");
    }
    Material material{ name, ParseCoefficients(node) };
    const int known = FindMaterial(scene, name);
    if (known >= NumberOfStandardMaterials)
    {
      node.Fail("this material is there already; case does not count");
    }
    if (known >= 0)
    {
      material.name = scene.materials[known].name;
      scene.materials[known] = material;
    }
    else
    {
      scene.materials.push_back(material);
    }
  }
}

void ParseLidar(const JsonNode& node, Scene& scene)
{
  node.RequireKeys({ "position", "inside", "comment" });
  scene.lidar = node.Get("position").Vector();
  scene.lidarInside = node.Has("inside") && node.Get("inside").Bool();
}
}

int FindMaterial(const Scene& scene, const std::string& name)
{
  const std::string wanted = vtksys::SystemTools::LowerCase(name);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
  {
    if (vtksys::SystemTools::LowerCase(scene.materials[i].name) == wanted)
    {
      return static_cast<int>(i);
    }
  }
  return -1;
}

int ParseMaterialName(const JsonNode& node, Scene& scene)
{
  const int material = FindMaterial(scene, node.Name());
  if (material >= 0)
  {
    return material;
  }
  Scene all = scene;
  for (const auto& shipped : vtkAvianLidarMaterials::NamedMaterials)
  {
    if (FindMaterial(all, shipped.name) < 0)
    {
      all.materials.push_back({ shipped.name, shipped.material });
    }
  }
  const int found = FindMaterial(all, node.Name());
  if (found < 0)
  {
    std::string known;
    for (const Material& m : all.materials)
    {
      known += (known.empty() ? "" : ", ") + m.name;
    }
    node.Fail("unknown material \"" + node.String() + "\"; known: " + known);
  }
  scene.materials.push_back(all.materials[found]);
  return static_cast<int>(scene.materials.size()) - 1;
}

std::vector<MaterialRule> ParseRules(const JsonNode& owner, Scene& scene)
{
  std::vector<MaterialRule> rules;
  if (owner.Has("material_map"))
  {
    for (const auto& [pattern, node] : owner.Get("material_map").Members())
    {
      rules.push_back({ pattern, ParseMaterialName(node, scene) });
    }
  }
  return rules;
}

Geodetic ParseGeodetic(const JsonNode& node)
{
  node.RequireKeys({ "latitude", "longitude", "height", "comment" });
  return { node.Get("latitude").NumberIn(-90, 90), node.Get("longitude").NumberIn(-180, 360),
    node.Get("height").Number() };
}

bool MatchesPattern(const std::string& pattern, const std::string& name)
{
  // Greedy, with one step back to the last star: linear in practice, no recursion.
  std::size_t p = 0, n = 0, star = std::string::npos, mark = 0;
  while (n < name.size())
  {
    if (p < pattern.size() && pattern[p] == '*')
    {
      star = p++;
      mark = n;
    }
    else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n]))
    {
      ++p;
      ++n;
    }
    else if (star != std::string::npos)
    {
      p = star + 1;
      n = ++mark;
    }
    else
    {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*')
  {
    ++p;
  }
  return p == pattern.size();
}

Scene ReadDescription(const std::string& file, const std::string& text)
{
  std::istringstream stream(text);
  const Json json = text.empty() ? ReadJson(file) : ReadJson(stream, file);
  Scene scene;
  scene.file = file;
  const JsonNode root(json, "", scene.file);
  root.RequireKeys({ "version", "comment", "attribution", "origin", "lidar", "materials",
    "material_map", "objects" });
  const JsonNode version = root.Get("version");
  if (version.Number() != 1)
  {
    version.Fail("must be 1, the only version there is");
  }
  if (root.Has("attribution"))
  {
    scene.attribution = root.Get("attribution").Strings();
  }
  if (root.Has("origin"))
  {
    scene.origin = ParseGeodetic(root.Get("origin"));
  }
  if (root.Has("lidar"))
  {
    ParseLidar(root.Get("lidar"), scene);
  }
  ParseMaterials(root, scene);
  scene.rules = ParseRules(root, scene);
  for (const JsonNode& node : root.Get("objects").Items())
  {
    scene.objects.push_back(ParseObject(node, scene));
  }
  return scene;
}
}
