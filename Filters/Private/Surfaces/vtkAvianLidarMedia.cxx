// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarMedia.h"

#include "Air.h"
#include "ClosedShells.h"
#include "CollisionTreeBuilder.h"
#include "JsonNode.h"
#include "ValueError.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBuiltInTexts.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarTriangles.h"

#include "vtkAppendPolyData.h"
#include "vtkCellArray.h"
#include "vtkCubeSource.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSphereSource.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

namespace
{
using avianlidar::Json;
using avianlidar::JsonNode;
using avianlidar::Medium;
using avianlidar::MediumShape;
using avianlidar::MediumVolume;
using avianlidar::Vec3;

/// The file media.json.
JsonNode File()
{
  static const std::string file = "media.json";
  static const Json all = avianlidar::ParseJson(vtkAvianLidarBuiltInText(file), file);
  return JsonNode(all, "", file);
}

/// All kinds of media.json.
JsonNode Known()
{
  return File().Get("media");
}

double NumberOf(const std::string& kind, const char* key)
{
  return Known().Get(kind).Get(key).Get("value").PositiveNumber();
}

/// Light that drops of water return. @param wavelength m
avianlidar::DropLight LightOfDrops(double wavelength)
{
  const JsonNode water = File().Get("water");
  const auto rows = water.Get("rows").Items(); // wavelength, um; index; extinction coefficient
  const double um = std::clamp(
    1e6 * wavelength, rows.front().Items(3)[0].Number(), rows.back().Items(3)[0].Number());
  std::size_t k = 1;
  while (rows[k].Items(3)[0].Number() < um)
  {
    ++k;
  }
  const auto below = rows[k - 1].Items(3);
  const auto above = rows[k].Items(3);
  const double t = (um - below[0].Number()) / (above[0].Number() - below[0].Number());
  const double index = (1.0 - t) * below[1].Number() + t * above[1].Number();
  const double extinction =
    std::exp((1.0 - t) * std::log(below[2].Number()) + t * std::log(above[2].Number()));
  std::array<avianlidar::DropLight::Term, 2> rear{};
  const auto terms = water.Get("rear").Get("terms").Items(rear.size());
  for (std::size_t i = 0; i < rear.size(); ++i)
  {
    rear[i] = { terms[i].Get("efficiency").PositiveNumber(), terms[i].Get("way").PositiveNumber() };
  }
  return { index, 4.0 * avianlidar::Pi * extinction / (1e-6 * um), rear };
}

Medium FoliageOf(const std::string& kind, double density)
{
  Medium leaves;
  leaves.extinction = density * NumberOf(kind, "projection");
  // Lambertian leaves face all directions: the mean of cos^2 is 1/3, and the mean of |cos| is 1/2.
  leaves.backscatterRatio = 1.5 * avianlidar::Pi / NumberOf(kind, "leaf_reflectance");
  leaves.drops = density / NumberOf(kind, "leaf_area");
  leaves.squareOfDrops = avianlidar::SquareOfLeaves;
  leaves.renewed = NumberOf(kind, "renewed");
  leaves.isFollowed = false;
  leaves.sharesGaps = true;
  return leaves;
}

Medium SnowOf(const std::string& kind, double visibility)
{
  // The extinction of snow is the same at all wavelengths.
  const double extinction = avianlidar::attenuationOfVisibility(visibility, 550e-9);
  return { extinction, NumberOf(kind, "backscatter_ratio"),
    extinction / (2.0 * NumberOf(kind, "flake_area")) };
}

using vtkAvianLidarMedia::Word;

const Word& WordOf(const JsonNode& node, const std::vector<Word>& all)
{
  std::vector<std::string> names;
  for (const Word& word : all)
  {
    if (word.name == node.String())
    {
      return word;
    }
    names.push_back(word.name);
  }
  node.Fail("must be " + avianlidar::anyOf(names));
}

const Word& KindOf(const JsonNode& node)
{
  return WordOf(node.Get("kind"), vtkAvianLidarMedia::Kinds());
}

const Word& ShapeOf(const JsonNode& node)
{
  return WordOf(node.Get("shape"), vtkAvianLidarMedia::Shapes());
}

/// Throws if a key has no meaning for the kind and the shape.
void CheckKeys(const Json& json, const std::string& file)
{
  const JsonNode node(json, "", file);
  const Word& kind = KindOf(node);
  const Word& shape = ShapeOf(node);
  std::vector<std::string> keys = { "kind", "shape", "velocity", "name", "comment" };
  keys.insert(keys.end(), kind.keys.begin(), kind.keys.end());
  if (node.Has("ellipsoids"))
  {
    keys.push_back("ellipsoids");
  }
  else
  {
    keys.insert(keys.end(), shape.keys.begin(), shape.keys.end());
  }
  JsonNode(json, "", file + ", kind " + kind.name + ", shape " + shape.name).RequireKeys(keys);
}

Medium MediumOf(const JsonNode& node, const avianlidar::LidarView& view)
{
  const Word& kind = KindOf(node);
  const std::string& by = kind.keys.front();
  if (by == "extinction")
  {
    Medium medium{ node.Get(by).NumberIn(0.0, 1e30),
      node.Get("backscatter_ratio").NumberIn(1e-3, 1e9) };
    medium.drops = node.Has("drops") ? node.Get("drops").NumberIn(0.0, 1e12) : 0.0;
    return medium;
  }
  if (by == "leaf_area_density")
  {
    return FoliageOf(kind.name, node.Get(by).NumberIn(1e-6, 1e3));
  }
  if (by == "rain_rate")
  {
    const double rate = node.Get(by).NumberIn(1e-6, avianlidar::MaximumRainRate);
    return vtkAvianLidarMedia::RainOf(rate, view, kind.name);
  }
  const double visibility = node.Get(by).NumberIn(1e-3, 1e9);
  if (Known().Get(kind.name).Has("flake_area"))
  {
    return SnowOf(kind.name, visibility);
  }
  return { avianlidar::attenuationOfVisibility(visibility, view.wavelength),
    NumberOf(kind.name, "backscatter_ratio") };
}

Vec3 VectorOf(const JsonNode& node, const char* key, const Vec3& otherwise)
{
  if (!node.Has(key))
  {
    return otherwise;
  }
  const auto v = node.Get(key).Vector();
  return { v[0], v[1], v[2] };
}

/// Read the closed surface of a text, with the box about the surface.
void ReadSurface(const JsonNode& node, MediumVolume& volume)
{
  auto mesh = std::make_shared<avianlidar::TriangleMesh>();
  Vec3 low(avianlidar::Infinity);
  Vec3 high(-avianlidar::Infinity);
  for (const JsonNode& point : node.Get("points").Items())
  {
    const auto p = point.Vector();
    mesh->points.emplace_back(p[0], p[1], p[2]);
    low = glm::min(low, mesh->points.back());
    high = glm::max(high, mesh->points.back());
  }
  for (const JsonNode& triangle : node.Get("triangles").Items())
  {
    const auto items = triangle.Items(3);
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k)
    {
      corners[k] = static_cast<std::uint32_t>(
        items[k].NumberIn(0.0, static_cast<double>(mesh->points.size()) - 1.0));
    }
    mesh->triangles.push_back({ corners[0], corners[1], corners[2] });
  }
  if (mesh->triangles.empty())
  {
    node.Get("triangles").Fail("is empty, expected the triangles of a closed surface");
  }
  volume.centre = 0.5 * (low + high);
  for (int axis = 0; axis < 3; ++axis)
  {
    Vec3& half = volume.halfAxes[static_cast<std::size_t>(axis)];
    half = Vec3(0.0);
    half[axis] = 0.5 * (high[axis] - low[axis]);
  }
  volume.surface = avianlidar::buildCollisionTree(mesh, avianlidar::TreeOptions{}, {}, 1);
}

