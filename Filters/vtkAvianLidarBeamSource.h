// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarBeamSource
 * @brief Makes the beams of a scanning lidar, with the lidar's pulse and receiver as field data.
 *
 * A new source has the preset Airport16, the lidar of the paper's Table 2 ("Research on Ground
 * Object Echo Simulation of Avian Lidar", Photonics 2024, 11(2), 153).
 *
 * - Input port 0, vtkPolyData, optional: trajectory of the platform on which the sensor moves. Each
 *   point is a pose: its position, m, with the point arrays `time` (s, rising) and, optionally,
 *   `pose_orientation` (unit quaternion w, x, y, z, from the platform's frame, x right, y forward,
 *   z up, to the scene's; default: not turned). Position (the lever arm) and Orientation of the
 *   sensor are then in the platform's frame. Positions between two poses are linear in time,
 *   orientations are interpolated by slerp. A revolution with beams before the first or after the
 *   last pose is an error.
 * - Output port 0, vtkPolyData: one vertex per beam at Position, column by column and channel by
 *   channel within a column, with the point arrays `beam_id`, `direction`, `laser_id`, `azimuth`,
 *   `vertical_angle` and `timestamp`, and with a trajectory `sensor_position` and
 *   `sensor_orientation`. With sway or jitter, `direction` is the true direction of a beam. The
 *   arrays `reported_direction`, `azimuth` and `vertical_angle` are the values that the sensor
 *   reports.
 * - Output port 1, vtkPolyData: the same beams as lines of the length DisplayLength, for display.
 * - Field data of both outputs: every property in snake case in its own unit, and `wavelength`.
 *   With a trajectory, `position` and `orientation` are those at the start of the revolution.
 *   Settings that the sensor does not use are left out. With a photon receiver, the energy limits
 *   are computed from the receiver's properties.
 *
 * The source is time-aware: revolution k lasts from k / RotationRate to (k + 1) / RotationRate
 * seconds. Any number of pieces can be requested. Columns are distributed to the pieces in turn.
 * The beams have the same bits for any number of threads and pieces.
 *
 * Setters accept any value. Values are checked when the source executes. A bad value, or more beams
 * than fit into memory, gives empty outputs and an error that names the property.
 *
 * @code
 * sensor->SetPresetToSearch905();
 * sensor->SetPosition(0, 0, 3);
 * echoes->SetInputConnection(0, sensor->GetOutputPort());
 * @endcode
 *
 * Documentation: reference/sensor-files.md (pattern, clock, prisms, files), guide/lidars.md
 * (presets, receivers), guide/moving.md (revolutions, sway), reference/arrays.md.
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarRangeImage
 */
#ifndef vtkAvianLidarBeamSource_h
#define vtkAvianLidarBeamSource_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPolyDataAlgorithm.h"

#include <functional> // For std::function
#include <memory>     // For std::shared_ptr
#include <string>     // For std::string
#include <utility>    // For std::pair
#include <vector>     // For std::vector

class vtkPolyData;
struct vtkAvianLidarSensorFile;

/// Declares the setter of a built-in sensor, which is a file in Filters/Sensors.
#define vtkAvianLidarPresetMacro(name) \
  void SetPresetTo##name()             \
  {                                    \
    this->TakePreset(#name);           \
  }

class VTKAVIANLIDAR_EXPORT vtkAvianLidarBeamSource : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarBeamSource* New();
  vtkTypeMacro(vtkAvianLidarBeamSource, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum BeamProfiles
  {
    BEAM_PROFILE_UNIFORM = 0,
    BEAM_PROFILE_GAUSSIAN = 1
  };

  enum BeamOutlines
  {
    BEAM_OUTLINE_ELLIPSE = 0,
    BEAM_OUTLINE_RECTANGLE = 1
  };

  enum PulseShapes
  {
    PULSE_SHAPE_RECTANGLE = 0,
    PULSE_SHAPE_GAUSSIAN = 1,
    PULSE_SHAPE_SAMPLES = 2
  };

  enum ReceiverModels
  {
    RECEIVER_MODEL_ENERGY_LIMITS = 0,
    RECEIVER_MODEL_PHOTONS = 1
  };

  enum ThresholdLaws
  {
    THRESHOLD_LAW_FIXED = 0,
    THRESHOLD_LAW_FOLLOWS_AIR = 1
  };

  ///@{
  /// Set all properties except ErrorsAsData to the values of a built-in sensor's file in
  /// Filters/Sensors. A property that is not in the file is set to its default
  /// (Documentation/reference/sensor-files.md).
  vtkAvianLidarPresetMacro(Airport16);
  vtkAvianLidarPresetMacro(Airport32);
  vtkAvianLidarPresetMacro(CorridorC16);
  vtkAvianLidarPresetMacro(Search905);
  vtkAvianLidarPresetMacro(Search1550);
  vtkAvianLidarPresetMacro(Automotive16);
  vtkAvianLidarPresetMacro(VLP16);
  vtkAvianLidarPresetMacro(VLP32C);
  vtkAvianLidarPresetMacro(HDL32E);
  vtkAvianLidarPresetMacro(Pandar40P);
  vtkAvianLidarPresetMacro(PandarXT32);
  vtkAvianLidarPresetMacro(OS1_64);
  vtkAvianLidarPresetMacro(Helios16P);
  vtkAvianLidarPresetMacro(OS0_128);
  vtkAvianLidarPresetMacro(OS2_128);
  vtkAvianLidarPresetMacro(Mid40);
  vtkAvianLidarPresetMacro(Avia);
  vtkAvianLidarPresetMacro(Mid360);
  ///@}

  /// From a built-in sensor, take only the values that have no setter: tables, prisms, the names of
  /// assumed values and the description. User interfaces that set all properties one by one need
  /// this function. An unknown name gives an error and changes nothing. @param name
  /// name of the sensor's file (`OS1_64`); null or empty: no tables
  void SetTablesOfPreset(const char* name);

  /// Set all properties from a file (`.lidarsensor.json`), and the values that only files set:
  /// azimuth offsets and firing times of channels, blanked sectors, prisms
  /// (Documentation/reference/sensor-files.md, Files).
  /// @return false for a bad file. A bad file changes nothing and gives an error that names file
  /// and key.
  bool LoadSensor(VTK_FILEPATH const char* fileName);

  /// Number of rotating prisms that steer the beams, 0 to 3. Only a file sets prisms. Default 0.
  /// With prisms, AzimuthRange and AzimuthStep are not used
  /// (Documentation/reference/sensor-files.md).
  int GetNumberOfPrisms() const;

  /// Set all properties from the text of a file, as LoadSensor() does from a file.
  /// GetDescription() returns such a text. Errors name "the text" instead of a file.
  bool LoadSensorText(const char* text);

  /// Text of the file that LoadSensor() or a preset read last, as JSON; empty for a new source. The
  /// text holds name, comment, documents, every number with unit and source, and the data sheet.
  /// Later changes of properties do not change the text.
  std::string GetDescription() const { return this->Description; }

  /// Use `beams` instead of columns and channels. The source copies the points (m), the point array
  /// `direction` (any length above 0) and the optional array `timestamp` (us, 0 to 1 /
  /// RotationRate; default 0). Points and directions are in the frame of the sensor, which
  /// Orientation turns and Position moves. Each beam has the number of its point as `beam_id` and 0
  /// as `laser_id`. Null, a preset or a file restores columns and channels. @return false for bad
  /// beams. Bad beams change nothing and give an error that names the array.
  bool SetBeams(vtkPolyData* beams);

  ///@{
  /// Set the trajectory, input port 0; null for a sensor that stands. @param port not used; for
  /// ParaView
  void SetTrajectoryConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(0, output); }
  void SetTrajectoryConnection(int port, vtkAlgorithmOutput* output)
  {
    static_cast<void>(port);
    this->SetTrajectoryConnection(output);
  }
  ///@}

  /// Position of the sensor in scene coordinates or, with a trajectory, in the platform's frame,
  /// m, at most 1e30. Default (0, 0, 0).
  vtkAvianLidarVectorMacro(Position, 3, 0.0, 0.0, 0.0);

  /// Yaw (from north), pitch (up) and roll (right), deg, applied in the order roll, pitch, yaw.
  /// Default (0, 0, 0).
  vtkAvianLidarVectorMacro(Orientation, 3, 0.0, 0.0, 0.0);

  /// Number of channels, at least 1. Not used with a table of elevations. Default 16.
  vtkAvianLidarPropertyMacro(NumberOfChannels, int, 16);

  /// Elevation of channel 0, deg, -90 to 90. Not used with a table of elevations. Default 0.
  vtkAvianLidarPropertyMacro(MinimumElevation, double, 0.0);

  /// Difference of elevation between channels, deg, above 0. Not used with a table of elevations.
  /// Default 0.375.
  vtkAvianLidarPropertyMacro(ElevationStep, double, 0.375);

  ///@{
  /// Table of the elevations of all channels, deg, -90 to 90, in any order, instead of
  /// NumberOfChannels, MinimumElevation and ElevationStep. New entries are 0. A bad index gives an
  /// error. Default: empty.
  void SetNumberOfChannelElevations(int number);
  int GetNumberOfChannelElevations() const;
  void SetChannelElevation(int index, double elevation);
  double GetChannelElevation(int index);
  ///@}

  /// First azimuth of the columns (-360 to 360) and excluded end of the columns (at most 360
  /// larger), deg from north, clockwise. Default (0, 360).
  vtkAvianLidarVectorMacro(AzimuthRange, 2, 0.0, 360.0);

  /// Difference of azimuth between columns, deg, above 0. Default 0.375.
  vtkAvianLidarPropertyMacro(AzimuthStep, double, 0.375);

  /// Half of the beam's opening angle, rad, 1e-9 to pi/3 (to 0.1 for beams that are not round).
  /// Default 5.6e-3.
  vtkAvianLidarPropertyMacro(HalfBeamwidth, double, 5.6e-3);

  /// Opening angle, mrad, which must be 2000 times HalfBeamwidth. Default 0: not checked.
  vtkAvianLidarPropertyMacro(BeamwidthMilliradians, double, 0.0);

  ///@{
  /// Outline of the beam across its axis: ellipse or rectangle. Default BEAM_OUTLINE_ELLIPSE.
  vtkAvianLidarPropertyMacro(BeamOutline, int, BEAM_OUTLINE_ELLIPSE);
  void SetBeamOutlineToEllipse() { this->SetBeamOutline(BEAM_OUTLINE_ELLIPSE); }
  void SetBeamOutlineToRectangle() { this->SetBeamOutline(BEAM_OUTLINE_RECTANGLE); }
  ///@}

  /// Half of the opening angle perpendicular to HalfBeamwidth, rad, 1e-9 to 0.1 and 1/1000 to 1000
  /// times HalfBeamwidth. Default 0: HalfBeamwidth. The energy of a beam that is not round is
  /// uniform, or Gaussian, over the plane perpendicular to the axis.
  vtkAvianLidarPropertyMacro(HalfBeamwidthAcross, double, 0.0);

  /// Angle from the sensor's horizontal to the direction of HalfBeamwidth, deg, -360 to 360. For a
  /// viewer who looks along the beam, a positive angle raises the right-hand end of this direction.
  /// For a vertical beam, a fixed direction replaces the horizontal. Default 0.
  vtkAvianLidarPropertyMacro(BeamRotation, double, 0.0);

  ///@{
  /// Distribution of the energy within the outline: uniform (the paper) or Gaussian. Default
  /// BEAM_PROFILE_UNIFORM.
  vtkAvianLidarPropertyMacro(BeamProfile, int, BEAM_PROFILE_UNIFORM);
  void SetBeamProfileToUniform() { this->SetBeamProfile(BEAM_PROFILE_UNIFORM); }
  void SetBeamProfileToGaussian() { this->SetBeamProfile(BEAM_PROFILE_GAUSSIAN); }
  ///@}

  /// Half-beamwidth divided by the 1/e^2 radius of the Gaussian profile, 1, 0.1 to 3. Default 1.
  vtkAvianLidarPropertyMacro(GaussianTruncation, double, 1.0);

  ///@{
  /// Threshold of a photon receiver where the air sends light back: fixed, or k standard deviations
  /// of the noise above the mean of this light. The number k is the same as without this light.
  /// Default THRESHOLD_LAW_FOLLOWS_AIR.
  vtkAvianLidarPropertyMacro(ThresholdLaw, int, THRESHOLD_LAW_FOLLOWS_AIR);
  void SetThresholdLawToFixed() { this->SetThresholdLaw(THRESHOLD_LAW_FIXED); }
  void SetThresholdLawToFollowsAir() { this->SetThresholdLaw(THRESHOLD_LAW_FOLLOWS_AIR); }
  ///@}

  /// Number of revolutions (with prisms: of scans) per second, Hz, 1e-20 to 1e20. Default 0.5.
  vtkAvianLidarPropertyMacro(RotationRate, double, 0.5);

  /// Time between two firings of a column, s, at least 0 (with prisms: above 0). Default 30e-6.
  vtkAvianLidarPropertyMacro(FiringInterval, double, 30e-6);

  /// Number of revolutions that the time steps cover, 1 to 1e6 / StepsPerRevolution. Default 1.
  vtkAvianLidarPropertyMacro(NumberOfRevolutions, int, 1);

  /// Number of steps that share a revolution's columns, 1 to the number of columns. Default 1.
  vtkAvianLidarPropertyMacro(StepsPerRevolution, int, 1);

  /// Sway of the mast: rms tilt about each horizontal axis, deg, 0 to 10. Default 0.
  vtkAvianLidarPropertyMacro(SwayAmplitude, double, 0.0);

  /// Frequency of the sway, Hz, 1e-6 to 1e6. Default 0.5 (assumed).
  vtkAvianLidarPropertyMacro(SwayFrequency, double, 0.5);

  /// Jitter of the encoder: rms error of a column's azimuth, deg, 0 to 10. Default 0.
  vtkAvianLidarPropertyMacro(EncoderJitter, double, 0.0);

  /// Seed of sway and jitter, any int. Default 0.
  vtkAvianLidarPropertyMacro(MotionSeed, int, 0);

  /// Energy Qs of a pulse, J, 1e-50 to 1e50. Default 3.6e-4.
  vtkAvianLidarPropertyMacro(PulseEnergy, double, 3.6e-4);

  /// Length tau_e of the rectangular pulse, or full width at half maximum of the Gaussian pulse, s,
  /// 0 to 1000 sampling intervals. Not used with PULSE_SHAPE_SAMPLES. Default 5e-9.
  vtkAvianLidarPropertyMacro(PulseWidth, double, 5e-9);

  ///@{
  /// Shape of the emitted pulse. Default PULSE_SHAPE_RECTANGLE, as in the paper. The mean time of
  /// each shape is the delay of its path, so a shape moves no range. The samples of
  /// PULSE_SHAPE_SAMPLES come from PulseFileName, or from `pulse_times` and `pulse_powers` of a
  /// sensor file.
  vtkAvianLidarPropertyMacro(PulseShape, int, PULSE_SHAPE_RECTANGLE);
  void SetPulseShapeToRectangle() { this->SetPulseShape(PULSE_SHAPE_RECTANGLE); }
  void SetPulseShapeToGaussian() { this->SetPulseShape(PULSE_SHAPE_GAUSSIAN); }
  void SetPulseShapeToSamples() { this->SetPulseShape(PULSE_SHAPE_SAMPLES); }
  ///@}

  /// CSV file of the pulse for PULSE_SHAPE_SAMPLES, with the header `time_s,power`: rising times,
  /// s, and powers, at least 0 in any unit, with straight lines between them. Default: no file.
  vtkAvianLidarFilePathMacro(PulseFileName);

  /// Full width at half maximum of the receiver's Gaussian response, s, 0 to 1000 sampling
  /// intervals. The receiver sees the pulse convolved with the response. Default 0: the receiver
  /// responds at once.
  vtkAvianLidarPropertyMacro(ResponseTime, double, 0.0);

  /// Samples per second of the waveforms of an echo filter, Hz: a whole number of samples, 1 to
  /// 100, in each SamplingInterval. Default 0: one sample. The rate acts on waveforms, and changes
  /// echoes of beams in cells by about 0.02 % while waveforms are recorded.
  vtkAvianLidarPropertyMacro(DigitiserRate, double, 0.0);

  /// Bits of a waveform's sample, 4 to 32. The highest level of the digitiser is the power that
  /// saturates a range unit. A sixteenth of the levels lies below 0 (assumed). Default 0: samples
  /// are not rounded.
  vtkAvianLidarPropertyMacro(DigitiserBits, double, 0.0);

  /// Frequency nu of the light, Hz, 1 to 1e30. Default 3.313e14 (905 nm).
  vtkAvianLidarPropertyMacro(Frequency, double, 3.313e14);

  ///@{
  /// Wavelength of the light, nm, 1e-6 to 3e17. The setter sets Frequency. Default 904.897247208.
  void SetWavelength(double nanometres);
  double GetWavelength();
  ///@}

  /// Length tau_s of a range unit in time, s, 1e-30 to 1e20. Default 5e-9 (0.75 m).
  vtkAvianLidarPropertyMacro(SamplingInterval, double, 5e-9);

  /// Greatest range recorded, m, above 0, at most 1e30 and 2^52 range units. Default 4000.
  vtkAvianLidarPropertyMacro(RangeGate, double, 4000.0);

  /// Range, m, beyond which echoes arrive after the next pulse has left; infinite for the beams of
  /// SetBeams(). A larger RangeGate gives one warning. The ranges of echoes are true even beyond
  /// this range (Documentation/reference/sensor-files.md).
  double GetUnambiguousRange();

  /// Mean rate of noise photons at the receiver, Hz, 0 to 1e50 (paper, Eq. 11). Default 20e3.
  vtkAvianLidarPropertyMacro(NoisePhotonRate, double, 20e3);

  /// Lower limit Qlow of the dynamic range, J, 0 to Qhigh (paper, Eq. 12). Default 2e-6.
  vtkAvianLidarPropertyMacro(LowerEnergyLimit, double, 2e-6);

  /// Upper limit Qhigh of the dynamic range, J, Qlow to 1e50 (paper, Eq. 12). Default 6.25e-5.
  vtkAvianLidarPropertyMacro(UpperEnergyLimit, double, 6.25e-5);

  /// Area of the receiver's aperture, m2, 0 to 1e20. Default 0: energies without the factor
  /// 1 / range^2.
  vtkAvianLidarPropertyMacro(ReceiverAperture, double, 0.0);

  ///@{
  /// Receiver that turns energies into echoes: the limits of the paper in J, or a photon receiver,
  /// which needs an aperture (Documentation/reference/sensor-files.md). Default
  /// RECEIVER_MODEL_ENERGY_LIMITS.
  vtkAvianLidarPropertyMacro(ReceiverModel, int, RECEIVER_MODEL_ENERGY_LIMITS);
  void SetReceiverModelToEnergyLimits() { this->SetReceiverModel(RECEIVER_MODEL_ENERGY_LIMITS); }
  void SetReceiverModelToPhotons() { this->SetReceiverModel(RECEIVER_MODEL_PHOTONS); }
  ///@}

  /// Number eta of electrons per photon in a photon receiver, 1, above 0 to 1. Default 0.4
  /// (assumed).
  vtkAvianLidarPropertyMacro(ReceiverEfficiency, double, 0.4);

  /// Width of a photon receiver's optical filter, nm, 0 to 1e6. Default 10 (assumed).
  vtkAvianLidarPropertyMacro(FilterBandwidth, double, 10.0);

  /// Background radiance L on a photon receiver, W/(m2 sr nm), 0 to 1e10. Default 0.05 (assumed).
  vtkAvianLidarPropertyMacro(BackgroundRadiance, double, 0.05);

  /// Noise n_a of a photon receiver's amplifier, electrons, 0 or 1e-3 to 1e20. Default 60
  /// (assumed).
  vtkAvianLidarPropertyMacro(AmplifierNoise, double, 60.0);

  /// Excess noise factor F of a photon receiver's avalanche, 1, 1 to 1e6. Default 3 (assumed).
  vtkAvianLidarPropertyMacro(ExcessNoiseFactor, double, 3.0);

  /// Spectral irradiance of the sun, W/(m2 nm), 0 to 1e10. Used only with a photon receiver.
  /// Default 0: no daylight.
  vtkAvianLidarPropertyMacro(Sunlight, double, 0.0);

  /// Azimuth of the sun, deg from north, clockwise, -360 to 360. Used only with Sunlight above 0.
  /// Default 180.
  vtkAvianLidarPropertyMacro(SunAzimuth, double, 180.0);

  /// Elevation of the sun, deg, -90 to 90. Used only with Sunlight above 0. Default 45.
  vtkAvianLidarPropertyMacro(SunElevation, double, 45.0);

  /// Least range recorded, m, 0 to below RangeGate. Nearer surfaces still hide farther surfaces.
  /// Default 0.
  vtkAvianLidarPropertyMacro(MinimumRange, double, 0.0);

  /// Range r_o in 1 - exp(-(r/r_o)^2), the share of light from range r that lies in the receiver's
  /// view, m, 0 to 1e9. Default 0: share 1.
  vtkAvianLidarPropertyMacro(OverlapRange, double, 0.0);

  /// Range r_d in 1 / (1 + (r_d/r)^2), the share of light from range r that lies in focus, m, 0 to
  /// 1e9. Default 0: share 1.
  vtkAvianLidarPropertyMacro(DefocusRange, double, 0.0);

  /// Coefficient b of the standard deviation of ranges, sqrt(a^2 + b^2/S^p), m, 0 to 1e9. S is the
  /// signal-to-noise ratio (at least 1), a is RangeNoiseFloor, and p is RangeNoiseExponent
  /// (Documentation/reference/sensor-files.md). Used only with a photon receiver. Default 0: exact.
  vtkAvianLidarPropertyMacro(RangeNoise, double, 0.0);

  /// Exponent p of S in the formula of RangeNoise, 1, 0 to 10. Used only with a photon receiver.
  /// Default 2.
  vtkAvianLidarPropertyMacro(RangeNoiseExponent, double, 2.0);

  /// Standard deviation a of the ranges of the strongest echoes, m, 0 to 1e9. Default 0.
  vtkAvianLidarPropertyMacro(RangeNoiseFloor, double, 0.0);

  /// Range error (walk) of an echo whose energy is the lower energy limit, m, 0 to 1e9. Stronger
  /// echoes have a smaller error. Default 0.
  vtkAvianLidarPropertyMacro(RangeWalk, double, 0.0);

  /// Step to which ranges are rounded, m, 0 (exact) or 1e-9 to 1e9. Default 0.
  vtkAvianLidarPropertyMacro(RangeQuantum, double, 0.0);

  /// Expected number of false alarms of a photon receiver in a scan of empty sky, 1, above 0 to
  /// 1e8. Default 1.
  vtkAvianLidarPropertyMacro(FalseAlarmsPerScan, double, 1.0);

  /// Ratio of the upper to the lower energy limit, in dB (10 log10 of the ratio of electrons), 0 to
  /// 1000. Default 40 (assumed).
  vtkAvianLidarPropertyMacro(DynamicRange, double, 40.0);

  ///@{
  /// Set LowerEnergyLimit from a line of a data sheet, and set UpperEnergyLimit so that this limit
  /// exceeds LowerEnergyLimit by DynamicRange. Up to `range`, m, the sensor then detects a
  /// Lambertian surface of `reflectance` (above 0 to 1) that fills the beam, in air of
  /// `attenuation`, 1/m (default: GetClearAirAttenuation()). The function needs ReceiverAperture
  /// and RECEIVER_MODEL_ENERGY_LIMITS. A bad value changes nothing. Limits from one line are only
  /// an estimate (Documentation/reference/sensor-files.md).
  void SetLimitsFromDataSheet(double range, double reflectance);
  void SetLimitsFromDataSheet(double range, double reflectance, double attenuation);
  ///@}

  /// Attenuation of clear air (23 km visibility) at Wavelength, 1/m.
  double GetClearAirAttenuation();

  /// Length of the lines of port 1, and range at which a beam report shows beams without an echo,
  /// m, above 0 to 1e30. Default 1000.
  vtkAvianLidarPropertyMacro(DisplayLength, double, 1000.0);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarBeamSource();
  ~vtkAvianLidarBeamSource() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  /// Read a sensor file. With `keepPlace`, position, orientation, revolutions, steps and seed are
  /// kept. @return an error text for a bad file, which changes nothing; else an empty string
  std::string ReadSensor(const char* fileName, bool keepPlace);

  std::vector<double> ChannelElevations;
  std::vector<double> ChannelAzimuthOffsets;
  std::vector<double> ChannelFiringTimes;
  std::vector<double> BlankedSectors; ///< azimuths of start and end in turn, deg
  std::vector<double> PrismWedgeAngles;
  std::vector<double> PrismRefractiveIndices;
  std::vector<double> PrismRotationRates;
  std::vector<double> PrismPhases;
  std::vector<double> PulseTimes;
  std::vector<double> PulsePowers;
  double PrismAxisElevation = 0.0;
  double PrismAxisRotationRate = 0.0;
  double PrismLaserRotationRate = 0.0;
  std::string Description;
  /// Properties that a file marks as assumed, by names in snake case, and their values.
  std::vector<std::pair<std::string, std::vector<double>>> Assumed;

private:
  vtkAvianLidarBeamSource(const vtkAvianLidarBeamSource&) = delete;
  void operator=(const vtkAvianLidarBeamSource&) = delete;

  bool HasChannelElevation(int index);
  bool IsGood(const char* what, const std::string& error);
  void TakeProperties(const vtkAvianLidarBeamSource& preset);
  void TakePreset(const char* name);
  std::string TakeFile(const std::function<vtkAvianLidarSensorFile()>& read, bool keepPlace);
  struct vtkInternals;
  struct vtkBeamTable;
  struct vtkTrajectory;
  std::string Warned;                        ///< warning given last, which is not repeated
  std::shared_ptr<const vtkBeamTable> Table; ///< beams of SetBeams(), or null
  std::shared_ptr<vtkTrajectory> Trajectory; ///< poses that were read last
};

#endif
