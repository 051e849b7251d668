// SPDX-License-Identifier: BSD-3-Clause
#include "SceneBuilder.h"

#include "Footprints.h"
#include "MeshImport.h"
#include "SceneDescription.h"
#include "SceneFrame.h"
#include "SceneReport.h"
#include "VirtualFiles.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <new>
#include <set>
#include <sstream>

namespace avianlidar::scene
{
namespace
{
// Names in a warning; a mesh may have hundreds.
constexpr std::size_t ListedNames = 10;

// Materials that no rule maps, in the order of their first use.
class UnmappedMaterials
{
public:
  void Add(const std::string& name)
  {
    if (std::find(this->Names.begin(), this->Names.end(), name) == this->Names.end())
    {
      this->Names.push_back(name);
    }
  }

  void Warn(std::vector<std::string>& warnings) const
  {
    if (this->Names.empty())
    {
      return;
    }
    std::string list;
    for (std::size_t i = 0; i < std::min(ListedNames, this->Names.size()); ++i)
    {
      list += (i ? ", " : "") + this->Names[i];
    }
    if (this->Names.size() > ListedNames)
    {
      list += " and " + std::to_string(this->Names.size() - ListedNames) + " more";
    }
    warnings.push_back("no material or material_map for " + list + ": taken as Wall");
  }

private:
  std::vector<std::string> Names;
};

int FindRule(const std::vector<MaterialRule>& rules, const std::string& name)
{
  for (const MaterialRule& rule : rules)
  {
    if (MatchesPattern(rule.pattern, name))
    {
      return rule.material;
    }
  }
  return -1;
}

// From indices of the file's own materials to the scene's ids.
void MapMaterials(const Scene& scene, const Object& object, Mesh& mesh, UnmappedMaterials& unmapped)
{
  std::vector<int> ids(mesh.materialNames.size(), -1);
  for (int& material : mesh.materials)
  {
    int& id = ids[material];
    if (id < 0)
    {
      const std::string& name = mesh.materialNames[material];
      id = object.material >= 0 ? object.material : FindRule(object.rules, name);
      id = id >= 0 ? id : FindRule(scene.rules, name);
      if (id < 0)
      {
        unmapped.Add(name.empty() ? object.name : "\"" + name + "\"");
        id = 0;
      }
    }
    material = id;
  }
}

void Place(const Scene& scene, const Object& object, Mesh& mesh)
{
  const Placement& placement = object.placement;
  const Vec3 t = placement.position.value_or(Vec3{ 0, 0, 0 });
  const Mat3& r = placement.rotation;
  for (Vec3& p : mesh.points)
  {
    const Vec3 v{ placement.scale[0] * p[0], placement.scale[1] * p[1], placement.scale[2] * p[2] };
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

// Mesh files, each read once, however many objects place it, and kept until the last of them.
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
      file.mesh = ReadMesh(name, keepGoing);
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
};

Part MakeMesh(BuiltScene& built, const Object& object, MeshFiles& files,
  UnmappedMaterials& unmapped, const std::function<bool()>& keepGoing)
{
  Part part{ object.name, object.objectClass, files.Take(object.file, keepGoing) };
  TurnUp(object.file, object.upAxis, part.mesh);
  if (part.mesh.skippedFaces > 0)
  {
    built.report.push_back(object.name + ": " + std::to_string(part.mesh.skippedFaces) +
      " points or lines were left out");
  }
  constexpr double leastLoss = 0.01; // m
  const Vec3& scale = object.placement.scale;
  const double lost =
    part.mesh.rounding * std::max({ std::abs(scale[0]), std::abs(scale[1]), std::abs(scale[2]) });
  if (lost > leastLoss)
  {
    std::ostringstream text;
    text.precision(2);
    text << object.name << ": its coordinates are so large that single precision keeps them to "
         << lost << " m only: subtract an offset from them, and give it as position";
    built.warnings.push_back(text.str());
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

// The surfaces that footprints stand on, each made once.
class Terrains
{
public:
  // Of the parts so far the first with that name.
  const Terrain* Get(const std::string& name, const std::vector<Part>& parts)
  {
    if (name.empty())
    {
      return nullptr;
    }
    const auto part = std::find_if(parts.begin(), parts.end(),
      [&name](const Part& p) { return p.name == name && p.medium.empty(); });
    if (part == parts.end())
    {
      throw Error("there is no " + name + " to stand on");
    }
    return &this->Known.try_emplace(name, name, part->mesh).first->second;
  }

private:
  std::map<std::string, Terrain> Known;
};

// Adds to the report and the warnings, not to the parts.
std::vector<Part> BuildObject(BuiltScene& built, const Object& object, const Terrain* terrain,
  MeshFiles& files, UnmappedMaterials& unmapped, const std::function<bool()>& keepGoing)
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
    named.material = object.material >= 0 ? object.material : FindRule(object.rules, object.name);
    named.material = named.material >= 0 ? named.material : FindRule(scene.rules, object.name);
    if (named.material < 0 && named.medium.empty())
    {
      unmapped.Add(object.name);
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
    // Footprints are in the scene's metres by now.
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
}

namespace
{
using PartsOf = std::function<std::vector<Part>(const Object&, const std::function<bool()>&)>;

// The parts of all objects, with an error that names the key; between objects somebody may say
// stop.
void AddParts(
  BuiltScene& built, const PartsOf& partsOf, const std::function<bool(double)>& progress)
{
  const Scene& scene = built.description;
  const QuietGdal quiet;
  const OfflineGdal offline;
  const UncachedGdal uncached;
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
    const auto fail = [&](const std::string& reason) {
      throw Error(scene.file + ": " + object.key + FileKey(object) + object.file + ": " + reason);
    };
    try
    {
      for (Part& part : partsOf(object, keepGoing))
      {
        built.parts.push_back(std::move(part));
      }
    }
    catch (const std::runtime_error& e) // Error or MemoryError
    {
      fail(e.what());
    }
    catch (const std::bad_alloc&)
    {
      fail("there is not enough memory for it");
    }
  }
}
}

BuiltScene OutlineScene(
  const std::string& file, const std::function<bool(double)>& progress, const std::string& text)
{
  BuiltScene built;
  built.description = ReadDescription(file, text);
  // How many parts footprints make, their features say, and the terrain below them.
  const auto hasParts = [](const Object& object)
  {
    return object.kind == ObjectKind::Footprints &&
      (object.footprints.separate || !object.medium.empty());
  };
  std::set<std::string> needed;
  for (const Object& object : built.description.objects)
  {
    if (hasParts(object))
    {
      needed.insert(object.footprints.on);
    }
  }
  UnmappedMaterials unmapped;
  MeshFiles files(built.description.objects);
  Terrains terrains;
  const auto outline = [&](const Object& object, const std::function<bool()>& keepGoing)
  {
    if (hasParts(object) || needed.count(object.name) > 0)
    {
      const Terrain* terrain =
        hasParts(object) ? terrains.Get(object.footprints.on, built.parts) : nullptr;
      return BuildObject(built, object, terrain, files, unmapped, keepGoing);
    }
    return std::vector<Part>{ { object.name, object.objectClass, {} } };
  };
  AddParts(built, outline, progress);
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
  BuiltScene built;
  built.description = ReadDescription(file, text);
  UnmappedMaterials unmapped;
  MeshFiles files(built.description.objects);
  Terrains terrains;
  AddParts(
    built,
    [&](const Object& object, const std::function<bool()>& keepGoing)
    {
      const Terrain* terrain = terrains.Get(object.footprints.on, built.parts);
      return BuildObject(built, object, terrain, files, unmapped, keepGoing);
    },
    progress);
  unmapped.Warn(built.warnings);
  ReportExtents(built);
  ReportLidar(built);
  return built;
}
}