MediumVolume VolumeOf(const JsonNode& node)
{
  MediumVolume volume;
  volume.shape = static_cast<MediumShape>(&ShapeOf(node) - vtkAvianLidarMedia::Shapes().data());
  volume.centre = VectorOf(node, "center", volume.centre);
  volume.velocity = VectorOf(node, "velocity", volume.velocity);
  volume.bottom = node.Find("bottom", &JsonNode::Number).value_or(volume.bottom);
  volume.top = volume.shape == MediumShape::Layer ? node.Get("top").Number() : volume.top;
  volume.softness = node.Find("softness", &JsonNode::Number).value_or(volume.softness);
  if (volume.shape == MediumShape::Surface)
  {
    ReadSurface(node, volume);
  }
  else if (volume.isBounded())
  {
    const double heading =
      node.Find("heading", &JsonNode::Number).value_or(0.0) * avianlidar::Pi / 180.0;
    node.Get("lengths");
    const Vec3 half = 0.5 * VectorOf(node, "lengths", Vec3(0.0));
    volume.halfAxes = { half.x * Vec3(std::cos(heading), -std::sin(heading), 0.0),
      half.y * Vec3(std::sin(heading), std::cos(heading), 0.0), Vec3(0.0, 0.0, half.z) };
  }
  const std::string problem = avianlidar::checkVolume(volume);
  if (!problem.empty())
  {
    node.Fail(problem);
  }
  return volume;
}
}

