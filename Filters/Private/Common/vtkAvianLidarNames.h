// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarNames.h
 * @brief Names and units of arrays of points and cells, which stand here only, and of field data
 * that several files use.
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

// Beams (point data).
constexpr Name BeamId{ "beam_id", "" };
constexpr Name Direction{ "direction", "1" };
constexpr Name ReportedDirection{ "reported_direction", "1" };
constexpr Name LaserId{ "laser_id", "" };
constexpr Name Azimuth{ "azimuth", "0.01 deg" };
constexpr Name VerticalAngle{ "vertical_angle", "deg" };
constexpr Name Timestamp{ "timestamp", "us" };

// The sensor (field data of the beams, one value each), besides sensorFields() (Sensor.h).
constexpr Name AirBackscatter{ "air_backscatter", "1" };
constexpr Name RainRate{ "rain_rate", "mm/h" };
constexpr Name BeamOutline{ "beam_outline", "1" };
constexpr Name ThresholdLaw{ "threshold_law", "1" };
constexpr Name BeamProfile{ "beam_profile", "1" };
constexpr Name LowerEnergyLimit{ "lower_energy_limit", "J" };
constexpr Name UpperEnergyLimit{ "upper_energy_limit", "J" };
constexpr Name ReceiverModel{ "receiver_model", "1" };
constexpr Name Wavelength{ "wavelength", "nm" };
constexpr Name FalseAlarmsPerScan{ "false_alarms_per_scan", "1" };
constexpr Name DynamicRange{ "dynamic_range", "dB" };
constexpr Name Assumed{ "assumed", "" };

// Its scan (field data of the beams).
constexpr Name Position{ "position", "m" };
constexpr Name Orientation{ "orientation", "deg" };
constexpr Name NumberOfChannels{ "number_of_channels", "1" };
constexpr Name MinimumElevation{ "minimum_elevation", "deg" };
constexpr Name ElevationStep{ "elevation_step", "deg" };
constexpr Name ChannelElevations{ "channel_elevations", "deg" };
constexpr Name ChannelAzimuthOffsets{ "channel_azimuth_offsets", "deg" };
constexpr Name ChannelFiringTimes{ "channel_firing_times", "s" };
constexpr Name BlankedSectors{ "blanked_sectors", "deg" };
constexpr Name PrismWedgeAngles{ "prism_wedge_angles", "deg" };
constexpr Name PrismRefractiveIndices{ "prism_refractive_indices", "1" };
constexpr Name PrismRotationRates{ "prism_rotation_rates", "Hz" };
constexpr Name PrismPhases{ "prism_phases", "deg" };
constexpr Name PrismAxisElevation{ "prism_axis_elevation", "deg" };
constexpr Name PrismAxisRotationRate{ "prism_axis_rotation_rate", "Hz" };
constexpr Name AzimuthRange{ "azimuth_range", "deg" };
constexpr Name AzimuthStep{ "azimuth_step", "deg" };
constexpr Name RotationRate{ "rotation_rate", "Hz" };
constexpr Name FiringInterval{ "firing_interval", "s" };
constexpr Name NumberOfRevolutions{ "number_of_revolutions", "1" };
constexpr Name StepsPerRevolution{ "steps_per_revolution", "1" };
constexpr Name Revolution{ "revolution", "" };
constexpr Name SwayAmplitude{ "sway_amplitude", "deg" };
constexpr Name SwayFrequency{ "sway_frequency", "Hz" };
constexpr Name EncoderJitter{ "encoder_jitter", "deg" };
constexpr Name MotionSeed{ "motion_seed", "" };
constexpr Name DisplayLength{ "display_length", "m" };

