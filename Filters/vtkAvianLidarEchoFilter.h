// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarEchoFilter
 * @brief Simulates the echoes that a lidar receives from surfaces, as points with energies.
 *
 * The filter implements "Research on Ground Object Echo Simulation of Avian Lidar", Photonics 2024,
 * 11(2), 153 (Algorithm 2, Eq. 1-18). Documentation/evidence/paper.md lists the differences from
 * the paper and the reasons.
 *
 * Passes: read beams and sensor; merge the surfaces; take the tree that came with the surfaces, or
 * build a tree; find what each beam sees; compute energies; sum energies in range units; form
 * returns. After a change of materials, air, limits, noise or return mode, the filter only computes
 * energies again and traces weak paths that an earlier execution left out. The result has the same
 * bits as the result of a new run. The filter uses OpenMP, but neither a VTK locator nor
 * vtkSMPTools.
 *
 * - Input port 0, beams: vtkPolyData, one point per beam at the sensor, with the point array
 *   `direction` and the field data of a vtkAvianLidarBeamSource.
 * - Input port 1, surfaces: vtkPolyData or a composite of vtkPolyData, preferably the output of a
 *   vtkAvianLidarCollisionTree. Media (vtkAvianLidarMedium) among the surfaces weaken light and
 *   send light back.
 * - Input port 2, movers (optional): vtkPolyData or a composite, with poses as field data, as from
 *   vtkAvianLidarTracks. Each beam meets movers at their places at the beam's `timestamp`.
 * - Output port 0, echoes: one vertex per return, with `energy`, `distance_m`, `object_id` and
 *   more.
 * - Output port 1, beam report: one vertex per beam, with `status`, `view`, `skipped` and the
 *   costs.
 * - Output port 2, mover report: one vertex per mover that is present, with `effective_area`,
 *   `detection_probability` and more; empty with ReportMovers off.
 * - Output port 3, waveforms: with RecordWaveforms on, one polyline per stretch of a beam, with a
 * point for each sample of the digitiser.
 *
 * Field data of all outputs: the field data of the beams; names and `geodetic_origin` of the
 * surfaces; every property of this filter in snake case with the value used, but for Visibility
 * (`attenuation_coefficient` gives the result), NumberOfThreads, MaximumCacheSize, ReportMovers,
 * Controller and ErrorsAsData; `avian_lidar_version`, `scene_checksum`, and bounds of everything
 * that the model left out.
 *
 * A bad input gives empty outputs and an error that names port and array. Without beams or surfaces
 * the echoes are empty. An aborted run leaves empty outputs and keeps no results.
 *
 * On one kind of CPU, the echoes have the same bits for any number of threads, any order and pieces
 * of the beams, any order and division of the surfaces, any tree, and any earlier runs. Costs
 * (`candidates`, `nodes_visited`, `rays_traced`) and `skipped` depend on order, pieces, tree and
 * earlier runs. MPI ranks that request their own pieces work together.
 *
 * @code
 * echoes->SetInputConnection(sensor->GetOutputPort());
 * echoes->SetSurfacesConnection(tree->GetOutputPort());
 * echoes->Update();
 * @endcode
 *
 * Documentation: method/echoes.md (method, inputs), reference/arrays.md, guide/accuracy.md
 * (bounds), guide/moving.md (movers, moving scenes), guide/parallel.md (ranks).
 *
 * @sa vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree, vtkAvianLidarMaterial,
 * vtkAvianLidarMedium
 */
#ifndef vtkAvianLidarEchoFilter_h
#define vtkAvianLidarEchoFilter_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarScanFilter.h"

#include <array>  // For the outputs
#include <memory> // For std::unique_ptr

class vtkFieldData;
class vtkPolyData;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarEchoFilter : public vtkAvianLidarScanFilter
{
public:
  static vtkAvianLidarEchoFilter* New();
  vtkTypeMacro(vtkAvianLidarEchoFilter, vtkAvianLidarScanFilter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum ReturnModeType
  {
    RETURN_MODE_ALL = 0,
    RETURN_MODE_STRONGEST = 1,
    RETURN_MODE_FIRST = 2,
    RETURN_MODE_LAST = 3,
    RETURN_MODE_RANGE_UNITS = 4
  };

  /// Whether to compute photon noise (Eq. 11) where the noise can change an echo. Default: on.
  vtkAvianLidarSwitchMacro(Noise, true);

  ///@{
  /// Returns that become points. RETURN_MODE_RANGE_UNITS makes a point of each range unit above the
  /// limit, as the paper does. Default: RETURN_MODE_ALL.
  vtkAvianLidarPropertyMacro(ReturnMode, int, RETURN_MODE_ALL);
  void SetReturnModeToAll() { this->SetReturnMode(RETURN_MODE_ALL); }
  void SetReturnModeToStrongest() { this->SetReturnMode(RETURN_MODE_STRONGEST); }
  void SetReturnModeToFirst() { this->SetReturnMode(RETURN_MODE_FIRST); }
  void SetReturnModeToLast() { this->SetReturnMode(RETURN_MODE_LAST); }
  void SetReturnModeToRangeUnits() { this->SetReturnMode(RETURN_MODE_RANGE_UNITS); }
  ///@}

  /// Whether to record the waveforms of beams: the light that the digitiser samples before the
  /// receiver decides. The samples have `sample_time`, `signal`, `background`, `sample`,
  /// `energy_received` and `threshold`; the stretches have `beam_id`, `timestamp` and `origin`. The
  /// echoes get `echo_width`, `echo_rise_time`, `echo_amplitude`, `echo_integral` and
  /// `echo_samples`. Default: off.
  vtkAvianLidarSwitchMacro(RecordWaveforms, false);

  /// Mean signal above which a stretch of a beam is recorded, as a share of the lower energy limit
  /// in a range unit (a pure number), 0 to 1e9. Stretches around echoes are always recorded. 0
  /// records whole beams. Default 0.1.
  vtkAvianLidarPropertyMacro(WaveformFloor, double, 0.1);

  /// Whether to report movers, which takes 1 ms of one core per mover and does not change echoes.
  /// Default: on.
  vtkAvianLidarSwitchMacro(ReportMovers, true);

  ///@{
  /// Input port 2, objects that move (optional).
  void SetMoversConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
  void SetMoversData(vtkDataObject* movers) { this->SetInputData(2, movers); }
  ///@}

  /// Number of beams, on all ranks, that movers may have touched in the last execution. Each of
  /// these beams was traced anew.
  double GetNumberOfTouchedBeams() const;

protected:
  vtkAvianLidarEchoFilter();
  ~vtkAvianLidarEchoFilter() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  // Reads all inputs. All ranks must call this function.
  void Prepare(const vtkAvianLidarRanks& ranks, vtkInformationVector** inputVector);
  void FillFields(vtkFieldData* beamFields, vtkFieldData* fields) const;

private:
  vtkAvianLidarEchoFilter(const vtkAvianLidarEchoFilter&) = delete;
  void operator=(const vtkAvianLidarEchoFilter&) = delete;

  void Trace(const std::array<vtkPolyData*, 4>& outputs);

  struct vtkMoved;
  std::unique_ptr<vtkMoved> Moved;
};

#endif
