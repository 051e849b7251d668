// SPDX-License-Identifier: BSD-3-Clause
#include "SceneBuilder.h"

#include "Figures.h"
#include "Footprints.h"
#include "Glob.h"
#include "MeshImport.h"
#include "SceneDescription.h"
#include "SceneFrame.h"
#include "ShownNames.h"
#include "Vector.h"
#include "VirtualFiles.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <new>
#include <set>
#include <sstream>

namespace avianlidar::scene
{
namespace
{
// Greatest number of names in a warning, because a mesh may have hundreds of materials.
constexpr std::size_t ListedNames = 10;

// Warns of materials that no rule maps, in the order of their first use.
void WarnOfUnmapped(const std::vector<std::string>& names, std::vector<std::string>& warnings)
{
  if (names.empty())
  {
    return;
  }
  std::string list;
  for (std::size_t i = 0; i < std::min(ListedNames, names.size()); ++i)
  {
    list += (i ? ", " : "") + names[i];
  }
  if (names.size() > ListedNames)
  {
    list += " and " + std::to_string(names.size() - ListedNames) + " more";
  }
  warnings.push_back("no material or material_map for " + list + ": taken as Wall");
}

void AddOnce(const std::string& name, std::vector<std::string>& names)
{
  if (std::find(names.begin(), names.end(), name) == names.end())
  {
    names.push_back(name);
  }
}

// Returns the id of the object's material, or of the first rule of object or scene that fits the
// name, or -1 if no rule fits.
int FindMaterial(const Scene& scene, const Object& object, const std::string& name)
{
  if (object.material >= 0)
  {
    return object.material;
  }
  for (const std::vector<MaterialRule>* rules : { &object.rules, &scene.rules })
  {
    for (const MaterialRule& rule : *rules)
    {
      if (globMatches(rule.pattern, name))
      {
        return rule.material;
      }
    }
  }
  return -1;
}

// Replaces indices of the file's materials by material ids of the scene.
void MapMaterials(
  const Scene& scene, const Object& object, Mesh& mesh, std::vector<std::string>& unmapped)
{
  std::vector<int> ids(mesh.materialNames.size(), -1);
  for (int& material : mesh.materials)
  {
    int& id = ids[material];
    if (id < 0)
    {
      const std::string& name = mesh.materialNames[material];
      id = FindMaterial(scene, object, name);
      if (id < 0)
      {
        AddOnce(name.empty() ? object.name : "\"" + name + "\"", unmapped);
        id = 0;
      }
    }
    material = id;
  }
}

void Place(const Scene& scene, const Object& object, Mesh& mesh)
{
  const Placement& placement = object.placement;
  const Point3 t = placement.position.value_or(Point3{ 0, 0, 0 });
  const Mat3& r = placement.rotation;
  for (Point3& p : mesh.points)
  {
    const Point3 v{ placement.scale[0] * p[0], placement.scale[1] * p[1],
      placement.scale[2] * p[2] };
    p = { r[0] * v[0] + r[1] * v[1] + r[2] * v[2] + t[0],
      r[3] * v[0] + r[4] * v[1] + r[5] * v[2] + t[1],
      r[6] * v[0] + r[7] * v[1] + r[8] * v[2] + t[2] };
  }
  if (placement.geodetic)
  {
    MoveToPlace(*scene.origin, *placement.geodetic, mesh.points);
  }
}

Part MakeGround(const Object& object)
{
  const GroundOptions& ground = object.ground;
  const double e = ground.sizeEast / 2, n = ground.sizeNorth / 2, z = ground.height;
  Part part{ object.name, object.objectClass, {} };
  part.mesh.points = { { -e, -n, z }, { e, -n, z }, { e, n, z }, { -e, n, z } };
  part.mesh.triangles = { { 0, 1, 2 }, { 0, 2, 3 } };
  part.mesh.materials = { std::max(0, object.material), std::max(0, object.material) };
  return part;
}

// Reads each mesh file once, and keeps the mesh until the last object that places the mesh.
class MeshFiles
{
public:
  explicit MeshFiles(const std::vector<Object>& objects)
  {
    for (const Object& object : objects)
    {
      this->Files[object.file].uses += object.kind == ObjectKind::Mesh;
    }
  }

