// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarBeamView
 * @brief What one beam of a scan sees: its cone, the surfaces in it, and the share of each.
 *
 * Traces the beam BeamId again as vtkAvianLidarEchoFilter does, without noise, limits and second
 * reflections, and sums its samples by triangle. Inputs and properties are those of the echo
 * filter; noise, returns and constraints have no effect.
 *
 * - Output port 0, surfaces (vtkPolyData): the part of each triangle, or of two that form a
 *   quadrilateral, within the beam's outline and between its nearest and farthest range; others may
 *   hide some of it. Cell arrays: `solid_angle_share` (of a beam that is not round: share of the
 *   area of its plane), `energy_share`, `energy_received`, `distance_m`, `incidence_angle`,
 *   `object_id`, `material_id`.
 * - Output port 1, beam (vtkPolyData): its cone, to the farthest surface that it sees, or to
 *   `display_length` of the beams (1000 m without it) if it sees none.
 * - Output port 2, shares (vtkTable): a row for each pair of object and material, brightest first,
 *   with `object`, `material`, `nearest_m`, `farthest_m` and the arrays above. The last row, `no
 *   surface`, is the sky. Both shares sum to one; energy_share is 0 if nothing is received.
 *
 * Shares are exact but for rounding where few triangles enter the beam, and else sampled by about
 * 32 RaysPerBeam rays. A `beam_id` that does not exist is an error that names BeamId. No beams:
 * empty outputs.
 *
 * Example, with the inputs of an echo filter: `view->SetBeamId(123)`. Documentation:
 * reference/paraview.md.
 *
 * @sa vtkAvianLidarEchoFilter
 */
#ifndef vtkAvianLidarBeamView_h
#define vtkAvianLidarBeamView_h

#include "vtkAvianLidarEchoFilter.h"

class vtkTable;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarBeamView : public vtkAvianLidarEchoFilter
{
public:
  static vtkAvianLidarBeamView* New();
  vtkTypeMacro(vtkAvianLidarBeamView, vtkAvianLidarEchoFilter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The `beam_id` of the beam to look along, as echoes have it. Default 0. */
  vtkSetMacro(BeamId, vtkIdType);
  vtkGetMacro(BeamId, vtkIdType);
  ///@}

protected:
  vtkAvianLidarBeamView() = default;
  ~vtkAvianLidarBeamView() override = default;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  vtkIdType BeamId = 0;

private:
  vtkAvianLidarBeamView(const vtkAvianLidarBeamView&) = delete;
  void operator=(const vtkAvianLidarBeamView&) = delete;

  bool Look(const vtkAvianLidarRanks& ranks, vtkFieldData* beamFields, vtkPolyData* surfaces,
    vtkPolyData* cone, vtkTable* shares);
};

#endif
