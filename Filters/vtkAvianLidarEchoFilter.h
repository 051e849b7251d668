// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarEchoFilter
 * @brief Simulates the echoes that a lidar receives from surfaces: beams and surfaces in, points
 * with energies out.
 *
 * Implements the method of "Research on Ground Object Echo Simulation of Avian Lidar", Photonics
 * 2024, 11(2), 153 (Algorithm 2, Eq. 1-18): N rays in each narrow beam, one descent of the
 * collision tree for the whole beam, a beam constraint and a light-energy constraint on secondary
 * reflections, reflectance, attenuation, receiver noise and dynamic range. Where the paper is open
 * or misprinted, Documentation/ says how it is read.
 *
 * Passes: read the beams and the sensor, merge the surfaces, take the tree that came with them or
 * build one, find the hits of all rays, light them, sum energies in range units, form returns. Hits
 * are kept: changing coefficients of materials, attenuation, limits, noise, return mode, energy of
 * the pulse or reflectance model traces nothing that is already known, and the result is that of a
 * fresh run, bit for bit. With BEAM_SAMPLES_CELLS another pulse width, sampling interval or range
 * gate, and other object ids, trace again. It uses no VTK locator, and OpenMP instead of
 * vtkSMPTools.
 *
 * Input port 0, beams: vtkPolyData, one point per beam at the sensor.
 * Point array `direction` (3 components, any numeric type; normalised here; zero or not finite is
 * an error). Optional point arrays `beam_id` (unique, >= 0; default: the point's number),
 * `laser_id` (whole numbers of 32 bits), `azimuth`, `vertical_angle`, `timestamp` (finite), and
 * `reported_direction` (as `direction`): where the sensor believes that the beam points. Field
 * data, one number each, all needed:
 * `half_beamwidth` rad, `beam_profile`, `pulse_energy` J, `pulse_width` s, `frequency` Hz,
 * `sampling_interval` s, `range_gate` m, `noise_photon_rate` Hz, `lower_energy_limit` J,
 * `upper_energy_limit` J, `receiver_aperture` m2. Optional: `display_length` m, the
 * other numbers of a vtkAvianLidarBeamSource (of beams that are not round `orientation`, too, which
 * turns them), and `revolution`, a whole number of 32 bits, 0 if it is missing: noise of each
 * revolution is its own.
 *
 * Input port 1, surfaces: vtkPolyData or a composite of it, as for vtkAvianLidarCollisionTree; best
 * its output. Whatever the piece of the beams, a process alone asks for all surfaces, as anything
 * may hide anything. A scene that moves is asked for its state at the start of the revolution that
 * the time asked for falls into, and stands still meanwhile; beams that do not come from a
 * vtkAvianLidarBeamSource (through whatever filters) have no revolutions: then for the time itself.
 * The steps to play are those of the beams, or of the surfaces if the beams have none.
 *
 * Input port 2, movers (optional): vtkPolyData or a composite of it, such as the output of
 * vtkAvianLidarTracks. Each vtkPolyData is an object in a frame of its own, with materials as
 * surfaces have them. Each beam meets it where it is at the beam's own `timestamp`. Field data:
 * `pose_time` (n, s, rising, on the clock of the beams), `pose_position` (n x 3, m, where the
 * frame's origin is), `pose_orientation` (n x 4, unit quaternion w, x, y, z from its frame to the
 * scene's; not turned if it is missing). Between poses positions are linear and orientations slerp;
 * before the first and after the last pose the object is absent. One position without `pose_time`
 * holds always. Parts that flap: cell array `part` (0 rigid, p the row p - 1 of what follows) and
 * `flap_hinge` (k x 3, m), `flap_axis` (k x 3, unit), `flap_amplitude` (k, rad), `flap_frequency`
 * (k, Hz), `flap_phase` (k, turns): the part turns about its hinge by amplitude sin(2 pi (frequency
 * t + phase)). Static hits are kept; beams that movers may touch, with what stands in their cones,
 * are traced anew in each execution. Object ids follow those of the surfaces if any is taken.
 * A mover at rest gives the echoes of the same surfaces, bit for bit.
 *
 * MPI ranks (pvserver, pvbatch) work together when the controller has several processes and
 * each asks for its own piece of as many: then each traces the beams that it has, and surfaces
 * reach all ranks once, whoever read them, with one tree; a scene that has not changed is not sent
 * again (Documentation/parallel.md). An error on one rank is one on all. Any other piece request is
 * a process' own: no communication.
 *
 * Output port 0, echoes: one vertex per return at origin + direction * range (with
 * `reported_direction`, if the beams have it, as points of port 1, too). Point arrays (double
 * unless said): `energy` J (Eq. 12) and `energy_received` J (Eq. 10), both of the strongest range
 * unit of the return; `return_energy` J (sum over the return); `energy_std_error` J (of
 * `energy_received`, of the sampling alone: +-1.96 of it hold the truth in 90 % of echoes and more
 * from N = 8 rays, in 93 % from 16; NaN below 8; of a beam that is integrated over polygons, a
 * bound of the error instead, see BeamSamples); `intensity` (0 to 255, linear in the dynamic
 * range); `distance_m`; `beam_id` (vtkIdType), `laser_id` (int), `azimuth` 0.01 deg,
 * `vertical_angle` deg, `timestamp` us; `return_number`, `number_of_returns` (int); `object_id`,
 * `material_id` (int, of the largest share of the energy; -1 for a false alarm; -2 and -1 for what
 * the air returns), `label_share` (that share), `incidence_angle` deg (energy-weighted, at the last
 * surface; NaN for a false alarm), `secondary_share` (of the energy, over two reflections: above
 * 0.5 a ghost); with a photon receiver `photoelectrons` and `signal_to_noise`, of the same range
 * unit as `energy_received`; with its sunlight `seen_radiance` W/(m2 sr nm), the daylight that the
 * beam looks at, which the noise of the others follows; where ranges have noise,
 * `distance_std_error` m, its standard deviation (of the receiver alone, not of the sampling).
 *
 * Output port 1, beam report: one vertex per beam at its strongest return (else at
 * `display_length`, 1000 m without it). Point arrays `beam_id`, `laser_id`, `azimuth` 0.01 deg,
 * `vertical_angle` deg (so that vtkAvianLidarRangeImage makes a map of it); `status` (0 echo, 1 no
 * surface, 2 below the lower limit, 3 saturated, 4 direct echoes, all of them from outside the
 * gate), `view`, how its direct echo was found (1 no triangle enters the beam, 2 integrated over
 * the visible polygons, 3 cells, 4 rays, 5 cells of a beam that more than 2,000 triangles enter),
 * `candidates` (triangles that were looked at for its rays, once for each packet of up to 64
 * of them), `nodes_visited`, `rays_traced`; `skipped`, what the model did without, a sum of 1
 * (paths over two reflections, some or all), 2 (everything: all its energy together would not be
 * perceived), 4 (noise), 8 (with 2: all it meets lies beyond `perceivable_range`), 16 (some direct
 * echoes); `skipped_bound` J, the most by which any of its range units so differs from the full
 * model; with 2 below the lower energy limit, so that no echo is lost.
 *
 * Output port 2, mover report: one vertex for each mover that is present, where its frame's origin
 * is when the beam is fired that receives most of it (of the beams that may touch it; else in the
 * middle of the scan), in the order of object ids. Point arrays: `object_id` (of its first cell),
 * `beam_id` of that beam (-1: none) and its `timestamp` us, `distance_m`, `azimuth` 0.01 deg,
 * `vertical_angle` deg of the origin; `effective_area` m2 (silhouette weighted by the cosine of
 * incidence, mutual shadow included, of the whole object even where something hides it; of more
 * than 1000 triangles, or of pieces where they cross, by rays with a standard error of 0.15 %,
 * which from nearer than ten times its size are lower than what is exact of fewer (4 % at twice its
 * size); NaN if it surrounds the sensor); `number_of_beams` whose cones hold its origin;
 * `first_timestamp` us and `first_position` m when the first beam is fired that holds its origin or
 * receives something of it, `last_timestamp` and `last_position` likewise (a whole revolution apart
 * where it crosses from the last column to the first; else those of the vertex, if there is none);
 * `energy_received` J, and `photoelectrons` of a photon receiver (without noise, in the strongest
 * range unit of that beam; 0 where it is hidden; as exact as the beam is, see BeamSamples);
 * `detection_probability` (that some beam perceives a range unit for its light alone;
 * noise of range units independent); `number_of_echoes` whose `object_id` it is. Of the beams of
 * this piece. Empty with ReportMovers off, but for field data.
 *
 * Units are attached to the arrays (vtkDataArray::UNITS_LABEL): "1" for pure numbers, that is
 * ratios, counts such as `return_number` and `rays_traced`, choices and switches; none for
 * identifiers (`beam_id`, `laser_id`, `object_id`, `material_id`, `status`, `seed`, `revolution`,
 * checksums).
 *
 * Field data of all: the sensor; every property of this filter in snake case as it was used (if a
 * `preset` overrode it, with the preset's value), but for Visibility, of which
 * `attenuation_coefficient` tells what the air was, and NumberOfThreads, MaximumCacheSize,
 * ReportMovers, Controller and ErrorsAsData, which change no echo; `avian_lidar_version`,
 * `scene_checksum` (geometry and materials), `noise_modelled` (0 if noise of energies was skipped)
 * with `noise_bound` J (no range unit receives more than this from skipped noise),
 * `light_energy_constraint_bound` J (no range unit loses more), `secondary_reflections_modelled` (0
 * if not asked for, or if none can matter), `further_reflections_bound` J (what paths over more
 * than NumberOfReflections return of a beam at most), `perceivable_range` m (from there on a
 * surface that fills the beam and returns as much as any of the scene is not perceived; may be
 * infinite), `skipped_energy_bound` J (no range unit of a beam with an echo differs more from the
 * full model), `missed_detail_energy` J (an object that returns more is missed by all rays of a
 * beam with a probability below 5 %; with BEAM_SAMPLES_CELLS of objects without an `object_id` of
 * their own), the same in words
 * (`note_noise`, `note_two_reflections`, `note_further_reflections`, `note_faint_paths`,
 * `note_small_objects`, `note_detail_between_rays`, `note_planes`, `note_perceivable_range`, and
 * all together `note_all_left_out`), and of the surfaces `object_names`, `object_classes` (if they
 * have some), `material_names`, `geodetic_origin`.
 *
 * Bad input (an array or a field of another kind or shape than above) gives an error that names
 * port and array, and empty outputs. Beams without surfaces or
 * no beams at all: empty echoes, no error. An aborted run leaves empty outputs and no cache.
 *
 * Deterministic: a function of all inputs, `revolution` among them, and the properties; the same
 * bits for any number of threads, order and pieces of the beams, tree, and state of the cache, on
 * one kind of CPU. `candidates`, `nodes_visited` and `rays_traced` are costs: the same for any
 * number of threads, but not for another order, piece, tree or state of the cache. Nor are
 * `skipped` and `skipped_bound`: what is known from before need not be bounded.
 *
 * Surfaces may hold media (vtkAvianLidarMedium): they are no surfaces, but weaken light, and send
 * it back; field data `media` then say which.
 *
 * @sa vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree, vtkAvianLidarMaterial,
 * vtkAvianLidarMedium, vtkAvianLidarHSBColorMap
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

  ///@{
  /**
   * Photon noise of the receiver (Eq. 11). Skipped, with the bound in field data, where it cannot
   * matter. Default: on.
   */
  vtkSetMacro(Noise, bool);
  vtkGetMacro(Noise, bool);
  vtkBooleanMacro(Noise, bool);
  ///@}

  ///@{
  /**
   * Which returns of a beam become points. A return is a maximal run of consecutive perceived range
   * units. RETURN_MODE_RANGE_UNITS is the paper's literal one point per perceived range unit.
   * Default: RETURN_MODE_ALL.
   */
  vtkSetMacro(ReturnMode, int);
  vtkGetMacro(ReturnMode, int);
  void SetReturnModeToAll() { this->SetReturnMode(RETURN_MODE_ALL); }
  void SetReturnModeToStrongest() { this->SetReturnMode(RETURN_MODE_STRONGEST); }
  void SetReturnModeToFirst() { this->SetReturnMode(RETURN_MODE_FIRST); }
  void SetReturnModeToLast() { this->SetReturnMode(RETURN_MODE_LAST); }
  void SetReturnModeToRangeUnits() { this->SetReturnMode(RETURN_MODE_RANGE_UNITS); }
  ///@}

  ///@{
  /**
   * Make the mover report, output port 2. Its effective areas take about a millisecond of one core
   * for each mover: turn it off where nobody reads it. Echoes do not depend on it; of the beam
   * report `skipped` and `skipped_bound` may, which are costs. Default: on.
   */
  vtkSetMacro(ReportMovers, bool);
  vtkGetMacro(ReportMovers, bool);
  vtkBooleanMacro(ReportMovers, bool);
  ///@}

  ///@{
  /**
   * Input port 2, objects that move (optional).
   */
  void SetMoversConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
  void SetMoversData(vtkDataObject* movers) { this->SetInputData(2, movers); }
  ///@}

  /**
   * Beams that movers may have touched in the last execution, of all ranks together. Each of them
   * was traced anew.
   */
  double GetNumberOfTouchedBeams() const;

protected:
  vtkAvianLidarEchoFilter();
  ~vtkAvianLidarEchoFilter() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  // A pass of an execution, as those of the superclass, and the field data of its outputs.
  bool PrepareMovers(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  void FillFields(vtkFieldData* beamFields, vtkFieldData* fields) const;

  bool Noise = true;
  int ReturnMode = RETURN_MODE_ALL;
  bool ReportMovers = true;

private:
  vtkAvianLidarEchoFilter(const vtkAvianLidarEchoFilter&) = delete;
  void operator=(const vtkAvianLidarEchoFilter&) = delete;

  bool Scan(const vtkAvianLidarRanks& ranks, vtkFieldData* beamFields,
    const std::array<vtkPolyData*, 3>& outputs);

  void Trace(const std::array<vtkPolyData*, 3>& outputs);

  struct vtkMoved;
  std::unique_ptr<vtkMoved> Moved;
};

#endif
