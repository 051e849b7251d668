// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarCollisionTree.h"

#include "ValueError.h"
#include "VolumeTree.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarScene.h"
#include "vtkAvianLidarSurfaceExchange.h"
#include "vtkAvianLidarSurfaces.h"
#include "vtkAvianLidarText.h"
#include "vtkAvianLidarTreeDisplay.h"
#include "vtkAvianLidarWarnings.h"

#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseKey.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <utility>

vtkStandardNewMacro(vtkAvianLidarCollisionTree);
vtkAvianLidarCxxControllerMacro(vtkAvianLidarCollisionTree);
vtkInformationKeyMacro(vtkAvianLidarCollisionTree, COLLISION_TREE, ObjectBase);

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
vtkAvianLidarCollisionTree::~vtkAvianLidarCollisionTree()
{
  this->SetController(nullptr);
}

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
      this->MakeOutputs(ranks, output, display);
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarCollisionTree::MergeSurfaces(
  const vtkAvianLidarRanks& ranks, vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  ranks.Together(this,
    [this]()
    {
      vtkAvianLidarAbort::StopIfWanted(this);
      this->CheckOptions();
    });
  in.Surfaces = in.Exchange.Merge(ranks, this, input, "Input port 0, ", 0, in.Surfaces);
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
  ranks.Together(this,
    [&]()
    {
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
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarCollisionTree::MakeOutputs(
  const vtkAvianLidarRanks& ranks, vtkPolyData* output, vtkPolyData* display)
{
  vtkInternals& in = *this->Internals;
  ranks.Together(this,
    [&]()
    {
      if (ranks.Rank() == 0)
      {
        output->ShallowCopy(in.Surfaces->ToPolyData(in.Exchange.Fields));
      }
      else
      {
        // One copy of the surfaces for all; with the others goes what they know of them.
        output->GetFieldData()->PassData(in.Exchange.Fields);
      }
      vtkNew<vtkAvianLidarScene> scene;
      scene->Surfaces = in.Surfaces;
      scene->Tree = in.Tree;
      scene->AttachTo(output);
      if (ranks.Rank() == 0)
      {
        vtkAvianLidarMakeTreeDisplay(*in.Tree, this->DisplayLevel, display);
      }
    });
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
double vtkAvianLidarCollisionTree::GetNumberOfBytesSent() const
{
  return this->Internals->Exchange.BytesSent;
}

//------------------------------------------------------------------------------
void vtkAvianLidarCollisionTree::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Controller: " << this->Controller << "\n";
  os << indent << "ErrorsAsData: " << this->ErrorsAsData << "\n";
  os << indent << "Preset: " << this->Preset << "\n";
  os << indent << "SplitRule: " << this->SplitRule << "\n";
  os << indent << "BoundingVolume: " << this->BoundingVolume << "\n";
  os << indent << "MaximumLeafSize: " << this->MaximumLeafSize << "\n";
  os << indent << "DisplayLevel: " << this->DisplayLevel << "\n";
  os << indent << "NumberOfNodes: " << this->GetNumberOfNodes() << "\n";
  os << indent << "NumberOfBuilds: " << this->GetNumberOfBuilds() << "\n";
}
