// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarScanFilter
 * @brief Base of filters that trace the beams of a scan to surfaces. The class has the two inputs,
 * the settings of rays and energies, and the results that are kept from one execution to the next.
 *
 * Input port 0 takes the beams. Input port 1 takes the surfaces or their collision tree.
 * vtkAvianLidarEchoFilter describes the inputs. Paper: "Research on Ground Object Echo Simulation
 * of Avian Lidar", Photonics 2024, 11(2), 153.
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarCoverage
 */
#ifndef vtkAvianLidarScanFilter_h
#define vtkAvianLidarScanFilter_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For std::unique_ptr
#include <string> // For error texts

class vtkAvianLidarRanks;
class vtkDataObject;

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
    LIGHT_ENERGY_THRESHOLD_LIMIT = 1,
    LIGHT_ENERGY_THRESHOLD_LIMIT_PER_RAY = 2
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
    PRESET_REFERENCE = 3,
    PRESET_PAPER = 4,
    PRESET_PREVIEW = 5
  };

  ///@{
  /// Preset of the fidelity. At execution all presets except PRESET_CUSTOM override RaysPerBeam,
  /// NumberOfConnections, Sampling and NumberOfReflections. The field data hold the values used.
  /// PRESET_PAPER and PRESET_PREVIEW also override BeamSamples. In brackets are the rms error of
  /// energy and the processor time of 15,360 beams, first at the shipped airport, then at Hongqiao
  /// with structures:
  ///
  /// - PRESET_PREVIEW: 100 stratified rays, no cells, 1 reflection (7.7 %, 0.032 s; 9.2 %, 0.038 s)
  /// - PRESET_DRAFT: 25 rays, 0 connections, 2 reflections (0.41 %, 0.11 s; 0.97 %, 0.29 s)
  /// - PRESET_STANDARD: 200 rays, 2 connections, 2 reflections (0.2 %, 0.12 s; 0.4 %, 0.47 s)
  /// - PRESET_REFERENCE: 3200 rays, 8 connections, 2 reflections (0.12 %, 0.51 s; 0.14 %, 2.3 s)
  /// - PRESET_PAPER: the method of the paper with 100 independent rays, no cells, 2 connections, 2
  ///   reflections (16 %, 0.2 s; 16 %, 0.4 s). The preset also overrides BatchCollisionDetection
  ///   (beams), BeamConstraint (on), LightEnergyConstraint (on), LightEnergyThreshold (limit),
  ///   ReflectanceModel (model of the paper) and ReturnMode (a point for each range unit). Tree of
  ///   the paper: vtkAvianLidarCollisionTree::PRESET_PAPER.
  ///
  /// Errors and times: Documentation/evidence/accuracy.md. Default: PRESET_CUSTOM.
  vtkAvianLidarPropertyMacro(Preset, int, PRESET_CUSTOM);
  void SetPresetToCustom() { this->SetPreset(PRESET_CUSTOM); }
  void SetPresetToDraft() { this->SetPreset(PRESET_DRAFT); }
  void SetPresetToStandard() { this->SetPreset(PRESET_STANDARD); }
  void SetPresetToReference() { this->SetPreset(PRESET_REFERENCE); }
  void SetPresetToPaper() { this->SetPreset(PRESET_PAPER); }
  void SetPresetToPreview() { this->SetPreset(PRESET_PREVIEW); }
  ///@}

  /// Number N of rays per beam (Eq. 1-3), 1 to 1000000. With BEAM_SAMPLES_CELLS, N sets the density
  /// of rays in cells (about 32 N rays in a beam), and of paths with two reflections. Default: 100.
  vtkAvianLidarPropertyMacro(RaysPerBeam, int, 100);

  ///@{
  /// Method that finds the direct echo of a beam (Documentation/method/beam.md):
  ///
  /// - BEAM_SAMPLES_CELLS: integrates over the polygons that the beam sees if few triangles enter
  ///   the beam, and otherwise over a grid of cells with dense rays
  /// - BEAM_SAMPLES_RAYS: sums over RaysPerBeam rays, as in the paper
  ///
  /// Default: BEAM_SAMPLES_CELLS.
  vtkAvianLidarPropertyMacro(BeamSamples, int, BEAM_SAMPLES_CELLS);
  void SetBeamSamplesToCells() { this->SetBeamSamples(BEAM_SAMPLES_CELLS); }
  void SetBeamSamplesToRays() { this->SetBeamSamples(BEAM_SAMPLES_RAYS); }
  ///@}

  ///@{
  /// Distribution of the rays: independent (the paper), or two in each of N/2 cells of equal solid
  /// angle. Default: SAMPLING_STRATIFIED.
  vtkAvianLidarPropertyMacro(Sampling, int, SAMPLING_STRATIFIED);
  void SetSamplingToMonteCarlo() { this->SetSampling(SAMPLING_MONTE_CARLO); }
  void SetSamplingToStratified() { this->SetSampling(SAMPLING_STRATIFIED); }
  ///@}

  /// Seed of all random numbers, any int. Default: 0.
  vtkAvianLidarPropertyMacro(Seed, int, 0);

  /// Attenuation of the air (Eq. 9), 1/m, 0 to 1e30. Not used if Visibility is above 0. Default:
  /// 3.5e-5.
  vtkAvianLidarPropertyMacro(AttenuationCoefficient, double, 3.5e-5);

  /// Visibility, m, 0 to 1e9, which sets the attenuation by the law of Kruse and Kim
  /// (Documentation/method/reflectance.md). With 0, AttenuationCoefficient is used. Default: 0 in
  /// the echo filter, 23000 (clear) in vtkAvianLidarCoverage.
  vtkAvianLidarPropertyMacro(Visibility, double, 0.0);

  /// Whether the air of Visibility sends light back to a sensor with an aperture. Default: off.
  vtkAvianLidarSwitchMacro(AirBackscatter, false);

  /// Rain rate, mm/h, 0 to 500. Rain weakens light and sends light back. Default: 0.
  vtkAvianLidarPropertyMacro(RainRate, double, 0.0);

  ///@{
  /// Reflectance model (Documentation/method/reflectance.md): the model of the paper (Eq. 5-8), the
  /// models that Fig. 10 of the paper compares with this model, or the model of Oren and Nayar for
  /// rough surfaces. Default: REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG.
  vtkAvianLidarPropertyMacro(ReflectanceModel, int, REFLECTANCE_MODEL_LAMBERT_BLINN_PHONG);
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

  /// Largest number of reflections: 1 (direct echoes only), 2 (Sec. 3.4), or 3, which adds matt
  /// light that arrives and comes back by the same mirror and needs an aperture. Default: 3.
  vtkAvianLidarPropertyMacro(NumberOfReflections, int, 3);

  /// Whether second reflections are searched only in the beam's cone. The echoes are the same if
  /// this property is off. Default: on.
  vtkAvianLidarSwitchMacro(BeamConstraint, true);

  /// Whether paths below LightEnergyThreshold are dropped (paper, Sec. 3.4). Default: on.
  vtkAvianLidarSwitchMacro(LightEnergyConstraint, true);

  /// Share of the lower limit that LightEnergyConstraint may drop, 1, 0 to 1e8. Default: 1e-3.
  vtkAvianLidarPropertyMacro(LightEnergyFraction, double, 1e-3);

  ///@{
  /// Energy below which LightEnergyConstraint drops a path: LightEnergyFraction times the lower
  /// limit, divided by the number of paths of the beam; or, for each path with two reflections
  /// alone, the lower limit or the lower limit divided by RaysPerBeam. Sec. 3.4 of the paper may be
  /// read in both of the latter ways. Default: LIGHT_ENERGY_THRESHOLD_SHARE_OF_LIMIT.
  vtkAvianLidarPropertyMacro(LightEnergyThreshold, int, LIGHT_ENERGY_THRESHOLD_SHARE_OF_LIMIT);
  void SetLightEnergyThresholdToShareOfLimit()
  {
    this->SetLightEnergyThreshold(LIGHT_ENERGY_THRESHOLD_SHARE_OF_LIMIT);
  }
  void SetLightEnergyThresholdToLimit()
  {
    this->SetLightEnergyThreshold(LIGHT_ENERGY_THRESHOLD_LIMIT);
  }
  void SetLightEnergyThresholdToLimitPerRay()
  {
    this->SetLightEnergyThreshold(LIGHT_ENERGY_THRESHOLD_LIMIT_PER_RAY);
  }
  ///@}

  ///@{
  /// Choice of the rays that descend the tree together. All choices give the same echoes:
  ///
  /// - BATCH_COLLISION_DETECTION_RAYS (Off): every ray by itself
  /// - BATCH_COLLISION_DETECTION_GROUPS (On): neighbouring beams together, then packets of rays;
  ///   the fastest choice
  /// - BATCH_COLLISION_DETECTION_BEAMS: the rays of one beam (the paper, Sec. 3.2)
  ///
  /// Default: BATCH_COLLISION_DETECTION_GROUPS.
  vtkAvianLidarPropertyMacro(BatchCollisionDetection, int, BATCH_COLLISION_DETECTION_GROUPS);
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

  /// Whether to compute the parts of the model that are otherwise left out and named in `skipped`.
  /// A full model takes longer. Default: off.
  vtkAvianLidarSwitchMacro(FullModel, false);

  /// Number M of connections of each ray that starts connections, at least 0. Default: 2, as
  /// accurate as 8.
  vtkAvianLidarPropertyMacro(NumberOfConnections, int, 2);

  /// Number of threads, at least 0, without effect on the echoes. Default: 0, which means this
  /// rank's share of the cores.
  vtkAvianLidarPropertyMacro(NumberOfThreads, int, 0);

  /// Largest memory for results kept between executions, MiB, at least 0. Default: 1024.
  vtkAvianLidarPropertyMacro(MaximumCacheSize, int, 1024);

  ///@{
  /// Input port 1, the surfaces.
  void SetSurfacesConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  void SetSurfacesData(vtkDataObject* surfaces) { this->SetInputData(1, surfaces); }
  ///@}

  /// Number of rays (primary, mirror, visibility) that the last execution traced, on all ranks; 0
  /// if only the energies were computed again.
  double GetNumberOfTracedRays() const;

  /// Number of beams, on all ranks, for which the last execution searched the surfaces (not only
  /// the movers); 0 if only the energies were computed again.
  double GetNumberOfTracedBeams() const;

  /// Number of collision trees that this filter has built because the surfaces came without a tree
  /// that fits.
  int GetNumberOfTreeBuilds() const;

  /// Size of the surfaces that this rank has sent to other ranks so far, bytes, for tests and
  /// measurements.
  double GetNumberOfBytesSent() const;

  /// Controller of the processes that may work together; null: this process works alone. Default:
  /// the global controller.
  vtkAvianLidarControllerMacro();

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarScanFilter();
  ~vtkAvianLidarScanFilter() override;

  vtkTypeBool ProcessRequest(
    vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  // Adds the media of the surfaces to the scan.
  void PlaceMedia();
  void AddAirTo(vtkFieldData* fields) const;

  // Passes of an execution. All ranks must call these functions.
  void PrepareBeams(const vtkAvianLidarRanks& ranks, vtkPolyData* input);
  void PrepareSurfaces(const vtkAvianLidarRanks& ranks, vtkDataObject* input);
  void PrepareTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input);

  struct vtkInternals;
  std::unique_ptr<vtkInternals> Internals;

private:
  vtkAvianLidarScanFilter(const vtkAvianLidarScanFilter&) = delete;
  void operator=(const vtkAvianLidarScanFilter&) = delete;

  std::string MissingInput();
  void PrepareSettings();
  void SummariseSurfaces(vtkDataObject* input, bool warn);
  void FindTree(vtkDataObject* input);
};

#endif
