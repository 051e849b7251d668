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
 * are kept: changing coefficients of materials, attenuation, limits, noise, return mode, pulse or
 * reflectance model traces nothing that is already known (but beams that then need another number
 * of rays: RefineNearLimit, TargetRelativeError), and the result is that of a fresh run, bit for
 * bit. It uses no VTK locator and no vtkSMPTools (OpenMP inside).
 *
 * Input port 0, beams: vtkPolyData, one point per beam at the sensor.
 * Point array `direction` (3 components, any numeric type; normalised here; zero or not finite is
 * an error). Optional point arrays `beam_id` (unique, >= 0; default: the point's number),
 * `laser_id` (whole numbers of 32 bits), `azimuth`, `vertical_angle`, `timestamp` (finite), and
 * `reported_direction` (as `direction`): where the sensor believes that the beam points. Field
 * data, one number each, all needed:
 * `half_beamwidth` rad, `beam_profile`, `pulse_energy` J, `pulse_width` s, `frequency` Hz,
 * `sampling_interval` s, `range_gate` m, `noise_photon_rate` Hz, `lower_energy_limit` J,
 * `upper_energy_limit` J, `receiver_aperture` m2. Optional: `display_length` m, and
 * `revolution`, a whole number of 32 bits, 0 if it is missing: noise of each revolution is its own.
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
 * from N = 8 rays, in 93 % from 16; NaN below 8; where PlaneIntegration integrated the beam, a
 * bound of the error instead); `intensity` (0 to 255, linear in the dynamic range);
 * `distance_m`; `beam_id` (vtkIdType), `laser_id` (int), `azimuth` 0.01 deg,
 * `vertical_angle` deg, `timestamp` us; `return_number`, `number_of_returns` (int); `object_id`,
 * `material_id` (int, of the largest share of the energy; -1 for a false alarm), `label_share`
 * (that share), `incidence_angle` deg (energy-weighted, at the last surface; NaN for a false
 * alarm), `secondary_share` (of the energy, over two reflections: above 0.5 a ghost).
 *
 * Output port 1, beam report: one vertex per beam at its strongest return (else at
 * `display_length`, 1000 m without it). Point arrays `beam_id`, `laser_id`, `azimuth` 0.01 deg,
 * `vertical_angle` deg (so that vtkAvianLidarRangeImage makes a map of it); `status` (0 echo, 1 no
 * surface, 2 below the lower limit, 3 saturated, 4 direct echoes, all of them from outside the
 * gate), `candidates` (triangles that were looked at for its rays, once for each packet of up to 64
 * of them), `nodes_visited`, `rays_traced`; `skipped`, what the model did without, a sum of 1
 * (paths over two reflections, some or all), 2 (everything: all its energy together would not be
 * perceived), 4 (noise), 8 (with 2: all it meets lies beyond `perceivable_range`), 16 (some direct
 * echoes); `skipped_bound` J, the most by which any of its range units so differs from the full
 * model; with 2 below the lower energy limit, so that no echo is lost; `small_targets_left_out`,
 * how many small objects had no rays of their own because 16 larger ones had (see SmallTargets).
 *
 * Output port 2, mover report: one vertex for each mover that is present, where its frame's origin
 * is when the beam is fired that receives most of it (of the beams that may touch it; else in the
 * middle of the scan), in the order of object ids. Point arrays: `object_id` (of its first cell),
 * `beam_id` of that beam (-1: none) and its `timestamp` us, `distance_m`, `azimuth` 0.01 deg,
 * `vertical_angle` deg of the origin; `effective_area` m2 (silhouette weighted by the cosine of
 * incidence, mutual shadow included, of the whole object even where something hides it; NaN if it
 * surrounds the sensor); `number_of_beams` whose cones hold its origin; `energy_received` J, and
 * `photoelectrons` of a photon receiver (without noise, in the strongest range unit of that beam; 0
 * where it is hidden); `detection_probability` (that some beam perceives a range unit for its light
 * alone; noise of range units independent); `number_of_echoes` whose `object_id` it is. Of the
 * beams of this piece.
 *
 * Units are attached to the arrays (vtkDataArray::UNITS_LABEL): "1" for pure numbers, that is
 * ratios, counts such as `return_number` and `rays_traced`, choices and switches; none for
 * identifiers (`beam_id`, `laser_id`, `object_id`, `material_id`, `status`, `seed`, `revolution`,
 * checksums).
 *
 * Field data of all: the sensor, every property of this filter in snake case as it was used (if a
 * `preset` overrode it, with the preset's value), `seed`,
 * `avian_lidar_version`, `scene_checksum` (geometry and materials), `noise_modelled` (0 if noise
 * was skipped) with `noise_bound` J (no range unit receives more than this from skipped noise),
 * `light_energy_constraint_bound` J (no range unit loses more), `secondary_reflections_modelled` (0
 * if not asked for, or if none can matter), `perceivable_range` m (from there on a surface that
 * fills the beam and returns as much as any of the scene is not perceived; may be infinite),
 * `skipped_energy_bound` J (no range unit of a beam with an echo differs more from the full model),
 * `missed_detail_energy` J (an object that returns more is missed by all rays of a beam with a
 * probability below 5 %, unless it has rays of its own), `crowded_beams` (how many beams left
 * out small targets, of all ranks that execute together), the same in words (`note_noise`,
 * `note_two_reflections`, `note_faint_paths`, `note_small_objects`, `note_detail_between_rays`,
 * `note_planes`, `note_perceivable_range`, and all together `note_all_left_out`), and of the
 * surfaces `object_names`, `object_classes` (if they have some), `material_names`,
 * `geodetic_origin`.
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
 * @sa vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree, vtkAvianLidarMaterial,
 * vtkAvianLidarHSBColorMap
 */
#ifndef vtkAvianLidarEchoFilter_h
#define vtkAvianLidarEchoFilter_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <array>  // For the outputs
#include <memory> // For std::unique_ptr
#include <string> // For what is wrong with settings

class vtkAvianLidarRanks;
class vtkDataObject;
class vtkFieldData;
class vtkMultiProcessController;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarEchoFilter : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarEchoFilter* New();
  vtkTypeMacro(vtkAvianLidarEchoFilter, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum SamplingType
  {
    SAMPLING_MONTE_CARLO = 0,
    SAMPLING_STRATIFIED = 1
  };

  enum ReflectanceModelType
  {
    REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG = 0,
    REFLECTANCE_MODEL_PHONG = 1,
    REFLECTANCE_MODEL_MICROFACET = 2
  };

  enum ReturnModeType
  {
    RETURN_MODE_ALL = 0,
    RETURN_MODE_STRONGEST = 1,
    RETURN_MODE_FIRST = 2,
    RETURN_MODE_LAST = 3,
    RETURN_MODE_RANGE_UNITS = 4
  };

  enum BatchCollisionDetectionType
  {
    BATCH_COLLISION_DETECTION_RAYS = 0,
    BATCH_COLLISION_DETECTION_GROUPS = 1,
    BATCH_COLLISION_DETECTION_BEAMS = 2
  };

  enum PrecisionType
  {
    PRECISION_SINGLE = 0,
    PRECISION_DOUBLE = 1
  };

  enum PresetType
  {
    PRESET_CUSTOM = 0,
    PRESET_DRAFT = 1,
    PRESET_STANDARD = 2,
    PRESET_REFERENCE = 3
  };

  ///@{
  /**
   * Fidelity by name: PRESET_CUSTOM (the properties as they are), PRESET_DRAFT (a fast look),
   * PRESET_STANDARD (what most want), PRESET_REFERENCE (converged). All but PRESET_CUSTOM override
   * RaysPerBeam, Sampling, TargetRelativeError, NumberOfReflections, NumberOfConnections
   * and RefineNearLimit (off) at execution; they write no property, and field data hold what was
   * used. All three are SAMPLING_STRATIFIED:
   *
   * - PRESET_DRAFT: 100 rays, no target error, 2 reflections, 0 connections
   * - PRESET_STANDARD: target error 0.02 of 400 rays (8 to 6400), 2 reflections, 2 connections
   * - PRESET_REFERENCE: 10000 rays, no target error, 2 reflections, 8 connections
   *
   * Rms relative error of energy_received over echoes of at least twice the lower limit (a missed
   * one counts as 1), and time of one core, at the airport with 16 and 32 channels and in the
   * corridor (Documentation/results/accuracy.md):
   *
   * - PRESET_DRAFT: 1.2 %, 0.12 s; 1.3 %, 0.38 s; 0.22 %, 0.018 s
   * - PRESET_STANDARD: 0.39 %, 0.18 s; 0.4 %, 0.56 s; 0.036 %, 0.026 s
   * - PRESET_REFERENCE: 0.058 %, 2.7 s; 0.093 %, 7.1 s; 0.014 %, 0.41 s
   *
   * Of the echoes of nine scenes PRESET_DRAFT invents or misses up to 16 %, PRESET_STANDARD up to
   * 2 %.
   *
   * Default: PRESET_CUSTOM.
   */
  vtkSetMacro(Preset, int);
  vtkGetMacro(Preset, int);
  void SetPresetToCustom() { this->SetPreset(PRESET_CUSTOM); }
  void SetPresetToDraft() { this->SetPreset(PRESET_DRAFT); }
  void SetPresetToStandard() { this->SetPreset(PRESET_STANDARD); }
  void SetPresetToReference() { this->SetPreset(PRESET_REFERENCE); }
  ///@}

  ///@{
  /**
   * N, rays per beam (Eq. 1-3), each of energy Qs/N. 1 to 1000000. Default: 100.
   */
  vtkSetMacro(RaysPerBeam, int);
  vtkGetMacro(RaysPerBeam, int);
  ///@}

  ///@{
  /**
   * How rays are drawn: SAMPLING_MONTE_CARLO (independent, the paper) or SAMPLING_STRATIFIED (two
   * independent rays in each of N/2 compact cells of equal solid angle; at an edge the error of six
   * times as many random rays). Default: SAMPLING_STRATIFIED.
   */
  vtkSetMacro(Sampling, int);
  vtkGetMacro(Sampling, int);
  void SetSamplingToMonteCarlo() { this->SetSampling(SAMPLING_MONTE_CARLO); }
  void SetSamplingToStratified() { this->SetSampling(SAMPLING_STRATIFIED); }
  ///@}

  ///@{
  /**
   * Relative standard error wanted of the energy_received of every echo, 0 (off) to less than 1;
   * of echoes below twice the lower energy limit, that share of twice the limit. If set, a pilot of
   * 32 rays fixes how many rays the beam gets, between 8 and 16 times RaysPerBeam, and is
   * discarded, so that the echoes stay without bias: few where a plane fills the beam, more at
   * edges and glints, about 32 (s/e)^(4/3) for a pilot of relative error s (Stratified; MonteCarlo:
   * the square). A beam whose pilot hits nothing gets RaysPerBeam, or fewer if two rays could be
   * perceived. Paths over two reflections are not in the pilot. Default: 0. See
   * Documentation/echoes.md.
   */
  vtkSetMacro(TargetRelativeError, double);
  vtkGetMacro(TargetRelativeError, double);
  ///@}

  ///@{
  /**
   * Seed of all random numbers, any int. Default: 0.
   */
  vtkSetMacro(Seed, int);
  vtkGetMacro(Seed, int);
  ///@}

  ///@{
  /**
   * Atmospheric attenuation coefficient (Eq. 9), 1/m, 0 to 1e30. Default: 3.5e-5 (a clear
   * day; 8.8e-5 is haze of 23 km visibility at 905 nm).
   */
  vtkSetMacro(AttenuationCoefficient, double);
  vtkGetMacro(AttenuationCoefficient, double);
  ///@}

  ///@{
  /**
   * How a surface reflects: REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG (Eq. 5-8, the paper),
   * REFLECTANCE_MODEL_PHONG or REFLECTANCE_MODEL_MICROFACET (the peers of Fig. 10; formulas in
   * Documentation/reflectance.md). Default: REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG.
   */
  vtkSetMacro(ReflectanceModel, int);
  vtkGetMacro(ReflectanceModel, int);
  void SetReflectanceModelToLambertBlinnPhong()
  {
    this->SetReflectanceModel(REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG);
  }
  void SetReflectanceModelToPhong() { this->SetReflectanceModel(REFLECTANCE_MODEL_PHONG); }
  void SetReflectanceModelToMicrofacet()
  {
    this->SetReflectanceModel(REFLECTANCE_MODEL_MICROFACET);
  }
  ///@}

  ///@{
  /**
   * Reflections followed, 1 (direct echoes only) or 2 (Sec. 3.4). Default: 2.
   */
  vtkSetMacro(NumberOfReflections, int);
  vtkGetMacro(NumberOfReflections, int);
  ///@}

  ///@{
  /**
   * Look for second reflection points only among the triangles that the cone may meet, instead of
   * the whole scene. The echoes are the same, only the work differs. Default: on.
   */
  vtkSetMacro(BeamConstraint, bool);
  vtkGetMacro(BeamConstraint, bool);
  vtkBooleanMacro(BeamConstraint, bool);
  ///@}

  ///@{
  /**
   * Drop paths that cannot matter: no range unit loses more than 1e-3 of the lower energy limit.
   * Default: on.
   */
  vtkSetMacro(LightEnergyConstraint, bool);
  vtkGetMacro(LightEnergyConstraint, bool);
  vtkBooleanMacro(LightEnergyConstraint, bool);
  ///@}

  ///@{
  /**
   * What goes down the tree together; the echoes are the same:
   *
   * - BATCH_COLLISION_DETECTION_RAYS (Off): every ray by itself
   * - BATCH_COLLISION_DETECTION_GROUPS (On): neighbouring beams, then their rays in packets; the
   *   fastest
   * - BATCH_COLLISION_DETECTION_BEAMS: every beam by itself to the set of triangles that it may
   *   meet, then all its rays against that set (the paper, Sec. 3.2)
   *
   * Default: BATCH_COLLISION_DETECTION_GROUPS.
   */
  vtkSetMacro(BatchCollisionDetection, int);
  vtkGetMacro(BatchCollisionDetection, int);
  vtkBooleanMacro(BatchCollisionDetection, int);
  void SetBatchCollisionDetectionToRays()
  {
    this->SetBatchCollisionDetection(BATCH_COLLISION_DETECTION_RAYS);
  }
  void SetBatchCollisionDetectionToGroups()
  {
    this->SetBatchCollisionDetection(BATCH_COLLISION_DETECTION_GROUPS);
  }
  void SetBatchCollisionDetectionToBeams()
  {
    this->SetBatchCollisionDetection(BATCH_COLLISION_DETECTION_BEAMS);
  }
  ///@}

  ///@{
  /**
   * Integrate the direct echo of a beam that few triangles enter over the polygons that it sees,
   * instead of sampling it: at most 100 to 200 triangles, and no more than RaysPerBeam. Direct
   * echoes of such a beam come from no rays and do not depend on RaysPerBeam, nor on Seed unless
   * noise is modelled (`noise_modelled`). Its `energy_std_error` is a bound of the error (1e-6 to
   * 1e-3 of the energy, more where lines of equal range are curved) instead of a standard error.
   * Paths over two reflections start from RaysPerBeam rays placed on the polygons, and add their
   * standard error. Off: every beam is sampled, as in the paper. See
   * Documentation/plane-integration.md. Default: on.
   */
  vtkSetMacro(PlaneIntegration, bool);
  vtkGetMacro(PlaneIntegration, bool);
  vtkBooleanMacro(PlaneIntegration, bool);
  ///@}

  ///@{
  /**
   * Sample a beam anew where RaysPerBeam rays leave open whether an echo exceeds the lower energy
   * limit: where the energy of a range unit that may be the strongest of a return, or lies between
   * two, is within two standard errors of the limit. The beam then gets as many rays as the
   * decision takes, at most 16 times RaysPerBeam and 10,000; objects with rays of their own
   * (SmallTargets) get more of these likewise. No effect with a TargetRelativeError, which looks
   * after such beams itself, below 8 rays, and from 10,000 on. Another limit or another air has
   * other beams near it, and these are traced. Off: echoes near the limit appear and vanish by
   * chance. See Documentation/results/accuracy.md. Default: on.
   */
  vtkSetMacro(RefineNearLimit, bool);
  vtkGetMacro(RefineNearLimit, bool);
  vtkBooleanMacro(RefineNearLimit, bool);
  ///@}

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
   * Give rays of their own to objects that are small against the spacing of a beam's rays and that
   * can bring it at least 1e-3 of the lower energy limit: eight in the narrowest cone about the
   * object's bounding sphere (with a target error as many as it takes), which count where they hit
   * that object; the beam's own rays then do not count where they do. The expected energies stay
   * the same, their spread falls, from 260 % to 28 % for a square of 0.15 m2 at 1 km. Objects are
   * cells with one `object_id`; at most 16 in a beam. See Documentation/model-needs.md. Default:
   * on.
   */
  vtkSetMacro(SmallTargets, bool);
  vtkGetMacro(SmallTargets, bool);
  vtkBooleanMacro(SmallTargets, bool);
  ///@}

  ///@{
  /**
   * Leave out nothing of what the beam report calls `skipped`: every path is followed whatever
   * LightEnergyConstraint says, no beam is skipped, and noise (if Noise is on) is modelled even
   * where it cannot matter. The echoes are the same within `skipped_bound` of their beam; it is
   * slower, and to check just that. It adds no rays: objects below the least share of SmallTargets
   * get none of their own, and beyond the 16 largest of a beam the others share its ordinary rays.
   * Default: off.
   */
  vtkSetMacro(FullModel, bool);
  vtkGetMacro(FullModel, bool);
  vtkBooleanMacro(FullModel, bool);
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
   * M, diffuse connections of each hit to other hits of its beam; at least 0, more than N - 1 means
   * N - 1. Default: 2, as accurate as 8 (Documentation/results/accuracy.md).
   */
  vtkSetMacro(NumberOfConnections, int);
  vtkGetMacro(NumberOfConnections, int);
  ///@}

  ///@{
  /**
   * Without effect, kept for scripts and states: hits are decided in double precision, and the
   * field data array precision is always PRECISION_DOUBLE. Default: PRECISION_SINGLE.
   */
  vtkSetMacro(Precision, int);
  vtkGetMacro(Precision, int);
  void SetPrecisionToSingle() { this->SetPrecision(PRECISION_SINGLE); }
  void SetPrecisionToDouble() { this->SetPrecision(PRECISION_DOUBLE); }
  ///@}

  ///@{
  /**
   * Threads, at least 0. 0: OpenMP's choice (all cores, or OMP_NUM_THREADS); where several MPI
   * ranks work together, this rank's share of the cores of its node. Never changes the echoes.
   * Default: 0.
   */
  vtkSetMacro(NumberOfThreads, int);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

  ///@{
  /**
   * Most memory for what is kept from one execution to the next, MiB, at least 0: hits and paths of
   * beams, and energies in range units where noise matters. Beams that do not fit are traced again.
   * Not counted: beams and surfaces as read, a tree built here, patterns of rays (some MiB a
   * thread), and about 120 bytes a beam. Default: 1024.
   */
  vtkSetMacro(MaximumCacheSize, int);
  vtkGetMacro(MaximumCacheSize, int);
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
   * Input port 2, objects that move (optional).
   */
  void SetMoversConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
  void SetMoversData(vtkDataObject* movers) { this->SetInputData(2, movers); }
  ///@}

  /**
   * Rays (primary, mirror, visibility) traced by the last execution, by all ranks together; 0 when
   * it only lit what was known.
   */
  double GetNumberOfTracedRays() const;

  /**
   * Beams whose surfaces the last execution looked for, by all ranks together; 0 when all were
   * known. Movers are not counted.
   */
  double GetNumberOfTracedBeams() const;

  /**
   * Beams that movers may have touched in the last execution, of all ranks together. Each of them
   * was traced anew.
   */
  double GetNumberOfTouchedBeams() const;

  /**
   * How many collision trees this filter had to build because none that fits came with the
   * surfaces.
   */
  int GetNumberOfTreeBuilds() const;

  /// Bytes of surfaces and trees that this rank has given to the others so far, for tests and
  /// measurements.
  double GetNumberOfBytesSent() const;

  ///@{
  /**
   * The processes that may work together. Default: the global controller when the filter was
   * made; null: this process works alone.
   */
  void SetController(vtkMultiProcessController* controller);
  vtkGetObjectMacro(Controller, vtkMultiProcessController);
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
  vtkAvianLidarEchoFilter();
  ~vtkAvianLidarEchoFilter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int ModifyRequest(vtkInformation* request, int when) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  int Preset = PRESET_CUSTOM;
  int RaysPerBeam = 100;
  int Sampling = SAMPLING_STRATIFIED;
  double TargetRelativeError = 0.0;
  int Seed = 0;
  double AttenuationCoefficient = 3.5e-5;
  int ReflectanceModel = REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG;
  int NumberOfReflections = 2;
  bool BeamConstraint = true;
  bool LightEnergyConstraint = true;
  int BatchCollisionDetection = BATCH_COLLISION_DETECTION_GROUPS;
  bool PlaneIntegration = true;
  bool RefineNearLimit = true;
  bool Noise = true;
  bool SmallTargets = true;
  bool FullModel = false;
  int ReturnMode = RETURN_MODE_ALL;
  int NumberOfConnections = 2;
  int Precision = PRECISION_SINGLE;
  int NumberOfThreads = 0;
  int MaximumCacheSize = 1024;

  bool ErrorsAsData = false;
  vtkMultiProcessController* Controller = nullptr;

private:
  vtkAvianLidarEchoFilter(const vtkAvianLidarEchoFilter&) = delete;
  void operator=(const vtkAvianLidarEchoFilter&) = delete;

  // Passes of an execution, by all ranks together; false ends it.
  bool PrepareBeams(const vtkAvianLidarRanks& ranks, vtkPolyData* input);
  bool PrepareSurfaces(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  bool PrepareMovers(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  bool PrepareTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  bool Scan(const vtkAvianLidarRanks& ranks, vtkFieldData* beamFields,
    const std::array<vtkPolyData*, 3>& outputs);

  std::string PrepareSettings();
  std::string CheckUnits() const;
  void SummarizeSurfaces(vtkDataObject* input, bool warn);
  void FindTree(vtkDataObject* input);
  void Trace(const std::array<vtkPolyData*, 3>& outputs);

  struct vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
