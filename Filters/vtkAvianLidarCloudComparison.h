// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCloudComparison
 * @brief How alike two point clouds are: Hausdorff distance, root mean square error and
 * density-aware Chamfer distance, both ways.
 *
 * **Input port 0**: the simulated cloud, **input port 1**: the reference (the actual scan); any
 * vtkPointSet, in the same coordinates. **Output ports 0 and 1**: shallow copies of the two with
 * the point array `nearest_distance` (double, m), the distance d to the nearest point of the other
 * cloud. With S and R the clouds of n_S and n_R points:
 *
 * - Hausdorff distance (paper, Eq. 19: "Research on Ground Object Echo Simulation of Avian Lidar",
 * Photonics 2024, 11(2), 153): the larger one of the largest d of S and the largest d of R;
 * - RMSE (paper, Eq. 20): sqrt(sum of d^2 over the points of one cloud / its number of points). The
 * paper sums over the actual cloud but divides by the number of simulated points; here each
 * direction is divided by the number of points that it sums over, and both are given. Eq. 20 so
 * corrected is the one from reference to simulated;
 * - density-aware Chamfer distance (DCD; Wu et al., "Density-aware Chamfer Distance as a
 * Comprehensive Metric for Point Cloud Completion", NeurIPS 2021, arXiv:2111.12702; the equation
 * second-hand): the mean of the two directions, of which the one from S to R is the mean over S of
 * 1 - exp(-alpha d) / n. There n is the number of points of S that have the same nearest place of
 * R. All are within [0, 1]; 0 says that each point of either cloud has a point of the other in its
 * place, and for itself. A direction is at least 1 - (number of places in the cloud that it leads
 * to) / (number of points that it starts from), so a cloud with several points in a place is not 0
 * from itself. The authors' program differs: it has squares of distances, and a factor for
 * different numbers of points.
 *
 * Points in the same place are one place. Of equally near places the one with the least x, then y,
 * then z is the nearest, so the order of points does not matter.
 *
 * The numbers are there as getters and as field data of both outputs: `hausdorff_distance`,
 * `hausdorff_simulated_to_reference`, `hausdorff_reference_to_simulated`,
 * `rmse_simulated_to_reference`, `rmse_reference_to_simulated` (double, m),
 * `density_aware_chamfer_distance`, `density_aware_chamfer_simulated_to_reference`,
 * `density_aware_chamfer_reference_to_simulated` (double, 1).
 *
 * Distances are Euclidean, in double precision (a relative error of a few 1e-16, and the rounding
 * of the coordinates). One thread; the same bits always. Outliers,
 * clusters and points in one place cost no more than others: n log n steps. Points that are nearly
 * equally far from a whole cloud, as the centre of a sphere is, look at all of it.
 *
 * **Pieces.** MPI ranks that execute together have one piece of each cloud each: every rank
 * measures its own points against the other cloud of all ranks, and passes on its own points alone.
 * The distances are those of one process, RMSE and DCD to the rounding of their sums; the numbers
 * are on all ranks. Otherwise both clouds are asked for as a whole, and of several pieces the first
 * has all points, the others have field data alone.
 *
 * **Bad input**: an alpha out of its range or other than on other ranks is an error; a cloud
 * without points (the distance to nothing is not defined) or with coordinates that are not finite
 * or beyond 1e30 m is an error that names port and point; both outputs are empty and the getters
 * give NaN. After an abort, too.
 *
 * @sa vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarCloudComparison_h
#define vtkAvianLidarCloudComparison_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPassInputTypeAlgorithm.h"

class vtkFieldData;
class vtkMultiProcessController;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarCloudComparison : public vtkPassInputTypeAlgorithm
{
public:
  static vtkAvianLidarCloudComparison* New();
  vtkTypeMacro(vtkAvianLidarCloudComparison, vtkPassInputTypeAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Result of the last execution in metres: the Hausdorff distance (paper, Eq. 19), and the largest
   * nearest-neighbour distance of the simulated points to the reference and the other way round.
   * NaN before the first.
   */
  vtkGetMacro(HausdorffDistance, double);
  vtkGetMacro(HausdorffSimulatedToReference, double);
  vtkGetMacro(HausdorffReferenceToSimulated, double);
  ///@}

  ///@{
  /**
   * Result of the last execution in metres: root mean square of the nearest-neighbour distances of
   * the simulated points to the reference, and the other way round (paper, Eq. 20, see the class).
   * NaN before the first.
   */
  vtkGetMacro(RMSESimulatedToReference, double);
  vtkGetMacro(RMSEReferenceToSimulated, double);
  ///@}

  ///@{
  /**
   * Result of the last execution, a pure number within [0, 1], 0 for the most alike: the
   * density-aware Chamfer distance (see the class), and its two directions, of which it is the
   * mean. NaN before the first.
   */
  vtkGetMacro(DensityAwareChamferDistance, double);
  vtkGetMacro(DensityAwareChamferSimulatedToReference, double);
  vtkGetMacro(DensityAwareChamferReferenceToSimulated, double);
  ///@}

  ///@{
  /**
   * Alpha of the density-aware Chamfer distance, per metre, 1e-6 to 1e6: at a distance of 1 / alpha
   * a nearest point counts for 1 / e of one in the same place. Default 1 (assumed, for scans in
   * metres: clouds of the paper are scaled to a size of about 1, second-hand, with another alpha).
   */
  vtkSetMacro(ChamferAlpha, double);
  vtkGetMacro(ChamferAlpha, double);
  ///@}

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
  vtkAvianLidarCloudComparison();
  ~vtkAvianLidarCloudComparison() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int ModifyRequest(vtkInformation* request, int when) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  vtkMultiProcessController* Controller = nullptr;

private:
  vtkAvianLidarCloudComparison(const vtkAvianLidarCloudComparison&) = delete;
  void operator=(const vtkAvianLidarCloudComparison&) = delete;

  void ForgetResult();
  void AddResult(vtkFieldData* fields) const;

  double HausdorffDistance;
  double HausdorffSimulatedToReference;
  double HausdorffReferenceToSimulated;
  double RMSESimulatedToReference;
  double RMSEReferenceToSimulated;
  double DensityAwareChamferDistance;
  double DensityAwareChamferSimulatedToReference;
  double DensityAwareChamferReferenceToSimulated;
  double ChamferAlpha;
};

#endif
