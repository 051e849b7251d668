// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarArrays.h
 * @brief Names and units of arrays of points and cells, which stand here only, and of field data
 * that several files use; making and reading of arrays.
 *
 * Used by every filter, reader and test of the module; not installed. Names of coefficients of
 * materials follow from their table in Reflectance.h.
 */
#ifndef vtkAvianLidarArrays_h
#define vtkAvianLidarArrays_h

#include "vtkAOSDataArrayTemplate.h"
#include "vtkAvianLidarText.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationStringKey.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>
#include <string>
#include <vector>

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
constexpr Name SurfaceTexts[] = { ObjectNames, ObjectClasses, MaterialNames };
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
constexpr Name Intensity{ "intensity", "1" };
constexpr Name Distance{ "distance_m", "m" };
constexpr Name ReturnNumber{ "return_number", "1" };
constexpr Name NumberOfReturns{ "number_of_returns", "1" };
constexpr Name LabelShare{ "label_share", "1" };
constexpr Name IncidenceAngle{ "incidence_angle", "deg" };
constexpr Name SecondaryShare{ "secondary_share", "1" };
constexpr Name Status{ "status", "" };
constexpr Name Candidates{ "candidates", "1" };
constexpr Name NodesVisited{ "nodes_visited", "1" };
constexpr Name RaysTraced{ "rays_traced", "1" };
constexpr Name Skipped{ "skipped", "" };
constexpr Name SkippedBound{ "skipped_bound", "J" };

// Mover report (point data).
constexpr Name EffectiveArea{ "effective_area", "m2" };
constexpr Name NumberOfBeams{ "number_of_beams", "1" };
constexpr Name FirstTimestamp{ "first_timestamp", "us" };
constexpr Name FirstPosition{ "first_position", "m" };
constexpr Name LastTimestamp{ "last_timestamp", "us" };
constexpr Name LastPosition{ "last_position", "m" };
constexpr Name NumberOfEchoes{ "number_of_echoes", "1" };
constexpr Name DetectionProbability{ "detection_probability", "1" };

// Coverage (point data, field data, and columns of the table).
constexpr Name TrackProbability{ "track_probability", "1" };
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

// Comparison of two clouds (point data; field data).
constexpr Name NearestDistance{ "nearest_distance", "m" };
constexpr Name HausdorffDistance{ "hausdorff_distance", "m" };
constexpr Name HausdorffSimulatedToReference{ "hausdorff_simulated_to_reference", "m" };
constexpr Name HausdorffReferenceToSimulated{ "hausdorff_reference_to_simulated", "m" };
constexpr Name RMSESimulatedToReference{ "rmse_simulated_to_reference", "m" };
constexpr Name RMSEReferenceToSimulated{ "rmse_reference_to_simulated", "m" };

/// Attach the unit to an array (vtkDataArray::UNITS_LABEL).
inline void SetUnit(vtkAbstractArray* array, const char* unit)
{
  if (unit && *unit)
  {
    array->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), unit);
  }
}

/// Set the number of tuples of a new array, whose components are set; values are not initialised.
/// VTK's own way ends the process where there is no memory (as Debian builds it): this throws
/// std::bad_alloc.
template <class ValueT>
void SetTuples(vtkAOSDataArrayTemplate<ValueT>* array, vtkIdType tuples)
{
  const vtkIdType values = tuples * array->GetNumberOfComponents();
  void* place =
    values > 0 ? std::malloc(static_cast<std::size_t>(values) * sizeof(ValueT)) : nullptr;
  if (values > 0 && !place)
  {
    throw std::bad_alloc();
  }
  array->SetArray(static_cast<ValueT*>(place), values, 0, vtkAbstractArray::VTK_DATA_ARRAY_FREE);
}
inline void SetTuples(vtkStringArray* array, vtkIdType tuples)
{
  array->SetNumberOfTuples(tuples);
}

/// A new array of the given type with name, unit, components and tuples set; values are not
/// initialised.
template <class ArrayT>
vtkSmartPointer<ArrayT> Make(const Name& name, vtkIdType tuples = 0, int components = 1)
{
  auto array = vtkSmartPointer<ArrayT>::New();
  array->SetName(name.name);
  array->SetNumberOfComponents(components);
  SetTuples(array.Get(), tuples);
  SetUnit(array, name.unit);
  return array;
}