  Mesh Take(const std::string& name, const std::function<bool()>& keepGoing)
  {
    File& file = this->Files.at(name);
    if (!file.mesh)
    {
      file.mesh = this->Reader.Read(name, keepGoing);
    }
    if (--file.uses > 0)
    {
      return *file.mesh;
    }
    Mesh last = std::move(*file.mesh);
    file.mesh.reset();
    return last;
  }

private:
  struct File
  {
    int uses = 0;
    std::optional<Mesh> mesh;
  };
  std::map<std::string, File> Files;
  MeshReader Reader;
};

Part MakeMesh(BuiltScene& built, const Object& object, MeshFiles& files,
  std::vector<std::string>& unmapped, const std::function<bool()>& keepGoing)
{
  Part part{ object.name, object.objectClass, files.Take(object.file, keepGoing) };
  TurnUp(object.file, object.upAxis, part.mesh);
  if (part.mesh.skippedFaces > 0)
  {
    built.report.push_back(object.name + ": " + std::to_string(part.mesh.skippedFaces) +
      " points or lines were left out");
  }
  constexpr double leastLoss = 0.01; // rounding that gives a warning, m
  const Point3& scale = object.placement.scale;
  const double lost =
    part.mesh.rounding * std::max({ std::abs(scale[0]), std::abs(scale[1]), std::abs(scale[2]) });
  if (lost > leastLoss)
  {
    built.warnings.push_back(object.name +
      ": its coordinates are so large that single precision keeps them to " + figures(lost, 2) +
      " m only: subtract an offset from them, and give it as position");
  }
  for (const std::string& warning : part.mesh.warnings)
  {
    built.warnings.push_back(object.name + ": " + warning);
  }
  if (object.medium.empty())
  {
    MapMaterials(built.description, object, part.mesh, unmapped);
  }
  return part;
}

// Surfaces on which footprints stand. Each surface is made once.
class Terrains
{
public:
  // Returns the surface of the first part of that name, or null for an empty name.
  const Terrain* Get(const std::string& name, const std::vector<Part>& parts)
  {
    if (name.empty())
    {
      return nullptr;
    }
    const auto part = std::find_if(parts.begin(), parts.end(),
      [&name](const Part& p) { return p.name == name && p.medium.empty(); });
    failIf(part == parts.end(), "there is no ", name, " to stand on");
    return &this->Known.try_emplace(name, name, part->mesh).first->second;
  }

private:
  std::map<std::string, Terrain> Known;
};

// Returns the parts of an object. Adds to the report and the warnings of `built`.
std::vector<Part> BuildObject(BuiltScene& built, const Object& object, const Terrain* terrain,
  MeshFiles& files, std::vector<std::string>& unmapped, const std::function<bool()>& keepGoing)
{
  const Scene& scene = built.description;
  std::vector<Part> parts;
  if (object.kind == ObjectKind::Medium)
  {
    parts.push_back({ object.name, "air", {}, object.medium });
    return parts;
  }
  if (object.kind == ObjectKind::Mesh)
  {
    parts.push_back(MakeMesh(built, object, files, unmapped, keepGoing));
  }
  else
  {
    Object named = object;
    named.material = FindMaterial(scene, object, object.name);
    if (named.material < 0 && named.medium.empty())
    {
      AddOnce(object.name, unmapped);
    }
    if (object.kind == ObjectKind::Footprints)
    {
      parts = ReadFootprints(named, scene, terrain, built.report, keepGoing);
    }
    else
    {
      parts.push_back(MakeGround(named));
    }
  }
  for (Part& part : parts)
  {
    part.medium = object.medium;
    Place(scene, object, part.mesh);
    // Footprints are already in metres of the scene.
    if (object.kind == ObjectKind::Mesh && !object.crs.empty() && object.crs != "local")
    {
      GeoreferencedPoints(*scene.origin, object.crs).ToLocal(part.mesh.points);
    }
  }
  return parts;
}

const char* FileKey(const Object& object)
{
  return object.kind == ObjectKind::Mesh
    ? ".file: "
    : (object.kind == ObjectKind::Footprints ? ".footprints: " : ": ");
}

// Returns whether the number of parts of an object depends on its file.
bool HasParts(const Object& object)
{
  return object.kind == ObjectKind::Footprints &&
    (object.footprints.separate || !object.medium.empty());
}

// Reads all objects or, for an outline, only the objects of HasParts() and the terrain below these
// objects. An error names the key. The work may stop between objects.
BuiltScene Build(const std::string& file, const std::function<bool(double)>& progress,
  const std::string& text, bool outline)
{
  BuiltScene built;
  built.description = ReadDescription(file, text);
  const Scene& scene = built.description;
  std::set<std::string> terrainsOfParts;
  for (const Object& object : scene.objects)
  {
    if (HasParts(object))
    {
      terrainsOfParts.insert(object.footprints.on);
    }
  }
  std::vector<std::string> unmapped;
  MeshFiles files(scene.objects);
  Terrains terrains;
  const QuietGdal quiet;
  const OfflineGdal offline;
  const double steps = static_cast<double>(scene.objects.size()) + 1;
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
  {
    const Object& object = scene.objects[i];
    const double done = static_cast<double>(i) / steps;
    const auto keepGoing = [&progress, done] { return progress(done); };
    if (!keepGoing())
    {
      throw WorkStopped();
    }
    const std::string where =
      joined(scene.file, ": ", object.key, FileKey(object), object.file, ": ");
    try
    {
      if (outline && !HasParts(object) && terrainsOfParts.count(object.name) == 0)
      {
        built.parts.push_back({ object.name, object.objectClass, {} });
        continue;
      }
      const Terrain* terrain =
        outline && !HasParts(object) ? nullptr : terrains.Get(object.footprints.on, built.parts);
      for (Part& part : BuildObject(built, object, terrain, files, unmapped, keepGoing))
      {
        built.parts.push_back(std::move(part));
      }
    }
    catch (const std::runtime_error& e) // an Error or a MemoryError
    {
      fail(where, e.what());
    }
    catch (const std::bad_alloc&)
    {
      fail(where, "there is not enough memory for it");
    }
  }
  WarnOfUnmapped(unmapped, built.warnings);
  return built;
}

constexpr double FarAway = 1e5;
// Area of a degenerate triangle, as a share of the square of the longest edge.
constexpr double DegenerateArea = 1e-12;

using glm::cross;
using glm::dot;
using Vector = glm::dvec3;

Vector CornerOf(const Mesh& mesh, std::int64_t point)
{
  const Point3& p = mesh.points[point];
  return { p[0], p[1], p[2] };
}

bool IsDegenerate(const Vector& a, const Vector& b, const Vector& c)
{
  const Vector e0 = b - a, e1 = c - b, e2 = a - c;
  const Vector n = cross(e0, e2);
  const double longest = std::max({ dot(e0, e0), dot(e1, e1), dot(e2, e2) });
  return std::sqrt(dot(n, n)) <= DegenerateArea * longest;
}

// Returns whether a half-line meets a triangle.
bool Meets(
  const Vector& start, const Vector& direction, const Vector& a, const Vector& b, const Vector& c)
{
  const Vector e1 = b - a, e2 = c - a, h = cross(direction, e2);
  const double determinant = dot(e1, h);
  if (determinant == 0)
  {
    return false;
  }
  const Vector s = start - a, q = cross(s, e1);
  const double u = dot(s, h) / determinant, v = dot(direction, q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && dot(e2, q) / determinant > 0;
}

// Directions up, down and sideways, a little askew so that edges of rectangular buildings are not
// along a direction.
const Vector Directions[6] = { { 0.00137, 0.00211, 1 }, { 0.00137, 0.00211, -1 },
  { 1, 0.0131, 0.0071 }, { -1, 0.0131, 0.0071 }, { 0.0113, 1, 0.0073 }, { 0.0113, -1, 0.0073 } };

std::array<int, 6> CountSurfaces(const Mesh& mesh, const Vector& start)
{
  std::array<int, 6> counts{};
  for (const auto& t : mesh.triangles)
  {
    for (int i = 0; i < 6; ++i)
    {
      counts[i] += Meets(
        start, Directions[i], CornerOf(mesh, t[0]), CornerOf(mesh, t[1]), CornerOf(mesh, t[2]));
    }
  }
  return counts;
}

// Box around points.
struct Extent
{
  Vector low{ std::numeric_limits<double>::max() };
  Vector high{ std::numeric_limits<double>::lowest() };

  void Add(const Vector& point)
  {
    this->low = min(this->low, point);
    this->high = max(this->high, point);
  }
  bool IsFar() const
  {
    const Vector farthest = max(-this->low, this->high);
    return std::max({ farthest.x, farthest.y, farthest.z }) > FarAway;
  }
  std::string Text() const
  {
    char text[256];
    std::snprintf(text, sizeof text, ", east %.2f to %.2f, north %.2f to %.2f, up %.2f to %.2f m",
      this->low[0], this->high[0], this->low[1], this->high[1], this->low[2], this->high[2]);
    return text;
  }
};

/// Adds a line for every part: numbers of triangles and of degenerate triangles, or the number of
/// crowns, and extents, m. A triangle is degenerate if its vertices lie on a line or at a point
/// within rounding. Rays do not meet a degenerate triangle. Warns of parts that have only
/// degenerate triangles, and of parts more than 100 km away, whose scale, unit, position or
/// reference system may be wrong.
void ReportExtents(BuiltScene& built)
{
  std::vector<std::string> distant;
  for (const Part& part : built.parts)
  {
    const std::string name = ShownName(part.name);
    Extent extent;
    std::size_t degenerate = 0;
    for (const auto& t : part.mesh.triangles)
    {
      const Vector corners[] = { CornerOf(part.mesh, t[0]), CornerOf(part.mesh, t[1]),
        CornerOf(part.mesh, t[2]) };
      std::for_each(std::begin(corners), std::end(corners),
        [&extent](const Vector& corner) { extent.Add(corner); });
      degenerate += IsDegenerate(corners[0], corners[1], corners[2]);
    }
    for (std::size_t i = 0; i < part.crowns.size(); ++i)
    {
      const auto& [width, height] = part.crowns[i];
      const Vector half(0.5 * width, 0.5 * width, 0.5 * height);
      const Vector centre = CornerOf(part.mesh, static_cast<std::int64_t>(i));
      extent.Add(centre - half);
      extent.Add(centre + half);
    }
    const std::size_t triangles = part.mesh.triangles.size();
    if (triangles == 0 && part.crowns.empty())
    {
      built.report.push_back(name + ": a medium that is not bounded by triangles");
      continue;
    }
    const std::string counts = triangles > 0
      ? joined(triangles, " triangles, ", degenerate, " degenerate")
      : joined(part.crowns.size(), " ellipsoids");
    built.report.push_back(name + ": " + counts + extent.Text());
    if (degenerate > 0 && degenerate == triangles)
    {
      built.warnings.push_back(name + ": all " + std::to_string(degenerate) +
        " triangles are points or lines, which no ray meets: is the scale wrong?");
    }
    if (extent.IsFar())
    {
      distant.push_back(name);
    }
  }
  if (!distant.empty())
  {
    built.warnings.push_back(distant.front() +
      (distant.size() > 1 ? " and " + std::to_string(distant.size() - 1) + " more objects reach"
                          : " reaches") +
      " more than 100 km from the origin: is the position, the scale or the crs wrong?");
  }
}

/// Adds a line with the numbers of surfaces above and below the lidar, and the part that contains
/// the lidar (an odd number of surfaces in all six directions). Warns if a part contains the lidar,
/// unless the scene says `inside`. Warns if surfaces lie above the lidar but not below the lidar.
void ReportLidar(BuiltScene& built)
{
  const Scene& scene = built.description;
  if (!scene.lidar || built.parts.empty())
  {
    return;
  }
  const Vector lidar((*scene.lidar)[0], (*scene.lidar)[1], (*scene.lidar)[2]);
  int above = 0, below = 0;
  std::string container;
  for (const Part& part : built.parts)
  {
    const std::array<int, 6> counts = CountSurfaces(part.mesh, lidar);
    above += counts[0];
    below += counts[1];
    if (std::all_of(counts.begin(), counts.end(), [](int count) { return count % 2 == 1; }))
    {
      container = ShownName(part.name);
    }
  }
  built.report.push_back("lidar: " + std::to_string(above) + " surfaces above, " +
    std::to_string(below) + " below" +
    (container.empty() ? std::string() : ", inside " + container));
  if (!container.empty() && !scene.lidarInside)
  {
    built.warnings.push_back("the lidar is inside " + container +
      ": if the position is right, add \"inside\": true to the lidar");
  }
  else if (above > 0 && below == 0)
  {
    built.warnings.push_back(
      "the lidar is under the scene: surfaces lie above the lidar, but not below the lidar");
  }
}
}

BuiltScene OutlineScene(
  const std::string& file, const std::function<bool(double)>& progress, const std::string& text)
{
  BuiltScene built = Build(file, progress, text, true);
  for (Part& part : built.parts)
  {
    part = { part.name, part.objectClass, {} };
  }
  built.report.clear();
  built.warnings.clear();
  return built;
}

BuiltScene BuildScene(
  const std::string& file, const std::function<bool(double)>& progress, const std::string& text)
{
  BuiltScene built = Build(file, progress, text, false);
  ReportExtents(built);
  ReportLidar(built);
  return built;
}
}
