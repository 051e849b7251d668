// SPDX-License-Identifier: BSD-3-Clause
#include "ObjectDescription.h"

#include "RegularFile.h"

#include <vtksys/SystemTools.hxx>

#include <cmath>

namespace avianlidar::scene
{
namespace
{
constexpr double DegreesToRadians = 3.14159265358979323846 / 180.0;
// Printed matrices have rounded digits.
constexpr double OrthonormalTolerance = 1e-6;

Mat3 ParseMatrix(const JsonNode& node)
{
  Mat3 m;
  const auto rows = node.Items(3);
  for (int i = 0; i < 3; ++i)
  {
    const Vec3 row = rows[i].Vector();
    std::copy(row.begin(), row.end(), m.begin() + 3 * i);
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      const double dot =
        m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];
      if (std::abs(dot - (i == j)) > OrthonormalTolerance)
      {
        node.Fail("must be a rotation: rows of length 1 at right angles (sizes belong in scale)");
      }
    }
  }
  const double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) -
    m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
  if (determinant < 0)
  {
    node.Fail("must be a rotation, not a reflection: its determinant is -1");
  }
  return m;
}

Mat3 ParseRotation(const JsonNode& node)
{
  if (node.IsNumber())
  {
    // Clockwise from north: at 90 degrees the model's north points east.
    const double yaw = node.Number() * DegreesToRadians;
    return { std::cos(yaw), std::sin(yaw), 0, -std::sin(yaw), std::cos(yaw), 0, 0, 0, 1 };
  }
  if (!node.IsArray())
  {
    node.Fail("must be a yaw in degrees, a direction [x, y, z] or a matrix [[...], [...], [...]]");
  }
  const auto items = node.Items(3);
  if (items[0].IsArray())
  {
    return ParseMatrix(node);
  }
  const Vec3 direction = node.Vector();
  if (!(std::hypot(direction[0], direction[1]) > 1e-9 * std::abs(direction[2])))
  {
    node.Fail("must be a direction that is neither zero nor vertical");
  }
  return RotationToDirection(direction);
}

Vec3 ParseScale(const JsonNode& node)
{
  if (node.IsNumber())
  {
    const double scale = node.PositiveNumber();
    return { scale, scale, scale };
  }
  const auto items = node.Items(3);
  return { items[0].PositiveNumber(), items[1].PositiveNumber(), items[2].PositiveNumber() };
}

void ParsePlacement(const JsonNode& node, const Scene& scene, Object& object)
{
  if (node.Has("position"))
  {
    object.placement.position = node.Get("position").Vector();
  }
  if (node.Has("geodetic"))
  {
    const JsonNode geodetic = node.Get("geodetic");
    if (object.placement.position || node.Has("crs"))
    {
      geodetic.Fail("stands beside position or crs; an object is placed in one way");
    }
    if (!scene.origin)
    {
      geodetic.Fail("needs the scene's origin");
    }
    object.placement.geodetic = ParseGeodetic(geodetic);
  }
  if (node.Has("rotation"))
  {
    object.placement.rotation = ParseRotation(node.Get("rotation"));
  }
  if (node.Has("scale"))
  {
    object.placement.scale = ParseScale(node.Get("scale"));
  }
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
  if (node.Has("material"))
  {
    glazing.material = ParseMaterialName(node.Get("material"), scene);
  }
  glazing.share = node.Get("share").NumberIn(0, 1);
  glazing.bay = node.Get("bay").PositiveNumber();
  return glazing;
}

