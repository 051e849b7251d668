// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarGather.h"

#include "vtkAvianLidarArrays.h"

#include "vtkAppendPolyData.h"
#include "vtkCharArray.h"
#include "vtkCommunicator.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <string>
#include <vector>

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

vtkSmartPointer<vtkPolyData> Merged(const std::vector<std::string>& parts)
{
  vtkNew<vtkAppendPolyData> append;
  append->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  for (const std::string& part : parts)
  {
    if (part.empty())
    {
      continue;
    }
    vtkNew<vtkCharArray> bytes;
    vtkAvianLidarArrays::SetTuples(bytes.Get(), static_cast<vtkIdType>(part.size()));
    std::copy(part.begin(), part.end(), bytes->GetPointer(0));
    vtkNew<vtkPolyData> data;
    vtkCommunicator::UnMarshalDataObject(bytes, data);
    append->AddInputData(data);
  }
  if (append->GetNumberOfInputConnections(0) > 0)
  {
    append->Update();
  }
  return append->GetOutput();
}
}

//------------------------------------------------------------------------------
vtkAvianLidarRanks::Outcome vtkAvianLidarGather::Points(const vtkAvianLidarRanks& ranks,
  vtkAlgorithm* self, vtkPointSet* mine, vtkSmartPointer<vtkPolyData>& all)
{
  std::string packed;
  const auto sent = ranks.Together(self,
    [&]() -> std::string
    {
      packed = Packed(mine);
      return {};
    });
  if (sent != vtkAvianLidarRanks::Outcome::Done)
  {
    return sent;
  }
  const std::vector<std::string> parts = ranks.Gather(packed);
  return ranks.Together(self,
    [&]() -> std::string
    {
      all = Merged(parts);
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
