// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarMovers.h"

#include "Hash.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarSurfaceLeaf.h"
#include "vtkAvianLidarSurfaces.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace
{
namespace names = vtkAvianLidarArrays;
using Leaf = vtkAvianLidarSurfaceLeaf;
using avianlidar::Mover;
using avianlidar::Vec3;

/// Field data with the name of a block, for the exchange between ranks. Only Named() writes this
/// array, and Named() removes any other array of the same name.
constexpr names::Name BlockName{ "block_name", "" };

/// Prefix of all errors.
constexpr char MoversPort[] = "Input port 2 (movers), ";

/// Hash of everything that is read of a block.
std::uint64_t HashOfMover(vtkPolyData* block)
{
  std::uint64_t hash = Leaf::HashOf(block);
  hash = vtkAvianLidarContent::HashOf(block->GetCellData()->GetArray(names::Part.name), hash);
  for (const names::Name& name :
    { names::PoseTime, names::PosePosition, names::PoseOrientation, names::FlapHinge,
      names::FlapAxis, names::FlapAmplitude, names::FlapFrequency, names::FlapPhase })
  {
    hash = vtkAvianLidarContent::HashOf(block->GetFieldData()->GetArray(name.name), hash);
  }
  return hash;
}

std::uint64_t HashOfMovers(vtkMultiBlockDataSet* blocks)
{
  std::uint64_t hash = 0;
  for (unsigned int i = 0; i < blocks->GetNumberOfBlocks(); ++i)
  {
    const std::uint64_t of[] = { HashOfMover(vtkPolyData::SafeDownCast(blocks->GetBlock(i))),
      hash };
    hash = avianlidar::hashOf(of, sizeof(of), 1);
  }
  return hash;
}

/// True if a block is not a mover. A rank without movers may still have a vtkPolyData.
bool IsNothing(vtkPolyData* block)
{
  return block->GetNumberOfPoints() == 0 && block->GetNumberOfCells() == 0 &&
    !block->GetFieldData()->HasArray(names::PosePosition.name);
}

/// The leaves that are movers. Throws if data of other types were found.
std::vector<Leaf> Collect(vtkDataObject* input)
{
  std::string problem;
  std::vector<Leaf> leaves = input ? Leaf::Collect(input, problem) : std::vector<Leaf>();
  leaves.erase(std::remove_if(leaves.begin(), leaves.end(),
                 [](const Leaf& leaf) { return IsNothing(leaf.data); }),
    leaves.end());
  vtkAvianLidarRequire(problem);
  return leaves;
}

/// One block for each leaf, with the given name of the leaf in the block's field data.
vtkSmartPointer<vtkMultiBlockDataSet> Named(vtkDataObject* input)
{
  auto blocks = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  unsigned int count = 0;
  for (const Leaf& leaf : Collect(input))
  {
    vtkNew<vtkPolyData> copy;
    copy->ShallowCopy(leaf.data);
    vtkNew<vtkFieldData> fields;
    fields->PassData(leaf.data->GetFieldData());
    fields->RemoveArray(BlockName.name); // the user's array is not read
    copy->SetFieldData(fields);
    if (leaf.named) // numbers of blocks differ between ranks
    {
      names::SetFieldStrings(fields, BlockName, { leaf.name });
    }
    blocks->SetBlock(count++, copy);
  }
  return blocks;
}

/// The blocks of all ranks, without blocks that a lower rank has, too.
vtkSmartPointer<vtkMultiBlockDataSet> United(
  const std::vector<vtkSmartPointer<vtkDataObject>>& parts)
{
  auto all = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  std::set<std::uint64_t> known;
  unsigned int count = 0;
  for (const auto& part : parts)
  {
    auto* blocks = vtkMultiBlockDataSet::SafeDownCast(part);
    std::set<std::uint64_t> here;
    for (unsigned int i = 0; blocks && i < blocks->GetNumberOfBlocks(); ++i)
    {
      auto* block = vtkPolyData::SafeDownCast(blocks->GetBlock(i));
      if (block && known.count(HashOfMover(block)) == 0)
      {
        here.insert(HashOfMover(block));
        all->SetBlock(count++, block);
      }
    }
    known.insert(here.begin(), here.end());
  }
  return all;
}

/// Read numbers from field data. @return number of rows; 0 without the array
std::size_t ReadNumbers(
  vtkFieldData* fields, const names::Name& name, int components, std::vector<double>& values)
{
  names::RequireNumeric(fields, name, "field data");
  vtkDataArray* const array = fields->GetArray(name.name);
  if (!array)
  {
    return 0;
  }
  names::RequireShape(array, "field data", components, array->GetNumberOfTuples());
  const auto rows = static_cast<std::size_t>(array->GetNumberOfTuples());
  values.resize(rows * static_cast<std::size_t>(components));
  for (std::size_t i = 0; i < rows; ++i)
  {
    array->GetTuple(static_cast<vtkIdType>(i), &values[i * static_cast<std::size_t>(components)]);
  }
  return rows;
}

void RequireCount(const names::Name& name, std::size_t rows, const char* like, std::size_t wanted)
{
  if (rows != wanted)
  {
    vtkAvianLidarRequire(std::string("field data '") + name.name + "' has " + std::to_string(rows) +
      " values, expected as many as '" + like + "' (" + std::to_string(wanted) + ")");
  }
}

void ReadPoses(vtkFieldData* fields, Mover& mover)
{
  std::vector<double> times, positions, turns;
  const std::size_t nPositions = ReadNumbers(fields, names::PosePosition, 3, positions);
  const std::size_t nTimes = ReadNumbers(fields, names::PoseTime, 1, times);
  const std::size_t nTurns = ReadNumbers(fields, names::PoseOrientation, 4, turns);
  vtkAvianLidarRequire(nPositions > 0
      ? ""
      : "field data 'pose_position' is missing or empty, expected a position (x, y, z in metres) "
        "for each pose");
  mover.always = nTimes == 0;
  if (!mover.always || nPositions != 1)
  {
    RequireCount(names::PoseTime, nTimes, "pose_position", nPositions);
  }
  if (nTurns != 0)
  {
    RequireCount(names::PoseOrientation, nTurns, "pose_position", nPositions);
  }
  mover.poses.resize(nPositions);
  for (std::size_t k = 0; k < nPositions; ++k)
  {
    avianlidar::Pose& pose = mover.poses[k];
    pose.time = nTimes > 0 ? times[k] : 0.0;
    pose.position = Vec3(positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]);
    if (nTurns > 0)
    {
      const double* q = &turns[4 * k];
      pose.orientation = { q[0], q[1], q[2], q[3] };
    }
  }
}

