// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarNames.h
 * @brief Declares the names and units of all point and cell arrays, and of the field data that
 * several files use.
 *
 * A comment above each group says where its arrays are, and a comment above each name gives the
 * meaning. CMake/arrays_page.py makes the table of Documentation/reference/arrays.md from these
 * comments.
 *
 * Coefficients of materials take their names from MaterialCoefficients in Reflectance.h.
 */
#ifndef vtkAvianLidarNames_h
#define vtkAvianLidarNames_h

namespace vtkAvianLidarArrays
{
/// A name with its unit. The unit is "1" for pure numbers: ratios, counts, choices and switches. It
/// is "" for text and for identifiers, among them status, skipped, view, part and seeds; such an
/// array has no unit label.
struct Name
{
  const char* name;
  const char* unit;
  const char* words = ""; ///< description in LAS files, with the unit at most 31 bytes
};

// Beams (point data); most of these arrays also in echoes and beam report.
/// column * channels + channel, unique among all pieces of a scan (vtkIdType)
constexpr Name BeamId{ "beam_id", "", "index of the beam" };
/// unit vector along the beam: east, north, up
constexpr Name Direction{ "direction", "1" };
/// direction that the sensor reports; only with sway or jitter (3 components)
constexpr Name ReportedDirection{ "reported_direction", "1" };
/// channel (int)
constexpr Name LaserId{ "laser_id", "", "channel" };
/// angle from north (y), clockwise seen from above, 0 to below 36000
constexpr Name Azimuth{ "azimuth", "0.01 deg", "from north, clockwise" };
/// elevation above the horizontal plane
constexpr Name VerticalAngle{ "vertical_angle", "deg", "from the horizon, up" };
/// firing time since the start of revolution 0
constexpr Name Timestamp{ "timestamp", "us" };

// Sensor (field data of beams and echoes).
/// whether the air sends light back: 0 no, 1 yes (int)
constexpr Name AirBackscatter{ "air_backscatter", "1" };
/// rain rate
constexpr Name RainRate{ "rain_rate", "mm/h" };
/// outline of the beam: 0 ellipse, 1 rectangle (int)
constexpr Name BeamOutline{ "beam_outline", "1" };
/// threshold in scattering air: 0 fixed, 1 raised by backscatter of the air (int)
constexpr Name ThresholdLaw{ "threshold_law", "1" };
/// profile of the beam: 0 uniform, 1 Gaussian (int)
constexpr Name BeamProfile{ "beam_profile", "1" };
/// lower limit Qlow, above which a range unit is perceived
constexpr Name LowerEnergyLimit{ "lower_energy_limit", "J" };
/// upper limit Qhigh, at which the receiver saturates
constexpr Name UpperEnergyLimit{ "upper_energy_limit", "J" };
/// model of the receiver: 0 energy limits, 1 photons (int)
constexpr Name ReceiverModel{ "receiver_model", "1" };
/// shape of the pulse: 0 rectangle, 1 Gaussian, 2 samples (int)
constexpr Name PulseShape{ "pulse_shape", "1" };
/// time of each sample of the pulse
constexpr Name PulseTimes{ "pulse_times", "s" };
/// power of each sample of the pulse, in any unit
constexpr Name PulsePowers{ "pulse_powers", "1" };
/// wavelength of the light
constexpr Name Wavelength{ "wavelength", "nm" };
/// false alarms expected in a scan of empty sky
constexpr Name FalseAlarmsPerScan{ "false_alarms_per_scan", "1" };
/// 10 log10 of the ratio of the upper to the lower limit in electrons
constexpr Name DynamicRange{ "dynamic_range", "dB" };
/// names of the settings with assumed values (text)
constexpr Name Assumed{ "assumed", "" };

// Scan pattern (field data of beams and echoes).
/// position of the sensor: east, north, up
constexpr Name Position{ "position", "m" };
/// yaw, pitch and roll of the sensor
constexpr Name Orientation{ "orientation", "deg" };
/// channels (int)
constexpr Name NumberOfChannels{ "number_of_channels", "1" };
/// elevation of channel 0
constexpr Name MinimumElevation{ "minimum_elevation", "deg" };
/// step of elevation between channels
constexpr Name ElevationStep{ "elevation_step", "deg" };
/// elevation of each channel, if tabulated
constexpr Name ChannelElevations{ "channel_elevations", "deg" };
/// azimuth of each channel minus azimuth of the column
constexpr Name ChannelAzimuthOffsets{ "channel_azimuth_offsets", "deg" };
/// firing time of each channel in its column
constexpr Name ChannelFiringTimes{ "channel_firing_times", "s" };
/// azimuths without beams: first azimuth and excluded end of each sector
constexpr Name BlankedSectors{ "blanked_sectors", "deg" };
/// wedge angle of each prism
constexpr Name PrismWedgeAngles{ "prism_wedge_angles", "deg" };
/// refractive index of each prism
constexpr Name PrismRefractiveIndices{ "prism_refractive_indices", "1" };
/// rotation rate of each prism, clockwise seen from the sensor
constexpr Name PrismRotationRates{ "prism_rotation_rates", "Hz" };
/// direction of each prism's deflection at time 0: 0 up, 90 right
constexpr Name PrismPhases{ "prism_phases", "deg" };
/// elevation of the prisms' axis
constexpr Name PrismAxisElevation{ "prism_axis_elevation", "deg" };
/// rotation rate of the prisms' axis about the vertical, clockwise seen from above
constexpr Name PrismAxisRotationRate{ "prism_axis_rotation_rate", "Hz" };
/// rotation rate of the lasers about the prisms' axis, clockwise seen from the sensor
constexpr Name PrismLaserRotationRate{ "prism_laser_rotation_rate", "Hz" };
/// first azimuth and excluded end
constexpr Name AzimuthRange{ "azimuth_range", "deg" };
/// step of azimuth between columns
constexpr Name AzimuthStep{ "azimuth_step", "deg" };
/// scans per second
constexpr Name RotationRate{ "rotation_rate", "Hz" };
/// time between firings of a column
constexpr Name FiringInterval{ "firing_interval", "s" };
/// number of revolutions to play (int)
constexpr Name NumberOfRevolutions{ "number_of_revolutions", "1" };
/// time steps per revolution (int)
constexpr Name StepsPerRevolution{ "steps_per_revolution", "1" };
/// number of the revolution, from 0 (int)
constexpr Name Revolution{ "revolution", "" };
/// rms tilt about each horizontal axis
constexpr Name SwayAmplitude{ "sway_amplitude", "deg" };
/// frequency of the sway
constexpr Name SwayFrequency{ "sway_frequency", "Hz" };
/// rms error of a column's azimuth
constexpr Name EncoderJitter{ "encoder_jitter", "deg" };
/// seed of sway and jitter (int)
constexpr Name MotionSeed{ "motion_seed", "" };
/// length of drawn beams without an echo
constexpr Name DisplayLength{ "display_length", "m" };

// Surfaces (cell data and field data).
/// part of a mover: 0 rigid; part p moves by row p - 1 of the `flap_` arrays (int)
constexpr Name Part{ "part", "" };
/// number of the object; in echoes -1 false alarm, -2 air (int)
constexpr Name ObjectId{ "object_id", "", "index of object_names" };
/// number of the material; in echoes -1 false alarm or air (int)
constexpr Name MaterialId{ "material_id", "", "index of material_names" };
/// name of each `object_id` (text)
constexpr Name ObjectNames{ "object_names", "" };
/// name of each `material_id` (text)
constexpr Name MaterialNames{ "material_names", "" };
/// class of each `object_id` (text)
constexpr Name ObjectClasses{ "object_classes", "" };
/// medium inside the surface, as JSON (text)
constexpr Name Medium{ "medium", "" };
/// all media of the scene, as JSON (text)
constexpr Name Media{ "media", "" };
constexpr Name SurfaceTexts[] = { ObjectNames, ObjectClasses, MaterialNames, Medium, Media };
/// latitude, longitude, and height above the WGS84 ellipsoid or the sea, as in the scene file
constexpr Name GeodeticOrigin{ "geodetic_origin", "deg deg m" };
/// position of the lidar in the scene file (3 components)
constexpr Name LidarPosition{ "lidar_position", "m" };
/// credit that the source of the data requires (text)
constexpr Name Attribution{ "attribution", "" };
/// size and repairs of each object (text)
constexpr Name SceneReport{ "scene_report", "" };
/// checksum of the collision tree (unsigned, 64 bits)
constexpr Name TreeChecksum{ "tree_checksum", "" };

// Movers (field data) and trails (point, cell and field data).
/// time of each pose, rising, since the start of revolution 0
constexpr Name PoseTime{ "pose_time", "s" };
/// origin of the mover in each pose (3 components)
constexpr Name PosePosition{ "pose_position", "m" };
/// unit quaternion w, x, y, z from the mover's frame to the scene's
constexpr Name PoseOrientation{ "pose_orientation", "1" };
/// point on each hinge (3 components)
constexpr Name FlapHinge{ "flap_hinge", "m" };
/// unit vector along each hinge (3 components)
constexpr Name FlapAxis{ "flap_axis", "1" };
/// amplitude of each part's angle
constexpr Name FlapAmplitude{ "flap_amplitude", "rad" };
/// frequency of each part's angle
constexpr Name FlapFrequency{ "flap_frequency", "Hz" };
/// phase of each part, in turns
constexpr Name FlapPhase{ "flap_phase", "1" };
/// name of the species (text)
constexpr Name Species{ "species", "" };
/// number of the species (int): built-in species from 0, then the species of the user's table
constexpr Name SpeciesId{ "species_id", "" };
/// name of each `species_id` (text)
constexpr Name SpeciesNames{ "species_names", "" };
/// time of a position; in the tracker's field data, time of the cloud
constexpr Name Time{ "time", "s" };

// Every output after an error (field data).
/// message of the failed execution (text)
constexpr Name Error{ "error", "" };

// Bounding volumes of the collision tree (cell data).
/// index of the node (int)
constexpr Name NodeId{ "node_id", "" };
/// triangles below the node (int)
constexpr Name Triangles{ "triangles", "1" };
/// depth of the node, 0 at the root (int)
constexpr Name Depth{ "depth", "1" };

// Echoes and beam report (point data).
/// energy of the strongest range unit, cut at Qhigh (Eq. 12)
constexpr Name Energy{ "energy", "J", "within receiver limits" };
/// energy received in the strongest range unit (Eq. 10)
constexpr Name EnergyReceived{ "energy_received", "J", "before the limits" };
/// energy received in all range units of the return
constexpr Name ReturnEnergy{ "return_energy", "J", "of the whole return" };
/// standard error of `energy_received`, with view 2 a bound of the error; NaN below 8 rays
constexpr Name EnergyStdError{ "energy_std_error", "J", "of energy_received" };
/// photoelectrons in the range unit of `energy_received`, with noise; photon receivers only
constexpr Name Photoelectrons{ "photoelectrons", "1", "of its range unit" };
/// `photoelectrons` divided by their standard deviation; photon receivers only
constexpr Name SignalToNoise{ "signal_to_noise", "1", "of its range unit" };
/// spectral radiance of daylight in the beam; photon receivers with sunlight only
constexpr Name SeenRadiance{ "seen_radiance", "W/(m2 sr nm)", "of what its beam looks at" };
/// standard deviation of the range, from noise
constexpr Name DistanceStdError{ "distance_std_error", "m", "of the receiver's noise" };
/// intensity, 0 to 255, linear between the energy limits
constexpr Name Intensity{ "intensity", "1" };
/// range
constexpr Name Distance{ "distance_m", "m", "range" };
/// number of the return in its beam, from 1, nearest first (int)
constexpr Name ReturnNumber{ "return_number", "1" };
/// returns of the beam (int)
constexpr Name NumberOfReturns{ "number_of_returns", "1" };
/// share of the energy that comes from the object and material of the echo
constexpr Name LabelShare{ "label_share", "1", "energy of object_id" };
/// energy-weighted mean angle of incidence at the last surface; NaN for false alarms
constexpr Name IncidenceAngle{ "incidence_angle", "deg", "at the surface" };
/// share of the energy from paths with two reflections; above 0.5 a ghost
constexpr Name SecondaryShare{ "secondary_share", "1", "energy of 2 bounces" };
/// full width of the echo at half its amplitude; with waveforms only
constexpr Name EchoWidth{ "echo_width", "s", "full width at half maximum" };
/// time of the echo from a tenth to nine tenths of its amplitude; with waveforms only
constexpr Name EchoRiseTime{ "echo_rise_time", "s", "from 10 to 90 %" };
/// greatest power of the echo's samples; with waveforms only
constexpr Name EchoAmplitude{ "echo_amplitude", "W", "greatest sample" };
/// energy of the echo's samples above a tenth of its amplitude; with waveforms only
constexpr Name EchoIntegral{ "echo_integral", "J", "samples above 10 %" };
/// samples above a tenth of the echo's amplitude (int); with waveforms only
constexpr Name EchoSamples{ "echo_samples", "1", "above 10 % of the peak" };
/// status of the beam: 0 echo, 1 no-surface, 2 below-Qlow, 3 saturated, 4 outside-gate; in a
/// coverage, index of `status_names`
constexpr Name Status{ "status", "" };
/// view of the beam: 1 nothing, 2 polygons, 3 cells, 4 rays, 5 cells with more than 2,000
/// triangles, whose rays are traced through the tree (int)
constexpr Name View{ "view", "" };
/// tested triangles, each counted once per packet of up to 64 rays
constexpr Name Candidates{ "candidates", "1" };
/// visited nodes of the tree
constexpr Name NodesVisited{ "nodes_visited", "1" };
/// traced rays
constexpr Name RaysTraced{ "rays_traced", "1" };
/// sum of codes for parts left out: 1 second reflections, 2 whole beam, 4 noise, 8 surfaces out of
/// range, 16 direct light (int)
constexpr Name Skipped{ "skipped", "" };
/// bound of the energy by which range units of echoes differ from the full model
constexpr Name SkippedBound{ "skipped_bound", "J" };

// Poses of a sensor that moves (point data of beams and echoes).
/// position of the sensor when the beam is fired (3 components); with a trajectory only
constexpr Name SensorPosition{ "sensor_position", "m" };
/// unit quaternion w, x, y, z from the sensor's frame to the scene's when the beam is fired; with a
/// trajectory only
constexpr Name SensorOrientation{ "sensor_orientation", "1" };

// Waveforms (point and cell data).
/// mean energy that a sample receives, without noise
constexpr Name Signal{ "signal", "J" };
/// photoelectrons of `signal`; photon receivers only
constexpr Name SignalElectrons{ "signal_electrons", "1" };
/// mean energy of the background in a sample, which the receiver subtracts
constexpr Name Background{ "background", "J" };
/// sample with drawn noise, as the digitiser stores it
constexpr Name Sample{ "sample", "J" };
/// energy above which the sample's range unit is perceived
constexpr Name Threshold{ "threshold", "J" };
/// time of a sample after the pulse
constexpr Name SampleTime{ "sample_time", "s" };
/// origin of the beam (3 components)
constexpr Name Origin{ "origin", "m" };

// Beam view (cell data; columns of the table).
/// share of the beam's solid angle that the surface fills
constexpr Name SolidAngleShare{ "solid_angle_share", "1" };
/// share of the received energy that the surface returns
constexpr Name EnergyShare{ "energy_share", "1" };
/// name of the object (text); in boxes of a sequence, class of the box
constexpr Name Object{ "object", "" };
/// name of the material (text)
constexpr Name Material{ "material", "" };
/// nearest range in the beam
constexpr Name NearestRange{ "nearest_m", "m" };
/// farthest range in the beam
constexpr Name FarthestRange{ "farthest_m", "m" };

// Mover report (point data).
/// area of the silhouette, weighted by the cosine of incidence; NaN if the mover's bounding sphere
/// contains the sensor
constexpr Name EffectiveArea{ "effective_area", "m2" };
/// beams whose cones contain the mover's origin (int)
constexpr Name NumberOfBeams{ "number_of_beams", "1" };
/// time when the first beam meets the mover
constexpr Name FirstTimestamp{ "first_timestamp", "us" };
/// origin of the mover at `first_timestamp` (3 components)
constexpr Name FirstPosition{ "first_position", "m" };
/// time when the last beam meets the mover
constexpr Name LastTimestamp{ "last_timestamp", "us" };
/// origin of the mover at `last_timestamp` (3 components)
constexpr Name LastPosition{ "last_position", "m" };
/// echoes of the mover; from the tracker, points of the cluster (int)
constexpr Name NumberOfEchoes{ "number_of_echoes", "1" };
/// probability that one scan detects the target or, in the clutter output, perceives the echo
constexpr Name DetectionProbability{ "detection_probability", "1" };

// Tracker (point and cell data).
/// number of the track; -1 for points without a track (int)
constexpr Name TrackId{ "track_id", "" };
/// 1 if the track of the point is confirmed (unsigned char)
constexpr Name TrackConfirmed{ "track_confirmed", "1" };
/// estimated velocity over ground (3 components)
constexpr Name Velocity{ "velocity", "m/s" };
/// covariance of the position: xx, yy, zz, xy, yz, xz
constexpr Name PositionCovariance{ "position_covariance", "m2" };
/// 1 if the track is confirmed (unsigned char)
constexpr Name Confirmed{ "confirmed", "1" };
/// 1 if the track has ended (unsigned char)
constexpr Name Ended{ "ended", "1" };
/// scans with a cluster of the track (int)
constexpr Name Hits{ "hits", "1" };

// Coverage (point data, field data, columns of the table).
/// probability that enough of several scans detect the bird
constexpr Name TrackProbability{ "track_probability", "1" };
/// detection probability in each pose of the bird
constexpr Name PoseProbabilities{ "pose_probabilities", "1" };
/// beams that meet the place, at most 255 (int)
constexpr Name BeamsPerScan{ "beams_per_scan", "1" };
/// effective area at which half of the targets inside the beams would be detected
constexpr Name MinimumEffectiveArea{ "minimum_effective_area", "m2" };
/// name of each `status` (text)
constexpr Name StatusNames{ "status_names", "" };
/// number of the region of the place (int)
constexpr Name RegionId{ "region_id", "" };
/// name of each `region_id` (text)
constexpr Name RegionNames{ "region_names", "" };
/// name of the region (text)
constexpr Name Region{ "region", "" };
/// lower limit of the band of heights
constexpr Name HeightFrom{ "height_from", "m" };
/// upper limit of the band of heights
constexpr Name HeightTo{ "height_to", "m" };
/// places in the region and band
constexpr Name Places{ "places", "1" };
/// standard error of the mean `detection_probability`
constexpr Name DetectionStdError{ "detection_std_error", "1" };
/// standard error of the mean `track_probability`
constexpr Name TrackStdError{ "track_std_error", "1" };

// Colours and coordinates (point data, field data).
/// hue of the colour, from 240 at Qlow to 0 at Qhigh (Eq. 13)
constexpr Name Hue{ "hue", "deg" };
/// colour, 0 to 255 (3 unsigned chars)
constexpr Name Rgb{ "rgb", "1" };
/// geodetic longitude, WGS84
constexpr Name Longitude{ "longitude", "deg" };
/// geodetic latitude, WGS84
constexpr Name Latitude{ "latitude", "deg" };
/// height above the WGS84 ellipsoid
constexpr Name Height{ "height", "m" };
/// UTM zone, negative in the south (int)
constexpr Name UTMZone{ "utm_zone", "" };
/// coordinate reference system of the points, WKT (text)
constexpr Name CrsWkt{ "crs_wkt", "" };
/// where the times of a recording's scans come from (text)
constexpr Name ScanTimes{ "scan_times", "" };

// Range image (field data).
/// azimuth of each column
constexpr Name ColumnAzimuths{ "column_azimuths", "deg" };
/// elevation of each row
constexpr Name RowElevations{ "row_elevations", "deg" };

// Clutter filter (point data, field data).
/// weighted share of earlier scans with an echo in the cell; for a point, the largest share among
/// the cells around the point
constexpr Name ClutterProbability{ "clutter_probability", "1" };
/// 1 for clutter, 0 for points that may move (unsigned char)
constexpr Name IsClutter{ "is_clutter", "1" };
/// cell of the point: indices of azimuth, elevation and range (3 ints)
constexpr Name ClutterCell{ "clutter_cell", "" };
/// number of scans in memory (int)
constexpr Name LearnedScans{ "learned_scans", "1" };
/// age, in scans, at which a scan weighs 1/e
constexpr Name ClutterWindow{ "clutter_window", "1" };
/// clutter probability from which a point is clutter
constexpr Name ClutterThreshold{ "clutter_threshold", "1" };
/// size of the cells in range
constexpr Name ClutterRangeStep{ "clutter_range_step", "m" };
/// size of the cells in azimuth
constexpr Name ClutterAzimuthStep{ "clutter_azimuth_step", "deg" };
/// size of the cells in elevation
constexpr Name ClutterElevationStep{ "clutter_elevation_step", "deg" };
/// neighbouring cells in range that count for a point (int)
constexpr Name ClutterRangeTolerance{ "clutter_range_tolerance", "1" };
/// neighbouring cells in azimuth and elevation that count for a point (int)
constexpr Name ClutterAngularTolerance{ "clutter_angular_tolerance", "1" };
/// number of first scans in which all points are clutter (int)
constexpr Name ClutterWarmUp{ "clutter_warm_up", "1" };
/// 1 if the filter learns from the scans (int)
constexpr Name ClutterLearning{ "clutter_learning", "1" };
/// time of a cloud, s; ParaView's array, without a unit label
constexpr Name TimeValue{ "TimeValue", "" };

// Cloud comparison (point data, field data).
/// distance to the nearest point of the other cloud
constexpr Name NearestDistance{ "nearest_distance", "m" };
/// Hausdorff distance (Eq. 19)
constexpr Name HausdorffDistance{ "hausdorff_distance", "m" };
/// largest distance from simulated to reference
constexpr Name HausdorffSimulatedToReference{ "hausdorff_simulated_to_reference", "m" };
/// largest distance from reference to simulated
constexpr Name HausdorffReferenceToSimulated{ "hausdorff_reference_to_simulated", "m" };
/// rms distance from simulated to reference
constexpr Name RMSESimulatedToReference{ "rmse_simulated_to_reference", "m" };
/// rms distance from reference to simulated (Eq. 20)
constexpr Name RMSEReferenceToSimulated{ "rmse_reference_to_simulated", "m" };
/// mean of both density-aware Chamfer distances
constexpr Name ChamferDistance{ "density_aware_chamfer_distance", "1" };
/// density-aware Chamfer distance from simulated to reference
constexpr Name ChamferSimulatedToReference{ "density_aware_chamfer_simulated_to_reference", "1" };
/// density-aware Chamfer distance from reference to simulated
constexpr Name ChamferReferenceToSimulated{ "density_aware_chamfer_reference_to_simulated", "1" };

// Every scan (field data).
/// filter preset (int)
constexpr Name Preset{ "preset", "1" };
/// software version (text)
constexpr Name Version{ "avian_lidar_version", "" };
/// checksum of surfaces, movers (unsigned 64-bit)
constexpr Name SceneChecksum{ "scene_checksum", "" };

// Clouds read from files (point data, field data).
/// class (unsigned short)
constexpr Name SemanticLabel{ "semantic_label", "" };
/// object (unsigned short)
constexpr Name InstanceId{ "instance_id", "" };
/// largest coordinate rounding
constexpr Name LasRoundingBound{ "las_rounding_bound", "m" };

/// Arrays of the points of a cloud, which readers and writers of files recognise.
constexpr Name CloudArrays[] = { BeamId, LaserId, Azimuth, VerticalAngle, Timestamp, ObjectId,
  MaterialId, Energy, EnergyReceived, ReturnEnergy, EnergyStdError, Photoelectrons, SignalToNoise,
  SeenRadiance, DistanceStdError, Distance, LabelShare, IncidenceAngle, SecondaryShare, Hue,
  Longitude, Latitude, Height, EchoWidth, EchoRiseTime, EchoAmplitude, EchoIntegral, EchoSamples };
}

#endif
