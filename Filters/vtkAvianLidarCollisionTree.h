// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCollisionTree
 * @brief Builds the collision detection tree of a scene once, so that many scans can share it.
 *
 * The filter implements the tree of "Research on Ground Object Echo Simulation of Avian Lidar",
 * Photonics 2024, 11(2), 153 (Sec. 3.1, Eq. 14, Algorithm 1), with the paper's three structures and
 * three bounding volumes. The split rule SPLIT_RULE_SURFACE_AREA_HEURISTIC is not in the paper. All
 * trees give the same echoes, bit for bit, at different cost.
 *
 * - Input port 0: vtkPolyData, or a composite of vtkPolyData, in which each leaf is an object.
 *   Polygons and strips are triangulated. Vertices, lines and ghost cells are dropped. Optional are
 *   the cell arrays `object_id`, `material_id` and the coefficients of vtkAvianLidarMaterial, and
 *   the field data `object_names`, `object_classes`, `material_names`. Without coefficients the
 *   material is Wall, with a warning.
 * - Output port 0: one vtkPolyData of all triangles with the arrays of the input. The field array
 *   `tree_checksum` refers to the tree, also in copies within the process. Files do not contain the
 *   tree.
 * - Output port 1: the bounding volumes of DisplayLevel as surfaces, with the cell arrays
 *   `node_id`, `triangles` and `depth`.
 *
 * Object ids are kept if every leaf has ids and no two leaves share an id. Otherwise ids are
 * assigned in leaf order. MPI ranks that request their own pieces exchange surfaces. Rank 0 has the
 * output.
 *
 * A bad input or option gives an error and empty outputs. Without triangles the outputs are empty.
 * The same input gives the same tree. The filter uses neither a VTK locator nor vtkSMPTools.
 *
 * @code
 * tree->SetInputConnection(reader->GetOutputPort());
 * echoes->SetSurfacesConnection(tree->GetOutputPort());
 * @endcode
 *
 * Documentation: method/collision.md, guide/parallel.md.
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarMaterial, vtkAvianLidarSceneReader
 */