void ReadFlaps(vtkFieldData* fields, Mover& mover)
{
  std::vector<double> hinges, axes, numbers[3];
  const std::size_t count = ReadNumbers(fields, names::FlapHinge, 3, hinges);
  if (count == 0)
  {
    return;
  }
  RequireCount(names::FlapAxis, ReadNumbers(fields, names::FlapAxis, 3, axes), "flap_hinge", count);
  int k = 0;
  for (const names::Name& name : { names::FlapAmplitude, names::FlapFrequency, names::FlapPhase })
  {
    RequireCount(name, ReadNumbers(fields, name, 1, numbers[k++]), "flap_hinge", count);
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    mover.flaps.push_back({ Vec3(hinges[3 * i], hinges[3 * i + 1], hinges[3 * i + 2]),
      Vec3(axes[3 * i], axes[3 * i + 1], axes[3 * i + 2]), numbers[0][i], numbers[1][i],
      numbers[2][i] });
  }
}

/// The part of each triangle. @param count number of triangles @param flaps number of flaps
std::vector<std::uint32_t> ReadParts(vtkPolyData* poly, std::size_t count, std::size_t flaps)
{
  std::vector<std::uint32_t> parts(count, 0);
  if (flaps == 0)
  {
    return parts; // a mover without flaps is rigid
  }
  names::RequireNumeric(poly->GetCellData(), names::Part, "cell array");
  vtkDataArray* const array = poly->GetCellData()->GetArray(names::Part.name);
  vtkAvianLidarRequire(array
      ? ""
      : "cell array 'part' is missing, expected with 'flap_hinge': 0 or the row of the flap of "
        "each cell, from 1");
  names::RequireShape(array, "cell array", 1, static_cast<vtkIdType>(count));
  for (std::size_t i = 0; i < count; ++i)
  {
    const double part = array->GetComponent(static_cast<vtkIdType>(i), 0);
    if (!(part >= 0.0 && part <= static_cast<double>(flaps)) || part != std::floor(part))
    {
      vtkAvianLidarRequire("cell " + std::to_string(i) +
        ": cell array 'part' is neither 0 nor a row of 'flap_hinge', from 1");
    }
    parts[i] = static_cast<std::uint32_t>(part);
  }
  return parts;
}

