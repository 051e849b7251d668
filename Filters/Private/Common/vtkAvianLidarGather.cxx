// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarGather.h"

#include "vtkAppendPolyData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <vector>

//------------------------------------------------------------------------------
vtkAvianLidarRanks::Outcome vtkAvianLidarGather::Points(const vtkAvianLidarRanks& ranks,
  vtkAlgorithm* self, vtkPointSet* mine, vtkSmartPointer<vtkPolyData>& all)
{
  vtkNew<vtkPolyData> bare;
  if (mine && mine->GetNumberOfPoints() > 0)
  {
    bare->SetPoints(mine->GetPoints());
    bare->GetPointData()->ShallowCopy(mine->GetPointData());
  }
  const std::vector<vtkSmartPointer<vtkDataObject>> parts = ranks.Gather(bare);
  return ranks.Together(self,
    [&]() -> std::string
    {
      vtkNew<vtkAppendPolyData> append;
      append->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
      for (const auto& part : parts)
      {
        append->AddInputData(vtkPolyData::SafeDownCast(part));
      }
      append->Update();
      all = append->GetOutput();
      return {};
    });
}

//------------------------------------------------------------------------------
vtkAvianLidarRanks::Outcome vtkAvianLidarGather::Coordinates(const vtkAvianLidarRanks& ranks,
  vtkAlgorithm* self, vtkPointSet* mine, vtkSmartPointer<vtkPolyData>& all)
{
  vtkNew<vtkPolyData> bare;
  bare->SetPoints(mine ? mine->GetPoints() : nullptr);
  return Points(ranks, self, bare, all);
}
