// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCloudComparison
 * @brief Compares two point clouds by Hausdorff distance, root mean square error and density-aware
 * Chamfer distance, from each cloud to the other cloud.
 *
 * - Input port 0, the simulated cloud: any vtkPointSet.
 * - Input port 1, the reference: any vtkPointSet, in the coordinates of the simulated cloud.
 * - Output ports 0 and 1: shallow copies of the clouds with the point array `nearest_distance`, and
 *   all measures as field data.
 *
 * Hausdorff distance and root mean square error are Eq. 19 and 20 of "Research on Ground Object
 * Echo Simulation of Avian Lidar", Photonics 2024, 11(2), 153. Unlike in the paper, the sum of each
 * direction of Eq. 20 is divided by the number of points in this sum. The Chamfer distance follows
 * Wu et al., NeurIPS 2021, arXiv:2111.12702. Distances are Euclidean, in double precision. The
 * order of points does not matter. The search uses one thread and, for n points, about n log n
 * steps. A point that is equally far from all points of a cloud is compared with every point.
 * Formulas and limits: Documentation/guide/clouds.md.
 *
 * A bad ChamferAlpha gives an error. A cloud without points, or with coordinates that are not
 * finite or beyond 1e30 m, gives an error that names port and point. After an error or an abort,
 * outputs are empty and getters return NaN. If MPI ranks have pieces of the clouds, each rank
 * compares the points of its pieces with all points of the other cloud.
 *
 * @code
 * comparison->SetInputConnection(0, echoes->GetOutputPort());
 * comparison->SetInputConnection(1, reader->GetOutputPort());
 * comparison->Update();
 * double farthest = comparison->GetHausdorffDistance();
 * @endcode
 *
 * @sa vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarCloudComparison_h
#define vtkAvianLidarCloudComparison_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPassInputTypeAlgorithm.h"

class vtkFieldData;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarCloudComparison : public vtkPassInputTypeAlgorithm
{
public:
  static vtkAvianLidarCloudComparison* New();
  vtkTypeMacro(vtkAvianLidarCloudComparison, vtkPassInputTypeAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Hausdorff distance (paper, Eq. 19) of both directions together and of each direction, m. NaN
  /// before the first execution.
  vtkGetMacro(HausdorffDistance, double);
  vtkGetMacro(HausdorffSimulatedToReference, double);
  vtkGetMacro(HausdorffReferenceToSimulated, double);
  ///@}

  ///@{
  /// Root mean square distance (paper, Eq. 20) of each direction, m. NaN before the first
  /// execution.
  vtkGetMacro(RMSESimulatedToReference, double);
  vtkGetMacro(RMSEReferenceToSimulated, double);
  ///@}

  ///@{
  /// Density-aware Chamfer distance, 1, 0 (equal clouds) to 1: mean of both directions, and value
  /// of each direction. NaN before the first execution.
  vtkGetMacro(DensityAwareChamferDistance, double);
  vtkGetMacro(DensityAwareChamferSimulatedToReference, double);
  vtkGetMacro(DensityAwareChamferReferenceToSimulated, double);
  ///@}

  /// Alpha of the Chamfer distance, 1/m, 1e-6 to 1e6. Default 1 (assumed, for scans in metres).
  vtkAvianLidarPropertyMacro(ChamferAlpha, double, 1.0);

  /// Controller of the processes that may work together; null: this process works alone. Default:
  /// the global controller.
  vtkAvianLidarControllerMacro();

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarCloudComparison();
  ~vtkAvianLidarCloudComparison() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

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
};

#endif
