// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarBeamView
 * @brief What one beam of a scan sees: its cone, the surfaces in it, and the share of each.
 *
 * Traces the beam BeamId again, as the echo filter does it, but without noise, limits and paths
 * over two reflections, and sums its samples by triangle. Inputs are those of
 * vtkAvianLidarEchoFilter (beams, surfaces, movers); so are the properties, of which those of
 * noise, returns and constraints do nothing here.
 *
 * **Output port 0**, surfaces (vtkPolyData): of each triangle that the beam sees (or quadrilateral
 * of two triangles with consecutive numbers), the part within the beam's outline and between its
 * nearest and farthest range, which others may hide in part, in scene coordinates. Cell data:
 * `solid_angle_share` (of the beam's solid angle; of a beam that is not round, of the area of its
 * plane), `energy_share` (of all energy that the beam receives), `energy_received` (J, direct, from
 * all ranges), `distance_m` and `incidence_angle` (deg; means over the light that arrives),
 * `object_id`, `material_id`.
 *
 * **Output port 1**, beam (vtkPolyData): its cone from the lidar to the farthest surface that it
 * sees, or `display_length` of the beams (1000 m without it) where it sees none.
 *
 * **Output port 2**, shares (vtkTable): a row for each pair of `object_id` and `material_id`, those
 * that return most first: `object`, `material` (names, if they have some), the ids, the shares and
 * the energy as above, `distance_m`, `nearest_m` and `farthest_m`. The last row, `no surface`, with
 * the ids -1, is the sky. Both shares sum to one over the rows; energy_share is 0 if nothing is
 * received.
 *
 * Field data of all: those of the echo filter, and `beam_id`.
 *
 * Shares are exact, but for rounding, where few triangles enter the beam; else sampled, with some
 * 32 times RaysPerBeam rays (BeamSamples). The sum of the shares and of the sky is one whatever the
 * error. Deterministic, as the echo filter is.
 *
 * A beam that is not there is an error that names BeamId. No beams: empty outputs.
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
  /**
   * The `beam_id` of the beam to look along, as echoes have it. Default 0.
   */
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
