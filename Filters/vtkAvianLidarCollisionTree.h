// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCollisionTree
 * @brief Builds the collision detection tree of a scene once, so that any number of scans can share
 * it.
 *
 * Implements the collision detection tree of "Research on Ground Object Echo Simulation of Avian
 * Lidar", Photonics 2024, 11(2), 153: Sec. 3.1, Eq. 14, Algorithm 1, with its three tree structures
 * and three bounding volumes, and a surface area heuristic beside them. Every combination gives the
 * same echoes, bit for bit; they differ in cost.
 *
 * Passes: merge the surfaces (see below), find a tree that came with them and fits, otherwise build
 * one with several threads, attach it. It uses no VTK locator and no vtkSMPTools.
 *
 * Input port 0: vtkPolyData, or a composite data set of vtkPolyData (each leaf an object). Polygons
 * and strips are triangulated; vertices, lines and ghost cells are dropped. Cell arrays read if
 * present: `object_id`, `material_id`, and the coefficients of vtkAvianLidarMaterial; field data
 * `object_names`, `object_classes`, `material_names`. Where coefficients are missing the material
 * is Wall, with one warning per changed scene.
 *
 * Output port 0: one vtkPolyData of triangles, points double, metres, with cell arrays `object_id`,
 * `material_id` (int), coefficients (double, 1), field arrays `object_names`, `object_classes` (if
 * any surface has them), `material_names` (string) and `tree_checksum` (one unsigned 64-bit value)
 * whose information holds the tree by reference under COLLISION_TREE(). The tree so survives
 * shallow and deep copies within one process, and is dropped in files and other processes, which
 * build it again.
 *
 * Output port 1: the bounding volumes of DisplayLevel as a surface to look at; cell arrays
 * `node_id`, `triangles` (below the node) and `depth` (of the node: leaves above the level appear,
 * too), int.
 *
 * MPI ranks (pvserver, pvbatch) work together when the controller has several processes and
 * each asks for its own piece of as many: surfaces are exchanged, and each rank builds the tree.
 * Rank 0 then has the merged surfaces as output; that of the others has no triangles, but by
 * reference what is known of them, for the echo filter. An error on one rank is one on all.
 *
 * Object ids are kept when every leaf brings its own and no two leaves share one; otherwise they
 * are given in leaf order.
 *
 * Bad input (coordinates that are not finite, only some of the coefficients, or out of range,
 * arrays of another kind or shape, identifiers that are no whole numbers of 32 bits,
 * blocks that are not vtkPolyData, options out of range) gives an error and empty outputs. No
 * triangles: empty outputs, no error. Deterministic: the same input gives the same tree.
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarMaterial, vtkAvianLidarSceneReader
 */
#ifndef vtkAvianLidarCollisionTree_h
#define vtkAvianLidarCollisionTree_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For std::unique_ptr
#include <string> // For what is wrong with options

class vtkAvianLidarRanks;
class vtkDataObject;
class vtkInformationObjectBaseKey;
class vtkMultiProcessController;

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
    BOUNDING_VOLUME_SPHERE = 2
  };

  ///@{
  /**
   * How a node's triangles are parted: SPLIT_RULE_HALVES (first and second half of the list, the
   * paper's BVH), SPLIT_RULE_MEDIAN (median along axes that alternate with depth, the paper's k-D),
   * SPLIT_RULE_PRINCIPAL_PLANE (plane normal to the principal axis, the paper's BSP),
   * SPLIT_RULE_SURFACE_AREA_HEURISTIC (binned). Default: SPLIT_RULE_SURFACE_AREA_HEURISTIC.
   */
  vtkSetMacro(SplitRule, int);
  vtkGetMacro(SplitRule, int);
  void SetSplitRuleToHalves() { this->SetSplitRule(SPLIT_RULE_HALVES); }
  void SetSplitRuleToMedian() { this->SetSplitRule(SPLIT_RULE_MEDIAN); }
  void SetSplitRuleToPrincipalPlane() { this->SetSplitRule(SPLIT_RULE_PRINCIPAL_PLANE); }
  void SetSplitRuleToSurfaceAreaHeuristic()
  {
    this->SetSplitRule(SPLIT_RULE_SURFACE_AREA_HEURISTIC);
  }
  ///@}

  ///@{
  /**
   * The volume around a node's triangles: BOUNDING_VOLUME_AABB (axis-aligned box),
   * BOUNDING_VOLUME_OBB (oriented box) or BOUNDING_VOLUME_SPHERE. Default: BOUNDING_VOLUME_AABB.
   */
  vtkSetMacro(BoundingVolume, int);
  vtkGetMacro(BoundingVolume, int);
  void SetBoundingVolumeToAABB() { this->SetBoundingVolume(BOUNDING_VOLUME_AABB); }
  void SetBoundingVolumeToOBB() { this->SetBoundingVolume(BOUNDING_VOLUME_OBB); }
  void SetBoundingVolumeToSphere() { this->SetBoundingVolume(BOUNDING_VOLUME_SPHERE); }
  ///@}

  ///@{
  /**
   * Most triangles a leaf may hold, at least 1 (1 is Algorithm 1 as printed). Default: 4.
   */
  vtkSetMacro(MaximumLeafSize, int);
  vtkGetMacro(MaximumLeafSize, int);
  ///@}

  ///@{
  /**
   * Level of the tree whose bounding volumes appear on port 1; the root is level 0. Leaves above
   * the level appear too, so that the volumes together always cover the scene. A negative value
   * shows nothing. Default: 0.
   */
  vtkSetMacro(DisplayLevel, int);
  vtkGetMacro(DisplayLevel, int);
  ///@}

  /**
   * Nodes, leaves and depth of the tree of the last execution; 0 before, and for an empty scene.
   */
  int GetNumberOfNodes() const;
  int GetNumberOfLeaves() const;
  int GetDepth() const;

  /**
   * How many trees this filter has built; one that came with the input and fits is not built again.
   */
  int GetNumberOfBuilds() const;

  /// Bytes of surfaces that this rank has given to the others so far, for tests and
  /// measurements.
  double GetNumberOfBytesSent() const;

  /**
   * Key under which the information of the field array `tree_checksum` holds the tree.
   */
  static vtkInformationObjectBaseKey* COLLISION_TREE();

  ///@{
  /**
   * The processes that may work together. Default: the global controller when the filter was
   * made; null: this process works alone.
   */
  void SetController(vtkMultiProcessController* controller);
  vtkGetObjectMacro(Controller, vtkMultiProcessController);
  ///@}

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarCollisionTree();
  ~vtkAvianLidarCollisionTree() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int ModifyRequest(vtkInformation* request, int when) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  int SplitRule = SPLIT_RULE_SURFACE_AREA_HEURISTIC;
  int BoundingVolume = BOUNDING_VOLUME_AABB;
  int MaximumLeafSize = 4;
  int DisplayLevel = 0;

  vtkMultiProcessController* Controller = nullptr;

private:
  vtkAvianLidarCollisionTree(const vtkAvianLidarCollisionTree&) = delete;
  void operator=(const vtkAvianLidarCollisionTree&) = delete;

  // Passes of an execution, by all ranks together; false ends it.
  bool MergeSurfaces(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  bool MakeTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  bool MakeOutputs(const vtkAvianLidarRanks& ranks, vtkPolyData* output, vtkPolyData* display);

  std::string CheckOptions() const;

  struct vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
