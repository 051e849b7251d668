// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarGather.h"

#include "vtkAvianLidarRanks.h"

#include "vtkAppendPolyData.h"
#include "vtkCharArray.h"
#include "vtkCommunicator.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <string>

namespace
{
/// Points and point arrays alone, as bytes; none where there are no points.
std::string Packed(vtkPointSet* points)
{
  if (!points || points->GetNumberOfPoints() == 0)
  {
    return {};
  }
  vtkNew<vtkPolyData> bare;
  bare->SetPoints(points->GetPoints());
  bare->GetPointData()->ShallowCopy(points->GetPointData());
  vtkNew<vtkCharArray> bytes;
  if (!vtkCommunicator::MarshalDataObject(bare, bytes))
  {
    return {};
  }
  return std::string(bytes->GetPointer(0), static_cast<std::size_t>(bytes->GetNumberOfValues()));
}
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarGather::Points(
  const vtkAvianLidarRanks& ranks, vtkPointSet* mine)
{
  vtkNew<vtkAppendPolyData> append;
  for (const std::string& part : ranks.Gather(Packed(mine)))
  {
    if (part.empty())
    {
      continue;
    }
    vtkNew<vtkCharArray> bytes;
    bytes->SetNumberOfValues(static_cast<vtkIdType>(part.size()));
    std::copy(part.begin(), part.end(), bytes->GetPointer(0));
    vtkNew<vtkPolyData> data;
    vtkCommunicator::UnMarshalDataObject(bytes, data);
    append->AddInputData(data);
  }
  append->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  if (append->GetNumberOfInputConnections(0) > 0)
  {
    append->Update();
  }
  return append->GetOutput();
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkAvianLidarGather::Coordinates(
  const vtkAvianLidarRanks& ranks, vtkPointSet* mine)
{
  vtkNew<vtkPolyData> bare;
  bare->SetPoints(mine ? mine->GetPoints() : nullptr);
  return Points(ranks, bare);
}
