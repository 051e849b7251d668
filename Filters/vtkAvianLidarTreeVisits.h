// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarTreeVisits
 * @brief The volumes of one level of the collision tree, with the number of beams that visit each:
 * where in a scene the search for hits has to look.
 *
 * Implements no equation of its own: every beam goes down the tree by the beam's test of Sec. 3.2
 * of "Research on Ground Object Echo Simulation of Avian Lidar", Photonics 2024, 11(2), 153, and is
 * counted where it comes by (Documentation/collision-detection.md).
 *
 * Input port 0, beams, and port 1, surfaces, are those of vtkAvianLidarEchoFilter, best the output
 * of vtkAvianLidarCollisionTree. A scene that moves is asked for its state at the same time as that
 * filter asks: at the start of a revolution of the beam source, else at the time itself. If no tree
 * that fits comes with the surfaces, one of default options is built, as the echo filter does.
 *
 * Output: the bounding volumes of the nodes at DisplayLevel, and of the leaves above it, as a
 * surface. Cell arrays, the same for all faces of a volume: `node_id`, `triangles` (below the node)
 * and `depth` (int); `visits` (vtkIdType; the active scalars), how many beams test the volume,
 * which are those whose cone meets the volume above it; `beams_met` (vtkIdType), of how many the
 * cone meets it.
 *
 * For trees of OBB or SPHERE these are the nodes that the echo filter's search for hits tests: with
 * one reflection, without integration of planes and small targets, of a beam with more than 32
 * rays, that meets at most 2,048 triangles and is so narrow that its rays go in packets (up to
 * about 0.05 rad), the sum of its visits of all levels, and for each packet of up to 64 rays eight
 * for every eight leaves that it met or part of them, is `nodes_visited` of its report. Trees of
 * AABB are searched folded, sixteen beams together and front to back: the counts then say where
 * beams lead, in scenes that hide much more than is looked at.
 *
 * MPI ranks work together as those of the echo filter do: each counts the beams that it has, the
 * counts are summed, and rank 0 has the volumes. A process alone asks for all beams and surfaces.
 *
 * Bad input gives the errors of the echo filter, and an empty output. No triangles: an empty
 * output; no beams: visits of 0. The counts are the same for any number of threads, ranks and order
 * of the beams.
 *
 * @sa vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter
 */
#ifndef vtkAvianLidarTreeVisits_h
#define vtkAvianLidarTreeVisits_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkAvianLidarRanks;
class vtkDataObject;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarTreeVisits : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarTreeVisits* New();
  vtkTypeMacro(vtkAvianLidarTreeVisits, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Level of the tree whose volumes are shown; the root is level 0. No beam is followed deeper. A
   * negative value shows nothing. Default: 8.
   */
  vtkSetMacro(DisplayLevel, int);
  vtkGetMacro(DisplayLevel, int);
  ///@}

  ///@{
  /**
   * Connect the surfaces (port 1).
   */
  void SetSurfacesConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  void SetSurfacesData(vtkDataObject* surfaces) { this->SetInputData(1, surfaces); }
  ///@}

  ///@{
  /**
   * Whether an execution that fails leaves its error as data and counts as done: a pipeline that
   * goes on, on empty outputs whose field data `error` hold the message. So it is in ParaView's
   * window, which never updates again what failed. Default: off, an error is a failure of the
   * pipeline, too.
   */
  vtkSetMacro(ErrorsAsData, bool);
  vtkGetMacro(ErrorsAsData, bool);
  vtkBooleanMacro(ErrorsAsData, bool);
  ///@}

protected:
  vtkAvianLidarTreeVisits();
  ~vtkAvianLidarTreeVisits() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int ModifyRequest(vtkInformation* request, int when) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  int DisplayLevel = 8;

  bool ErrorsAsData = false;

private:
  vtkAvianLidarTreeVisits(const vtkAvianLidarTreeVisits&) = delete;
  void operator=(const vtkAvianLidarTreeVisits&) = delete;

  // Passes of an execution, by all ranks together; false ends it.
  bool ReadBeams(const vtkAvianLidarRanks& ranks, vtkPolyData* input);
  bool ReadSurfaces(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  bool FindTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  bool Count(const vtkAvianLidarRanks& ranks);
  bool Show(const vtkAvianLidarRanks& ranks, vtkPolyData* output);

  struct vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