/// Copy the triangles [begin, end) of a mesh to a mover. A point of several parts is copied for
/// each part.
void TakeTriangles(const avianlidar::TriangleMesh& all, std::size_t begin, std::size_t end,
  const std::vector<std::uint32_t>& parts, Mover& mover)
{
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
  for (std::size_t t = begin; t < end; ++t)
  {
    std::array<std::uint32_t, 3> corners;
    for (int c = 0; c < 3; ++c)
    {
      const std::uint32_t point = all.triangles[t][c];
      const std::uint32_t part = parts[t - begin];
      const auto found =
        known.emplace(std::make_pair(point, part), static_cast<std::uint32_t>(known.size()));
      if (found.second)
      {
        mover.mesh.points.push_back(all.points[point]);
        mover.parts.push_back(part);
      }
      corners[c] = found.first->second;
    }
    mover.mesh.triangles.push_back(corners);
  }
}

/// The triangulated movers. @param triangulated data to which the leaves point @param warning
/// becomes the warning on the first mover with polygons that cross or overlap themselves, or empty
std::vector<Leaf> TakeLeaves(vtkDataObject* input, bool named,
  std::vector<vtkSmartPointer<vtkPolyData>>& triangulated, std::string& warning)
{
  std::vector<Leaf> leaves = Collect(input);
  for (Leaf& leaf : leaves)
  {
    const std::string wrong = leaf.Check(vtkAvianLidarSurfaceArrays(leaf.data));
    vtkAvianLidarRequire(wrong.empty() ? wrong : leaf.Message(wrong));
    vtkFieldData* const fields = leaf.data->GetFieldData();
    if (named && fields->HasArray(BlockName.name))
    {
      leaf.name = names::TextAt(fields, BlockName, 0);
    }
    std::string lost;
    triangulated.push_back(leaf.Triangulated(lost));
    warning = warning.empty() ? lost : warning;
    leaf.data = triangulated.back();
  }
  return leaves;
}