std::string AbsoluteFile(const JsonNode& node, const Scene& scene)
{
  const std::string folder =
    vtksys::SystemTools::GetFilenamePath(vtksys::SystemTools::CollapseFullPath(scene.file));
  const std::string file = vtksys::SystemTools::CollapseFullPath(node.Name(), folder);
  if (!vtksys::SystemTools::FileExists(file, true))
  {
    node.Fail("there is no file " + file);
  }
  const std::string irregular = whyNotRegular(file);
  if (!irregular.empty())
  {
    node.Fail(file + " cannot be read: " + irregular);
  }
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
  if (node.Has("base"))
  {
    options.base = node.Get("base").Number();
  }
  options.flat = node.Has("flat") && node.Get("flat").Bool();
  for (const char* key :
    { "height", "height_attribute", "min_height_attribute", "glazing", "roof_material" })
  {
    if (options.flat && node.Has(key))
    {
      node.Get(key).Fail("means nothing for flat footprints");
    }
  }
  if (node.Has("height"))
  {
    options.height = node.Get("height").PositiveNumber();
  }
  if (node.Has("height_attribute"))
  {
    options.heightAttribute = node.Get("height_attribute").Name();
  }
  if (node.Has("min_height_attribute"))
  {
    options.minHeightAttribute = node.Get("min_height_attribute").Name();
  }
  if (!options.flat && !options.height && options.heightAttribute.empty())
  {
    node.Fail("footprints need height or height_attribute, or flat");
  }
  if (node.Has("width"))
  {
    options.width = node.Get("width").PositiveNumber();
  }
  if (node.Has("width_attribute"))
  {
    options.widthAttribute = node.Get("width_attribute").Name();
  }
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
  if (node.Has("layer"))
  {
    options.layer = node.Get("layer").Name();
  }
  if (node.Has("filter"))
  {
    ParseFilters(node.Get("filter"), options);
  }
  ParseShape(node, options);
  if (node.Has("roof_material"))
  {
    options.roofMaterial = ParseMaterialName(node.Get("roof_material"), scene);
  }
  if (node.Has("glazing"))
  {
    options.glazing = ParseGlazing(node.Get("glazing"), scene);
  }
  if (node.Has("features"))
  {
    const std::string features = node.Get("features").String();
    if (features != "separate" && features != "together")
    {
      node.Get("features").Fail("must be \"separate\" or \"together\"");
    }
    options.separate = features == "separate";
  }
  if (node.Has("name_attribute"))
  {
    options.nameAttribute = node.Get("name_attribute").Name();
  }
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
  if (size.IsArray())
  {
    const auto items = size.Items(2);
    object.ground.sizeEast = items[0].PositiveNumber();
    object.ground.sizeNorth = items[1].PositiveNumber();
  }
  else
  {
    object.ground.sizeEast = object.ground.sizeNorth = size.PositiveNumber();
  }
  if (ground.Has("height"))
  {
    object.ground.height = ground.Get("height").Number();
  }
}

// What a medium is made of is checked where it is read as one.
std::string ParseMedium(const JsonNode& node, bool hasSurface)
{
  Json text = node.Content();
  if (!text.is_object())
  {
    node.Fail("must be an object with kind, what says how much of it there is, and a shape");
  }
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
  if (node.Has("up_axis"))
  {
    const std::string axis = node.Get("up_axis").String();
    if (axis != "y" && axis != "z")
    {
      node.Get("up_axis").Fail("must be \"y\" or \"z\"");
    }
    object.upAxis = axis[0];
  }
}
}

Mat3 RotationToDirection(const Vec3& direction)
{
  const double horizontal = std::hypot(direction[0], direction[1]);
  const double length = std::hypot(horizontal, direction[2]);
  const Vec3 y{ direction[0] / length, direction[1] / length, direction[2] / length };
  const Vec3 x{ direction[1] / horizontal, -direction[0] / horizontal, 0 };
  const Vec3 z{ x[1] * y[2], -x[0] * y[2], x[0] * y[1] - x[1] * y[0] };
  return { x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2] };
}

Object ParseObject(const JsonNode& node, Scene& scene)
{
  Object object;
  object.key = node.GetPath();
  const int kinds = node.Has("file") + node.Has("footprints") + node.Has("ground");
  if (kinds > 1 || (kinds == 0 && !node.Has("medium")))
  {
    node.Fail("must have one of file, footprints, ground, and only one, or a medium");
  }
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
  object.objectClass = node.Has("class") ? node.Get("class").String() : std::string();
  object.material = node.Has("material") ? ParseMaterialName(node.Get("material"), scene) : -1;
  object.rules = ParseRules(node, scene);
  return object;
}
}