#ifndef vtkAvianLidarCollisionTree_h
#define vtkAvianLidarCollisionTree_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkAvianLidarRanks;
class vtkDataArray;
class vtkDataObject;
class vtkInformationObjectBaseKey;
class vtkUnsignedCharArray;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarCollisionTree : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarCollisionTree* New();
  vtkTypeMacro(vtkAvianLidarCollisionTree, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum SplitRuleType
  {
    SPLIT_RULE_HALVES = 0,
    SPLIT_RULE_MEDIAN = 1,
    SPLIT_RULE_PRINCIPAL_PLANE = 2,
    SPLIT_RULE_SURFACE_AREA_HEURISTIC = 3
  };

  enum BoundingVolumeType
  {
    BOUNDING_VOLUME_AABB = 0,
    BOUNDING_VOLUME_OBB = 1,
    BOUNDING_VOLUME_SPHERE = 2,
    BOUNDING_VOLUME_BINARY_AABB = 3
  };

  enum PresetType
  {
    PRESET_CUSTOM = 0,
    PRESET_PAPER = 1
  };

  ///@{
  /// Preset of the tree. PRESET_PAPER builds the paper's k-D tree (Sec. 3.1, 5.1 and Algorithm 1).
  /// At execution this preset overrides SplitRule (median), BoundingVolume (boxes, two per node)
  /// and MaximumLeafSize (1). Default: PRESET_CUSTOM, which overrides nothing.
  vtkAvianLidarPropertyMacro(Preset, int, PRESET_CUSTOM);
  void SetPresetToCustom() { this->SetPreset(PRESET_CUSTOM); }
  void SetPresetToPaper() { this->SetPreset(PRESET_PAPER); }
  ///@}

  ///@{
  /// Rule that splits a node's triangles: halves of the list (paper: BVH), median (k-D), principal
  /// plane (BSP), or the binned surface area heuristic. Default: SPLIT_RULE_SURFACE_AREA_HEURISTIC.
  vtkAvianLidarPropertyMacro(SplitRule, int, SPLIT_RULE_SURFACE_AREA_HEURISTIC);
  void SetSplitRuleToHalves() { this->SetSplitRule(SPLIT_RULE_HALVES); }
  void SetSplitRuleToMedian() { this->SetSplitRule(SPLIT_RULE_MEDIAN); }
  void SetSplitRuleToPrincipalPlane() { this->SetSplitRule(SPLIT_RULE_PRINCIPAL_PLANE); }
  void SetSplitRuleToSurfaceAreaHeuristic()
  {
    this->SetSplitRule(SPLIT_RULE_SURFACE_AREA_HEURISTIC);
  }
  ///@}

  ///@{
  /// Volume around a node. BOUNDING_VOLUME_AABB has eight boxes per node in single precision. The
  /// other choices have two volumes per node in double precision, as in the paper: oriented boxes,
  /// spheres or boxes (BOUNDING_VOLUME_BINARY_AABB). Default: BOUNDING_VOLUME_AABB.
  vtkAvianLidarPropertyMacro(BoundingVolume, int, BOUNDING_VOLUME_AABB);
  void SetBoundingVolumeToAABB() { this->SetBoundingVolume(BOUNDING_VOLUME_AABB); }
  void SetBoundingVolumeToOBB() { this->SetBoundingVolume(BOUNDING_VOLUME_OBB); }
  void SetBoundingVolumeToSphere() { this->SetBoundingVolume(BOUNDING_VOLUME_SPHERE); }
  void SetBoundingVolumeToBinaryAABB() { this->SetBoundingVolume(BOUNDING_VOLUME_BINARY_AABB); }
  ///@}

  /// Largest number of triangles in a leaf, at least 1 (1: Algorithm 1 as printed). Default: 4.
  vtkAvianLidarPropertyMacro(MaximumLeafSize, int, 4);

  /// Level of the nodes whose volumes port 1 shows; negative: no volumes. Port 1 also shows the
  /// volumes of leaves above this level. Default: 0, the root.
  vtkAvianLidarPropertyMacro(DisplayLevel, int, 0);

  /// Number of nodes, number of leaves, and depth of the last tree; 0 without a tree.
  int GetNumberOfNodes() const;
  int GetNumberOfLeaves() const;
  int GetDepth() const;

  /// Number of trees that this filter has built. If the input already has a tree of the same
  /// surfaces and options, the filter uses that tree and does not count it.
  int GetNumberOfBuilds() const;

  /// Size of the surfaces that this rank has sent to other ranks so far, bytes, for tests and
  /// measurements.
  double GetNumberOfBytesSent() const;

  /// Finds the points that a place does not see because surfaces of the last tree lie between them.
  /// Without a tree no point is hidden. @param place the place, m @param points three components
  /// for each point, m; otherwise an error is reported @param hidden gets a 1 for each hidden
  /// point, and a 0 for each other point, also for points that are not finite
  void FindHiddenPoints(const double place[3], vtkDataArray* points, vtkUnsignedCharArray* hidden);

  /// Key under which the information of the field array `tree_checksum` holds the tree.
  static vtkInformationObjectBaseKey* COLLISION_TREE();

  /// Controller of the processes that may work together; null: this process works alone. Default:
  /// the global controller.
  vtkAvianLidarControllerMacro();

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarCollisionTree();
  ~vtkAvianLidarCollisionTree() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarCollisionTree(const vtkAvianLidarCollisionTree&) = delete;
  void operator=(const vtkAvianLidarCollisionTree&) = delete;

  // Passes of an execution, which all ranks make together. A failure on one rank throws on all
  // ranks.
  void MergeSurfaces(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  void MakeTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  void MakeOutputs(const vtkAvianLidarRanks& ranks, vtkDataObject* input, vtkPolyData* output,
    vtkPolyData* display);

  void CheckOptions() const;

  struct vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
