// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"
#include "Tracers.h"

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

VtkPeer peer(const Scene& scene, const vtkSmartPointer<vtkAbstractCellLocator>& locator)
{
  const vtkSmartPointer<vtkPolyData> data = toPolyData(scene);
  locator->SetDataSet(data);
  const double seconds = secondsOf([&]() { locator->BuildLocator(); });
  double reach = 0.0; // of the segments that are given to the locators, m
  for (const Vec3& p : scene.mesh->points)
  {
    reach = std::max(reach, 2.0 * glm::length(p - scene.apex));
  }
  const auto trace = [=](const Workload& work, int, const Consumer& consumer)
  {
    vtkNew<vtkGenericCell> cell;
    std::vector<Hit> hits(work.size());
    for (std::size_t i = 0; i < work.size(); ++i)
    {
      const Vec3 to = Stand + reach * work.direction(i);
      double t = 0.0;
      double x[3];
      double parametric[3];
      int part = 0;
      vtkIdType triangle = -1;
      if (locator->IntersectWithLine(&Stand.x, &to.x, 0.0, t, x, parametric, part, triangle, cell))
      {
        hits[i].triangle = static_cast<std::uint32_t>(triangle);
        hits[i].range = safeLength(Vec3(x[0], x[1], x[2]) - Stand);
      }
    }
    if (consumer)
    {
      consumer(0, hits.data(), hits.size());
    }
  };
  return { seconds, trace };
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
