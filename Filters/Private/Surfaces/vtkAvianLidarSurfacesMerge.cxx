// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaces.h"

#include "AABB.h"
#include "Hash.h"
#include "ParallelLoop.h"
#include "TriangleOrder.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarContent.h"
#include "vtkAvianLidarMaterials.h"
#include "vtkAvianLidarMedia.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarSurfaceIds.h"
#include "vtkAvianLidarSurfaceLeaf.h"

#include "vtkFieldData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVariant.h"

#include <algorithm>
#include <map>
#include <utility>

namespace
{
using avianlidar::Material;
using avianlidar::TriangleMesh;
using avianlidar::Vec3;
using Leaf = vtkAvianLidarSurfaceLeaf;
using Range = vtkAvianLidarSurfaces::Range;
using Column = vtkAvianLidarColumn;

using vtkAvianLidarMaterials::NamedMaterials;

/// Call f(i) for each leaf, by several threads, because the data of leaves are scattered in memory.
template <class F>
void ForAll(const std::vector<Leaf>& leaves, int threads, F&& f)
{
  avianlidar::parallelFor(leaves.size(), 1, threads,
    [&f](std::size_t begin, std::size_t end, int)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        f(i);
      }
    });
}

/// Merges the leaves one after the other. The members hold what was merged so far.
class Merger
{
public:
  vtkAvianLidarSurfaces Result;

  Merger(int threads, bool keepsOrder)
    : Threads(threads)
    , KeepsOrder(keepsOrder)
  {
  }

  void Run(
    const std::vector<Leaf>& leaves, vtkFieldData* fields, const vtkAvianLidarSurfaces* known)
  {
    this->Mesh = std::make_shared<TriangleMesh>();
    this->Arrays.resize(leaves.size());
    this->Result.leaves.resize(leaves.size());
    ForAll(leaves, this->Threads,
      [&](std::size_t i) { this->Arrays[i] = vtkAvianLidarSurfaceArrays(leaves[i].data); });
    if (!this->Check(leaves))
    {
      return;
    }
    this->Ids.Begin(fields, leaves);
    this->Result.geometry = this->HashOfGeometry(leaves, fields);
    this->MeshIsKnown = known && known->mesh && known->geometry == this->Result.geometry;
    this->Reserve(leaves);
    for (std::size_t i = 0; i < leaves.size(); ++i)
    {
      Range& range = this->Result.leaves[i];
      range.begin = this->Materials.size();
      if (!this->AddLeaf(leaves[i], this->Arrays[i]))
      {
        return;
      }
      range.end = this->Materials.size();
    }
    this->AddMedia(leaves);
    this->Ids.AddUnusedNames(leaves);
    this->FindWarnings(leaves);
    this->Finish(known);
    this->WarnOfSize();
  }

private:
  const int Threads;
  const bool KeepsOrder;
  std::vector<Material> Materials;
  std::vector<int> ObjectIds;
  std::vector<int> MaterialIds;
  bool MeshIsKnown = false;
  std::shared_ptr<TriangleMesh> Mesh;
  std::uint32_t FirstPoint = 0; ///< index of the leaf's first point
  vtkAvianLidarSurfaceIds Ids;
  std::vector<vtkAvianLidarSurfaceArrays> Arrays; ///< cell arrays of the leaves
  vtkIdType WithoutMaterial = 0;
  std::string AreaWarning; ///< sentence on polygons that cross or overlap themselves

  /// Hash of everything that the mesh and the order of its triangles depend on.
  std::uint64_t HashOfGeometry(const std::vector<Leaf>& leaves, vtkFieldData* fields) const
  {
    std::uint64_t hash = Leaf::HashOfNames(fields, 0);
    for (std::size_t i = 0; i < leaves.size(); ++i)
    {
      hash = avianlidar::hashOf(leaves[i].name.data(), leaves[i].name.size(), hash);
      hash = Leaf::HashOfNames(leaves[i].data->GetFieldData(), hash);
      hash = vtkAvianLidarContent::HashOfGeometry(leaves[i].data, hash);
      hash = vtkAvianLidarContent::HashOf(this->Arrays[i].ghosts, hash);
      hash = vtkAvianLidarContent::HashOf(this->Arrays[i].object, hash);
      const bool hasMaterials =
        this->Arrays[i].HasMaterials(); // without materials, material ids are not used
      hash = avianlidar::hashOf(&hasMaterials, sizeof(hasMaterials), hash);
      hash = vtkAvianLidarContent::HashOf(this->Arrays[i].material, hash);
    }
    return hash;
  }

