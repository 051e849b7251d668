// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarNames.h
 * @brief Names and units of arrays of points and cells, which stand here only, and of field data
 * that several files use.
 *
 * Above each group stands where its arrays are, above each name its meaning: CMake/arrays_page.py
 * makes the table of Documentation/arrays.md of both.
 *
 * Used by every filter, reader and test of the module; not installed. Names of coefficients of
 * materials follow from their table in Reflectance.h.
 */
#ifndef vtkAvianLidarNames_h
#define vtkAvianLidarNames_h

namespace vtkAvianLidarArrays
{
/// A name with its unit. The unit is "1" for pure numbers: ratios, counts (return_number,
/// number_of_returns, candidates, nodes_visited, rays_traced), choices and switches. It is "", and
/// the array carries none, for identifiers (beam_id, laser_id, object_id, material_id, status,
/// skipped, seeds, revolution, checksums) and text.
struct Name
{
  const char* name;
  const char* unit;
};

// Beams, and most of echoes and beam report (point data).
/// number of the beam, unique over all pieces of a scan: column * channels + channel
/// (vtkIdType)
constexpr Name BeamId{ "beam_id", "" };
/// unit vector along the axis of the beam, x east, y north, z up (3 components)
constexpr Name Direction{ "direction", "1" };
/// where the sensor believes that the beam points; there with sway or jitter (3 components)
constexpr Name ReportedDirection{ "reported_direction", "1" };
/// number of the channel (int)
constexpr Name LaserId{ "laser_id", "" };
/// azimuth of the beam or point, from north (y) clockwise as seen from above, 0 to below 36000
constexpr Name Azimuth{ "azimuth", "0.01 deg" };
/// elevation of the beam or point above the horizontal plane
constexpr Name VerticalAngle{ "vertical_angle", "deg" };
/// time of firing, from the start of revolution 0
constexpr Name Timestamp{ "timestamp", "us" };

// Sensor (field data of beams and echoes).
/// 1 if the air sends light back, else 0 (int)
constexpr Name AirBackscatter{ "air_backscatter", "1" };
/// rain rate
constexpr Name RainRate{ "rain_rate", "mm/h" };
/// outline of the beam: 0 ellipse, 1 rectangle (int)
constexpr Name BeamOutline{ "beam_outline", "1" };
/// threshold where the air sends light back: 0 fixed, 1 follows the air (int)
constexpr Name ThresholdLaw{ "threshold_law", "1" };
/// energy within the beam: 0 uniform, 1 Gaussian (int)
constexpr Name BeamProfile{ "beam_profile", "1" };
/// Qlow, the limit above which a range unit is perceived
constexpr Name LowerEnergyLimit{ "lower_energy_limit", "J" };
/// Qhigh, at which the receiver saturates
constexpr Name UpperEnergyLimit{ "upper_energy_limit", "J" };
/// receiver: 0 energy limits, 1 photons (int)
constexpr Name ReceiverModel{ "receiver_model", "1" };
/// wavelength of the light
constexpr Name Wavelength{ "wavelength", "nm" };
/// false alarms expected in a scan of empty sky
constexpr Name FalseAlarmsPerScan{ "false_alarms_per_scan", "1" };
/// upper limit over lower limit, 10 log10 of electrons
constexpr Name DynamicRange{ "dynamic_range", "dB" };
/// names of the values that are assumed, not measured (text)
constexpr Name Assumed{ "assumed", "" };

// Scan pattern (field data of beams and echoes).
/// position of the sensor, x east, y north, z up (3 components)
constexpr Name Position{ "position", "m" };
/// attitude of the sensor: yaw, pitch, roll (3 components)
constexpr Name Orientation{ "orientation", "deg" };
/// channels of the sensor (int)
constexpr Name NumberOfChannels{ "number_of_channels", "1" };
/// elevation of channel 0
constexpr Name MinimumElevation{ "minimum_elevation", "deg" };
/// elevation from one channel to the next
constexpr Name ElevationStep{ "elevation_step", "deg" };
/// elevation of each channel, where the sensor has a table
constexpr Name ChannelElevations{ "channel_elevations", "deg" };
/// azimuth of each channel's beam less the azimuth of its column
constexpr Name ChannelAzimuthOffsets{ "channel_azimuth_offsets", "deg" };
/// time of firing of each channel, from the start of its column
constexpr Name ChannelFiringTimes{ "channel_firing_times", "s" };
/// azimuths without beams: from, to, from, to, ...
constexpr Name BlankedSectors{ "blanked_sectors", "deg" };
/// wedge angle of each rotating prism
constexpr Name PrismWedgeAngles{ "prism_wedge_angles", "deg" };
/// refractive index of each prism
constexpr Name PrismRefractiveIndices{ "prism_refractive_indices", "1" };
/// rotation rate of each prism, clockwise as the sensor sees it
constexpr Name PrismRotationRates{ "prism_rotation_rates", "Hz" };
/// direction to which each prism deflects at time 0: 0 up, 90 right
constexpr Name PrismPhases{ "prism_phases", "deg" };
/// elevation of the common axis of the prisms
constexpr Name PrismAxisElevation{ "prism_axis_elevation", "deg" };
/// rotation rate of that axis about the vertical, clockwise from above
constexpr Name PrismAxisRotationRate{ "prism_axis_rotation_rate", "Hz" };
/// first azimuth of the scan, and its end (2 components)
constexpr Name AzimuthRange{ "azimuth_range", "deg" };
/// azimuth from one column to the next
constexpr Name AzimuthStep{ "azimuth_step", "deg" };
/// scans per second
constexpr Name RotationRate{ "rotation_rate", "Hz" };
/// time between two firings of a column
constexpr Name FiringInterval{ "firing_interval", "s" };
/// revolutions to play (int)
constexpr Name NumberOfRevolutions{ "number_of_revolutions", "1" };
/// steps in which a revolution is played (int)
constexpr Name StepsPerRevolution{ "steps_per_revolution", "1" };
/// number of the revolution to which the data belong (int)
constexpr Name Revolution{ "revolution", "" };
/// rms tilt of the mast about each horizontal axis
constexpr Name SwayAmplitude{ "sway_amplitude", "deg" };
/// frequency of the sway
constexpr Name SwayFrequency{ "sway_frequency", "Hz" };
/// rms error of the azimuth of a column
constexpr Name EncoderJitter{ "encoder_jitter", "deg" };
/// seed of sway and jitter (int)
constexpr Name MotionSeed{ "motion_seed", "" };
/// length at which beams without an echo are drawn
constexpr Name DisplayLength{ "display_length", "m" };

// Surfaces (cell data and field data).
/// part that flaps: 0 rigid, p row p - 1 of the `flap_` field data (int)
constexpr Name Part{ "part", "" };
/// number of the object; in echoes -1 is a false alarm, -2 the air (int)
constexpr Name ObjectId{ "object_id", "" };
/// number of the material; in echoes -1 for false alarms and the air (int)
constexpr Name MaterialId{ "material_id", "" };
/// name of each object, by `object_id` (text)
constexpr Name ObjectNames{ "object_names", "" };
/// name of each material, by `material_id` (text)
constexpr Name MaterialNames{ "material_names", "" };
/// class of each object, by `object_id` (text)
constexpr Name ObjectClasses{ "object_classes", "" };
/// description of a medium as JSON, which makes a surface its boundary (text)
constexpr Name Medium{ "medium", "" };
/// descriptions of all media of the scene as JSON (text)
constexpr Name Media{ "media", "" };
constexpr Name SurfaceTexts[] = { ObjectNames, ObjectClasses, MaterialNames, Medium, Media };
/// origin of the scene: latitude, longitude, height above the WGS84 ellipsoid (3 components)
constexpr Name GeodeticOrigin{ "geodetic_origin", "deg deg m" };
/// position of the lidar that a scene file names (3 components)
constexpr Name LidarPosition{ "lidar_position", "m" };
/// whom to credit for the scene (text)
constexpr Name Attribution{ "attribution", "" };
/// size and repairs of each object of a scene file (text)
constexpr Name SceneReport{ "scene_report", "" };
/// checksum under which the collision tree travels with its surfaces (unsigned, 64 bits)
constexpr Name TreeChecksum{ "tree_checksum", "" };

// Movers (field data) and trails (point, cell and field data).
/// time of each pose, rising, on the clock of the beams
constexpr Name PoseTime{ "pose_time", "s" };
/// position of the mover's origin in each pose (3 components)
constexpr Name PosePosition{ "pose_position", "m" };
/// unit quaternion w, x, y, z from the mover's frame to the scene's (4 components)
constexpr Name PoseOrientation{ "pose_orientation", "1" };
/// point on the hinge of each part that flaps (3 components)
constexpr Name FlapHinge{ "flap_hinge", "m" };
/// unit vector along each hinge (3 components)
constexpr Name FlapAxis{ "flap_axis", "1" };
/// amplitude of each part's angle
constexpr Name FlapAmplitude{ "flap_amplitude", "rad" };
/// frequency of each part's angle
constexpr Name FlapFrequency{ "flap_frequency", "Hz" };
/// phase of each part's angle, in turns
constexpr Name FlapPhase{ "flap_phase", "1" };
/// species of the bird (text)
constexpr Name Species{ "species", "" };
/// number of the species, for colours (int)
constexpr Name SpeciesId{ "species_id", "" };
/// name of each species, by `species_id` (text)
constexpr Name SpeciesNames{ "species_names", "" };
/// time of a position; in field data of the tracker the time of the cloud
constexpr Name Time{ "time", "s" };

// All outputs after an error (field data).
/// message of the execution that failed (text)
constexpr Name Error{ "error", "" };

// Bounding volumes of the collision tree (cell data).
/// number of the node (int)
constexpr Name NodeId{ "node_id", "" };
/// triangles below the node (int)
constexpr Name Triangles{ "triangles", "1" };
/// depth of the node, 0 at the root (int)
constexpr Name Depth{ "depth", "1" };

// Echoes and beam report (point data).
/// detected energy of the strongest range unit, cut at Qhigh (Eq. 12)
constexpr Name Energy{ "energy", "J" };
/// energy received in the strongest range unit (Eq. 10)
constexpr Name EnergyReceived{ "energy_received", "J" };
/// energy received in all range units of the return
constexpr Name ReturnEnergy{ "return_energy", "J" };
/// standard error of `energy_received` from sampling, or a bound of the error; NaN below 8 rays
constexpr Name EnergyStdError{ "energy_std_error", "J" };
/// electrons in the range unit of `energy_received`, noise included; of photon receivers
constexpr Name Photoelectrons{ "photoelectrons", "1" };
/// photoelectrons over their standard deviation; of photon receivers
constexpr Name SignalToNoise{ "signal_to_noise", "1" };
/// daylight that the beam looks at; of photon receivers with sunlight
constexpr Name SeenRadiance{ "seen_radiance", "W/(m2 sr nm)" };
/// standard deviation of the range from noise of the receiver, where there is such noise
constexpr Name DistanceStdError{ "distance_std_error", "m" };
/// energy on a scale of 0 to 255, linear between the limits
constexpr Name Intensity{ "intensity", "1" };
/// range
constexpr Name Distance{ "distance_m", "m" };
/// number of the return in its beam, from 1, nearest first (int)
constexpr Name ReturnNumber{ "return_number", "1" };
/// returns of the beam (int)
constexpr Name NumberOfReturns{ "number_of_returns", "1" };
/// share of the energy that belongs to `object_id` and `material_id`
constexpr Name LabelShare{ "label_share", "1" };
/// angle of incidence at the last surface, energy-weighted; NaN for false alarms
constexpr Name IncidenceAngle{ "incidence_angle", "deg" };
/// share of the energy over two reflections; above 0.5 the echo is a ghost
constexpr Name SecondaryShare{ "secondary_share", "1" };
/// beam report: 0 echo, 1 no surface, 2 below Qlow, 3 saturated, 4 outside the gate; coverage:
/// see `status_names`
constexpr Name Status{ "status", "" };
/// how the direct echo was found: 1 empty beam, 2 polygons, 3 cells, 4 rays, 5 cells of a
/// crowded beam (int)
constexpr Name View{ "view", "" };
/// triangles tested, once for each packet of up to 64 rays
constexpr Name Candidates{ "candidates", "1" };
/// nodes of the collision tree visited
constexpr Name NodesVisited{ "nodes_visited", "1" };
/// rays traced
constexpr Name RaysTraced{ "rays_traced", "1" };
/// what the model left out, a sum of 1, 2, 4, 8 and 16 (model-needs.md) (int)
constexpr Name Skipped{ "skipped", "" };
/// most by which a range unit so differs from the full model
constexpr Name SkippedBound{ "skipped_bound", "J" };

// Beam view (cell data; columns of the table).
/// share of the beam's solid angle that the surface fills
constexpr Name SolidAngleShare{ "solid_angle_share", "1" };
/// share of the energy received that the surface returns
constexpr Name EnergyShare{ "energy_share", "1" };
/// name of the object (text); sequence reader: class of a box
constexpr Name Object{ "object", "" };
/// name of the material (text)
constexpr Name Material{ "material", "" };
/// nearest range of the surface in the beam
constexpr Name NearestRange{ "nearest_m", "m" };
/// farthest range of the surface in the beam
constexpr Name FarthestRange{ "farthest_m", "m" };

// Mover report (point data).
/// silhouette of the mover weighted by the cosine of incidence; NaN if it surrounds the sensor
constexpr Name EffectiveArea{ "effective_area", "m2" };
/// beams whose cones hold the mover's origin (int)
constexpr Name NumberOfBeams{ "number_of_beams", "1" };
/// time at which the first beam meets the mover
constexpr Name FirstTimestamp{ "first_timestamp", "us" };
/// position of the mover's origin at that time (3 components)
constexpr Name FirstPosition{ "first_position", "m" };
/// time at which the last beam meets the mover
constexpr Name LastTimestamp{ "last_timestamp", "us" };
/// position of the mover's origin at that time (3 components)
constexpr Name LastPosition{ "last_position", "m" };
/// echoes of the mover; in the tracker points of the cluster (int)
constexpr Name NumberOfEchoes{ "number_of_echoes", "1" };
/// probability that one scan detects the target; of clutter, that it is perceived
constexpr Name DetectionProbability{ "detection_probability", "1" };

// Tracker (point and cell data).
/// number of the track; -1 for points of no track (int)
constexpr Name TrackId{ "track_id", "" };
/// 1 if the point belongs to a confirmed track (unsigned char)
constexpr Name TrackConfirmed{ "track_confirmed", "1" };
/// estimated velocity over ground (3 components)
constexpr Name Velocity{ "velocity", "m/s" };
/// covariance of the position: xx, yy, zz, xy, yz, xz (6 components)
constexpr Name PositionCovariance{ "position_covariance", "m2" };
/// 1 if the track is confirmed (unsigned char)
constexpr Name Confirmed{ "confirmed", "1" };
/// 1 if the track has ended (unsigned char)
constexpr Name Ended{ "ended", "1" };
/// scans in which the track had a cluster (int)
constexpr Name Hits{ "hits", "1" };

// Coverage (point data, field data, columns of the table).
/// probability that enough of several scans detect the bird
constexpr Name TrackProbability{ "track_probability", "1" };
/// detection probability in each pose of the bird
constexpr Name PoseProbabilities{ "pose_probabilities", "1" };
/// beams whose cones hold the place, at most 255 (int)
constexpr Name BeamsPerScan{ "beams_per_scan", "1" };
/// effective area of which half would be detected
constexpr Name MinimumEffectiveArea{ "minimum_effective_area", "m2" };
/// name of each value of `status` (text)
constexpr Name StatusNames{ "status_names", "" };
/// number of the region of a place (int)
constexpr Name RegionId{ "region_id", "" };
/// name of each region, by `region_id` (text)
constexpr Name RegionNames{ "region_names", "" };
/// name of the region (text)
constexpr Name Region{ "region", "" };
/// lower limit of the height band
constexpr Name HeightFrom{ "height_from", "m" };
/// upper limit of the height band
constexpr Name HeightTo{ "height_to", "m" };
/// places in the row
constexpr Name Places{ "places", "1" };
/// standard error of the mean `detection_probability`
constexpr Name DetectionStdError{ "detection_std_error", "1" };
/// standard error of the mean `track_probability`
constexpr Name TrackStdError{ "track_std_error", "1" };

// Colours and coordinates (point data, field data).
/// hue of the energy, 240 at Qlow to 0 at Qhigh (Eq. 13)
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
/// coordinate reference system of the points as WKT (text)
constexpr Name CrsWkt{ "crs_wkt", "" };

// Range image (field data).
/// azimuth of each column
constexpr Name ColumnAzimuths{ "column_azimuths", "deg" };
/// elevation of each row
constexpr Name RowElevations{ "row_elevations", "deg" };

// Clutter filter (point data, field data).
/// share of the earlier scans with an echo in this place; in the table its persistence
constexpr Name ClutterProbability{ "clutter_probability", "1" };
/// 1 for clutter, 0 for what may move (unsigned char)
constexpr Name IsClutter{ "is_clutter", "1" };
/// indices of the cell: azimuth, elevation, range (3 ints)
constexpr Name ClutterCell{ "clutter_cell", "" };
/// scans in memory (int)
constexpr Name LearnedScans{ "learned_scans", "1" };
/// property Window
constexpr Name ClutterWindow{ "clutter_window", "1" };
/// property ClutterThreshold
constexpr Name ClutterThreshold{ "clutter_threshold", "1" };
/// property RangeStep
constexpr Name ClutterRangeStep{ "clutter_range_step", "m" };
/// property AzimuthStep
constexpr Name ClutterAzimuthStep{ "clutter_azimuth_step", "deg" };
/// property ElevationStep
constexpr Name ClutterElevationStep{ "clutter_elevation_step", "deg" };
/// property RangeTolerance (int)
constexpr Name ClutterRangeTolerance{ "clutter_range_tolerance", "1" };
/// property AngularTolerance (int)
constexpr Name ClutterAngularTolerance{ "clutter_angular_tolerance", "1" };
/// property WarmUp (int)
constexpr Name ClutterWarmUp{ "clutter_warm_up", "1" };
/// property Learning (int)
constexpr Name ClutterLearning{ "clutter_learning", "1" };
/// time of a cloud in s as ParaView writes it
constexpr Name TimeValue{ "TimeValue", "" };

// Cloud comparison (point data, field data).
/// distance to the nearest point of the other cloud
constexpr Name NearestDistance{ "nearest_distance", "m" };
/// Hausdorff distance (Eq. 19)
constexpr Name HausdorffDistance{ "hausdorff_distance", "m" };
/// largest distance of a simulated point to the reference
constexpr Name HausdorffSimulatedToReference{ "hausdorff_simulated_to_reference", "m" };
/// largest distance of a reference point to the simulated cloud
constexpr Name HausdorffReferenceToSimulated{ "hausdorff_reference_to_simulated", "m" };
/// rms distance of the simulated points to the reference
constexpr Name RMSESimulatedToReference{ "rmse_simulated_to_reference", "m" };
/// rms distance of the reference points to the simulated cloud (Eq. 20)
constexpr Name RMSEReferenceToSimulated{ "rmse_reference_to_simulated", "m" };
/// density-aware Chamfer distance, the mean of both directions
constexpr Name ChamferDistance{ "density_aware_chamfer_distance", "1" };
/// its direction from simulated to reference
constexpr Name ChamferSimulatedToReference{ "density_aware_chamfer_simulated_to_reference", "1" };
/// its direction from reference to simulated
constexpr Name ChamferReferenceToSimulated{ "density_aware_chamfer_reference_to_simulated", "1" };
}

#endif
