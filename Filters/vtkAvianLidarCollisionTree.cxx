// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarCollisionTree.h"

#include "BeamTracer.h"
#include "SceneTriangles.h"
#include "ValueError.h"
#include "VolumeTree.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarScene.h"
#include "vtkAvianLidarSurfaceExchange.h"
#include "vtkAvianLidarSurfaces.h"
#include "vtkAvianLidarText.h"
#include "vtkAvianLidarWarnings.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseKey.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

vtkStandardNewMacro(vtkAvianLidarCollisionTree);
vtkAvianLidarCxxControllerMacro(vtkAvianLidarCollisionTree);
vtkInformationKeyMacro(vtkAvianLidarCollisionTree, COLLISION_TREE, ObjectBase);

namespace
{
namespace names = vtkAvianLidarArrays;
using avianlidar::Vec3;

/// Collects the surfaces of volumes, with the number of the node to which each face belongs.
struct Volumes
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> faces;
  vtkSmartPointer<vtkIntArray> nodes = names::Make<vtkIntArray>(names::NodeId);
  vtkSmartPointer<vtkIntArray> triangles = names::Make<vtkIntArray>(names::Triangles);
  vtkSmartPointer<vtkIntArray> depths = names::Make<vtkIntArray>(names::Depth);
  int node = 0;
  int count = 0;
  int depth = 0;

  Volumes() { this->points->SetDataTypeToDouble(); }

  void Face(const std::vector<vtkIdType>& corners)
  {
    this->faces->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    this->nodes->InsertNextValue(this->node);
    this->triangles->InsertNextValue(this->count);
    this->depths->InsertNextValue(this->depth);
  }
};

void AddBox(Volumes& surface, const Vec3& center, const Vec3& x, const Vec3& y, const Vec3& z)
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

void AddVolume(Volumes& surface, const avianlidar::OBB& box)
{
  AddBox(surface, box.center, box.half.x * box.axes[0], box.half.y * box.axes[1],
    box.half.z * box.axes[2]);
}

void AddVolume(Volumes& surface, const avianlidar::BoundingSphere& sphere)
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
/// Fill `display` with the volumes of the nodes at depth `level`, and of the leaves above this
/// depth. For a negative `level`, `display` is left empty.
void MakeDisplay(const avianlidar::CollisionTree& tree, int level, vtkPolyData* display)
{
  Volumes surface;
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
}

struct vtkAvianLidarCollisionTree::vtkInternals
{
  std::shared_ptr<const avianlidar::CollisionTree> Tree;
  vtkAvianLidarSurfaceExchange Exchange;                 ///< exchange of surfaces between ranks
  std::shared_ptr<const vtkAvianLidarSurfaces> Surfaces; ///< surfaces merged last
  vtkAvianLidarWarnings Warnings;
  int Builds = 0;

  bool Fits(std::uint64_t checksum, const avianlidar::TreeOptions& options) const
  {
    return this->Tree && this->Tree->checksum == checksum &&
      this->Tree->options.splitRule == options.splitRule &&
      this->Tree->options.boundingVolume == options.boundingVolume &&
      this->Tree->options.maximumLeafSize == options.maximumLeafSize;
  }
};