// Surfaces (cell data and field data).
constexpr Name Part{ "part", "" };
constexpr Name ObjectId{ "object_id", "" };
constexpr Name MaterialId{ "material_id", "" };
constexpr Name ObjectNames{ "object_names", "" };
constexpr Name MaterialNames{ "material_names", "" };
constexpr Name ObjectClasses{ "object_classes", "" };
constexpr Name Medium{ "medium", "" };
constexpr Name Media{ "media", "" };
constexpr Name SurfaceTexts[] = { ObjectNames, ObjectClasses, MaterialNames, Medium, Media };
constexpr Name GeodeticOrigin{ "geodetic_origin", "deg deg m" };
constexpr Name LidarPosition{ "lidar_position", "m" };
constexpr Name Attribution{ "attribution", "" };
constexpr Name SceneReport{ "scene_report", "" };
constexpr Name TreeChecksum{ "tree_checksum", "" };

// Movers (field data), and tracks to draw (point, cell and field data).
constexpr Name PoseTime{ "pose_time", "s" };
constexpr Name PosePosition{ "pose_position", "m" };
constexpr Name PoseOrientation{ "pose_orientation", "1" };
constexpr Name FlapHinge{ "flap_hinge", "m" };
constexpr Name FlapAxis{ "flap_axis", "1" };
constexpr Name FlapAmplitude{ "flap_amplitude", "rad" };
constexpr Name FlapFrequency{ "flap_frequency", "Hz" };
constexpr Name FlapPhase{ "flap_phase", "1" };
constexpr Name Species{ "species", "" };
constexpr Name SpeciesId{ "species_id", "" };
constexpr Name SpeciesNames{ "species_names", "" };
constexpr Name Time{ "time", "s" };

// Why an execution failed (field data of its empty outputs).
constexpr Name Error{ "error", "" };

// Volumes of the collision tree (cell data).
constexpr Name NodeId{ "node_id", "" };
constexpr Name Triangles{ "triangles", "1" };
constexpr Name Depth{ "depth", "1" };

// Echoes and beam report (point data).
constexpr Name Energy{ "energy", "J" };
constexpr Name EnergyReceived{ "energy_received", "J" };
constexpr Name ReturnEnergy{ "return_energy", "J" };
constexpr Name EnergyStdError{ "energy_std_error", "J" };
constexpr Name Photoelectrons{ "photoelectrons", "1" };
constexpr Name SignalToNoise{ "signal_to_noise", "1" };
constexpr Name SeenRadiance{ "seen_radiance", "W/(m2 sr nm)" };
constexpr Name DistanceStdError{ "distance_std_error", "m" };
constexpr Name Intensity{ "intensity", "1" };
constexpr Name Distance{ "distance_m", "m" };
constexpr Name ReturnNumber{ "return_number", "1" };
constexpr Name NumberOfReturns{ "number_of_returns", "1" };
constexpr Name LabelShare{ "label_share", "1" };
constexpr Name IncidenceAngle{ "incidence_angle", "deg" };
constexpr Name SecondaryShare{ "secondary_share", "1" };
constexpr Name Status{ "status", "" };
constexpr Name View{ "view", "" };
constexpr Name Candidates{ "candidates", "1" };
constexpr Name NodesVisited{ "nodes_visited", "1" };
constexpr Name RaysTraced{ "rays_traced", "1" };
constexpr Name Skipped{ "skipped", "" };
constexpr Name SkippedBound{ "skipped_bound", "J" };

// What a beam sees (cell data, and columns of the table).
constexpr Name SolidAngleShare{ "solid_angle_share", "1" };
constexpr Name EnergyShare{ "energy_share", "1" };
constexpr Name Object{ "object", "" };
constexpr Name Material{ "material", "" };
constexpr Name NearestRange{ "nearest_m", "m" };
constexpr Name FarthestRange{ "farthest_m", "m" };

// Mover report (point data).
constexpr Name EffectiveArea{ "effective_area", "m2" };
constexpr Name NumberOfBeams{ "number_of_beams", "1" };
constexpr Name FirstTimestamp{ "first_timestamp", "us" };
constexpr Name FirstPosition{ "first_position", "m" };
constexpr Name LastTimestamp{ "last_timestamp", "us" };
constexpr Name LastPosition{ "last_position", "m" };
constexpr Name NumberOfEchoes{ "number_of_echoes", "1" };
constexpr Name DetectionProbability{ "detection_probability", "1" };

