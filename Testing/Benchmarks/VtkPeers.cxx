// SPDX-License-Identifier: BSD-3-Clause
#include "VtkPeers.h"

#include "vtkAbstractCellLocator.h"
#include "vtkCellArray.h"
#include "vtkGenericCell.h"
#include "vtkModifiedBSPTree.h"
#include "vtkNew.h"
#include "vtkOBBTree.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStaticCellLocator.h"

#include <algorithm>
#include <chrono>

namespace benchmarks
{
using namespace avianlidar;

vtkSmartPointer<vtkPolyData> toPolyData(const Scene& scene)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec3& p : scene.mesh->points)
  {
    points->InsertNextPoint(p.x - scene.apex.x, p.y - scene.apex.y, p.z - scene.apex.z);
  }
  vtkNew<vtkCellArray> cells;
  for (const auto& t : scene.mesh->triangles)
  {
    cells->InsertNextCell(
      { static_cast<vtkIdType>(t[0]), static_cast<vtkIdType>(t[1]), static_cast<vtkIdType>(t[2]) });
  }
  data->SetPoints(points);
  data->SetPolys(cells);
  return data;
}

namespace
{
/// Reach of the segments that are given to the locators, m.
double farthestCorner(vtkPolyData* data)
{
  const double* b = data->GetBounds();
  double sum = 0.0;
  for (int k = 0; k < 3; ++k)
  {
    const double side = std::max(std::fabs(b[2 * k]), std::fabs(b[2 * k + 1]));
    sum += side * side;
  }
  return std::sqrt(sum);
}

VtkPeer peer(const std::string& name, vtkSmartPointer<vtkPolyData> data,
  const vtkSmartPointer<vtkAbstractCellLocator>& locator)
{
  locator->SetDataSet(data);
  const auto start = std::chrono::steady_clock::now();
  locator->BuildLocator();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const double reach = 1.001 * farthestCorner(data);
  const auto trace = [=](const Workload& work, int, const Consumer& consumer)
  {
    vtkNew<vtkGenericCell> cell;
    const double from[3] = { 0.0, 0.0, 0.0 };
    for (std::size_t i = 0; i < work.size(); ++i)
    {
      const Vec3 to = reach * work.direction(i);
      double t = 0.0;
      double x[3];
      double parametric[3];
      int part = 0;
      vtkIdType triangle = -1;
      Hit hit;
      if (locator->IntersectWithLine(from, &to.x, 0.0, t, x, parametric, part, triangle, cell))
      {
        hit.triangle = static_cast<std::uint32_t>(triangle);
        hit.range = safeLength(Vec3(x[0], x[1], x[2]));
      }
      consumer(i, &hit, 1);
    }
  };
  return { name, seconds.count(), trace };
}
}

std::vector<VtkPeer> vtkPeers(const Scene& scene)
{
  const vtkSmartPointer<vtkPolyData> data = toPolyData(scene);
  return {
    peer("vtkStaticCellLocator", data, vtkSmartPointer<vtkStaticCellLocator>::New()),
    peer("vtkModifiedBSPTree", data, vtkSmartPointer<vtkModifiedBSPTree>::New()),
    peer("vtkOBBTree", data, vtkSmartPointer<vtkOBBTree>::New()),
  };
}
}
