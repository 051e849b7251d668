// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaces.h"

#include "AABB.h"
#include "ParallelLoop.h"
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

/// f(i) for each leaf, by several threads: their data lie all over memory.
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

/// Merges the leaves one after the other; its members are the state of that walk.
class Merger
{
public:
  vtkAvianLidarSurfaces Result;

  explicit Merger(int threads)
    : Threads(threads)
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
    for (std::size_t i = 0; i < leaves.size(); ++i)
    {
      this->Result.geometry = vtkAvianLidarContent::HashOf(this->Arrays[i].ghosts,
        vtkAvianLidarContent::HashOfGeometry(leaves[i].data, this->Result.geometry));
    }
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
    this->FindWarnings(leaves);
    this->Finish(known);
    this->WarnOfSize();
  }

private:
  const int Threads;
  std::vector<Material> Materials;
  std::vector<int> ObjectIds;
  std::vector<int> MaterialIds;
  bool MeshIsKnown = false;
  std::shared_ptr<TriangleMesh> Mesh;
  std::uint32_t FirstPoint = 0; ///< of the leaf
  vtkAvianLidarSurfaceIds Ids;
  std::vector<vtkAvianLidarSurfaceArrays> Arrays; ///< of the leaves
  vtkIdType WithoutMaterial = 0;

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

  /// Media are no surfaces. They come by themselves, or with surfaces that were merged before.
  void AddMedia(const std::vector<Leaf>& leaves)
  {
    for (const Leaf& leaf : leaves)
    {
      try
      {
        const std::string own = vtkAvianLidarMedia::TextOf(leaf.data, leaf.name);
        if (!own.empty())
        {
          auto* names = vtkStringArray::SafeDownCast(
            leaf.data->GetFieldData()->GetAbstractArray(vtkAvianLidarArrays::ObjectNames.name));
          const bool isNamed =
            names && names->GetNumberOfValues() == 1 && !names->GetValue(0).empty();
          this->AddMedium(vtkAvianLidarMedia::WithObject(
            own, isNamed ? std::string(names->GetValue(0)) : leaf.name, -1));
        }
        auto* others = vtkStringArray::SafeDownCast(
          leaf.data->GetFieldData()->GetAbstractArray(vtkAvianLidarArrays::Media.name));
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

  /// Room for all leaves at once: growing to the size of each in turn would copy all before it.
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

  /// The result from what was gathered of all leaves.
  void Finish(const vtkAvianLidarSurfaces* known)
  {
    this->Result.mesh = this->MeshIsKnown ? known->mesh : this->Mesh;
    this->Result.checksum = this->MeshIsKnown ? known->checksum : this->Mesh->checksum();
    this->Result.materials = std::move(this->Materials);
    this->Result.objectIds = std::move(this->ObjectIds);
    this->Result.materialIds = std::move(this->MaterialIds);
    if (known)
    {
      // Equal values share one copy, which is summarised once.
      this->Result.materials.shareWith(known->materials);
      this->Result.objectIds.shareWith(known->objectIds);
      this->Result.materialIds.shareWith(known->materialIds);
    }
    this->Result.objectNames = std::move(this->Ids.ObjectNames);
    this->Result.objectClasses = std::move(this->Ids.ObjectClasses);
    this->Result.materialNames = std::move(this->Ids.MaterialNames);
  }

  /// Input that can be used but may be a mistake.
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
    for (const Leaf& leaf : leaves)
    {
      const std::string coarse = leaf.WarningOnPoints();
      if (!coarse.empty())
      {
        warning += (warning.empty() ? "" : " Also, ") + coarse;
        return; // of the first such leaf
      }
    }
  }

  /// Boxes in single precision are widened by a share of the scene (WideTree.h).
  void WarnOfSize()
  {
    avianlidar::AABB bounds; // of VTK they would take more threads than are asked for
    for (const Vec3& point : this->Result.mesh->points)
    {
      bounds.extend(point);
    }
    const Vec3 size = bounds.empty() ? Vec3(0.0) : bounds.upper - bounds.lower;
    const double largest = std::max({ size.x, size.y, size.z });
    constexpr double LargestUsual = 1e8; // m, by which boxes are 40 m wider
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
    // Without a holder where the leaf is taken as it is: VTK collects garbage whenever one goes.
    vtkSmartPointer<vtkPolyData> made;
    const bool asItIs = leaf.IsTriangulated();
    if (!asItIs)
    {
      made = leaf.Triangulated();
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

  void AddCells(const Leaf& leaf, vtkPolyData* poly, const vtkAvianLidarSurfaceArrays& arrays)
  {
    LeafWalk walk(arrays);
    const auto add = [&](const auto* ids, vtkIdType)
    {
      const vtkIdType cells = poly->GetNumberOfPolys();
      for (vtkIdType cell = 0; cell < cells; ++cell, ids += 3)
      {
        if (arrays.ghosts && arrays.ghosts->GetValue(cell))
        {
          continue;
        }
        if (!this->MeshIsKnown)
        {
          this->Mesh->triangles.push_back({ this->FirstPoint + static_cast<std::uint32_t>(ids[0]),
            this->FirstPoint + static_cast<std::uint32_t>(ids[1]),
            this->FirstPoint + static_cast<std::uint32_t>(ids[2]) });
        }
        this->AddMaterial(poly, walk, cell);
        this->AddObject(leaf, poly, walk, cell);
      }
    };
    vtkAvianLidarPointIds(poly->GetPolys(), add);
  }

  /// Of the cells of one leaf: their arrays, and what the last of them had, as most have what the
  /// one before had.
  struct LeafWalk
  {
    explicit LeafWalk(const vtkAvianLidarSurfaceArrays& arrays)
      : hasMaterials(arrays.HasMaterials())
      , coefficients(arrays)
      , materialId(arrays.material)
      , objectId(arrays.object)
    {
    }
    const bool hasMaterials;
    const vtkAvianLidarMaterialColumns coefficients;
    const Column materialId, objectId;
    std::map<int, int> objects;   ///< from ids of the leaf to those of the scene
    std::map<int, int> materials; ///< likewise
    bool first = true;
    Material material;
    int localMaterial = 0;
    int globalMaterial = 0;
    int localObject = 0;
    int globalObject = 0;
  };

  void AddMaterial(vtkPolyData* poly, LeafWalk& walk, vtkIdType cell)
  {
    Material& material = this->Materials.emplace_back(NamedMaterials[0].material);
    int id = 0;
    if (walk.hasMaterials)
    {
      walk.coefficients.Read(cell, material);
      const int local = walk.materialId ? static_cast<int>(walk.materialId[cell]) : -1;
      const bool same = !walk.first && material == walk.material && local == walk.localMaterial;
      if (!same)
      {
        const auto found = walk.materials.find(local);
        walk.globalMaterial = found != walk.materials.end()
          ? found->second
          : (walk.materials[local] = this->Ids.MaterialOf(poly, local));
        walk.material = material;
        walk.localMaterial = local;
      }
      id = walk.globalMaterial;
    }
    else
    {
      ++this->WithoutMaterial;
    }
    this->MaterialIds.push_back(id);
  }

  void AddObject(const Leaf& leaf, vtkPolyData* poly, LeafWalk& walk, vtkIdType cell)
  {
    const int local = walk.objectId ? static_cast<int>(walk.objectId[cell]) : 0;
    if (walk.first || local != walk.localObject)
    {
      auto found = walk.objects.find(local);
      if (found == walk.objects.end())
      {
        const int global = this->Ids.AddObject(leaf, poly, local, walk.objects.size());
        found = walk.objects.emplace(local, global).first;
      }
      walk.localObject = local;
      walk.globalObject = found->second;
      walk.first = false;
    }
    this->ObjectIds.push_back(walk.globalObject);
  }
};
}

//------------------------------------------------------------------------------
vtkAvianLidarSurfaces vtkAvianLidarSurfaces::Merge(
  vtkDataObject* input, const vtkAvianLidarSurfaces* known, int threads)
{
  vtkAvianLidarSurfaces bad;
  const std::vector<Leaf> leaves = Leaf::Collect(input, bad.problem);
  return bad.problem.empty() ? Merge(leaves, input->GetFieldData(), known, threads) : bad;
}

//------------------------------------------------------------------------------
vtkAvianLidarSurfaces vtkAvianLidarSurfaces::Merge(
  const std::vector<vtkAvianLidarSurfaceLeaf>& leaves, vtkFieldData* fields,
  const vtkAvianLidarSurfaces* known, int threads)
{
  Merger merger(threads);
  merger.Run(leaves, fields, known);
  return std::move(merger.Result);
}
