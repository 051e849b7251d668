// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfaces.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarSurfaceLeaf.h"
#include "vtkAvianLidarSurfaceState.h"

#include "vtkFieldData.h"
#include "vtkPolyData.h"

#include <functional>
#include <new>

using Leaf = vtkAvianLidarSurfaceLeaf;
using State = vtkAvianLidarSurfaces::State;
using vtkAvianLidarSurfaceState::AddGeometryTo;
using vtkAvianLidarSurfaceState::AddTo;

//------------------------------------------------------------------------------
State vtkAvianLidarSurfaces::ArraysOf(vtkPolyData* poly)
{
  State state;
  AddGeometryTo(state, poly);
  const vtkAvianLidarSurfaceArrays arrays(poly);
  for (vtkDataArray* array : { arrays.object, arrays.material, arrays.kd, arrays.ks, arrays.kp })
  {
    AddTo(state, array);
  }
  for (const char* name :
    { vtkAvianLidarArrays::ObjectNames.name, vtkAvianLidarArrays::MaterialNames.name })
  {
    AddTo(state, poly->GetFieldData()->GetAbstractArray(name));
  }
  return state;
}

//------------------------------------------------------------------------------
vtkAvianLidarSurfaces vtkAvianLidarSurfaces::MergedAgain() const
{
  vtkAvianLidarSurfaces again = *this;
  again.advice.clear();
  again.geometryState.clear();
  again.leaves.clear();
  // Names of objects without cells are not found there.
  std::vector<char> used(this->objectNames.size(), 0);
  for (const int id : this->objectIds)
  {
    used[id] = 1;
  }
  for (std::size_t id = 0; id < used.size(); ++id)
  {
    if (!used[id])
    {
      again.objectNames[id].clear();
    }
  }
  while (!used.empty() && !used.back())
  {
    used.pop_back();
  }
  again.objectNames.resize(used.size());
  return again;
}

//------------------------------------------------------------------------------
State vtkAvianLidarSurfaces::StateOf(vtkDataObject* input)
try
{
  State state;
  std::string problem;
  state.emplace_back(input, input->GetFieldData()->GetMTime());
  for (const Leaf& leaf : Leaf::Collect(input, problem))
  {
    state.emplace_back(leaf.data, leaf.data->GetMTime());
    // A renamed block leaves no trace in its data.
    state.emplace_back(leaf.data, std::hash<std::string>()(leaf.name));
    state.emplace_back(leaf.data->GetFieldData(), leaf.data->GetFieldData()->GetMTime());
  }
  return problem.empty() ? state : State{};
}
catch (const std::bad_alloc&)
{
  return {};
}
