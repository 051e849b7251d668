// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarGather.h"

#include "vtkAppendPolyData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <vector>

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarGather::Points(
  const vtkAvianLidarRanks& ranks, vtkPolyData* mine)
{
  if (ranks.Alone())
  {
    return mine;
  }
  vtkNew<vtkPolyData> bare;
  if (mine->GetNumberOfPoints() > 0)
  {
    bare->SetPoints(mine->GetPoints());
    bare->GetPointData()->ShallowCopy(mine->GetPointData());
  }
  const std::vector<vtkSmartPointer<vtkDataObject>> parts = ranks.Gather(bare);
  vtkNew<vtkAppendPolyData> append;
  append->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  for (const auto& part : parts)
  {
    append->AddInputData(vtkPolyData::SafeDownCast(part));
  }
  append->Update();
  return append->GetOutput();
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPointSet> vtkAvianLidarGather::Coordinates(
  const vtkAvianLidarRanks& ranks, vtkPointSet* mine)
{
  if (ranks.Alone())
  {
    return mine;
  }
  vtkNew<vtkPolyData> bare;
  bare->SetPoints(mine ? mine->GetPoints() : nullptr);
  return Points(ranks, bare);
}