//------------------------------------------------------------------------------
const std::vector<Word>& vtkAvianLidarMedia::Kinds()
{
  static const std::vector<Word> all = []()
  {
    std::vector<Word> kinds;
    for (const auto& [name, numbers] : Known().Members())
    {
      kinds.push_back({ name, numbers.Get("given_by").Strings() });
    }
    return kinds;
  }();
  return all;
}

//------------------------------------------------------------------------------
const std::vector<Word>& vtkAvianLidarMedia::Shapes()
{
  static const std::vector<Word> all = { { "everywhere", {} },
    { "layer", { "bottom", "top", "softness" } }, { "box", { "center", "lengths", "heading" } },
    { "ellipsoid", { "center", "lengths", "heading" } }, { "surface", { "points", "triangles" } } };
  return all;
}

//------------------------------------------------------------------------------
Medium vtkAvianLidarMedia::HazeOf(double visibility, double extinction)
{
  const bool isFog = visibility <= NumberOf("fog", "most_visibility");
  return { extinction, NumberOf(isFog ? "fog" : "haze", "backscatter_ratio") };
}

//------------------------------------------------------------------------------
Medium vtkAvianLidarMedia::RainOf(
  double rate, const avianlidar::LidarView& view, const std::string& kind)
{
  return avianlidar::rainOf(rate, LightOfDrops(view.wavelength), view,
    NumberOf(kind, "drops_per_volume"), NumberOf(kind, "slope"));
}

//------------------------------------------------------------------------------
std::vector<avianlidar::PlacedMedium> vtkAvianLidarMedia::Read(
  const std::string& text, const avianlidar::LidarView& view)
{
  const Json json = avianlidar::ParseJson(text, "medium");
  const std::string file = "medium '" + json.value("name", std::string()) + "'";
  const JsonNode node(json, "", file);
  CheckKeys(json, file);
  Medium medium = MediumOf(node, view);
  if (node.Has("renewed"))
  {
    medium.renewed = node.Get("renewed").NumberIn(0.0, 1.0);
  }
  if (!medium.isFollowed)
  {
    medium.objectId = node.Has("object_id")
      ? static_cast<int>(node.Get("object_id").NumberIn(0.0, 1e6))
      : medium.objectId;
  }
  const std::string problem = avianlidar::checkMedium(medium);
  if (!problem.empty())
  {
    node.Fail(problem);
  }
  std::vector<avianlidar::PlacedMedium> all;
  if (node.Has("ellipsoids"))
  {
    for (const JsonNode& one : node.Get("ellipsoids").Items())
    {
      const auto n = one.Items(5);
      MediumVolume volume;
      volume.shape = MediumShape::Ellipsoid;
      volume.centre = Vec3(n[0].Number(), n[1].Number(), n[2].Number());
      volume.velocity = VectorOf(node, "velocity", volume.velocity);
      const double across = 0.5 * n[3].PositiveNumber();
      volume.halfAxes = { Vec3(across, 0.0, 0.0), Vec3(0.0, across, 0.0),
        Vec3(0.0, 0.0, 0.5 * n[4].PositiveNumber()) };
      const std::string wrong = avianlidar::checkVolume(volume);
      if (!wrong.empty())
      {
        one.Fail(wrong);
      }
      all.push_back({ medium, volume });
    }
    return all;
  }
  all.push_back({ medium, VolumeOf(node) });
  if (medium.sharesGaps && all[0].volume.shape == MediumShape::Everywhere)
  {
    node.Get("shape").Fail("must be a layer, box, ellipsoid or surface for " + KindOf(node).name);
  }
  return all;
}