  /// @return false if something is wrong with the input
  bool Check(const std::vector<Leaf>& leaves)
  {
    std::vector<std::string> wrong(leaves.size());
    ForAll(
      leaves, this->Threads, [&](std::size_t i) { wrong[i] = leaves[i].Check(this->Arrays[i]); });
    const auto first = std::find_if(
      wrong.begin(), wrong.end(), [](const std::string& text) { return !text.empty(); });
    return first == wrong.end() || this->Fail(leaves[first - wrong.begin()], *first);
  }

  /// Media are not surfaces. A medium is a leaf of its own, or a text in the field data of surfaces
  /// that were merged before.
  void AddMedia(const std::vector<Leaf>& leaves)
  {
    for (const Leaf& leaf : leaves)
    {
      try
      {
        const std::string own = vtkAvianLidarMedia::TextOf(leaf.data, leaf.name);
        if (!own.empty())
        {
          auto* names = vtkAvianLidarArrays::FindTexts(
            leaf.data->GetFieldData(), vtkAvianLidarArrays::ObjectNames);
          const bool isNamed =
            names && names->GetNumberOfValues() == 1 && !names->GetValue(0).empty();
          this->AddMedium(vtkAvianLidarMedia::WithObject(
            own, isNamed ? std::string(names->GetValue(0)) : leaf.name, -1));
        }
        auto* others =
          vtkAvianLidarArrays::FindTexts(leaf.data->GetFieldData(), vtkAvianLidarArrays::Media);
        for (vtkIdType i = 0; others && i < others->GetNumberOfValues(); ++i)
        {
          this->AddMedium(others->GetValue(i));
        }
      }
      catch (const std::exception& error)
      {
        this->Fail(leaf, error.what());
        return;
      }
    }
  }

  void AddMedium(const std::string& text)
  {
    int id = -1;
    std::string name;
    const bool isObject = vtkAvianLidarMedia::IsObject(text, id, name);
    this->Result.media.push_back(
      isObject ? vtkAvianLidarMedia::WithObject(text, name, this->Ids.AddMedium(name, id)) : text);
  }

  /// Reserve memory for all leaves at once. Memory that grows leaf by leaf would be copied each
  /// time.
  void Reserve(const std::vector<Leaf>& leaves)
  {
    std::size_t points = 0;
    std::size_t triangles = 0;
    for (const Leaf& leaf : leaves)
    {
      points += static_cast<std::size_t>(leaf.data->GetNumberOfPoints());
      triangles += leaf.NumberOfTriangles();
    }
    if (!this->MeshIsKnown)
    {
      this->Mesh->points.reserve(points);
      this->Mesh->triangles.reserve(triangles);
    }
    this->Materials.reserve(triangles);
    this->ObjectIds.reserve(triangles);
    this->MaterialIds.reserve(triangles);
  }

  /// Make the result from the values of all leaves.
  void Finish(const vtkAvianLidarSurfaces* known)
  {
    if (this->MeshIsKnown)
    {
      this->Result.order = known->order;
    }
    else if (!this->KeepsOrder)
    {
      this->Result.order = std::make_shared<const std::vector<std::uint32_t>>(
        avianlidar::triangleOrder(*this->Mesh, this->ObjectIds, this->MaterialIds));
      avianlidar::reorder(this->Mesh->triangles, *this->Result.order);
    }
    if (this->Result.order)
    {
      avianlidar::reorder(this->Materials, *this->Result.order);
      avianlidar::reorder(this->ObjectIds, *this->Result.order);
      avianlidar::reorder(this->MaterialIds, *this->Result.order);
    }
    this->Result.mesh = this->MeshIsKnown ? known->mesh : this->Mesh;
    this->Result.checksum = this->MeshIsKnown ? known->checksum : this->Mesh->checksum();
    this->Result.materials = this->Materials;
    this->Result.objectIds = this->ObjectIds;
    this->Result.materialIds = this->MaterialIds;
    this->Result.objectNames = std::move(this->Ids.ObjectNames);
    this->Result.objectClasses = std::move(this->Ids.ObjectClasses);
    this->Result.materialNames = std::move(this->Ids.MaterialNames);
  }