//------------------------------------------------------------------------------
vtkAvianLidarCollisionTree::vtkAvianLidarCollisionTree()
  : Internals(new vtkInternals)
{
  this->SetController(vtkMultiProcessController::GetGlobalController());
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
vtkAvianLidarCollisionTree::~vtkAvianLidarCollisionTree() = default;

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::FillInputPortInformation(int, vtkInformation* info)
{
  info->Remove(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE());
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  return 1;
}

//------------------------------------------------------------------------------
void vtkAvianLidarCollisionTree::CheckOptions() const
{
  using avianlidar::rangeError;
  vtkAvianLidarRequire(
    rangeError("Preset", this->Preset, PRESET_CUSTOM, PRESET_PAPER, "0 (custom) or 1 (paper)"));
  if (this->Preset == PRESET_CUSTOM)
  {
    vtkAvianLidarRequire(rangeError("SplitRule", this->SplitRule, 0, 3, "0 to 3"));
    vtkAvianLidarRequire(rangeError("BoundingVolume", this->BoundingVolume, 0, 3, "0 to 3"));
    vtkAvianLidarRequire(
      rangeError("MaximumLeafSize", this->MaximumLeafSize, 1, VTK_INT_MAX, "at least 1"));
  }
}

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks)
    {
      vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
      vtkPolyData* output = vtkPolyData::GetData(outputVector, 0);
      vtkPolyData* display = vtkPolyData::GetData(outputVector, 1);
      this->MergeSurfaces(ranks, input);
      this->MakeTree(ranks, input);
      this->MakeOutputs(ranks, input, output, display);
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarCollisionTree::MergeSurfaces(
  const vtkAvianLidarRanks& ranks, vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  this->CheckOptions();
  vtkAvianLidarRanks::Settings settings;
  settings.Add("Preset", this->Preset);
  if (this->Preset == PRESET_CUSTOM)
  {
    settings.Add("SplitRule", this->SplitRule);
    settings.Add("BoundingVolume", this->BoundingVolume);
    settings.Add("MaximumLeafSize", this->MaximumLeafSize);
  }
  ranks.AgreeOn(settings);
  in.Surfaces = in.Exchange.Merge(ranks, input, "Input port 0, ", 0, in.Surfaces);
  const vtkAvianLidarSurfaces& merged = *in.Surfaces;
  if (in.Warnings.IsNew(input, merged.checksum, merged.warning) && ranks.Rank() == 0)
  {
    vtkWarningMacro("Input port 0, " << vtkAvianLidarText(merged.warning));
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarCollisionTree::MakeTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  using avianlidar::BoundingVolumeType;
  using avianlidar::TreeOptions;
  const TreeOptions options = this->Preset == PRESET_PAPER
    ? TreeOptions{ avianlidar::SplitRule::Median, BoundingVolumeType::BinaryAABB, 1 }
    : TreeOptions{ static_cast<avianlidar::SplitRule>(this->SplitRule),
        static_cast<BoundingVolumeType>(this->BoundingVolume), this->MaximumLeafSize };
  const int threads = ranks.Threads(0);
  const std::uint64_t checksum = in.Surfaces->checksum;
  if (!in.Fits(checksum, options))
  {
    in.Tree = vtkAvianLidarScene::FindTree(input, checksum).tree;
  }
  if (!in.Fits(checksum, options))
  {
    in.Tree = avianlidar::buildVolumeTree(
      in.Surfaces->mesh, options, vtkAvianLidarAbort::KeepGoing(this), threads);
    in.Builds += in.Tree != nullptr;
  }
  vtkAvianLidarAbort::Require(in.Tree != nullptr);
}

//------------------------------------------------------------------------------
void vtkAvianLidarCollisionTree::MakeOutputs(
  const vtkAvianLidarRanks& ranks, vtkDataObject* input, vtkPolyData* output, vtkPolyData* display)
{
  vtkInternals& in = *this->Internals;
  if (ranks.Rank() == 0)
  {
    output->ShallowCopy(in.Surfaces->ToPolyData(in.Exchange.Fields, input));
  }
  else
  {
    // Only rank 0 has the surfaces. The other ranks have the field data of the surfaces.
    output->GetFieldData()->PassData(in.Exchange.Fields);
  }
  vtkNew<vtkAvianLidarScene> scene;
  scene->Surfaces = in.Surfaces;
  scene->Tree = in.Tree;
  scene->AttachTo(output);
  if (ranks.Rank() == 0)
  {
    MakeDisplay(*in.Tree, this->DisplayLevel, display);
  }
}

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::GetNumberOfNodes() const
{
  return std::max(0, 2 * this->GetNumberOfLeaves() - 1);
}

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::GetNumberOfLeaves() const
{
  return this->Internals->Tree ? static_cast<int>(this->Internals->Tree->leaves) : 0;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::GetDepth() const
{
  return this->Internals->Tree ? static_cast<int>(this->Internals->Tree->depth) : 0;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::GetNumberOfBuilds() const
{
  return this->Internals->Builds;
}

//------------------------------------------------------------------------------
void vtkAvianLidarCollisionTree::FindHiddenPoints(
  const double place[3], vtkDataArray* points, vtkUnsignedCharArray* hidden)
{
  if (!points || points->GetNumberOfComponents() != 3 || !hidden)
  {
    vtkErrorMacro("FindHiddenPoints: expected an array of three components, and an array for the "
                  "results");
    return;
  }
  hidden->SetNumberOfComponents(1);
  hidden->SetNumberOfTuples(points->GetNumberOfTuples());
  hidden->FillValue(0);
  const auto tree = this->Internals->Tree;
  if (!tree || tree->empty())
  {
    return;
  }
  const avianlidar::SceneTriangles scene(*tree);
  avianlidar::BeamTracer tracer(scene);
  const Vec3 apex(place[0], place[1], place[2]);
  tracer.setBeam(avianlidar::makeBeamFrame(apex, Vec3(1.0, 0.0, 0.0), 1e-6));
  for (vtkIdType i = 0; i < points->GetNumberOfTuples(); ++i)
  {
    Vec3 point;
    points->GetTuple(i, &point.x);
    const bool isHidden =
      tracer.occluded(Vec3(0.0), point - apex, 0.0, avianlidar::NoTriangle, avianlidar::NoTriangle);
    hidden->SetValue(i, isHidden ? 1 : 0);
  }
}

//------------------------------------------------------------------------------
double vtkAvianLidarCollisionTree::GetNumberOfBytesSent() const
{
  return this->Internals->Exchange.BytesSent;
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarCollisionTree, Controller, ErrorsAsData, Preset, SplitRule,
  BoundingVolume, MaximumLeafSize, DisplayLevel, GetNumberOfNodes(), GetNumberOfBuilds());
