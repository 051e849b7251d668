// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaceState.h"

#include "Hash.h"
#include "vtkAvianLidarContent.h"
#include "vtkAvianLidarNames.h"

#include "vtkFieldData.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <string_view>

namespace vtkAvianLidarSurfaceState
{
namespace Content = vtkAvianLidarContent;
using avianlidar::hashOf;
using Leaf = vtkAvianLidarSurfaceLeaf;

//------------------------------------------------------------------------------
std::uint64_t HashOfNames(vtkFieldData* fields, std::uint64_t seed)
{
  for (const auto& name : vtkAvianLidarArrays::SurfaceTexts)
  {
    vtkAbstractArray* array = fields ? fields->GetAbstractArray(name.name) : nullptr;
    auto* names = vtkStringArray::SafeDownCast(array);
    constexpr vtkIdType none = -1;
    constexpr vtkIdType noText = -2; // an error: another state than none
    const vtkIdType count = names ? names->GetNumberOfValues() : array ? noText : none;
    seed = hashOf(&count, sizeof(count), seed);
    for (vtkIdType i = 0; i < count; ++i)
    {
      const std::string& text = names->GetValue(i);
      seed = hashOf(text.data(), text.size(), seed);
    }
  }
  return seed;
}

//------------------------------------------------------------------------------
LeafState StateOf(const Leaf& leaf, const vtkAvianLidarSurfaceArrays& a)
{
  LeafState state{};
  state.words =
    HashOfNames(leaf.data->GetFieldData(), hashOf(leaf.name.data(), leaf.name.size(), 0));
  state.geometry = Content::HashOf(a.ghosts, Content::HashOfGeometry(leaf.data, 0));
  const std::string_view odd =
    a.notNumeric ? a.notNumeric : ""; // an error: another state than none
  state.ids =
    Content::HashOf(a.material, Content::HashOf(a.object, hashOf(odd.data(), odd.size(), 0)));
  for (vtkDataArray* coefficient : a.coefficients)
  {
    state.coefficients = Content::HashOf(coefficient, state.coefficients);
  }
  return state;
}

//------------------------------------------------------------------------------
std::uint64_t HashOf(vtkPolyData* poly)
{
  Leaf leaf;
  leaf.data = poly;
  const LeafState state = StateOf(leaf, vtkAvianLidarSurfaceArrays(poly));
  const std::uint64_t all[] = { state.words, state.geometry, state.ids, state.coefficients };
  return hashOf(all, sizeof(all), 0);
}

//------------------------------------------------------------------------------
bool IsGeometryOf(const vtkAvianLidarSurfaces& known, const std::vector<LeafState>& states)
{
  return known.mesh && !known.leaves.empty() &&
    std::equal(states.begin(), states.end(), known.leaves.begin(), known.leaves.end(),
      [](const LeafState& a, const LeafState& b) { return a.geometry == b.geometry; });
}

//------------------------------------------------------------------------------
bool IsRepaintingOf(const vtkAvianLidarSurfaces& known, std::uint64_t words,
  const std::vector<Leaf>& leaves, const std::vector<vtkAvianLidarSurfaceArrays>& arrays,
  std::vector<LeafState>& states)
{
  if (known.words != words)
  {
    return false;
  }
  for (std::size_t i = 0; i < leaves.size(); ++i)
  {
    const LeafState& before = known.leaves[i];
    LeafState& now = states[i];
    if (before.words != now.words || before.ids != now.ids)
    {
      return false;
    }
    if (before.coefficients != now.coefficients &&
      (!before.plain || !leaves[i].Check(arrays[i]).empty() || !arrays[i].HasMaterials()))
    {
      return false;
    }
    now.begin = before.begin;
    now.end = before.end;
    now.plain = before.plain;
  }
  return true;
}
}