  /// Set the warning about input that can be used but may be a mistake.
  void FindWarnings(const std::vector<Leaf>& leaves)
  {
    std::string& warning = this->Result.warning;
    vtkIdType points = 0;
    for (const Leaf& leaf : leaves)
    {
      points += vtkAvianLidarMedia::IsMedium(leaf.data) ? 0 : leaf.data->GetNumberOfPoints();
    }
    if (points > 0 && this->ObjectIds.empty())
    {
      warning = "surfaces: " + std::to_string(points) +
        " points without a polygon, expected surfaces, as of a scene reader or a collision tree: "
        "no "
        "beam meets points or lines.";
    }
    if (this->WithoutMaterial)
    {
      warning = "surfaces: " + std::to_string(this->WithoutMaterial) + " triangles have no " +
        avianlidar::namesOfCoefficients() + " cell arrays and are taken as Wall (" +
        avianlidar::textOf(NamedMaterials[0].material) +
        "). Use the Material filter, and combine surfaces by Group Datasets: Append Geometry drops "
        "arrays that one input lacks.";
    }
    const auto add = [&warning](const std::string& text)
    {
      warning += (warning.empty() || text.empty() ? "" : " Also, ") + text;
      return !text.empty();
    };
    add(this->AreaWarning.empty() ? "" : this->AreaWarning + ".");
    std::any_of(leaves.begin(), leaves.end(), // only the first such leaf is named
      [&add](const Leaf& leaf) { return add(leaf.WarningOnPoints()); });
  }

  /// Warn of a large scene: boxes in single precision are widened by a share of the scene
  /// (WideTree.h).
  void WarnOfSize()
  {
    avianlidar::AABB bounds; // VTK's own bounds would use too many threads
    for (const Vec3& point : this->Result.mesh->points)
    {
      bounds.extend(point);
    }
    const Vec3 size = bounds.empty() ? Vec3(0.0) : bounds.upper - bounds.lower;
    const double largest = std::max({ size.x, size.y, size.z });
    constexpr double LargestUsual = 1e8; // m; boxes of such a scene are 40 m wider
    if (largest > LargestUsual)
    {
      std::string& warning = this->Result.warning;
      warning += (warning.empty() ? "surfaces: " : " Also, ") + std::string("points lie ") +
        vtkVariant(largest).ToString() +
        " m apart, expected at most 1e8 m: the collision tree separates little then, and scans "
        "take long. Are all points and units right?";
    }
  }

  bool Fail(const Leaf& leaf, const std::string& what)
  {
    this->Result.problem = leaf.Message(what);
    return false;
  }

  bool AddLeaf(const Leaf& leaf, const vtkAvianLidarSurfaceArrays& own)
  {
    if (vtkAvianLidarMedia::IsMedium(leaf.data))
    {
      return true;
    }
    // A leaf that is used as it is has no smart pointer, because VTK collects garbage whenever a
    // smart pointer is destroyed.
    vtkSmartPointer<vtkPolyData> made;
    const bool asItIs = leaf.IsTriangulated();
    if (!asItIs)
    {
      std::string lost;
      made = leaf.Triangulated(lost);
      this->AreaWarning =
        this->AreaWarning.empty() ? lost : this->AreaWarning; // of the first such leaf
    }
    vtkPolyData* poly = asItIs ? leaf.data : made.Get();
    const vtkIdType cells = poly->GetNumberOfPolys();
    if (cells == 0)
    {
      this->Ids.AddEmptyLeaf(leaf);
      return true;
    }
    if (this->Mesh->points.size() + poly->GetNumberOfPoints() >= avianlidar::NoTriangle ||
      this->Mesh->size() + cells >= avianlidar::NoTriangle)
    {
      return this->Fail(leaf, "more than 4294967294 points or triangles in the scene");
    }
    if (!this->MeshIsKnown && !this->AddPoints(leaf, poly))
    {
      return false;
    }
    const vtkAvianLidarSurfaceArrays arrays = asItIs ? own : vtkAvianLidarSurfaceArrays(poly);
    this->AddCells(leaf, poly, arrays);
    return true;
  }

  bool AddPoints(const Leaf& leaf, vtkPolyData* poly)
  {
    this->FirstPoint = static_cast<std::uint32_t>(this->Mesh->points.size());
    for (vtkIdType i = 0; i < poly->GetNumberOfPoints(); ++i)
    {
      Vec3 p;
      poly->GetPoint(i, &p.x);
      const double largest = std::max({ std::abs(p.x), std::abs(p.y), std::abs(p.z) });
      if (!avianlidar::isFinite(p) || largest > avianlidar::MaximumCoordinate)
      {
        return this->Fail(leaf,
          "point " + std::to_string(i) +
            " has a coordinate that is not finite or beyond 1e30, expected metres");
      }
      this->Mesh->points.push_back(p);
    }
    return true;
  }

