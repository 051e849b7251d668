// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarBeamSource
 * @brief The sensor: the beams of a rotating multichannel avian lidar; a new one is Airport16.
 *
 * Everything that belongs to the instrument (scan pattern, beam, pulse, receiver; paper, Table 2)
 * is a property of this source and travels with the beams as field data. No input. The paper is
 * "Research on Ground Object Echo Simulation of Avian Lidar", Photonics 2024, 11(2), 153.
 *
 * **Output port 0** (vtkPolyData): one vertex per beam, all at `Position`. Points are double. Beams
 * are ordered column by column (a column is one azimuth), channel by channel within a column. Point
 * arrays, one component each unless noted:
 *
 * - `beam_id` (vtkIdType): column * channels + channel; unique over all pieces
 * - `direction` (double, 3 components): unit vector of the beam's axis (x east, y north, z up)
 * - `laser_id` (int): index of the channel
 * - `azimuth` (double, 0.01 deg): from north (y), clockwise seen from above, in [0, 36000)
 * - `vertical_angle` (double, deg): from the horizontal plane, up
 * - `timestamp` (double, us): time of firing since the start of the scan
 * - `reported_direction` (double, 3 components): only with sway or jitter, see below
 *
 * `azimuth` and `vertical_angle` are those of the direction in the scene.
 *
 * **Output port 1** (vtkPolyData): the same rays as lines of `DisplayLength`, to look at, with
 * `beam_id`, `laser_id` and `timestamp` as cell data.
 *
 * **Field data** of both ports: every property in snake case, one tuple each, in the property's
 * unit, and `wavelength`; not those of sway, jitter and tables that are not used;
 * where there is a table, `channel_elevations` with one value per channel; with prisms theirs
 * (GetNumberOfPrisms()), without `azimuth_range` and `azimuth_step`; and `revolution`, the
 * number of the revolution that these beams are of; with sway `sway_amplitude` and
 * `sway_frequency`, with jitter `encoder_jitter`, with either `motion_seed`; with the photon
 * receiver `assumed`, the names of those values in use that nobody has measured, and so with any
 * receiver whose file assumes some. With the photon receiver `lower_energy_limit` and
 * `upper_energy_limit` are those that follow from it.
 *
 * **Receivers.** `EnergyLimits` is the paper's: an echo is what exceeds a limit in joules, and its
 * radiometry has no fall with the square of the range unless `ReceiverAperture` is set: a wall at 3
 * km is as bright as one at 50 m. `Photons` counts electrons (see SetReceiverModel()): use it where
 * it matters how far small things are seen.
 *
 * Units are attached to the arrays (vtkDataArray::UNITS_LABEL): "1" for ratios, counts and choices;
 * none for the identifiers `beam_id`, `laser_id`, `revolution` and `motion_seed`.
 *
 * **Clock.** Within a column the channels fire in the staggered order of Fig. 1b, 0, C/2, 1, C/2 +
 * 1, ... (for an odd C, C/2 is rounded up), so timestamp = column / (columns * RotationRate) + slot
 * * FiringInterval. All channels of a column share its azimuth: the turn of the rotor between the
 * firings of one column is not modelled.
 *
 * **Prisms.** Where a sensor has rotating prisms (GetNumberOfPrisms()), its pattern does not
 * repeat: a scan is a window of 1 / RotationRate seconds, revolution k the one from k /
 * RotationRate on. Lasers fire on and on, one after the other in the same order, at FiringInterval;
 * a column is one firing of each. Elevations and azimuth offsets of the channels are those of their
 * light before the prisms. AzimuthRange and AzimuthStep are not used, and not in the field data.
 *
 * **Time.** The source is time-aware. Revolution k (any int) lasts from k / RotationRate to (k + 1)
 * / RotationRate seconds, and has its k / RotationRate in the timestamps. It publishes the steps to
 * play, (k + j / StepsPerRevolution) / RotationRate for NumberOfRevolutions revolutions (TIME_STEPS
 * and TIME_RANGE; of one step alone only the range 0 to 0): at step j the beams are there that were
 * fired before the share (j + 1) / StepsPerRevolution of the revolution is over. Any other time is
 * served by what stood at the last step before it (less than 1e-9 of a step before one it is that
 * step's); a time whose revolution is not an int is an error. As long as no time has been asked for
 * there is the whole of revolution 0. Without sway, jitter and prisms all revolutions have the same
 * values but `timestamp`.
 *
 * **Mast sway and encoder jitter**, both off by default: a mast tilts the sensor about both
 * horizontal axes, the encoder gives each column an error of its azimuth. The sensor knows of
 * neither: `direction` is where the beam really points, at its own timestamp, and
 * `reported_direction`, `azimuth` and `vertical_angle` are what the sensor reports; echoes lie
 * along `reported_direction`. Port 1 shows the real rays. The beams then differ in each revolution.
 *
 * **Pieces.** Any number of pieces is served; columns are dealt to them in turn (column c to piece
 * c mod pieces), and all pieces together are the whole scan.
 *
 * **Bad values** (not finite, outside the range that the property states, a column too short for
 * its firings) are an error that names the property, with both outputs empty; so are more beams
 * than there is memory for. Setters keep what they are given; the check is made when the source
 * executes. Beams are the same bits for any number of threads and pieces.
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarRangeImage
 */
#ifndef vtkAvianLidarBeamSource_h
#define vtkAvianLidarBeamSource_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarSensorPresets.h"
#include "vtkPolyDataAlgorithm.h"

#include <functional> // For std::function
#include <memory>     // For std::shared_ptr
#include <string>     // For std::string
#include <utility>    // For std::pair
#include <vector>     // For std::vector

class vtkPolyData;
struct vtkAvianLidarSensorFile;
class VTKAVIANLIDAR_EXPORT vtkAvianLidarBeamSource : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarBeamSource* New();
  vtkTypeMacro(vtkAvianLidarBeamSource, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Values of BeamProfile.
  enum BeamProfiles
  {
    BEAM_PROFILE_UNIFORM = 0,
    BEAM_PROFILE_GAUSSIAN = 1
  };

  /// Values of BeamOutline.
  enum BeamOutlines
  {
    BEAM_OUTLINE_ELLIPSE = 0,
    BEAM_OUTLINE_RECTANGLE = 1
  };

  /// Values of ReceiverModel.
  enum ReceiverModels
  {
    RECEIVER_MODEL_ENERGY_LIMITS = 0,
    RECEIVER_MODEL_PHOTONS = 1
  };

  /// Values of ThresholdLaw.
  enum ThresholdLaws
  {
    THRESHOLD_LAW_FIXED = 0,
    THRESHOLD_LAW_FOLLOWS_AIR = 1
  };

  ///@{
  /**
   * Set all properties but ErrorsAsData to those of a sensor that is built in (the files in
   * Filters/Sensors say where each number comes from). What a file does not name, position and
   * orientation among it, gets the default of this class.
   *
   * `Airport16` and `Airport32` are the lidar of the paper's Sec. 5.3 with 16 and 32 channels from
   * 0 degrees up in steps of 6/16 and 6/32 degrees and the same step in azimuth (960 x 16 and 1920
   * x 32 beams), 0.5 Hz, 30 us between firings, 3.6e-4 J, gate 4000 m. `CorridorC16` is the lidar
   * of Sec. 5.2: 16 channels from -15 to +15 degrees, 180 columns, 10 Hz, 5 us, 2.5e-4 J, gate 200
   * m. In these three the half-beamwidth is 5.6e-3 rad, the pulse and the range unit last 5 ns, the
   * limits are 2e-6 and 6.25e-5 J, the frequency is 3.313e14 Hz and noise arrives at 20e3 photons
   * per second.
   *
   * Three have a photon receiver, whose numbers are assumed: `Search905` (transmitter and pattern
   * of Airport16), `Search1550` and `Automotive16`.
   *
   * The others are lidars that can be bought, with the pattern, wavelength and range of their
   * manuals; what these do not tell is assumed (`assumed` in the field data). Those of Ouster and
   * Livox have photon receivers fitted to their sheets, the others limits that see what the manual
   * says. Mid40, Avia and Mid360 have rotating prisms (GetNumberOfPrisms()); of Mid360 the pattern
   * is assumed.
   */
  vtkAvianLidarSensorPresetsMacro();
  ///@}

  /**
   * Of a sensor that is built in, by the name of its file (`OS1_64`), only what no other method of
   * this class sets: the tables of files and the prisms, the names of what is assumed, and the
   * description. For a user interface that sets all properties one by one. Null or empty: none. An
   * unknown name is an error and changes nothing.
   */
  void SetTablesOfPreset(const char* name);

  /**
   * The same from a file (`.lidarsensor.json`, see the page on sensors). Of files alone, and field
   * data where they are given, are `channel_azimuth_offsets` (deg, of a channel's beam from the
   * column), `channel_firing_times` (s, since the column begins, instead of FiringInterval),
   * `blanked_sectors` (deg, pairs: no beams from the one azimuth until before the other), and the
   * prisms of GetNumberOfPrisms(). @return false, with an error that names the file and the key,
   * where it is not one: then nothing changes.
   */
  bool LoadSensor(VTK_FILEPATH const char* fileName);

  /**
   * Number of rotating prisms that steer the beams, at most 3; 0, the default: none. A file sets
   * them, a value for each: `prism_wedge_angles` (deg, -60 to 60; above 0 light leaves by the
   * inclined face, below 0 it enters by it), `prism_refractive_indices` (1 to 4),
   * `prism_rotation_rates` (Hz, -1e6 to 1e6; above 0 clockwise as the sensor sees it) and
   * `prism_phases` (deg, -360 to 360; where it deflects to at time 0: 0 is up, 90 right; default
   * 0); and of their axis `prism_axis_elevation` (deg, -90 to 90, default 0) and
   * `prism_axis_rotation_rate` (Hz, -1e6 to 1e6, about the vertical, clockwise seen from above,
   * default 0). At time 0 the axis points to the sensor's front.
   */
  int GetNumberOfPrisms() const;

  /// The same of a file's text, as GetDescription() has it; errors name it "the text".
  bool LoadSensorText(const char* text);

  /**
   * What the file of the sensor says, as JSON: its name, what it is (`comment`), its documents
   * (`source`), each number with its unit and source, and what no property has (`data_sheet`). Of
   * the preset or file that was set last; empty for a new object. Later changes do not count.
   */
  std::string GetDescription() const { return this->Description; }

  /**
   * Any beams instead of columns and channels: points of which the point array `direction` (any
   * length above 0) and, unless all fire at once, `timestamp` (us since the scan began, within 0 to
   * 1 / RotationRate) are taken, and the coordinates (m). All are those of the sensor's frame:
   * Orientation turns them, Position is added. `beam_id` is the number of the point, `laser_id` 0;
   * field data have no properties of the pattern. The points are copied. Null, a preset or a file
   * ends this. @return false, with an error that names the array, for others: then nothing changes.
   */
  bool SetBeams(vtkPolyData* beams);

  ///@{
  /**
   * Where the sensor stands, in metres, in the coordinates of the scene, at most 1e30. Default
   * (0, 0, 0).
   */
  vtkSetVector3Macro(Position, double);
  vtkGetVector3Macro(Position, double);
  ///@}

  ///@{
  /**
   * Yaw (clockwise from north), pitch (nose up) and roll (to the right) in degrees; R = yaw * pitch
   * * roll. Any finite angles. Default (0, 0, 0).
   */
  vtkSetVector3Macro(Orientation, double);
  vtkGetVector3Macro(Orientation, double);
  ///@}

  ///@{
  /**
   * Number of channels, at least 1. Not used when there is a table of elevations, whose length it
   * then is. Default 16.
   */
  vtkSetMacro(NumberOfChannels, int);
  vtkGetMacro(NumberOfChannels, int);
  ///@}

  ///@{
  /**
   * Elevation of channel 0 in degrees, in the sensor's frame, within [-90, 90]. Not used when there
   * is a table. Default 0.
   */
  vtkSetMacro(MinimumElevation, double);
  vtkGetMacro(MinimumElevation, double);
  ///@}

  ///@{
  /**
   * Elevation from one channel to the next in degrees, above 0; the last channel must stay within
   * 90 degrees. Not used when there is a table. Default 0.375.
   */
  vtkSetMacro(ElevationStep, double);
  vtkGetMacro(ElevationStep, double);
  ///@}

  ///@{
  /**
   * Optional table: the elevation of each channel in degrees, within [-90, 90], in any order; it
   * replaces NumberOfChannels, MinimumElevation and ElevationStep. New entries are 0; an index
   * outside the table is an error, and so is a table for which there is no memory. Default: empty.
   */
  void SetNumberOfChannelElevations(int number);
  int GetNumberOfChannelElevations() const;
  void SetChannelElevation(int index, double elevation);
  double GetChannelElevation(int index);
  ///@}

  ///@{
  /**
   * First azimuth and end (excluded) in degrees from north, clockwise, before yaw. The start lies
   * within [-360, 360], the end after it and at most 360 degrees away. Default (0, 360).
   */
  vtkSetVector2Macro(AzimuthRange, double);
  vtkGetVector2Macro(AzimuthRange, double);
  ///@}

  ///@{
  /**
   * Azimuth from one column to the next in degrees, above 0. Default 0.375.
   */
  vtkSetMacro(AzimuthStep, double);
  vtkGetMacro(AzimuthStep, double);
  ///@}

  ///@{
  /**
   * Half of the beam's full opening angle in radians, 1e-9 to pi/3 (60 degrees), or 0.1 if the beam
   * is not round. Default 5.6e-3.
   */
  vtkSetMacro(HalfBeamwidth, double);
  vtkGetMacro(HalfBeamwidth, double);
  ///@}

  ///@{
  /**
   * The beam's full opening angle in milliradians, where a user interface has it beside
   * HalfBeamwidth. It is compared, not used: unless it is 0, the default, beams are an error where
   * it is not 2000 times HalfBeamwidth, but for rounding.
   */
  vtkSetMacro(BeamwidthMilliradians, double);
  vtkGetMacro(BeamwidthMilliradians, double);
  ///@}

  ///@{
  /**
   * Outline of the beam in the plane across its axis: an ellipse (with HalfBeamwidthAcross 0 a
   * disc, the paper's), or a rectangle (with 0 a square). Default BEAM_OUTLINE_ELLIPSE.
   */
  vtkSetMacro(BeamOutline, int);
  vtkGetMacro(BeamOutline, int);
  void SetBeamOutlineToEllipse() { this->SetBeamOutline(BEAM_OUTLINE_ELLIPSE); }
  void SetBeamOutlineToRectangle() { this->SetBeamOutline(BEAM_OUTLINE_RECTANGLE); }
  ///@}

  ///@{
  /**
   * Half of the opening angle across the direction of HalfBeamwidth in radians, 1e-9 to 0.1, and
   * 1/1000 to 1000 times that. Default 0: as wide as there. The energy of a beam that is not round
   * is uniform over the plane across its axis, or Gaussian there.
   */
  vtkSetMacro(HalfBeamwidthAcross, double);
  vtkGetMacro(HalfBeamwidthAcross, double);
  ///@}

  ///@{
  /**
   * Turn of the direction of HalfBeamwidth from the horizontal of the sensor (of a beam straight up
   * from a direction of its own) upwards, on the right of someone who looks along the beam, in
   * degrees, -360 to 360. Default 0.
   */
  vtkSetMacro(BeamRotation, double);
  vtkGetMacro(BeamRotation, double);
  ///@}

  ///@{
  /**
   * Distribution of the energy within the beam: uniform in solid angle (the paper), or Gaussian,
   * cut at the outline (see GaussianTruncation). Default BEAM_PROFILE_UNIFORM.
   */
  vtkSetMacro(BeamProfile, int);
  vtkGetMacro(BeamProfile, int);
  void SetBeamProfileToUniform() { this->SetBeamProfile(BEAM_PROFILE_UNIFORM); }
  void SetBeamProfileToGaussian() { this->SetBeamProfile(BEAM_PROFILE_GAUSSIAN); }
  ///@}

  ///@{
  /**
   * Where the Gaussian profile is cut: half-beamwidths over its radii of 1/e^2, a pure number, 0.1
   * to 3. Default 1: it falls to 1/e^2 at the half-beamwidth.
   */
  vtkSetMacro(GaussianTruncation, double);
  vtkGetMacro(GaussianTruncation, double);
  ///@}

  ///@{
  /**
   * What a photon receiver's threshold does where the air sends light back: THRESHOLD_LAW_FIXED (it
   * stays; near the sensor the air becomes echoes), or THRESHOLD_LAW_FOLLOWS_AIR, the default: the
   * mean of that light is taken off, and as many standard deviations of its noise lie above.
   */
  vtkSetMacro(ThresholdLaw, int);
  vtkGetMacro(ThresholdLaw, int);
  void SetThresholdLawToFixed() { this->SetThresholdLaw(THRESHOLD_LAW_FIXED); }
  void SetThresholdLawToFollowsAir() { this->SetThresholdLaw(THRESHOLD_LAW_FOLLOWS_AIR); }
  ///@}

  ///@{
  /**
   * Sweeps over the azimuth range (turns, when that is the full circle) per second in hertz, with
   * prisms scans per second, 1e-20 to 1e20. Default 0.5.
   */
  vtkSetMacro(RotationRate, double);
  vtkGetMacro(RotationRate, double);
  ///@}

  ///@{
  /**
   * Time between two firings of a column in seconds, at least 0 (above 0 with prisms, whose columns
   * follow each other without a pause); all firings of a column have to
   * fit into the column's time 1 / (columns * RotationRate). Default 30e-6.
   */
  vtkSetMacro(FiringInterval, double);
  vtkGetMacro(FiringInterval, double);
  ///@}

  ///@{
  /**
   * How many revolutions there are to play, at least 1; other times are served all the same. At
   * most 1e6 steps in all. Default 1.
   */
  vtkSetMacro(NumberOfRevolutions, int);
  vtkGetMacro(NumberOfRevolutions, int);
  ///@}

  ///@{
  /**
   * In how many steps playing shows a revolution, at least 1 and at most the number of columns.
   * With more than 1 the scan sweeps: each step has the beams fired until its end. Default 1.
   */
  vtkSetMacro(StepsPerRevolution, int);
  vtkGetMacro(StepsPerRevolution, int);
  ///@}

  ///@{
  /**
   * Sway of the mast: the rms of its tilt about each of the two horizontal axes in degrees, 0 to 10
   * (1 mrad is 0.0573 degrees). The tilt is a narrow-band random motion around SwayFrequency and
   * stays below 5.7 times its rms. The sensor turns about its own position; that it moves with the
   * top of the mast is not modelled. Default 0: none.
   */
  vtkSetMacro(SwayAmplitude, double);
  vtkGetMacro(SwayAmplitude, double);
  ///@}

  ///@{
  /**
   * Frequency of the sway in hertz, 1e-6 to 1e6; the motion fills a band of 20 % to each side.
   * Default 0.5 (assumed). Without sway not used.
   */
  vtkSetMacro(SwayFrequency, double);
  vtkGetMacro(SwayFrequency, double);
  ///@}

  ///@{
  /**
   * Jitter of the encoder: the rms of the error of a column's azimuth in degrees, 0 to 10. It is a
   * normal deviate, the same for all channels of a column, another one for each column and each
   * revolution. With prisms 0. Default 0: none.
   */
  vtkSetMacro(EncoderJitter, double);
  vtkGetMacro(EncoderJitter, double);
  ///@}

  ///@{
  /**
   * Seed of sway and jitter, any int: another seed, another motion of the same size. Default 0.
   */
  vtkSetMacro(MotionSeed, int);
  vtkGetMacro(MotionSeed, int);
  ///@}

  ///@{
  /**
   * Energy of a pulse Qs in joules, 1e-50 to 1e50. Default 3.6e-4.
   */
  vtkSetMacro(PulseEnergy, double);
  vtkGetMacro(PulseEnergy, double);
  ///@}

  ///@{
  /**
   * Length of the rectangular pulse tau_e in seconds, at least 0 and at most 1000 sampling
   * intervals. Default 5e-9.
   */
  vtkSetMacro(PulseWidth, double);
  vtkGetMacro(PulseWidth, double);
  ///@}

  ///@{
  /**
   * Frequency of the light nu in hertz, 1 to 1e30. Default 3.313e14 (905 nm).
   */
  vtkSetMacro(Frequency, double);
  vtkGetMacro(Frequency, double);
  ///@}

  ///@{
  /**
   * The same as a wavelength in nanometres, 1e-6 to 3e17, rounded to 1e-9 nm. Default
   * 904.897247208.
   */
  void SetWavelength(double nanometres);
  double GetWavelength();
  ///@}

  ///@{
  /**
   * Length of a range unit in time tau_s in seconds, 1e-30 to 1e20; a unit is c * tau_s / 2 long.
   * Default 5e-9 (0.75 m).
   */
  vtkSetMacro(SamplingInterval, double);
  vtkGetMacro(SamplingInterval, double);
  ///@}

  ///@{
  /**
   * Greatest range that is recorded in metres, above 0, at most 1e30 and at most 2^52 range units.
   * Default 4000.
   */
  vtkSetMacro(RangeGate, double);
  vtkGetMacro(RangeGate, double);
  ///@}

  /**
   * Range in metres from which echoes arrive after the next pulse has left: c/2 times
   * FiringInterval, or times what a column lasts where each channel has a receiver of its own
   * (`channel_firing_times` of a file, a FiringInterval of 0, one channel). Infinite for
   * SetBeams(). A RangeGate beyond it is warned of once; echoes stay where they are.
   */
  double GetUnambiguousRange();

  ///@{
  /**
   * Mean rate of noise photons at the receiver in hertz, 0 to 1e50 (paper, Eq. 11). Default 20e3.
   */
  vtkSetMacro(NoisePhotonRate, double);
  vtkGetMacro(NoisePhotonRate, double);
  ///@}

  ///@{
  /**
   * Lower limit of the receiver's dynamic range Qlow in joules, 0 to Qhigh (paper, Eq. 12). Default
   * 2e-6.
   */
  vtkSetMacro(LowerEnergyLimit, double);
  vtkGetMacro(LowerEnergyLimit, double);
  ///@}

  ///@{
  /**
   * Upper limit of the receiver's dynamic range Qhigh in joules, Qlow to 1e50 (paper, Eq. 12).
   * Default 6.25e-5.
   */
  vtkSetMacro(UpperEnergyLimit, double);
  vtkGetMacro(UpperEnergyLimit, double);
  ///@}

  ///@{
  /**
   * Area of the receiver's aperture in square metres, 0 to 1e20. With 0, the default, the
   * radiometry is the paper's, which has no fall of the energy with the square of the range; a
   * sensor with an aperture needs limits of its own.
   */
  vtkSetMacro(ReceiverAperture, double);
  vtkGetMacro(ReceiverAperture, double);
  ///@}

  ///@{
  /**
   * What turns energies into echoes. RECEIVER_MODEL_ENERGY_LIMITS, the default, is the paper's:
   * LowerEnergyLimit, UpperEnergyLimit, NoisePhotonRate. RECEIVER_MODEL_PHOTONS: an energy Q at the
   * aperture, which must be above 0, makes eta Q/(h nu) electrons; a range unit has Gaussian noise
   * of variance F (n + n_b) + n_a^2, the mean of the background is removed. The lower limit is k
   * standard deviations of an empty unit, k such that a scan of empty sky has FalseAlarmsPerScan;
   * the three numbers of the other are not used.
   */
  vtkSetMacro(ReceiverModel, int);
  vtkGetMacro(ReceiverModel, int);
  void SetReceiverModelToEnergyLimits() { this->SetReceiverModel(RECEIVER_MODEL_ENERGY_LIMITS); }
  void SetReceiverModelToPhotons() { this->SetReceiverModel(RECEIVER_MODEL_PHOTONS); }
  ///@}

  ///@{
  /**
   * Electrons per photon at the aperture eta, optics and detector together, above 0, at most 1.
   * Photon receiver. Default 0.4 (assumed).
   */
  vtkSetMacro(ReceiverEfficiency, double);
  vtkGetMacro(ReceiverEfficiency, double);
  ///@}

  ///@{
  /**
   * Width of the optical filter in nanometres, 0 to 1e6. Photon receiver. Default 10 (assumed).
   */
  vtkSetMacro(FilterBandwidth, double);
  vtkGetMacro(FilterBandwidth, double);
  ///@}

  ///@{
  /**
   * Radiance of the background L in W/(m2 sr nm), watts per square metre, steradian and nanometre,
   * 0 (night) to 1e10; the field of view is the beam. Photon receiver. Default 0.05 (assumed:
   * daylight at 905 nm).
   */
  vtkSetMacro(BackgroundRadiance, double);
  vtkGetMacro(BackgroundRadiance, double);
  ///@}

  ///@{
  /**
   * Noise of the amplifier n_a, electrons rms in a range unit, 0 or 1e-3 to 1e20. Photon receiver.
   * Default 60 (assumed).
   */
  vtkSetMacro(AmplifierNoise, double);
  vtkGetMacro(AmplifierNoise, double);
  ///@}

  ///@{
  /**
   * Excess noise factor F of the avalanche, 1 to 1e6. Photon receiver. Default 3 (assumed).
   */
  vtkSetMacro(ExcessNoiseFactor, double);
  vtkGetMacro(ExcessNoiseFactor, double);
  ///@}

  ///@{
  /**
   * Spectral irradiance of the sun on a surface that faces it, watts per square metre and
   * nanometre, 0 to 1e10 (clear noon: about 0.7 at 905 nm). Above 0, each beam has the background
   * of what it looks at, sky or lit surfaces; its noise and, where it is brighter than the sky, its
   * threshold follow (Documentation/sensors.md), and echoes have `seen_radiance`. Photon receiver.
   * Default 0.
   */
  vtkSetMacro(Sunlight, double);
  vtkGetMacro(Sunlight, double);
  ///@}

  ///@{
  /**
   * Where the sun stands: degrees from north, clockwise, -360 to 360. With Sunlight. Default 180,
   * south.
   */
  vtkSetMacro(SunAzimuth, double);
  vtkGetMacro(SunAzimuth, double);
  ///@}

  ///@{
  /**
   * How high the sun stands: degrees above the horizon, -90 to 90. With Sunlight. Default 45.
   */
  vtkSetMacro(SunElevation, double);
  vtkGetMacro(SunElevation, double);
  ///@}

  ///@{
  /**
   * Least range that is recorded in metres, 0 to less than RangeGate: what arrives earlier is no
   * echo, and surfaces there still hide what is behind. Default 0.
   */
  vtkSetMacro(MinimumRange, double);
  vtkGetMacro(MinimumRange, double);
  ///@}

  ///@{
  /**
   * Range r_o, metres, 0 to 1e9, of the overlap of beam and view: 1 - exp(-(r/r_o)^2) of the light
   * from the range r lies in the view. Default 0: all of it.
   */
  vtkSetMacro(OverlapRange, double);
  vtkGetMacro(OverlapRange, double);
  ///@}

  ///@{
  /**
   * Range r_d, metres, 0 to 1e9, at which half of the image of a spot falls on the detector, as it
   * is out of focus: 1/(1 + (r_d/r)^2) of the light from the range r. Default 0: all of it.
   */
  vtkSetMacro(DefocusRange, double);
  vtkGetMacro(DefocusRange, double);
  ///@}

  ///@{
  /**
   * Standard deviation b of the ranges of returns at S = 1, metres, 0 to 1e9. It is sqrt(a^2 +
   * b^2/S^p), S the signal-to-noise ratio of a pulse's flanks (Documentation/sensors.md), a
   * RangeNoiseFloor, p RangeNoiseExponent; it belongs to a pulse and a SamplingInterval (0.649
   * range units for a pulse of one unit). Drawn where the echo filter has Noise; then echoes have
   * `distance_std_error`. Photon receiver. Default 0: ranges are exact, as in the paper.
   */
  vtkSetMacro(RangeNoise, double);
  vtkGetMacro(RangeNoise, double);
  ///@}

  ///@{
  /**
   * Power p of the signal-to-noise ratio by which the variance of ranges falls, 0 to 10. Photon
   * receiver. Default 2.
   */
  vtkSetMacro(RangeNoiseExponent, double);
  vtkGetMacro(RangeNoiseExponent, double);
  ///@}

  ///@{
  /**
   * Standard deviation a of the ranges of the strongest echoes, metres, 0 to 1e9. Default 0.
   */
  vtkSetMacro(RangeNoiseFloor, double);
  vtkGetMacro(RangeNoiseFloor, double);
  ///@}

  ///@{
  /**
   * Walk of a leading edge: how far beyond its place an echo at the lower limit is said to be,
   * metres, 0 to 1e9. It falls with the energy. Default 0.
   */
  vtkSetMacro(RangeWalk, double);
  vtkGetMacro(RangeWalk, double);
  ///@}

  ///@{
  /**
   * Ranges are multiples of this, metres, 0 (exact) or 1e-9 to 1e9. Default 0.
   */
  vtkSetMacro(RangeQuantum, double);
  vtkGetMacro(RangeQuantum, double);
  ///@}

  ///@{
  /**
   * False alarms expected in a whole scan of empty sky, above 0, at most 1e8 and less than a tenth
   * of its range units. Photon receiver. A warning says where a real one would have ten times as
   * many, as noise of few electrons is not Gaussian. Default 1.
   */
  vtkSetMacro(FalseAlarmsPerScan, double);
  vtkGetMacro(FalseAlarmsPerScan, double);
  ///@}

  ///@{
  /**
   * From the lower limit to the upper one, where the receiver saturates, in decibels of electrons
   * (10 log10), 0 to 1000. Photon receiver, and SetLimitsFromDataSheet(). Default 40 (assumed).
   */
  vtkSetMacro(DynamicRange, double);
  vtkGetMacro(DynamicRange, double);
  ///@}

  ///@{
  /**
   * Set LowerEnergyLimit and UpperEnergyLimit (DynamicRange above it) by a line of a data sheet:
   * the sensor sees a Lambertian surface of `reflectance` (above 0, at most 1) that fills the beam
   * until `range` in metres, through air of `attenuation` in 1/m, by default clear air. One point
   * is a guess: others of its sheet were predicted up to 58 % wrong (Documentation/sensors.md,
   * Fitted to a sheet). Needs ReceiverAperture; for RECEIVER_MODEL_ENERGY_LIMITS. A bad value
   * changes nothing.
   */
  void SetLimitsFromDataSheet(double range, double reflectance);
  void SetLimitsFromDataSheet(double range, double reflectance, double attenuation);
  ///@}

  /**
   * Attenuation in 1/m of clear air, of a visibility of 23 km, at Wavelength.
   */
  double GetClearAirAttenuation();

  ///@{
  /**
   * Length of the lines of port 1 in metres, above 0 and at most 1e30; also where the beam report
   * puts a beam without an echo. Default 1000.
   */
  vtkSetMacro(DisplayLength, double);
  vtkGetMacro(DisplayLength, double);
  ///@}

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarBeamSource();
  ~vtkAvianLidarBeamSource() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  /// Take a file. With `keepPlace` position, orientation, revolutions, steps and seed stay.
  /// @return what is wrong, then nothing changes
  std::string ReadSensor(const char* fileName, bool keepPlace);

  double Position[3] = { 0.0, 0.0, 0.0 };
  double Orientation[3] = { 0.0, 0.0, 0.0 };
  int NumberOfChannels = 16;
  double MinimumElevation = 0.0;
  double ElevationStep = 0.375;
  std::vector<double> ChannelElevations;
  std::vector<double> ChannelAzimuthOffsets;
  std::vector<double> ChannelFiringTimes;
  std::vector<double> BlankedSectors; ///< from, to, from, to, ...
  std::vector<double> PrismWedgeAngles;
  std::vector<double> PrismRefractiveIndices;
  std::vector<double> PrismRotationRates;
  std::vector<double> PrismPhases;
  double PrismAxisElevation = 0.0;
  double PrismAxisRotationRate = 0.0;
  double AzimuthRange[2] = { 0.0, 360.0 };
  double AzimuthStep = 0.375;
  double HalfBeamwidth = 5.6e-3;
  double BeamwidthMilliradians = 0.0;
  int BeamOutline = BEAM_OUTLINE_ELLIPSE;
  double HalfBeamwidthAcross = 0.0;
  double BeamRotation = 0.0;
  int BeamProfile = BEAM_PROFILE_UNIFORM;
  double GaussianTruncation = 1.0;
  int ThresholdLaw = THRESHOLD_LAW_FOLLOWS_AIR;
  double RotationRate = 0.5;
  double FiringInterval = 30e-6;
  int NumberOfRevolutions = 1;
  int StepsPerRevolution = 1;
  double SwayAmplitude = 0.0;
  double SwayFrequency = 0.5;
  double EncoderJitter = 0.0;
  int MotionSeed = 0;
  double PulseEnergy = 3.6e-4;
  double PulseWidth = 5e-9;
  double Frequency = 3.313e14;
  double SamplingInterval = 5e-9;
  double RangeGate = 4000.0;
  double NoisePhotonRate = 20e3;
  double LowerEnergyLimit = 2e-6;
  double UpperEnergyLimit = 6.25e-5;
  double ReceiverAperture = 0.0;
  int ReceiverModel = RECEIVER_MODEL_ENERGY_LIMITS;
  double ReceiverEfficiency = 0.4;
  double FilterBandwidth = 10.0;
  double BackgroundRadiance = 0.05;
  double AmplifierNoise = 60.0;
  double ExcessNoiseFactor = 3.0;
  double FalseAlarmsPerScan = 1.0;
  double DynamicRange = 40.0;
  double Sunlight = 0.0;
  double SunAzimuth = 180.0;
  double SunElevation = 45.0;
  double MinimumRange = 0.0;
  double OverlapRange = 0.0;
  double DefocusRange = 0.0;
  double RangeNoise = 0.0;
  double RangeNoiseExponent = 2.0;
  double RangeNoiseFloor = 0.0;
  double RangeWalk = 0.0;
  double RangeQuantum = 0.0;
  double DisplayLength = 1000.0;
  std::string Description;
  /// Properties that a file calls assumed, in snake case, and their values.
  std::vector<std::pair<std::string, std::vector<double>>> Assumed;

private:
  vtkAvianLidarBeamSource(const vtkAvianLidarBeamSource&) = delete;
  void operator=(const vtkAvianLidarBeamSource&) = delete;

  void TakeProperties(const vtkAvianLidarBeamSource& preset);
  void TakePreset(const char* name);
  std::string TakeFile(const std::function<vtkAvianLidarSensorFile()>& read, bool keepPlace);
  struct vtkInternals;
  struct vtkBeamTable;
  std::string Warned;                        ///< the warning given last: each is given once
  std::shared_ptr<const vtkBeamTable> Table; ///< beams instead of the pattern
};

#endif
