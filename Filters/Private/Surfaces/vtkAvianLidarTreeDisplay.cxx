// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTreeDisplay.h"

#include "VolumeTree.h"
#include "vtkAvianLidarArrays.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <cmath>
#include <variant>
#include <vector>

namespace
{
namespace names = vtkAvianLidarArrays;
using avianlidar::Vec3;

/// Collects the surfaces of volumes, with the number of the node each face belongs to.
struct Surface
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> faces;
  vtkSmartPointer<vtkIntArray> nodes = names::Make<vtkIntArray>(names::NodeId);
  vtkSmartPointer<vtkIntArray> triangles = names::Make<vtkIntArray>(names::Triangles);
  vtkSmartPointer<vtkIntArray> depths = names::Make<vtkIntArray>(names::Depth);
  int node = 0;
  int count = 0;
  int depth = 0;

  Surface() { this->points->SetDataTypeToDouble(); }

  void Face(const std::vector<vtkIdType>& corners)
  {
    this->faces->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    this->nodes->InsertNextValue(this->node);
    this->triangles->InsertNextValue(this->count);
    this->depths->InsertNextValue(this->depth);
  }
};

void AddBox(Surface& surface, const Vec3& center, const Vec3& x, const Vec3& y, const Vec3& z)
{
  const vtkIdType first = surface.points->GetNumberOfPoints();
  for (int i = 0; i < 8; ++i)
  {
    const Vec3 p = center + (i & 1 ? x : -x) + (i & 2 ? y : -y) + (i & 4 ? z : -z);
    surface.points->InsertNextPoint(&p.x);
  }
  constexpr int faces[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 },
    { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
  for (const auto& face : faces)
  {
    surface.Face({ first + face[0], first + face[1], first + face[2], first + face[3] });
  }
}

void AddVolume(Surface& surface, const avianlidar::OBB& box)
{
  AddBox(surface, box.center, box.half.x * box.axes[0], box.half.y * box.axes[1],
    box.half.z * box.axes[2]);
}

void AddVolume(Surface& surface, const avianlidar::BoundingSphere& sphere)
{
  constexpr int meridians = 24;
  constexpr int parallels = 12;
  const vtkIdType first = surface.points->GetNumberOfPoints();
  for (int i = 0; i <= parallels; ++i)
  {
    const double theta = vtkMath::Pi() * i / parallels;
    for (int j = 0; j < meridians; ++j)
    {
      const double phi = 2.0 * vtkMath::Pi() * j / meridians;
      const Vec3 p = sphere.center +
        sphere.radius *
          Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      surface.points->InsertNextPoint(&p.x);
    }
  }
  for (int i = 0; i < parallels; ++i)
  {
    for (int j = 0; j < meridians; ++j)
    {
      const vtkIdType a = first + i * meridians + j;
      const vtkIdType b = first + i * meridians + (j + 1) % meridians;
      surface.Face({ a, a + meridians, b + meridians, b });
    }
  }
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarMakeTreeDisplay(
  const avianlidar::CollisionTree& tree, int level, vtkPolyData* display)
{
  Surface surface;
  const auto shown =
    level < 0 ? nullptr : avianlidar::volumesOf(tree, static_cast<std::uint32_t>(level));
  for (std::size_t i = 0; shown && i < shown->nodes.size(); ++i)
  {
    const avianlidar::BinaryNode& node = shown->nodes[i];
    const int depth = static_cast<int>(node.depth);
    if (depth == level || (depth < level && node.children == 0))
    {
      surface.node = static_cast<int>(i);
      surface.count = static_cast<int>(node.count);
      surface.depth = depth;
      std::visit([&](const auto& volumes) { AddVolume(surface, volumes[i]); }, shown->volumes);
    }
  }
  display->SetPoints(surface.points);
  display->SetPolys(surface.faces);
  display->GetCellData()->AddArray(surface.nodes);
  display->GetCellData()->AddArray(surface.triangles);
  display->GetCellData()->AddArray(surface.depths);
  display->GetCellData()->SetActiveScalars(names::Depth.name);
}