  /// Maps the ids of a leaf's cells to ids of the scene. Ids of the scene are assigned in ascending
  /// order of the leaf's ids, so that the order of cells does not matter.
  class Renumbering
  {
  public:
    /// @param ids ids of the cells; null: all cells have the id `none` @param idOf function from an
    /// id of the leaf to the id in the scene
    template <class F>
    Renumbering(const vtkAvianLidarSurfaceArrays& arrays, vtkDataArray* ids, int none,
      vtkIdType cells, F idOf)
      : Ids(ids)
      , None(none)
      , Last(Scene.end())
    {
      for (vtkIdType cell = 0; cell < cells; ++cell)
      {
        const int id = this->IdOf(cell);
        if (!arrays.IsGhost(cell) && (this->Scene.empty() || id != this->Last->first))
        {
          this->Last = this->Scene.emplace(id, 0).first;
        }
      }
      for (auto& [id, inScene] : this->Scene)
      {
        inScene = idOf(id);
      }
    }
    int operator[](vtkIdType cell)
    {
      const int id = this->IdOf(cell);
      this->Last = id == this->Last->first ? this->Last : this->Scene.find(id);
      return this->Last->second;
    }

  private:
    int IdOf(vtkIdType cell) const
    {
      return this->Ids ? static_cast<int>(this->Ids[cell]) : this->None;
    }
    const Column Ids;
    const int None;
    std::map<int, int> Scene;
    std::map<int, int>::iterator
      Last; ///< entry of the last cell, as most cells have the id of the cell before
  };

  void AddCells(const Leaf& leaf, vtkPolyData* poly, const vtkAvianLidarSurfaceArrays& arrays)
  {
    const vtkIdType cells = poly->GetNumberOfPolys();
    const bool hasMaterials = arrays.HasMaterials();
    const vtkAvianLidarMaterialColumns coefficients(arrays);
    std::size_t objects = 0;
    Renumbering objectIds(arrays, arrays.object, 0, cells,
      [&](int id) { return this->Ids.AddObject(leaf, poly, id, objects++); });
    Renumbering materialIds(arrays, arrays.material, -1, hasMaterials ? cells : 0,
      [&](int id) { return this->Ids.MaterialOf(poly, id); });
    const auto add = [&](const auto* ids, vtkIdType)
    {
      for (vtkIdType cell = 0; cell < cells; ++cell, ids += 3)
      {
        if (arrays.IsGhost(cell))
        {
          continue;
        }
        if (!this->MeshIsKnown)
        {
          this->Mesh->triangles.push_back({ this->FirstPoint + static_cast<std::uint32_t>(ids[0]),
            this->FirstPoint + static_cast<std::uint32_t>(ids[1]),
            this->FirstPoint + static_cast<std::uint32_t>(ids[2]) });
        }
        coefficients.Read(cell, this->Materials.emplace_back(NamedMaterials[0].material));
        this->ObjectIds.push_back(objectIds[cell]);
        this->MaterialIds.push_back(hasMaterials ? materialIds[cell] : 0);
        this->WithoutMaterial += !hasMaterials;
      }
    };
    vtkAvianLidarPointIds(poly->GetPolys(), add);
  }
};
}

//------------------------------------------------------------------------------
vtkAvianLidarSurfaces vtkAvianLidarSurfaces::Merge(
  vtkDataObject* input, const vtkAvianLidarSurfaces* known, int threads)
{
  vtkAvianLidarSurfaces bad;
  const std::vector<Leaf> leaves = Leaf::Collect(input, bad.problem);
  return bad.problem.empty() ? Merge(leaves, input->GetFieldData(), known, threads, false) : bad;
}

//------------------------------------------------------------------------------
vtkAvianLidarSurfaces vtkAvianLidarSurfaces::Merge(
  const std::vector<vtkAvianLidarSurfaceLeaf>& leaves, vtkFieldData* fields,
  const vtkAvianLidarSurfaces* known, int threads, bool keepsOrder)
{
  Merger merger(threads, keepsOrder);
  merger.Run(leaves, fields, known);
  return std::move(merger.Result);
}

//------------------------------------------------------------------------------
std::uint64_t vtkAvianLidarSurfaces::Hash() const
{
  const std::uint64_t parts[] = { this->checksum, this->materials.checksum(),
    this->objectIds.checksum(), this->materialIds.checksum() };
  std::uint64_t hash = avianlidar::hashOf(parts, sizeof(parts), 0);
  for (const std::string& medium : this->media)
  {
    hash = avianlidar::hashOf(medium.data(), medium.size(), hash);
  }
  return hash;
}
