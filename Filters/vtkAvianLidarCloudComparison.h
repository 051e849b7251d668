// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCloudComparison
 * @brief How alike two point clouds are: Hausdorff distance and root mean square error, both ways.
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
 * corrected is the one from reference to simulated.
 *
 * The numbers are there as getters and as field data of both outputs (double, m):
 * `hausdorff_distance`, `hausdorff_simulated_to_reference`, `hausdorff_reference_to_simulated`,
 * `rmse_simulated_to_reference`, `rmse_reference_to_simulated`.
 *
 * Distances are Euclidean, in double precision (a relative error of a few 1e-16, and the rounding
 * of the coordinates). One thread; the same bits always. Outliers,
 * clusters and points in one place cost no more than others: n log n steps. Points that are nearly
 * equally far from a whole cloud, as the centre of a sphere is, look at all of it.
 *
 * **Pieces.** MPI ranks that execute together have one piece of each cloud each: every rank
 * measures its own points against the other cloud of all ranks, and passes on its own points alone.
 * The distances are those of one process, the two RMSE to the rounding of their sums; the numbers
 * are on all ranks. Otherwise both clouds are asked for as a whole, and of several pieces the first
 * has all points, the others have field data alone.
 *
 * **Bad input**: a cloud without points (the distance to nothing is not defined) or with
 * coordinates that are not finite or beyond 1e30 m is an error that names port and point; both
 * outputs are empty and the getters give NaN. After an abort, too.
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
};

#endif
