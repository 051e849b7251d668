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
#include "vtkSmartPointer.h"
#include "vtkStaticCellLocator.h"

#include <algorithm>
#include <chrono>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
/// Where the lidar stands in the locators' data: not in the planes that they cut space by.
const Vec3 Stand(17.3127, -5.7713, 0.9131);

/// The surfaces in a frame near the lidar, in double precision.
vtkSmartPointer<vtkPolyData> toPolyData(const Scene& scene)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec3& p : scene.mesh->points)
  {
    const Vec3 q = p - scene.apex + Stand;
    points->InsertNextPoint(q.x, q.y, q.z);
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

VtkPeer peer(const Scene& scene, const vtkSmartPointer<vtkAbstractCellLocator>& locator)
{
  const vtkSmartPointer<vtkPolyData> data = toPolyData(scene);
  locator->SetDataSet(data);
  const auto start = std::chrono::steady_clock::now();
  locator->BuildLocator();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const double reach = 2.0 * farthestCorner(data);
  const auto trace = [=](const Workload& work, int, const Consumer& consumer)
  {
    vtkNew<vtkGenericCell> cell;
    const double from[3] = { Stand.x, Stand.y, Stand.z };
    for (std::size_t i = 0; i < work.size(); ++i)
    {
      const Vec3 to = Stand + reach * work.direction(i);
      double t = 0.0;
      double x[3];
      double parametric[3];
      int part = 0;
      vtkIdType triangle = -1;
      Hit hit;
      if (locator->IntersectWithLine(from, &to.x, 0.0, t, x, parametric, part, triangle, cell))
      {
        hit.triangle = static_cast<std::uint32_t>(triangle);
        hit.range = safeLength(Vec3(x[0], x[1], x[2]) - Stand);
      }
      if (consumer)
      {
        consumer(i, &hit, 1);
      }
    }
  };
  return { seconds.count(), trace };
}

template <class Locator>
PeerMaker makerOf(const std::string& name)
{
  return { name, [](const Scene& scene) { return peer(scene, vtkSmartPointer<Locator>::New()); } };
}
}

std::vector<PeerMaker> vtkPeers()
{
  return { makerOf<vtkStaticCellLocator>("vtkStaticCellLocator"),
    makerOf<vtkModifiedBSPTree>("vtkModifiedBSPTree"), makerOf<vtkOBBTree>("vtkOBBTree") };
}
}