/// The same of one component, with values.
template <class ArrayT, class Values>
vtkSmartPointer<ArrayT> MakeOf(const Name& name, const Values& values)
{
  auto array = Make<ArrayT>(name, static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

/// Points in double precision, not initialised.
inline vtkSmartPointer<vtkPoints> MakePoints(vtkIdType count)
{
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  SetTuples(coordinates.Get(), count);
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(coordinates);
  return points;
}

/// Put one double value (with unit) into field data, replacing an array of that name.
inline void SetFieldValue(vtkFieldData* fields, const Name& name, double value)
{
  auto array = Make<vtkDoubleArray>(name, 1);
  array->SetValue(0, value);
  fields->AddArray(array);
}

/// The same of an integer.
inline void SetFieldInteger(vtkFieldData* fields, const Name& name, int value)
{
  auto array = Make<vtkIntArray>(name, 1);
  array->SetValue(0, value);
  fields->AddArray(array);
}

/// Put strings into field data, as UTF-8, replacing an array of that name.
inline void SetFieldStrings(
  vtkFieldData* fields, const Name& name, const std::vector<std::string>& values)
{
  auto array = Make<vtkStringArray>(name, static_cast<vtkIdType>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    array->SetValue(static_cast<vtkIdType>(i), vtkAvianLidarText(values[i]));
  }
  fields->AddArray(array);
}

/// Empty if the array (null: fine) has as many components and tuples as expected; otherwise what is
/// wrong with it.
/// @param kind "point array" or "cell array"
inline std::string CheckShape(
  vtkDataArray* array, const char* kind, int components, vtkIdType tuples)
{
  if (!array ||
    (array->GetNumberOfComponents() == components && array->GetNumberOfTuples() == tuples))
  {
    return {};
  }
  const bool width = array->GetNumberOfComponents() != components;
  return std::string(kind) + " '" + array->GetName() + "' has " +
    std::to_string(width ? array->GetNumberOfComponents() : array->GetNumberOfTuples()) +
    (width ? " components, expected " : " values, expected ") +
    std::to_string(width ? components : tuples);
}

/// The error of an array that holds no numbers. @param kind "point array", "cell array" or
/// "field data"
inline std::string NotNumeric(const char* kind, const char* name)
{
  return std::string(kind) + " '" + name + "' holds no numbers, expected numbers";
}

/// Empty if there is no array of the name, or if it holds numbers; otherwise what is wrong.
/// @param kind as above
inline std::string CheckNumeric(vtkFieldData* arrays, const Name& name, const char* kind)
{
  return !arrays->GetAbstractArray(name.name) || arrays->GetArray(name.name)
    ? std::string()
    : NotNumeric(kind, name.name);
}

/// The same for text.
inline std::string CheckText(vtkFieldData* fields, const Name& name)
{
  vtkAbstractArray* array = fields->GetAbstractArray(name.name);
  return !array || vtkStringArray::SafeDownCast(array)
    ? std::string()
    : std::string("field data '") + name.name + "' holds no text, expected text";
}

/// True for the whole numbers that an int holds.
inline bool IsInt(double value)
{
  return value >= -2147483648.0 && value <= 2147483647.0 && value == std::floor(value);
}

/// Read one finite number of any numeric type from field data; false if there is none, or anything
/// else than one.
inline bool GetFieldValue(vtkFieldData* fields, const Name& name, double& value)
{
  vtkDataArray* array = fields ? fields->GetArray(name.name) : nullptr;
  if (!array || array->GetNumberOfValues() != 1)
  {
    return false;
  }
  value = array->GetComponent(0, 0);
  return std::isfinite(value);
}

/// The same where it may be absent: empty if it is (the value stays) or if it was read, otherwise
/// what is wrong.
inline std::string ReadFieldValue(vtkFieldData* fields, const Name& name, double& value)
{
  double read = value;
  if (fields && fields->GetAbstractArray(name.name) && !GetFieldValue(fields, name, read))
  {
    return std::string("field data '") + name.name + "' is not one finite number";
  }
  value = read;
  return {};
}
}

#endif
