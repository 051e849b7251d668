// SPDX-License-Identifier: BSD-3-Clause
#include "SceneDescription.h"

#include "JsonNode.h"
#include "RegularFile.h"
#include "vtkAvianLidarNamedMaterials.h"

#include <vtksys/SystemTools.hxx>

#include <cmath>

namespace avianlidar::scene
{
namespace
{
constexpr double DegreesToRadians = 3.14159265358979323846 / 180.0;
// Greatest error of a rotation, because matrices in files have rounded digits.
constexpr double OrthonormalTolerance = 1e-6;

/// Returns the id of the material with a name, in upper or lower case, or -1 if no material has the
/// name.
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

/// Returns the id of the material that a string names. Adds a shipped material to the scene when it
/// is first named. Throws Error for an unknown material.
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

std::optional<int> FindMaterialName(const JsonNode& owner, const char* key, Scene& scene)
{
  return owner.Find(key, [&](const JsonNode& node) { return ParseMaterialName(node, scene); });
}

/// Returns one of two words, or an empty text if the key is missing.
std::string FindChoice(
  const JsonNode& owner, const char* key, const std::string& one, const std::string& other)
{
  const std::string word = owner.Find(key, &JsonNode::String).value_or("");
  if (owner.Has(key) && word != one && word != other)
  {
    owner.Get(key).Fail("must be \"" + one + "\" or \"" + other + "\"");
  }
  return word;
}

/// Returns the rules of the "material_map" of the scene or of an object. The map may be missing.
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
  node.FailIf(!problem.empty(), problem);
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
    node.FailIf(name.empty(), "a material must have a name");
    Material material{ name, ParseCoefficients(node) };
    const int known = FindMaterial(scene, name);
    node.FailIf(known >= NumberOfStandardMaterials,
      "this material is already in the scene (case is ignored)");
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
  scene.lidarInside = node.Find("inside", &JsonNode::Bool).value_or(false);
}

Mat3 ParseMatrix(const JsonNode& node)
{
  Mat3 m;
  const auto rows = node.Items(3);
  for (int i = 0; i < 3; ++i)
  {
    const Point3 row = rows[i].Vector();
    std::copy(row.begin(), row.end(), m.begin() + 3 * i);
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      const double dot =
        m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];
      node.FailIf(std::abs(dot - (i == j)) > OrthonormalTolerance,
        "must be a rotation: rows of length 1 at right angles (sizes belong in scale)");
    }
  }
  const double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) -
    m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
  node.FailIf(determinant < 0, "must be a rotation, not a reflection: its determinant is -1");
  return m;
}

/// Returns the rotation whose second axis (the model's north, +y) points along a direction, and
/// whose third axis (the model's up) is as near to up as possible. The direction must not be
/// vertical.
Mat3 RotationToDirection(const Point3& direction)
{
  const double horizontal = std::hypot(direction[0], direction[1]);
  const double length = std::hypot(horizontal, direction[2]);
  const Point3 y{ direction[0] / length, direction[1] / length, direction[2] / length };
  const Point3 x{ direction[1] / horizontal, -direction[0] / horizontal, 0 };
  const Point3 z{ x[1] * y[2], -x[0] * y[2], x[0] * y[1] - x[1] * y[0] };
  return { x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2] };
}

Mat3 ParseRotation(const JsonNode& node)
{
  if (node.IsNumber())
  {
    // The yaw is clockwise from north. At 90 degrees the model's north points east.
    const double yaw = node.Number() * DegreesToRadians;
    return { std::cos(yaw), std::sin(yaw), 0, -std::sin(yaw), std::cos(yaw), 0, 0, 0, 1 };
  }
  node.FailIf(!node.IsArray(),
    "must be a yaw in degrees, a direction [x, y, z] or a matrix [[...], [...], [...]]");
  const auto items = node.Items(3);
  if (items[0].IsArray())
  {
    return ParseMatrix(node);
  }
  const Point3 direction = node.Vector();
  node.FailIf(!(std::hypot(direction[0], direction[1]) > 1e-9 * std::abs(direction[2])),
    "must be a direction that is neither zero nor vertical");
  return RotationToDirection(direction);
}

Point3 ParseScale(const JsonNode& node)
{
  const auto items = node.IsNumber() ? std::vector<JsonNode>(3, node) : node.Items(3);
  return { items[0].PositiveNumber(), items[1].PositiveNumber(), items[2].PositiveNumber() };
}

