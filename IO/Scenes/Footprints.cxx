// SPDX-License-Identifier: BSD-3-Clause
#include "Footprints.h"

#include "Extrusion.h"
#include "FootprintFeatures.h"
#include "SceneFrame.h"
#include "ShownNames.h"
#include "VirtualFiles.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace avianlidar::scene
{
namespace
{
// Area in plan. With `follows` the area follows the terrain and does not have a level roof.
struct Region
{
  Polygon polygon;
  bool follows = false;
};

double GetHeight(const FootprintFeature& feature, const Object& object, FootprintCounts& counts)
{
  const FootprintOptions& options = object.footprints;
  if (feature.height)
  {
    return *feature.height;
  }
  failIf(!options.height, "feature \"", ShownName(feature.name), "\" has no usable ",
    options.heightAttribute, ", and there is no height to assume");
  if (!options.heightAttribute.empty())
  {
    counts.assumedHeights.Add(
      feature.name + (feature.heightText.empty() ? "" : " (\"" + feature.heightText + "\")"));
  }
  return *options.height;
}

// Returns the height of the underside, m, or 0 if the underside is not below the height.
double GetMinHeight(const FootprintFeature& feature, double height, FootprintCounts& counts)
{
  const double under = feature.minHeight.value_or(0);
  if (under >= height && under > 0)
  {
    counts.minHeights.Add(feature.name);
  }
  return under < height ? under : 0;
}

// Returns a square of the width about a point.
Polygon SquareAround(const Vec2& p, double width)
{
  const double half = width / 2;
  return { { { { p[0] - half, p[1] - half }, { p[0] + half, p[1] - half },
    { p[0] + half, p[1] + half }, { p[0] - half, p[1] + half } } } };
}

std::vector<Region> GetRegions(const FootprintFeature& feature, const FootprintOptions& options,
  bool isMedium, FootprintCounts& counts)
{
  std::vector<Region> regions;
  Repairs repairs;
  for (Polygon& valid : MakeValid(feature.polygons, feature.isNested, repairs))
  {
    regions.push_back({ std::move(valid), isMedium });
  }
  if (repairs.isRepaired)
  {
    counts.repaired.Add(feature.name);
  }
  for (int i = 0; i < repairs.strayHoles; ++i)
  {
    counts.strayHoles.Add(feature.name);
  }
  const std::optional<double> width = feature.width ? feature.width : options.width;
  for (const Ring& line : isMedium ? std::vector<Ring>() : feature.lines)
  {
    if (!width)
    {
      ++counts.thinLines;
      continue;
    }
    for (Polygon& region : WidenLine(line, *width))
    {
      regions.push_back({ std::move(region), true });
    }
  }
  for (const Vec2& p : isMedium ? Ring() : feature.points)
  {
    width && !options.flat ? regions.push_back({ SquareAround(p, *width) }) : void(++counts.points);
  }
  return regions;
}

// Adds points of crowns along a line, one width apart and half a width from the ends of the line.
// Throws Error if a wrong coordinate or width gives too many points.
void AddAlong(const Ring& line, double width, Ring& points)
{
  constexpr int most = 100000;
  double next = 0.5 * width;
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
  {
    const Vec2 way{ line[i + 1][0] - line[i][0], line[i + 1][1] - line[i][1] };
    const double length = std::hypot(way[0], way[1]);
    failIf(!(static_cast<double>(points.size()) + length / width <= most), "a line has more than ",
      most, " crowns of ", width, " m: a coordinate or 'width' is wrong");
    for (; next <= length; next += width)
    {
      points.push_back(
        { line[i][0] + next / length * way[0], line[i][1] + next / length * way[1] });
    }
    next -= length;
  }
}

// Adds the crowns of trees and rows of trees, as ellipsoids between base and height.
void AddCrowns(const FootprintFeature& feature, const Object& object, const Terrain* terrain,
  FootprintCounts& counts, Part& crowns)
{
  const std::optional<double> width = feature.width ? feature.width : object.footprints.width;
  Ring points;
  for (const Ring& line : feature.lines)
  {
    width ? AddAlong(line, *width, points) : void(++counts.thinLines);
  }
  points.insert(points.begin(), feature.points.begin(), feature.points.end());
  if (points.empty() || !width)
  {
    counts.points += static_cast<int>(points.size());
    return;
  }
  const double height = GetHeight(feature, object, counts);
  for (const Vec2& p : points)
  {
    const std::optional<double> ground = terrain ? terrain->HeightAt(p) : 0.0;
    if (!ground)
    {
      ++counts.beyond;
      continue;
    }
    crowns.mesh.points.push_back({ p[0], p[1], *ground + object.footprints.base + 0.5 * height });
    crowns.crowns.push_back({ *width, height });
  }
}

// Adds an area or a solid, unless the region lies beyond the terrain. A solid with a level roof
// stands on the lowest point of the terrain below the solid.
void AddRegion(const Region& region, const Terrain* terrain, const FootprintOptions& options,
  double base, double height, const ExtrusionMaterials& materials, FootprintCounts& counts,
  Mesh& mesh)
{
  Sheet sheet;
  if (terrain)
  {
    const std::vector<TerrainPiece> pieces = terrain->Cut(region.polygon);
    if (pieces.empty())
    {
      ++counts.beyond;
      return;
    }
    const bool follows = options.flat || region.follows;
    base += follows ? 0.0 : LowestOf(pieces);
    sheet = follows ? Join(pieces) : Triangulate(region.polygon);
  }
  else
  {
    sheet = Triangulate(region.polygon);
  }
  options.flat ? AddFlat(sheet, base, materials.facade, mesh)
               : AddSolid(sheet, base, height, materials, mesh);
}

// Removes what was added to a mesh.
class Undo
{
public:
  explicit Undo(Mesh& mesh)
    : Target(mesh)
    , Points(mesh.points.size())
    , Triangles(mesh.triangles.size())
  {
  }
  void operator()() const
  {
    this->Target.points.resize(this->Points);
    this->Target.triangles.resize(this->Triangles);
    this->Target.materials.resize(this->Triangles);
  }

private:
  Mesh& Target;
  const std::size_t Points;
  const std::size_t Triangles;
};

// Adds the areas or solids of a feature.
void AddRegions(const FootprintFeature& feature, const Object& object,
  const std::vector<Region>& regions, const Terrain* terrain, const ExtrusionMaterials& materials,
  FootprintCounts& counts, Mesh& mesh)
{
  const FootprintOptions& options = object.footprints;
  const double top = options.flat ? 0 : GetHeight(feature, object, counts);
  const double under = options.flat ? 0 : GetMinHeight(feature, top, counts);
  const Undo undo(mesh);
  try
  {
    for (const Region& region : regions)
    {
      AddRegion(
        region, terrain, options, options.base + under, top - under, materials, counts, mesh);
    }
  }
  catch (...)
  {
    undo();
    throw;
  }
}

std::vector<Part> Raise(const std::vector<FootprintFeature>& features, const Object& object,
  const Terrain* terrain, FootprintCounts& counts, const std::function<bool()>& keepGoing)
{
  const FootprintOptions& options = object.footprints;
  ExtrusionMaterials materials;
  materials.facade = std::max(0, object.material);
  materials.roof = options.roofMaterial < 0 ? materials.facade : options.roofMaterial;
  materials.glazing = options.glazing;
  std::vector<Part> parts;
  Part crowns{ object.name, object.objectClass, {} };
  const bool isMedium = !object.medium.empty();
  for (const FootprintFeature& feature : features)
  {
    if (!keepGoing())
    {
      throw WorkStopped();
    }
    try
    {
      if (isMedium)
      {
        AddCrowns(feature, object, terrain, counts, crowns);
      }
      const std::vector<Region> regions = GetRegions(feature, options, isMedium, counts);
      if (regions.empty())
      {
        if (!isMedium && feature.HasPlan())
        {
          counts.empty.Add(feature.name);
        }
        continue;
      }
      const std::string& name = options.separate ? feature.name : object.name;
      Part part{ name, object.objectClass, {} };
      const bool isNew = parts.empty() || options.separate;
      AddRegions(feature, object, regions, terrain, materials, counts,
        isNew ? part.mesh : parts.back().mesh);
      if (!part.mesh.triangles.empty())
      {
        parts.push_back(std::move(part));
      }
    }
    catch (const std::runtime_error& error)
    {
      counts.AddFailure(feature.name, error.what());
    }
  }
  if (!crowns.crowns.empty())
  {
    parts.push_back(std::move(crowns));
  }
  return parts;
}

// Adds a sentence to the notes, unless nothing was counted.
void AddNote(const Object& object, int count, const std::string& what, const std::string& names,
  std::vector<std::string>& notes)
{
  if (count > 0)
  {
    notes.push_back(joined(object.name, ": ", count, " ", what, names.empty() ? "" : ": ", names));
  }
}

void AddNotes(const Object& object, const FootprintCounts& counts, std::vector<std::string>& notes)
{
  for (const auto& [what, names] : counts.map)
  {
    AddNote(object, names.GetCount(), what, names.GetText(), notes);
  }
  const std::pair<const Names&, std::string> named[] = {
    { counts.repaired, "footprints with crossing or overlapping rings were repaired" },
    { counts.strayHoles, "holes outside their outlines were left out" },
    { counts.failed, "features that cannot be made (" + counts.failure + ") were left out" },
    { counts.empty, "features without an area were left out" },
    { counts.placeless, "features without a geometry were left out" },
    { counts.surfaces, "surfaces in space were left out" },
    { counts.assumedHeights,
      "features have no usable height attribute and got the default height" },
    { counts.lowest, "features have a least height that is not a length, and stand on the ground" },
    { counts.minHeights,
      "features have a least height that is not below their height, and stand on the ground" },
  };
  for (const auto& [names, what] : named)
  {
    AddNote(object, names.GetCount(), what, names.GetText(), notes);
  }
  AddNote(object, counts.thinLines, "lines without a width were left out", "", notes);
  AddNote(object, counts.points, "points were left out", "", notes);
  AddNote(object, counts.beyond,
    "areas and points beyond " + object.footprints.on + " were left out", "", notes);
}
}

std::vector<Part> ReadFootprints(const Object& object, const Scene& scene, const Terrain* terrain,
  std::vector<std::string>& notes, const std::function<bool()>& keepGoing)
{
  const QuietGdal quiet;
  FootprintCounts counts;
  const std::vector<FootprintFeature> features =
    ReadFootprintFeatures(object, scene, counts, notes, keepGoing);
  std::vector<Part> parts = Raise(features, object, terrain, counts, keepGoing);
  failIf(parts.empty() && counts.failed.GetCount() > 0, counts.failure);
  failIf(parts.empty() && counts.surfaces.GetCount() > 0,
    "its features are surfaces in space, expected areas, lines or points in plan: give it as a "
    "mesh");
  failIf(parts.empty(), "its features have no area (points, or lines without width)",
    std::string(terrain ? ", or lie beyond " + object.footprints.on : ""), FaultsOf(counts));
  AddNotes(object, counts, notes);
  return parts;
}
}