namespace
{
/// A closed surface as triangles that face outward. Throws if the surface is open.
vtkSmartPointer<vtkPolyData> Closed(vtkPolyData* surface, const std::string& name)
{
  const vtkSmartPointer<vtkPolyData> given = vtkAvianLidarTriangles(surface);
  avianlidar::TriangleMesh mesh;
  for (vtkIdType i = 0; i < given->GetNumberOfPoints(); ++i)
  {
    double p[3];
    given->GetPoint(i, p);
    mesh.points.emplace_back(p[0], p[1], p[2]);
  }
  vtkIdType size = 0;
  const vtkIdType* corners = nullptr;
  for (given->GetPolys()->InitTraversal(); given->GetPolys()->GetNextCell(size, corners);)
  {
    mesh.triangles.push_back({ static_cast<std::uint32_t>(corners[0]),
      static_cast<std::uint32_t>(corners[1]), static_cast<std::uint32_t>(corners[2]) });
  }
  std::string problem;
  mesh = avianlidar::closedShells(mesh, problem);
  if (!problem.empty())
  {
    throw std::runtime_error("medium '" + name + "': the input surface " + problem);
  }
  vtkNew<vtkPoints> points;
  points->SetDataType(surface->GetPoints()->GetDataType());
  for (const Vec3& p : mesh.points)
  {
    points->InsertNextPoint(p.x, p.y, p.z);
  }
  auto closed = vtkSmartPointer<vtkPolyData>::New();
  closed->SetPoints(points);
  closed->SetPolys(vtkAvianLidarMakeTriangles(mesh.triangles, [](std::size_t i) { return i; }));
  return closed;
}

/// A sphere or a cube, scaled by the half axes of the volume.
vtkSmartPointer<vtkPolyData> Drawn(const MediumVolume& volume)
{
  auto drawn = vtkSmartPointer<vtkPolyData>::New();
  if (volume.shape == MediumShape::Ellipsoid)
  {
    vtkNew<vtkSphereSource> sphere;
    sphere->SetRadius(1.0);
    sphere->SetThetaResolution(24);
    sphere->SetPhiResolution(16);
    sphere->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    sphere->Update();
    drawn->CopyStructure(sphere->GetOutput());
  }
  else
  {
    vtkNew<vtkCubeSource> cube;
    cube->SetXLength(2.0);
    cube->SetYLength(2.0);
    cube->SetZLength(2.0);
    cube->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    cube->Update();
    drawn->CopyStructure(cube->GetOutput());
  }
  vtkPoints* points = drawn->GetPoints();
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    double p[3];
    points->GetPoint(i, p);
    const Vec3 at = volume.centre + p[0] * volume.halfAxes[0] + p[1] * volume.halfAxes[1] +
      p[2] * volume.halfAxes[2];
    points->SetPoint(i, at.x, at.y, at.z);
  }
  return drawn;
}
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarMedia::Surface(
  const std::string& text, vtkPolyData* closed, double size)
{
  const Json json = avianlidar::ParseJson(text, "medium");
  vtkSmartPointer<vtkPolyData> drawn;
  const avianlidar::LidarView any;
  if (json.value("shape", std::string()) == "surface")
  {
    drawn = Closed(closed ? closed : vtkSmartPointer<vtkPolyData>::New().Get(),
      json.value("name", std::string()));
    vtkAvianLidarArrays::SetFieldStrings(
      drawn->GetFieldData(), vtkAvianLidarArrays::Medium, { text });
    Read(TextOf(drawn, json.value("name", std::string())), any);
    return drawn;
  }
  vtkNew<vtkAppendPolyData> together;
  together->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  for (const avianlidar::PlacedMedium& one : Read(text, any))
  {
    MediumVolume volume = one.volume;
    if (!volume.isBounded())
    {
      const bool isLayer = volume.shape == MediumShape::Layer;
      const double low = isLayer ? std::max(volume.bottom, volume.top - size) : -0.5 * size;
      const double high = isLayer ? volume.top : 0.5 * size;
      volume.centre += Vec3(0.0, 0.0, 0.5 * (low + high));
      volume.halfAxes = { Vec3(0.5 * size, 0.0, 0.0), Vec3(0.0, 0.5 * size, 0.0),
        Vec3(0.0, 0.0, 0.5 * (high - low)) };
    }
    together->AddInputData(Drawn(volume));
  }
  together->Update();
  drawn = together->GetOutput();
  vtkAvianLidarArrays::SetFieldStrings(
    drawn->GetFieldData(), vtkAvianLidarArrays::Medium, { text });
  return drawn;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarMedia::IsMedium(vtkPolyData* leaf)
{
  auto* texts = vtkAvianLidarArrays::FindTexts(leaf->GetFieldData(), vtkAvianLidarArrays::Medium);
  return texts && texts->GetNumberOfValues() == 1;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarMedia::TextOf(vtkPolyData* leaf, const std::string& name)
{
  if (!IsMedium(leaf))
  {
    return {};
  }
  auto* texts = vtkAvianLidarArrays::FindTexts(leaf->GetFieldData(), vtkAvianLidarArrays::Medium);
  const std::string file = "medium '" + name + "'";
  Json json = avianlidar::ParseJson(texts->GetValue(0), file);
  json.erase("object_id"); // the scene gives ids
  if (JsonNode(json, "", file).Get("shape").String() != "surface" || json.contains("points"))
  {
    return json.dump();
  }
  Json points = Json::array();
  const vtkSmartPointer<vtkPolyData> surface = vtkAvianLidarTriangles(leaf);
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    double p[3];
    surface->GetPoint(i, p);
    points.push_back({ p[0], p[1], p[2] });
  }
  Json triangles = Json::array();
  vtkIdType size = 0;
  const vtkIdType* corners = nullptr;
  vtkCellArray* polys = surface->GetPolys();
  for (polys->InitTraversal(); polys->GetNextCell(size, corners);)
  {
    triangles.push_back({ corners[0], corners[1], corners[2] });
  }
  json["points"] = std::move(points);
  json["triangles"] = std::move(triangles);
  return json.dump();
}

//------------------------------------------------------------------------------
bool vtkAvianLidarMedia::IsObject(const std::string& text, int& id, std::string& name)
{
  const Json json = avianlidar::ParseJson(text, "medium");
  id = json.value("object_id", -1);
  name = json.value("name", std::string());
  return json.contains("leaf_area_density");
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarMedia::WithObject(const std::string& text, const std::string& name, int id)
{
  Json json = avianlidar::ParseJson(text, "medium");
  json["name"] = name;
  if (id >= 0)
  {
    json["object_id"] = id;
  }
  return json.dump();
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarMedia::WithCrowns(
  const std::string& text, vtkPolyData* middles, const std::vector<std::array<double, 2>>& sizes)
{
  if (sizes.empty())
  {
    return text;
  }
  Json json = avianlidar::ParseJson(text, "medium");
  json["shape"] = "ellipsoid";
  Json ellipsoids = Json::array();
  for (std::size_t i = 0; i < sizes.size(); ++i)
  {
    double p[3];
    middles->GetPoint(static_cast<vtkIdType>(i), p);
    ellipsoids.push_back({ p[0], p[1], p[2], sizes[i][0], sizes[i][1] });
  }
  json["ellipsoids"] = std::move(ellipsoids);
  return json.dump();
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarMedia::InWords(const std::string& text)
{
  Json json = avianlidar::ParseJson(text, "medium");
  json.erase("points");
  json.erase("triangles");
  json.erase("ellipsoids");
  return json.dump();
}