void ParsePlacement(const JsonNode& node, const Scene& scene, Object& object)
{
  object.placement.position = node.Find("position", &JsonNode::Vector);
  if (node.Has("geodetic"))
  {
    const JsonNode geodetic = node.Get("geodetic");
    if (object.placement.position || node.Has("crs"))
    {
      geodetic.Fail("stands beside position or crs; an object is placed in one way");
    }
    geodetic.FailIf(!scene.origin, "needs the scene's origin");
    object.placement.geodetic = ParseGeodetic(geodetic);
  }
  object.placement.rotation = node.Find("rotation", ParseRotation).value_or(Placement().rotation);
  object.placement.scale = node.Find("scale", ParseScale).value_or(Placement().scale);
  if (node.Has("crs"))
  {
    object.crs = node.Get("crs").Name();
    if (object.crs != "local" && !scene.origin)
    {
      node.Get("crs").Fail("needs the scene's origin");
    }
  }
}

Glazing ParseGlazing(const JsonNode& node, Scene& scene)
{
  node.RequireKeys({ "material", "share", "bay", "comment" });
  Glazing glazing;
  glazing.material = FindMaterialName(node, "material", scene).value_or(glazing.material);
  glazing.share = node.Get("share").NumberIn(0, 1);
  glazing.bay = node.Get("bay").PositiveNumber();
  return glazing;
}

std::string AbsoluteFile(const JsonNode& node, const Scene& scene)
{
  const std::string folder =
    vtksys::SystemTools::GetFilenamePath(vtksys::SystemTools::CollapseFullPath(scene.file));
  const std::string file = vtksys::SystemTools::CollapseFullPath(node.Name(), folder);
  node.FailIf(!vtksys::SystemTools::FileExists(file, true), "there is no file ", file);
  const std::string irregular = whyNotRegular(file);
  node.FailIf(!irregular.empty(), file, " cannot be read: ", irregular);
  return file;
}

void ParseFilters(const JsonNode& node, FootprintOptions& options)
{
  for (const auto& [attribute, value] : node.Members())
  {
    if (value.IsNumber())
    {
      std::string number = std::to_string(value.Number());
      number.erase(number.find_last_not_of('0') + 1);
      number.erase(number.find_last_not_of('.') + 1);
      options.filters.push_back({ attribute, number });
    }
    else
    {
      options.filters.push_back({ attribute, value.Name() });
    }
  }
}

void ParseShape(const JsonNode& node, FootprintOptions& options)
{
  options.base = node.Find("base", &JsonNode::Number).value_or(0.0);
  options.flat = node.Find("flat", &JsonNode::Bool).value_or(false);
  for (const char* key :
    { "height", "height_attribute", "min_height_attribute", "glazing", "roof_material" })
  {
    if (options.flat && node.Has(key))
    {
      node.Get(key).Fail("cannot be given for flat footprints");
    }
  }
  options.height = node.Find("height", &JsonNode::PositiveNumber);
  options.heightAttribute = node.Find("height_attribute", &JsonNode::Name).value_or("");
  options.minHeightAttribute = node.Find("min_height_attribute", &JsonNode::Name).value_or("");
  node.FailIf(!options.flat && !options.height && options.heightAttribute.empty(),
    "footprints need height or height_attribute, or flat");
  options.width = node.Find("width", &JsonNode::PositiveNumber);
  options.widthAttribute = node.Find("width_attribute", &JsonNode::Name).value_or("");
}

void ParseOn(const JsonNode& node, const Scene& scene, FootprintOptions& options)
{
  options.on = node.Get("on").Name();
  for (const char* key : { "position", "geodetic", "rotation", "scale" })
  {
    if (node.Has(key))
    {
      node.Get(key).Fail("stands beside on, which needs footprints that are in place");
    }
  }
  for (const Object& object : scene.objects)
  {
    if (object.name == options.on && object.medium.empty() && object.kind == ObjectKind::Mesh)
    {
      return;
    }
  }
  node.Get("on").Fail("is " + options.on + ", expected the name of a mesh further up");
}

void ParseFootprints(const JsonNode& node, Scene& scene, Object& object)
{
  node.RequireKeys({ "footprints", "name", "class", "material", "material_map", "medium", "comment",
    "position", "geodetic", "rotation", "scale", "crs", "layer", "filter", "base", "height",
    "height_attribute", "min_height_attribute", "flat", "width", "width_attribute", "roof_material",
    "glazing", "features", "name_attribute", "on" });
  object.kind = ObjectKind::Footprints;
  object.file = AbsoluteFile(node.Get("footprints"), scene);
  FootprintOptions& options = object.footprints;
  options.layer = node.Find("layer", &JsonNode::Name).value_or("");
  if (node.Has("filter"))
  {
    ParseFilters(node.Get("filter"), options);
  }
  ParseShape(node, options);
  options.roofMaterial = FindMaterialName(node, "roof_material", scene).value_or(-1);
  if (node.Has("glazing"))
  {
    options.glazing = ParseGlazing(node.Get("glazing"), scene);
  }
  options.separate = FindChoice(node, "features", "separate", "together") == "separate";
  options.nameAttribute = node.Find("name_attribute", &JsonNode::Name).value_or("name");
  if (node.Has("on"))
  {
    ParseOn(node, scene, options);
  }
}

