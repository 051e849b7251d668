// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarBeamView
 * @brief Shows what one beam of a scan sees: its cone, the surfaces in the cone, and the share of
 * each surface.
 *
 * The filter traces the beam BeamId again as vtkAvianLidarEchoFilter does, but without noise,
 * limits and second reflections. The samples of the beam are summed by triangle. Inputs and
 * properties are the same as in the echo filter. The properties of noise, returns and constraints
 * have no effect.
 *
 * - Output port 0, surfaces (vtkPolyData): the part of each triangle, or of two triangles that form
 *   a quadrilateral, within the beam's outline and between the nearest and farthest range at which
 *   the beam sees a point of the triangles. Other surfaces may hide some of this part. Cell arrays:
 *   `solid_angle_share` (if the beam is not round: share of the area in the plane across its axis),
 *   `energy_share`, `energy_received`, `distance_m`, `incidence_angle`, `object_id`, `material_id`.
 * - Output port 1, beam (vtkPolyData): the cone, to the farthest surface that the beam sees. If the
 *   beam sees no surface, the cone has the length `display_length` of the beams (1000 m by
 *   default).
 * - Output port 2, shares (vtkTable): a row for each pair of object and material, brightest first,
 *   with `object`, `material`, `nearest_m`, `farthest_m` and the arrays of port 0 except
 *   `incidence_angle`. The last row, `no surface`, is the sky. The shares of a column sum to one.
 *   If no energy is received, `energy_share` is 0.
 *
 * If few triangles enter the beam, shares are exact up to rounding. Otherwise shares are estimated
 * from rays, whose number is about 32 times RaysPerBeam. An error is given if no beam has the id
 * BeamId. Without beams the outputs are empty.
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

  /// Value of `beam_id` of the beam to view, at least 0. Default 0.
  vtkAvianLidarPropertyMacro(BeamId, vtkIdType, 0);

protected:
  vtkAvianLidarBeamView() { this->SetNumberOfOutputPorts(3); }
  ~vtkAvianLidarBeamView() override = default;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarBeamView(const vtkAvianLidarBeamView&) = delete;
  void operator=(const vtkAvianLidarBeamView&) = delete;

  void Look(const vtkAvianLidarRanks& ranks, vtkFieldData* beamFields, vtkPolyData* surfaces,
    vtkPolyData* cone, vtkTable* shares);
};

#endif