/// The mover of leaf `k`. @param merged all leaves, merged @param shift number to add to object ids
/// @param materialOf material id by the id in `merged`
Mover ReadMover(vtkPolyData* poly, const vtkAvianLidarSurfaces& merged, std::size_t k, int shift,
  const std::vector<int>& materialOf)
{
  const auto& leaf = merged.leaves[k];
  Mover mover;
  ReadPoses(poly->GetFieldData(), mover);
  ReadFlaps(poly->GetFieldData(), mover);
  TakeTriangles(*merged.mesh, leaf.begin, leaf.end,
    ReadParts(poly, leaf.end - leaf.begin, mover.flaps.size()), mover);
  for (std::size_t t = leaf.begin; t < leaf.end; ++t)
  {
    mover.materials.push_back(merged.materials[t]);
    mover.objectIds.push_back(merged.objectIds[t] + shift);
    mover.materialIds.push_back(materialOf[merged.materialIds[t]]);
  }
  vtkAvianLidarRequire(avianlidar::prepareMover(mover));
  return mover;
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarMovers::Read(
  const vtkAvianLidarRanks& ranks, vtkDataObject* input, const vtkAvianLidarSurfaces& surfaces)
{
  std::vector<std::string> surfaceNames = surfaces.objectNames;
  for (const auto* more : { &surfaces.objectClasses, &surfaces.materialNames })
  {
    surfaceNames.push_back(std::to_string(surfaceNames.size())); // separator of lists
    surfaceNames.insert(surfaceNames.end(), more->begin(), more->end());
  }
  auto state = input ? vtkAvianLidarContent::StateOf(input) : vtkAvianLidarContent::State();
  const bool same = this->Known && this->SurfaceNames == surfaceNames &&
    this->ReadBy == ranks.Group() && state == this->State;
  if (ranks.All(same))
  {
    return;
  }
  this->Known = false;
  vtkSmartPointer<vtkDataObject> all = input;
  if (!ranks.Alone())
  {
    const auto mine = vtkAvianLidarWithin(MoversPort, [input]() { return Named(input); });
    all = ranks.Same(HashOfMovers(mine)) ? mine : United(ranks.Gather(mine));
  }
  vtkAvianLidarWithin(MoversPort, [&]() { this->ReadAll(all, !ranks.Alone(), surfaces); });
  this->State = std::move(state);
  this->SurfaceNames = std::move(surfaceNames);
  this->ReadBy = ranks.Group();
  this->Known = true;
}

//------------------------------------------------------------------------------
void vtkAvianLidarMovers::ReadAll(
  vtkDataObject* input, bool named, const vtkAvianLidarSurfaces& surfaces)
{
  this->movers.reset();
  this->checksum = 0;
  this->warning.clear();
  this->objectNames = surfaces.objectNames;
  this->objectClasses = surfaces.objectClasses;
  this->materialNames = surfaces.materialNames;
  std::vector<vtkSmartPointer<vtkPolyData>> triangulated;
  const std::vector<Leaf> leaves = TakeLeaves(input, named, triangulated, this->warning);
  if (leaves.empty())
  {
    return;
  }
  const vtkAvianLidarSurfaces merged =
    vtkAvianLidarSurfaces::Merge(leaves, input->GetFieldData(), nullptr, 1, true);
  vtkAvianLidarRequire(merged.problem);
  const auto first = static_cast<int>(surfaces.objectNames.size());
  const std::vector<int>& ids = merged.objectIds.different();
  const auto least = std::min_element(ids.begin(), ids.end());
  const int shift = least == ids.end() ? 0 : std::max(0, first - *least);
  const auto append = [shift](const auto& more, std::vector<std::string>& all)
  {
    for (std::size_t id = 0; id < more.size(); ++id)
    {
      if (!more[id].empty())
      {
        all.resize(std::max(all.size(), id + shift + 1));
        all[id + shift] = more[id];
      }
    }
  };
  append(merged.objectNames, this->objectNames);
  append(merged.objectClasses, this->objectClasses);
  if (!this->objectClasses.empty())
  {
    this->objectClasses.resize(this->objectNames.size());
  }
  std::vector<int> materialOf;
  for (const std::string& name : merged.materialNames)
  {
    auto& known = this->materialNames;
    materialOf.push_back(
      static_cast<int>(std::find(known.begin(), known.end(), name) - known.begin()));
    if (materialOf.back() == static_cast<int>(known.size()))
    {
      known.push_back(name);
    }
  }
  std::vector<Mover> all;
  for (std::size_t k = 0; k < leaves.size(); ++k)
  {
    Mover mover = vtkAvianLidarWithin(leaves[k].Message(""),
      [&]() { return ReadMover(leaves[k].data, merged, k, shift, materialOf); });
    if (mover.mesh.size() > 0)
    {
      all.push_back(std::move(mover));
    }
  }
  if (!all.empty())
  {
    this->checksum = avianlidar::orderMovers(all);
    this->movers = std::make_shared<const std::vector<Mover>>(std::move(all));
  }
}