void ParseGround(const JsonNode& node, Object& object)
{
  node.RequireKeys({ "ground", "name", "class", "material", "material_map", "comment", "position",
    "geodetic", "rotation", "scale" });
  object.kind = ObjectKind::Ground;
  const JsonNode ground = node.Get("ground");
  ground.RequireKeys({ "size", "height", "comment" });
  const JsonNode size = ground.Get("size");
  const auto sides = size.IsArray() ? size.Items(2) : std::vector<JsonNode>{ size, size };
  object.ground.sizeEast = sides[0].PositiveNumber();
  object.ground.sizeNorth = sides[1].PositiveNumber();
  object.ground.height = ground.Find("height", &JsonNode::Number).value_or(0.0);
}

// Returns the JSON of a medium. vtkAvianLidarMedia checks the contents later.
std::string ParseMedium(const JsonNode& node, bool hasSurface)
{
  Json text = node.Content();
  node.FailIf(
    !text.is_object(), "must be an object with kind, a quantity of the medium, and a shape");
  if (text.contains("name"))
  {
    node.Get("name").Fail("stands in the medium, expected beside it");
  }
  if (hasSurface && text.contains("shape"))
  {
    node.Get("shape").Fail("stands beside a file or footprints, whose surface is the shape");
  }
  if (hasSurface)
  {
    text["shape"] = "surface";
  }
  return text.dump();
}

void ParseMesh(const JsonNode& node, Scene& scene, Object& object)
{
  node.RequireKeys({ "file", "name", "class", "material", "material_map", "medium", "comment",
    "position", "geodetic", "rotation", "scale", "up_axis", "crs" });
  object.kind = ObjectKind::Mesh;
  object.file = AbsoluteFile(node.Get("file"), scene);
  object.upAxis = FindChoice(node, "up_axis", "y", "z")[0]; // 0 if the key is missing
}

/// Parses a value of "objects". The origin, materials and file name of the scene must be set
/// before.
Object ParseObject(const JsonNode& node, Scene& scene)
{
  Object object;
  object.key = node.GetPath();
  const int kinds = node.Has("file") + node.Has("footprints") + node.Has("ground");
  node.FailIf(kinds > 1 || (kinds == 0 && !node.Has("medium")),
    "must have one of file, footprints, ground, and only one, or a medium");
  if (node.Has("medium"))
  {
    object.medium = ParseMedium(node.Get("medium"), kinds == 1);
  }
  if (node.Has("file"))
  {
    ParseMesh(node, scene, object);
  }
  else if (node.Has("footprints"))
  {
    ParseFootprints(node, scene, object);
  }
  else if (node.Has("ground"))
  {
    ParseGround(node, object);
  }
  else
  {
    node.RequireKeys({ "medium", "name", "comment" });
    object.kind = ObjectKind::Medium;
  }
  ParsePlacement(node, scene, object);
  object.name = node.Has("name")
    ? node.Get("name").Name()
    : (object.file.empty() ? std::string(node.Has("ground") ? "Ground" : "Medium")
                           : vtksys::SystemTools::GetFilenameWithoutExtension(object.file));
  object.objectClass = node.Find("class", &JsonNode::String).value_or("");
  object.material = FindMaterialName(node, "material", scene).value_or(-1);
  object.rules = ParseRules(node, scene);
  return object;
}
}

Scene ReadDescription(const std::string& file, const std::string& text)
{
  const Json json = text.empty() ? ReadJson(file) : ParseJson(text, file);
  Scene scene;
  scene.file = file;
  const JsonNode root(json, "", scene.file);
  root.RequireKeys({ "version", "comment", "attribution", "origin", "lidar", "materials",
    "material_map", "objects" });
  const JsonNode version = root.Get("version");
  version.FailIf(version.Number() != 1, "must be 1, the only version");
  scene.attribution = root.Find("attribution", &JsonNode::Strings).value_or(scene.attribution);
  scene.origin = root.Find("origin", ParseGeodetic);
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