// Tracks of what was detected (point and cell data).
constexpr Name TrackId{ "track_id", "" };
constexpr Name TrackConfirmed{ "track_confirmed", "1" };
constexpr Name Velocity{ "velocity", "m/s" };
constexpr Name PositionCovariance{ "position_covariance", "m2" };
constexpr Name Confirmed{ "confirmed", "1" };
constexpr Name Ended{ "ended", "1" };
constexpr Name Hits{ "hits", "1" };

// Coverage (point data, field data, and columns of the table).
constexpr Name TrackProbability{ "track_probability", "1" };
constexpr Name PoseProbabilities{ "pose_probabilities", "1" };
constexpr Name BeamsPerScan{ "beams_per_scan", "1" };
constexpr Name MinimumEffectiveArea{ "minimum_effective_area", "m2" };
constexpr Name StatusNames{ "status_names", "" };
constexpr Name RegionId{ "region_id", "" };
constexpr Name RegionNames{ "region_names", "" };
constexpr Name Region{ "region", "" };
constexpr Name HeightFrom{ "height_from", "m" };
constexpr Name HeightTo{ "height_to", "m" };
constexpr Name Places{ "places", "1" };
constexpr Name DetectionStdError{ "detection_std_error", "1" };
constexpr Name TrackStdError{ "track_std_error", "1" };

// Colours and coordinates.
constexpr Name Hue{ "hue", "deg" };
constexpr Name Rgb{ "rgb", "1" };
constexpr Name Longitude{ "longitude", "deg" };
constexpr Name Latitude{ "latitude", "deg" };
constexpr Name Height{ "height", "m" };
constexpr Name UTMZone{ "utm_zone", "" };
constexpr Name CrsWkt{ "crs_wkt", "" };

// Range image (field data).
constexpr Name ColumnAzimuths{ "column_azimuths", "deg" };
constexpr Name RowElevations{ "row_elevations", "deg" };

// Clutter (point data; field data), and the time of a cloud as ParaView writes it (field data).
constexpr Name ClutterProbability{ "clutter_probability", "1" };
constexpr Name IsClutter{ "is_clutter", "1" };
constexpr Name ClutterCell{ "clutter_cell", "" };
constexpr Name LearnedScans{ "learned_scans", "1" };
constexpr Name ClutterWindow{ "clutter_window", "1" };
constexpr Name ClutterThreshold{ "clutter_threshold", "1" };
constexpr Name ClutterRangeStep{ "clutter_range_step", "m" };
constexpr Name ClutterAzimuthStep{ "clutter_azimuth_step", "deg" };
constexpr Name ClutterElevationStep{ "clutter_elevation_step", "deg" };
constexpr Name ClutterRangeTolerance{ "clutter_range_tolerance", "1" };
constexpr Name ClutterAngularTolerance{ "clutter_angular_tolerance", "1" };
constexpr Name ClutterWarmUp{ "clutter_warm_up", "1" };
constexpr Name ClutterLearning{ "clutter_learning", "1" };
constexpr Name TimeValue{ "TimeValue", "" };

// Comparison of two clouds (point data; field data).
constexpr Name NearestDistance{ "nearest_distance", "m" };
constexpr Name HausdorffDistance{ "hausdorff_distance", "m" };
constexpr Name HausdorffSimulatedToReference{ "hausdorff_simulated_to_reference", "m" };
constexpr Name HausdorffReferenceToSimulated{ "hausdorff_reference_to_simulated", "m" };
constexpr Name RMSESimulatedToReference{ "rmse_simulated_to_reference", "m" };
constexpr Name RMSEReferenceToSimulated{ "rmse_reference_to_simulated", "m" };
constexpr Name ChamferDistance{ "density_aware_chamfer_distance", "1" };
constexpr Name ChamferSimulatedToReference{ "density_aware_chamfer_simulated_to_reference", "1" };
constexpr Name ChamferReferenceToSimulated{ "density_aware_chamfer_reference_to_simulated", "1" };
}

#endif
