// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBeamSourceInternals.h
 * @brief Sets the properties of vtkAvianLidarBeamSource from sensor files, and converts them for
 * the kernel and the field data.
 */
#ifndef vtkAvianLidarBeamSourceInternals_h
#define vtkAvianLidarBeamSourceInternals_h

#include "PointingErrors.h"
#include "Poses.h"
#include "ScanBeams.h"
#include "ScanClock.h"
#include "ScanPattern.h"
#include "Sensor.h"
#include "vtkAvianLidarBeamSource.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarSensorFile.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

class vtkFieldData;
class vtkInformation;
class vtkInformationVector;

struct vtkAvianLidarBeamSource::vtkBeamTable : avianlidar::BeamTable
{
};

struct vtkAvianLidarBeamSource::vtkTrajectory
{
  const vtkPolyData* input = nullptr;
  vtkMTimeType time = 0;
  avianlidar::Poses poses;
};

// Access to the properties of the source, for the kernel and the field data.
struct vtkAvianLidarBeamSource::vtkInternals
{
  using Source = vtkAvianLidarBeamSource;

  // A property that is a number, and the member of the kernel's sensor with the same number. Field
  // data hold the number unless the property `onlyWith` is 0.
  struct Scalar
  {
    vtkAvianLidarArrays::Name name;
    double Source::*property;
    double avianlidar::Sensor::*sensor;
    double Source::*onlyWith = nullptr;
  };
  static const std::vector<Scalar>& Scalars();
  // True if a property has no meaning for the table of beams or for the prisms in use.
  static bool IsUnused(const Source& self, const vtkAvianLidarArrays::Name& name)
  {
    const std::string word = name.name;
    const bool ofColumns = word == vtkAvianLidarArrays::AzimuthStep.name;
    const bool ofPattern = ofColumns || word == vtkAvianLidarArrays::MinimumElevation.name ||
      word == vtkAvianLidarArrays::ElevationStep.name ||
      word == vtkAvianLidarArrays::FiringInterval.name ||
      word == vtkAvianLidarArrays::PrismAxisElevation.name ||
      word == vtkAvianLidarArrays::PrismAxisRotationRate.name ||
      word == vtkAvianLidarArrays::PrismLaserRotationRate.name;
    return self.Table ? ofPattern : ofColumns && self.GetNumberOfPrisms() > 0;
  }

  // Properties that are whole numbers in sensor files.
  static const std::vector<std::pair<vtkAvianLidarArrays::Name, int Source::*>>& Integers()
  {
    static const std::vector<std::pair<vtkAvianLidarArrays::Name, int Source::*>> all = {
      { vtkAvianLidarArrays::NumberOfChannels, &Source::NumberOfChannels },
      { vtkAvianLidarArrays::BeamOutline, &Source::BeamOutline },
      { vtkAvianLidarArrays::BeamProfile, &Source::BeamProfile },
      { vtkAvianLidarArrays::PulseShape, &Source::PulseShape },
      { vtkAvianLidarArrays::ThresholdLaw, &Source::ThresholdLaw },
      { vtkAvianLidarArrays::ReceiverModel, &Source::ReceiverModel }
    };
    return all;
  }

  // Properties that are tables.
  static const std::vector<std::pair<vtkAvianLidarArrays::Name, std::vector<double> Source::*>>&
  Tables()
  {
    static const std::vector<std::pair<vtkAvianLidarArrays::Name, std::vector<double> Source::*>>
      all = { { vtkAvianLidarArrays::ChannelElevations, &Source::ChannelElevations },
        { vtkAvianLidarArrays::ChannelAzimuthOffsets, &Source::ChannelAzimuthOffsets },
        { vtkAvianLidarArrays::ChannelFiringTimes, &Source::ChannelFiringTimes },
        { vtkAvianLidarArrays::BlankedSectors, &Source::BlankedSectors },
        { vtkAvianLidarArrays::PrismWedgeAngles, &Source::PrismWedgeAngles },
        { vtkAvianLidarArrays::PrismRefractiveIndices, &Source::PrismRefractiveIndices },
        { vtkAvianLidarArrays::PrismRotationRates, &Source::PrismRotationRates },
        { vtkAvianLidarArrays::PrismPhases, &Source::PrismPhases },
        { vtkAvianLidarArrays::PulseTimes, &Source::PulseTimes },
        { vtkAvianLidarArrays::PulsePowers, &Source::PulsePowers } };
    return all;
  }

  // Set the properties that a file names. Throws std::exception for an unknown name or unit.
  static void Apply(const vtkAvianLidarSensorFile& file, Source& self);
  // Set the properties that the file of a built-in sensor names. Throws std::out_of_range for an
  // unknown name.
  static void ApplyPreset(const std::string& name, Source& self);
  using AssumedValues = std::vector<std::pair<std::string, std::vector<double>>>;
  // Values of a property, by its name in snake case.
  static std::vector<double> ValuesOf(const Source& self, const std::string& name);
  // Names of the properties in use whose values are assumed.
  static std::vector<std::string> AssumedOf(const Source& self);

  // Read the user's beams. Throws std::runtime_error.
  static void ReadTable(vtkPolyData* beams, avianlidar::BeamTable& table);

  // Time, s, and power of each sample of the pulse. Throws std::runtime_error if the file is bad.
  static std::vector<double> PulseOf(const Source& self);

  // The sensor with the energy limits in use. Throws std::runtime_error if a value is bad.
  static avianlidar::Sensor SensorOf(const Source& self);
  static avianlidar::ScanPattern PatternOf(const Source& self);
  // Wavelength, nm, rounded to 1e-9 nm, so that it equals the value that the user gave.
  static double WavelengthOf(const Source& self)
  {
    return std::round(1e18 * avianlidar::SpeedOfLight / self.Frequency) / 1e9;
  }
  static avianlidar::ScanClock ClockOf(const Source& self);
  static avianlidar::PointingErrors PointingOf(const Source& self)
  {
    return { self.SwayAmplitude, self.SwayFrequency, self.EncoderJitter, self.MotionSeed };
  }
  // Finds the requested part and revolution. Throws std::runtime_error.
  static void FindMoment(
    const Source& self, vtkInformation* asked, avianlidar::ScanPart& part, int& revolution);
  // Throws std::runtime_error for the first bad value.
  static void RequireProperties(const Source& self);
  // The poses of the platform; empty without a trajectory. Throws std::runtime_error unless there
  // are poses at the times of all beams of the revolution.
  static const avianlidar::Poses& TrajectoryOf(
    Source& self, vtkInformationVector* input, int revolution);
  // A warning about a lever arm that is probably a place in the scene; empty: none.
  static std::string WarningOnLeverArm(const Source& self);
  // The sensor as field data of its beams. @param pose pose of the platform
  static void AddSensor(
    const Source& self, int revolution, const avianlidar::Pose& pose, vtkFieldData* fields);
};

#endif
