// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarScanFilter
 * @brief What filters share that look at surfaces along the beams of a scan: the two inputs, the
 * properties of tracing and lighting, and what is kept from one execution to the next.
 *
 * Input port 0 are the beams, input port 1 the surfaces or their collision tree: see
 * vtkAvianLidarEchoFilter.
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarCoverage
 */
#ifndef vtkAvianLidarScanFilter_h
#define vtkAvianLidarScanFilter_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For std::unique_ptr
#include <string> // For what is wrong with settings

class vtkAvianLidarRanks;
class vtkDataObject;
class vtkMultiProcessController;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarScanFilter : public vtkPolyDataAlgorithm
{
public:
  vtkTypeMacro(vtkAvianLidarScanFilter, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum SamplingType
  {
    SAMPLING_MONTE_CARLO = 0,
    SAMPLING_STRATIFIED = 1
  };

  enum LightEnergyThresholdType
  {
    LIGHT_ENERGY_THRESHOLD_SHARE_OF_LIMIT = 0,
    LIGHT_ENERGY_THRESHOLD_LIMIT = 1
  };

  enum ReflectanceModelType
  {
    REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG = 0,
    REFLECTANCE_MODEL_PHONG = 1,
    REFLECTANCE_MODEL_MICROFACET = 2
  };

  enum BatchCollisionDetectionType
  {
    BATCH_COLLISION_DETECTION_RAYS = 0,
    BATCH_COLLISION_DETECTION_GROUPS = 1,
    BATCH_COLLISION_DETECTION_BEAMS = 2
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
   * That airport has footprints only. Where masts, jetways, terrain or small houses stand,
   * PRESET_DRAFT has had up to 9 % and invents or misses 2 to 28 % of the echoes, PRESET_STANDARD
   * up to 3 %, by scene and place.
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
   * Atmospheric attenuation coefficient (Eq. 9), 1/m, 0 to 1e30. Counts where Visibility is 0.
   * Default: 3.5e-5 (a clear day; 8.8e-5 is haze of 23 km visibility at 905 nm).
   */
  vtkSetMacro(AttenuationCoefficient, double);
  vtkGetMacro(AttenuationCoefficient, double);
  ///@}

  ///@{
  /**
   * Visibility, m, above 0 to 1e9: the air's attenuation at the lidar's wavelength follows by the
   * law of Kruse and Kim (Documentation/reflectance.md). 0: AttenuationCoefficient counts. Default:
   * 0 of vtkAvianLidarEchoFilter, 23000 (clear) of vtkAvianLidarCoverage.
   */
  vtkSetMacro(Visibility, double);
  vtkGetMacro(Visibility, double);
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
   * Drop paths that carry less than the LightEnergyThreshold (paper, Sec. 3.4). The default
   * threshold loses nothing that matters. Default: on.
   */
  vtkSetMacro(LightEnergyConstraint, bool);
  vtkGetMacro(LightEnergyConstraint, bool);
  vtkBooleanMacro(LightEnergyConstraint, bool);
  ///@}

  ///@{
  /**
   * Fraction of the lower energy limit that a range unit of a beam may lose by
   * LightEnergyConstraint, a pure number, 0 to 1e8. Direct echoes and paths over two reflections
   * are dropped if they carry less than this fraction of the limit over the number of paths of
   * their beam. Above 1 echoes get lost. No effect with the constraint off, or with
   * LIGHT_ENERGY_THRESHOLD_LIMIT. What other values cost and gain is measured in
   * Documentation/results/paper-figures.md. Default: 1e-3.
   */
  vtkSetMacro(LightEnergyFraction, double);
  vtkGetMacro(LightEnergyFraction, double);
  ///@}

  ///@{
  /**
   * What LightEnergyConstraint compares a path with: LIGHT_ENERGY_THRESHOLD_SHARE_OF_LIMIT (see
   * LightEnergyFraction; no range unit loses more than that), or LIGHT_ENERGY_THRESHOLD_LIMIT:
   * paths over two reflections that carry less than the lower energy limit are not followed, direct
   * echoes are left alone (paper, Sec. 3.4). Such paths may be many, and together matter: field
   * data `light_energy_constraint_bound`. What a path carries depends on how finely light is cut
   * into rays (1/N of the pulse, less where RefineNearLimit adds rays): with the paper's 100 rays
   * no path over two reflections comes back in the scenes that were measured. Meant for comparison
   * with the paper. Default: LIGHT_ENERGY_THRESHOLD_SHARE_OF_LIMIT.
   */
  vtkSetMacro(LightEnergyThreshold, int);
  vtkGetMacro(LightEnergyThreshold, int);
  void SetLightEnergyThresholdToShareOfLimit()
  {
    this->SetLightEnergyThreshold(LIGHT_ENERGY_THRESHOLD_SHARE_OF_LIMIT);
  }
  void SetLightEnergyThresholdToLimit()
  {
    this->SetLightEnergyThreshold(LIGHT_ENERGY_THRESHOLD_LIMIT);
  }
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
   * standard error. A beam that more triangles enter, up to 4000, is divided into cells, with some
   * 32 RaysPerBeam rays for its direct echo, unless Sampling is Monte Carlo or a
   * TargetRelativeError is set. Off: every beam is sampled, as in the paper. See
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
   * chance. Beams that PlaneIntegration integrates or divides into cells need no refinement. See
   * Documentation/results/accuracy.md. Default: on.
   */
  vtkSetMacro(RefineNearLimit, bool);
  vtkGetMacro(RefineNearLimit, bool);
  vtkBooleanMacro(RefineNearLimit, bool);
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
   * M, diffuse connections of each hit to other hits of its beam; at least 0, more than N - 1 means
   * N - 1. Default: 2, as accurate as 8 (Documentation/results/accuracy.md).
   */
  vtkSetMacro(NumberOfConnections, int);
  vtkGetMacro(NumberOfConnections, int);
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
  vtkAvianLidarScanFilter();
  ~vtkAvianLidarScanFilter() override;

  vtkTypeBool ProcessRequest(
    vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int ModifyRequest(vtkInformation* request, int when) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  // Passes of an execution, by all ranks together; false ends it.
  bool PrepareBeams(const vtkAvianLidarRanks& ranks, vtkPolyData* input);
  bool PrepareSurfaces(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  bool PrepareTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input);

  int Preset = PRESET_CUSTOM;
  int RaysPerBeam = 100;
  int Sampling = SAMPLING_STRATIFIED;
  double TargetRelativeError = 0.0;
  int Seed = 0;
  double AttenuationCoefficient = 3.5e-5;
  double Visibility = 0.0;
  int ReflectanceModel = REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG;
  int NumberOfReflections = 2;
  bool BeamConstraint = true;
  bool LightEnergyConstraint = true;
  double LightEnergyFraction = 1e-3;
  int LightEnergyThreshold = LIGHT_ENERGY_THRESHOLD_SHARE_OF_LIMIT;
  int BatchCollisionDetection = BATCH_COLLISION_DETECTION_GROUPS;
  bool PlaneIntegration = true;
  bool RefineNearLimit = true;
  bool SmallTargets = true;
  bool FullModel = false;
  int NumberOfConnections = 2;
  int NumberOfThreads = 0;
  int MaximumCacheSize = 1024;

  bool ErrorsAsData = false;
  vtkMultiProcessController* Controller = nullptr;

  struct vtkInternals;
  std::unique_ptr<vtkInternals> Internals;

private:
  vtkAvianLidarScanFilter(const vtkAvianLidarScanFilter&) = delete;
  void operator=(const vtkAvianLidarScanFilter&) = delete;

  std::string MissingInput();
  std::string PrepareSettings();
  std::string CheckUnits() const;
  void SummarizeSurfaces(vtkDataObject* input, bool warn);
  void FindTree(vtkDataObject* input);
};

#endif
