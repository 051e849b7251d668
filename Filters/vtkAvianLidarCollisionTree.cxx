// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarCollisionTree.h"

#include "CollisionTreeBuilder.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarSurfaces.h"
#include "vtkAvianLidarTreeAccess.h"
#include "vtkAvianLidarTreeDisplay.h"

#include "vtkInformation.h"
#include "vtkInformationObjectBaseKey.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <utility>

vtkStandardNewMacro(vtkAvianLidarCollisionTree);
vtkInformationKeyMacro(vtkAvianLidarCollisionTree, COLLISION_TREE, ObjectBase);

struct vtkAvianLidarCollisionTree::vtkInternals
{
  std::shared_ptr<const avianlidar::CollisionTree> Tree;
  vtkAvianLidarSurfaces Surfaces;       ///< merged last
  vtkSmartPointer<vtkPolyData> Merged;  ///< the same
  vtkSmartPointer<vtkPolyData> Display; ///< volumes of the tree, drawn last
  std::shared_ptr<const avianlidar::CollisionTree> DrawnTree;
  int DrawnLevel = 0;
  std::uint64_t WarnedFor = 0;
  int Builds = 0;

  void Draw(int level)
  {
    if (!this->Display || this->DrawnTree != this->Tree || this->DrawnLevel != level)
    {
      this->Display = vtkSmartPointer<vtkPolyData>::New();
      vtkAvianLidarMakeTreeDisplay(*this->Tree, level, this->Display);
      this->DrawnTree = this->Tree;
      this->DrawnLevel = level;
    }
  }

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
bool vtkAvianLidarCollisionTree::CheckOptions()
{
  if (this->SplitRule < HALVES || this->SplitRule > SURFACE_AREA_HEURISTIC)
  {
    vtkErrorMacro("SplitRule is " << this->SplitRule << ", expected 0 to 3.");
    return false;
  }
  if (this->BoundingVolume < AABB || this->BoundingVolume > SPHERE)
  {
    vtkErrorMacro("BoundingVolume is " << this->BoundingVolume << ", expected 0 to 2.");
    return false;
  }
  if (this->MaximumLeafSize < 1)
  {
    vtkErrorMacro("MaximumLeafSize is " << this->MaximumLeafSize << ", expected at least 1.");
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]() -> int
    {
      vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
      vtkPolyData* output = vtkPolyData::GetData(outputVector, 0);
      vtkPolyData* display = vtkPolyData::GetData(outputVector, 1);
      if (!this->CheckOptions())
      {
        return 0;
      }
      vtkInternals& in = *this->Internals;
      vtkAvianLidarSurfaces surfaces = vtkAvianLidarSurfaces::Merge(input, &in.Surfaces);
      if (!surfaces.problem.empty())
      {
        vtkErrorMacro("Input port 0, " << surfaces.problem << ".");
        return 0;
      }
      const std::uint64_t checksum = surfaces.checksum;
      if (!surfaces.advice.empty() && this->Internals->WarnedFor != checksum)
      {
        vtkWarningMacro("Input port 0, " << surfaces.advice);
      }
      this->Internals->WarnedFor = surfaces.advice.empty() ? 0 : checksum;

      const avianlidar::TreeOptions options{ static_cast<avianlidar::SplitRule>(this->SplitRule),
        static_cast<avianlidar::BoundingVolumeType>(this->BoundingVolume), this->MaximumLeafSize };
      if (!this->Internals->Fits(checksum, options))
      {
        this->Internals->Tree = vtkAvianLidarTreeAccess::Find(input, surfaces.mesh, checksum).tree;
      }
      if (!this->Internals->Fits(checksum, options))
      {
        auto keepGoing = [this](double fraction)
        {
          this->UpdateProgress(fraction);
          return !vtkAvianLidarAbort::Wanted(this);
        };
        this->Internals->Tree = avianlidar::buildCollisionTree(surfaces.mesh, options, keepGoing);
        if (!this->Internals->Tree)
        {
          return 1; // aborted: empty and valid
        }
        ++this->Internals->Builds;
      }
      in.Merged = surfaces.ToPolyData(input, &in.Surfaces, std::move(in.Merged));
      in.Surfaces = std::move(surfaces);
      output->ShallowCopy(in.Merged);
      vtkAvianLidarTreeAccess::Attach(
        output, in.Tree, std::make_shared<const vtkAvianLidarSurfaces>(in.Surfaces.MergedAgain()));
      if (this->EmbedTree)
      {
        vtkAvianLidarTreeAccess::Embed(output, *this->Internals->Tree);
      }
      in.Draw(this->DisplayLevel);
      display->ShallowCopy(in.Display);
      return 1;
    });
}

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::GetNumberOfNodes() const
{
  return this->Internals->Tree ? static_cast<int>(this->Internals->Tree->nodes.size()) : 0;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::GetNumberOfLeaves() const
{
  if (!this->Internals->Tree)
  {
    return 0;
  }
  const auto& nodes = this->Internals->Tree->nodes;
  return static_cast<int>(
    std::count_if(nodes.begin(), nodes.end(), [](const auto& n) { return n.isLeaf(); }));
}

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::GetDepth() const
{
  if (!this->Internals->Tree || this->Internals->Tree->nodes.empty())
  {
    return 0;
  }
  // Breadth-first numbering: the last node is one of the deepest.
  return static_cast<int>(this->Internals->Tree->depths().back());
}

//------------------------------------------------------------------------------
int vtkAvianLidarCollisionTree::GetNumberOfBuilds() const
{
  return this->Internals->Builds;
}

//------------------------------------------------------------------------------
void vtkAvianLidarCollisionTree::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "SplitRule: " << this->SplitRule << "\n";
  os << indent << "BoundingVolume: " << this->BoundingVolume << "\n";
  os << indent << "MaximumLeafSize: " << this->MaximumLeafSize << "\n";
  os << indent << "DisplayLevel: " << this->DisplayLevel << "\n";
  os << indent << "EmbedTree: " << this->EmbedTree << "\n";
  os << indent << "NumberOfNodes: " << this->GetNumberOfNodes() << "\n";
  os << indent << "NumberOfBuilds: " << this->GetNumberOfBuilds() << "\n";
}
