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

#include "vtkAvianLidarErrorsAsData.h"
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

  enum BeamSamplesType
  {
    BEAM_SAMPLES_CELLS = 0,
    BEAM_SAMPLES_RAYS = 1
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
    REFLECTANCE_MODEL_MICROFACET = 2,
    REFLECTANCE_MODEL_OREN_NAYAR = 3
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
   * RaysPerBeam, Sampling, NumberOfReflections and NumberOfConnections at execution; they write no
   * property, and field data hold what was used. All three are SAMPLING_STRATIFIED, with 2
   * reflections:
   *
   * - PRESET_DRAFT: 25 rays, 0 connections
   * - PRESET_STANDARD: 200 rays, 2 connections
   * - PRESET_REFERENCE: 3200 rays, 8 connections
   *
   * Errors and times are measured in Documentation/results/accuracy.md. Default: PRESET_CUSTOM.
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
   * N, rays per beam (Eq. 1-3), each of energy Qs/N, with BEAM_SAMPLES_RAYS. With
   * BEAM_SAMPLES_CELLS the density of a beam's grid, of about 32 N rays in steps, a million at most
   * (Documentation/beam-samples.md), and of paths over two reflections. 1 to 1000000. Default: 100.
   */
  vtkSetMacro(RaysPerBeam, int);
  vtkGetMacro(RaysPerBeam, int);
  ///@}

  ///@{
  /**
   * How the direct echo of a beam is found; see Documentation/beam-samples.md:
   *
   * - BEAM_SAMPLES_CELLS: a beam that few triangles enter (at most 100, up to 200 from 5,000
   *   RaysPerBeam on) is integrated over the polygons that it sees, without rays; its
   *   `energy_std_error` is a bound of the error (1e-6 to 1e-3 of the energy, more where lines of
   *   equal range are curved). A beam that more enter is divided into cells with a dense grid of
   *   rays (3,217 for RaysPerBeam of 32 to 226), and more where a small object (by `object_id`)
   *   would have fewer than 256 (a 25th below 32). Mirror paths start where one surface shows
   *   another, connections from a quarter of RaysPerBeam rays, at least 16.
   * - BEAM_SAMPLES_RAYS: RaysPerBeam rays of each beam are traced, as in the paper.
   *
   * Default: BEAM_SAMPLES_CELLS.
   */
  vtkSetMacro(BeamSamples, int);
  vtkGetMacro(BeamSamples, int);
  void SetBeamSamplesToCells() { this->SetBeamSamples(BEAM_SAMPLES_CELLS); }
  void SetBeamSamplesToRays() { this->SetBeamSamples(BEAM_SAMPLES_RAYS); }
  ///@}

  ///@{
  /**
   * How the RaysPerBeam rays are drawn: SAMPLING_MONTE_CARLO (independent, the paper) or
   * SAMPLING_STRATIFIED (two independent rays in each of N/2 compact cells of equal solid angle; at
   * an edge the error of six times as many random rays). Default: SAMPLING_STRATIFIED.
   */
  vtkSetMacro(Sampling, int);
  vtkGetMacro(Sampling, int);
  void SetSamplingToMonteCarlo() { this->SetSampling(SAMPLING_MONTE_CARLO); }
  void SetSamplingToStratified() { this->SetSampling(SAMPLING_STRATIFIED); }
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
   * Whether the air of Visibility sends light back, by its extinction-to-backscatter ratio: 18.8 sr
   * of fog (a visibility up to 1000 m), 50 sr of haze (assumed). It needs a sensor with an
   * aperture; what a receiver makes of it is its threshold law
   * (vtkAvianLidarBeamSource::SetThresholdLaw()). Of no account where Visibility is 0. Default:
   * off.
   */
  vtkSetMacro(AirBackscatter, bool);
  vtkGetMacro(AirBackscatter, bool);
  vtkBooleanMacro(AirBackscatter, bool);
  ///@}

  ///@{
  /**
   * Rain rate in millimetres per hour, 0 to 500. Rain weakens light in addition to the air and
   * sends it back, drop by drop, as Marshall and Palmer distribute them, each like twice its area
   * (geometric optics), with 20 sr (assumed). What drops diffract into the view, as wide as the
   * beam, is not lost. Default: 0, none.
   */
  vtkSetMacro(RainRate, double);
  vtkGetMacro(RainRate, double);
  ///@}

  ///@{
  /**
   * How a surface reflects: REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG (Eq. 5-8, the paper),
   * REFLECTANCE_MODEL_PHONG or REFLECTANCE_MODEL_MICROFACET (the peers of Fig. 10), or
   * REFLECTANCE_MODEL_OREN_NAYAR: rough surfaces, which return light also at grazing incidence
   * (roughness of their materials; formulas in Documentation/reflectance.md). Default:
   * REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG.
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
  void SetReflectanceModelToOrenNayar() { this->SetReflectanceModel(REFLECTANCE_MODEL_OREN_NAYAR); }
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
   * into rays (1/N of the pulse): with the paper's 100 rays
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
   * Leave out nothing of what the beam report calls `skipped`: every path is followed whatever
   * LightEnergyConstraint says, no beam is skipped, and noise (if Noise is on) is modelled even
   * where it cannot matter. The echoes are the same within `skipped_bound` of their beam; it is
   * slower, and to check just that. It adds no rays.
   * Default: off.
   */
  vtkSetMacro(FullModel, bool);
  vtkGetMacro(FullModel, bool);
  vtkBooleanMacro(FullModel, bool);
  ///@}

  ///@{
  /**
   * M, diffuse connections of each ray from which they start (N, with BEAM_SAMPLES_CELLS N/4 and at
   * least 16) to others; at least 0, more than there are others means all. Default: 2, as accurate
   * as 8 (Documentation/results/accuracy.md).
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

  /// Bytes of surfaces that this rank has given to the others so far, for tests and
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

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarScanFilter();
  ~vtkAvianLidarScanFilter() override;

  vtkTypeBool ProcessRequest(
    vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int ModifyRequest(vtkInformation* request, int when) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  // Whether air and rain send light back, as field data.
  std::string PlaceMedia();
  void AddAirTo(vtkFieldData* fields) const;

  // Passes of an execution, by all ranks together; false ends it.
  bool PrepareBeams(const vtkAvianLidarRanks& ranks, vtkPolyData* input);
  bool PrepareSurfaces(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  bool PrepareTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input);

  int Preset = PRESET_CUSTOM;
  int RaysPerBeam = 100;
  int BeamSamples = BEAM_SAMPLES_CELLS;
  int Sampling = SAMPLING_STRATIFIED;
  int Seed = 0;
  double AttenuationCoefficient = 3.5e-5;
  double Visibility = 0.0;
  bool AirBackscatter = false;
  double RainRate = 0.0;
  int ReflectanceModel = REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG;
  int NumberOfReflections = 2;
  bool BeamConstraint = true;
  bool LightEnergyConstraint = true;
  double LightEnergyFraction = 1e-3;
  int LightEnergyThreshold = LIGHT_ENERGY_THRESHOLD_SHARE_OF_LIMIT;
  int BatchCollisionDetection = BATCH_COLLISION_DETECTION_GROUPS;
  bool FullModel = false;
  int NumberOfConnections = 2;
  int NumberOfThreads = 0;
  int MaximumCacheSize = 1024;

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
