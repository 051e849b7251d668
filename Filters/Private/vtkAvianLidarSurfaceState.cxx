// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaceState.h"

#include "Hash.h"
#include "vtkAvianLidarArrays.h"

#include "vtkCellArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

namespace vtkAvianLidarSurfaceState
{
using avianlidar::hashOf;
using Leaf = vtkAvianLidarSurfaceLeaf;
using Column = vtkAvianLidarColumn;

namespace
{
std::uint64_t HashOfIds(vtkDataArray* ids, std::uint64_t seed)
{
  if (auto* ints = vtkIntArray::SafeDownCast(ids))
  {
    return hashOf(ints->GetPointer(0), ints->GetNumberOfValues() * sizeof(int), seed);
  }
  const Column column(ids);
  for (vtkIdType i = 0; column && i < ids->GetNumberOfTuples(); ++i)
  {
    const double id = column[i];
    seed = hashOf(&id, sizeof(id), seed);
  }
  return seed + (ids != nullptr);
}

std::uint64_t IdsOf(const Leaf& leaf)
{
  const vtkAvianLidarSurfaceArrays a(leaf.data);
  return HashOfIds(a.material, HashOfIds(a.object, 0));
}
}

void AddTo(State& state, vtkObject* object)
{
  state.emplace_back(object, object ? object->GetMTime() : 0);
}

void AddGeometryTo(State& state, vtkPolyData* poly)
{
  AddTo(state, poly->GetPoints());
  for (vtkCellArray* cells :
    { poly->GetVerts(), poly->GetLines(), poly->GetPolys(), poly->GetStrips() })
  {
    AddTo(state, cells);
    AddTo(state, cells ? cells->GetOffsetsArray() : nullptr);
    AddTo(state, cells ? cells->GetConnectivityArray() : nullptr);
  }
  AddTo(state, vtkAvianLidarSurfaceArrays(poly).ghosts);
}

std::uint64_t HashOfNames(vtkFieldData* fields, std::uint64_t seed)
{
  for (const auto& name : { vtkAvianLidarArrays::ObjectNames, vtkAvianLidarArrays::MaterialNames })
  {
    auto* names =
      vtkStringArray::SafeDownCast(fields ? fields->GetAbstractArray(name.name) : nullptr);
    const vtkIdType count = names ? names->GetNumberOfValues() : -1;
    seed = hashOf(&count, sizeof(count), seed);
    for (vtkIdType i = 0; i < count; ++i)
    {
      const std::string& text = names->GetValue(i);
      seed = hashOf(text.data(), text.size(), seed);
    }
  }
  return seed;
}

LeafState StateOf(const Leaf& leaf)
{
  LeafState state{};
  const vtkAvianLidarSurfaceArrays a(leaf.data);
  for (vtkDataArray* array : { a.object, a.material, a.kd, a.ks, a.kp })
  {
    AddTo(state.arrays, array);
  }
  state.words =
    HashOfNames(leaf.data->GetFieldData(), hashOf(leaf.name.data(), leaf.name.size(), 0));
  return state;
}

void Remember(const Leaf& leaf, LeafState& state)
{
  const vtkAvianLidarSurfaceArrays a(leaf.data);
  state.ids = IdsOf(leaf);
  state.plain = a.kd && leaf.Triangulated() == leaf.data &&
    state.end - state.begin == static_cast<std::size_t>(leaf.data->GetNumberOfCells());
}

bool IsRepaintingOf(const vtkAvianLidarSurfaces& known, std::uint64_t words,
  const std::vector<Leaf>& leaves, std::vector<LeafState>& states)
{
  if (known.leaves.size() != leaves.size() || known.words != words)
  {
    return false;
  }
  for (std::size_t i = 0; i < leaves.size(); ++i)
  {
    const LeafState& before = known.leaves[i];
    LeafState& now = states[i];
    if (before.words != now.words)
    {
      return false;
    }
    const bool same = before.arrays == now.arrays;
    if (!same &&
      (!before.plain || !leaves[i].Check().empty() ||
        !vtkAvianLidarSurfaceArrays(leaves[i].data).kd || IdsOf(leaves[i]) != before.ids))
    {
      return false;
    }
    now.ids = before.ids;
    now.begin = before.begin;
    now.end = before.end;
    now.plain = before.plain;
  }
  return true;
}
}
