// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarCloudComparison
 * @brief How alike two point clouds are: Hausdorff distance, root mean square error and
 * density-aware Chamfer distance, both ways.
 *
 * - Input ports 0, the simulated cloud, and 1, the reference: any vtkPointSet, in the same
 *   coordinates.
 * - Output ports 0 and 1: shallow copies with the point array `nearest_distance`, and all measures
 *   as field data.
 *
 * Hausdorff distance and RMSE are Eq. 19 and 20 of "Research on Ground Object Echo Simulation of
 * Avian Lidar", Photonics 2024, 11(2), 153; here each direction of Eq. 20 is divided by its own
 * number of points. The Chamfer distance is that of Wu et al., NeurIPS 2021, arXiv:2111.12702.
 * Distances are Euclidean, in double precision; the order of points does not matter. It takes one
 * thread and n log n steps; points equally far from a whole cloud look at all of it. Formulas and
 * limits: Documentation/guide/clouds.md.
 *
 * A bad alpha is an error; so is a cloud without points or with coordinates that are not finite or
 * beyond 1e30 m, with port and point. Outputs are then empty and the getters NaN, as after an
 * abort. MPI ranks with a piece of each cloud measure their own points against the whole other
 * cloud.
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
  /** Hausdorff distance of the last execution (paper, Eq. 19) and its directions, m; NaN before. */
  vtkGetMacro(HausdorffDistance, double);
  vtkGetMacro(HausdorffSimulatedToReference, double);
  vtkGetMacro(HausdorffReferenceToSimulated, double);
  ///@}

  ///@{
  /** Root mean square distances of the last execution (paper, Eq. 20), m; NaN before. */
  vtkGetMacro(RMSESimulatedToReference, double);
  vtkGetMacro(RMSEReferenceToSimulated, double);
  ///@}

  ///@{
  /** Density-aware Chamfer distance, 0 (alike) to 1, the mean of its directions; NaN before. */
  vtkGetMacro(DensityAwareChamferDistance, double);
  vtkGetMacro(DensityAwareChamferSimulatedToReference, double);
  vtkGetMacro(DensityAwareChamferReferenceToSimulated, double);
  ///@}

  ///@{
  /** Alpha of the Chamfer distance, 1/m, 1e-6 to 1e6. Default 1 (assumed, for scans in metres). */
  vtkSetMacro(ChamferAlpha, double);
  vtkGetMacro(ChamferAlpha, double);
  ///@}

  ///@{
  /** Processes that may work together; null: this one alone. Default: the global controller. */
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
