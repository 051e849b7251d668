// SPDX-License-Identifier: BSD-3-Clause
// What vtkAvianLidarBeamSource takes from sensor files and tables of beams, and what it says is
// assumed.
#include "vtkAvianLidarBeamSourceInternals.h"

#include "AvailableMemory.h"
#include "vtkAvianLidarArrays.h"

#include "vtkDoubleArray.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>

namespace Arrays = vtkAvianLidarArrays;

//------------------------------------------------------------------------------
const std::vector<vtkAvianLidarBeamSource::vtkInternals::Scalar>& vtkAvianLidarBeamSource::
  vtkInternals::Scalars()
{
  using Sensor = avianlidar::Sensor;
  const auto ofSensor = [](double Source::*property, double Sensor::*member) -> Scalar
  {
    const avianlidar::SensorField& field = avianlidar::sensorField(member);
    return { { field.name, field.unit }, property, member };
  };
  static const std::vector<Scalar> all = { { Arrays::MinimumElevation, &Source::MinimumElevation,
                                             nullptr },
    { Arrays::ElevationStep, &Source::ElevationStep, nullptr },
    { Arrays::AzimuthStep, &Source::AzimuthStep, nullptr },
    { Arrays::RotationRate, &Source::RotationRate, nullptr },
    { Arrays::FiringInterval, &Source::FiringInterval, nullptr },
    { Arrays::PrismAxisElevation, &Source::PrismAxisElevation, nullptr,
      &Source::PrismAxisElevation },
    { Arrays::PrismAxisRotationRate, &Source::PrismAxisRotationRate, nullptr,
      &Source::PrismAxisRotationRate },
    ofSensor(&Source::HalfBeamwidth, &Sensor::halfBeamwidth),
    ofSensor(&Source::HalfBeamwidthAcross, &Sensor::halfBeamwidthAcross),
    ofSensor(&Source::BeamRotation, &Sensor::beamRotation),
    ofSensor(&Source::GaussianTruncation, &Sensor::gaussianTruncation),
    ofSensor(&Source::PulseEnergy, &Sensor::pulseEnergy),
    ofSensor(&Source::PulseWidth, &Sensor::pulseWidth),
    ofSensor(&Source::Frequency, &Sensor::frequency),
    ofSensor(&Source::SamplingInterval, &Sensor::samplingInterval),
    ofSensor(&Source::RangeGate, &Sensor::rangeGate),
    ofSensor(&Source::NoisePhotonRate, &Sensor::noisePhotonRate),
    ofSensor(&Source::LowerEnergyLimit, &Sensor::lowerEnergyLimit),
    ofSensor(&Source::UpperEnergyLimit, &Sensor::upperEnergyLimit),
    ofSensor(&Source::ReceiverAperture, &Sensor::receiverAperture),
    ofSensor(&Source::ReceiverEfficiency, &Sensor::receiverEfficiency),
    ofSensor(&Source::FilterBandwidth, &Sensor::filterBandwidth),
    ofSensor(&Source::BackgroundRadiance, &Sensor::backgroundRadiance),
    ofSensor(&Source::AmplifierNoise, &Sensor::amplifierNoise),
    ofSensor(&Source::ExcessNoiseFactor, &Sensor::excessNoiseFactor),
    { Arrays::FalseAlarmsPerScan, &Source::FalseAlarmsPerScan, nullptr },
    { Arrays::DynamicRange, &Source::DynamicRange, nullptr },
    ofSensor(&Source::Sunlight, &Sensor::sunlight),
    ofSensor(&Source::SunAzimuth, &Sensor::sunAzimuth),
    ofSensor(&Source::SunElevation, &Sensor::sunElevation),
    ofSensor(&Source::MinimumRange, &Sensor::minimumRange),
    ofSensor(&Source::OverlapRange, &Sensor::overlapRange),
    ofSensor(&Source::DefocusRange, &Sensor::defocusRange),
    ofSensor(&Source::RangeNoise, &Sensor::rangeNoise),
    ofSensor(&Source::RangeNoiseExponent, &Sensor::rangeNoiseExponent),
    ofSensor(&Source::RangeNoiseFloor, &Sensor::rangeNoiseFloor),
    ofSensor(&Source::RangeWalk, &Sensor::rangeWalk),
    ofSensor(&Source::RangeQuantum, &Sensor::rangeQuantum),
    { Arrays::DisplayLength, &Source::DisplayLength, nullptr },
    { Arrays::SwayAmplitude, &Source::SwayAmplitude, nullptr, &Source::SwayAmplitude },
    { Arrays::SwayFrequency, &Source::SwayFrequency, nullptr, &Source::SwayAmplitude },
    { Arrays::EncoderJitter, &Source::EncoderJitter, nullptr, &Source::EncoderJitter } };
  return all;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarBeamSource::vtkInternals::ReadTable(
  vtkPolyData* beams, avianlidar::BeamTable& table)
{
  const vtkIdType count = beams->GetNumberOfPoints();
  if (count == 0)
  {
    return "it has no points, expected one for each beam";
  }
  avianlidar::requireMemory(static_cast<double>(count), "beams", sizeof(double) * 7.0 * count);
  for (const Arrays::Name& name : { Arrays::Direction, Arrays::Timestamp })
  {
    const std::string text = Arrays::CheckNumeric(beams->GetPointData(), name, "point array");
    if (!text.empty())
    {
      return text;
    }
  }
  vtkDataArray* directions = beams->GetPointData()->GetArray(Arrays::Direction.name);
  vtkDataArray* timestamps = beams->GetPointData()->GetArray(Arrays::Timestamp.name);
  if (!directions)
  {
    return std::string("point array '") + Arrays::Direction.name +
      "' is missing, expected 3 numbers per beam";
  }
  for (const std::string& wrong : { Arrays::CheckShape(directions, "point array", 3, count),
         Arrays::CheckShape(timestamps, "point array", 1, count) })
  {
    if (!wrong.empty())
    {
      return wrong;
    }
  }
  table.times.assign(static_cast<std::size_t>(count), 0.0);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const std::string beam = "beam " + std::to_string(i) + ": ";
    avianlidar::Vec3 d;
    avianlidar::Vec3 origin;
    directions->GetTuple(i, &d.x);
    beams->GetPoint(i, &origin.x);
    if (!avianlidar::isFinite(d) || (d.x == 0.0 && d.y == 0.0 && d.z == 0.0))
    {
      return beam + "point array '" + Arrays::Direction.name +
        "' is zero or not finite, expected any length above 0";
    }
    const std::string bad = avianlidar::checkPosition(origin);
    if (!bad.empty())
    {
      return beam + bad;
    }
    const avianlidar::Vec3 unit = avianlidar::unitVector(d);
    table.directions.push_back(unit);
    table.origins.push_back(origin);
    if (timestamps)
    {
      table.times[static_cast<std::size_t>(i)] = 1e-6 * timestamps->GetComponent(i, 0);
    }
  }
  return {};
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::vtkInternals::Apply(const vtkAvianLidarSensorFile& file, Source& self)
{
  self.Description = file.text;
  for (const vtkAvianLidarSensorFile::Entry& entry : file.entries)
  {
    const auto require = [&](const Arrays::Name& name, std::size_t count)
    {
      if (entry.unit != name.unit)
      {
        file.Fail(entry, "its unit is \"" + entry.unit + "\", expected \"" + name.unit + "\"");
      }
      if (count > 0 && entry.values.size() != count)
      {
        file.Fail(
          entry, "expected " + std::to_string(count) + (count == 1 ? " number" : " numbers"));
      }
    };
    const auto whole = [&](const Arrays::Name& name)
    {
      require(name, 1);
      if (!Arrays::IsInt(entry.values[0]))
      {
        file.Fail(entry, "expected a whole number");
      }
      return static_cast<int>(entry.values[0]);
    };
    const auto is = [&](const Arrays::Name& name) { return entry.name == name.name; };
    const std::vector<Scalar>& all = Scalars();
    const auto scalar =
      std::find_if(all.begin(), all.end(), [&](const Scalar& one) { return is(one.name); });
    const auto& tables = Tables();
    const auto table =
      std::find_if(tables.begin(), tables.end(), [&](const auto& one) { return is(one.first); });
    if (scalar != all.end())
    {
      require(scalar->name, 1);
      self.*scalar->property = entry.values[0];
    }
    else if (is(Arrays::Wavelength))
    {
      require(Arrays::Wavelength, 1);
      self.Frequency = avianlidar::SpeedOfLight / (1e-9 * entry.values[0]);
    }
    else if (is(Arrays::NumberOfChannels))
    {
      self.NumberOfChannels = whole(Arrays::NumberOfChannels);
    }
    else if (is(Arrays::BeamOutline))
    {
      self.BeamOutline = whole(Arrays::BeamOutline);
    }
    else if (is(Arrays::BeamProfile))
    {
      self.BeamProfile = whole(Arrays::BeamProfile);
    }
    else if (is(Arrays::ThresholdLaw))
    {
      self.ThresholdLaw = whole(Arrays::ThresholdLaw);
    }
    else if (is(Arrays::ReceiverModel))
    {
      self.ReceiverModel = whole(Arrays::ReceiverModel);
    }
    else if (is(Arrays::AzimuthRange))
    {
      require(Arrays::AzimuthRange, 2);
      std::copy(entry.values.begin(), entry.values.end(), self.AzimuthRange);
    }
    else if (table != tables.end())
    {
      require(table->first, 0);
      self.*table->second = entry.values;
    }
    else
    {
      file.Fail(entry,
        "is not a property of a sensor, expected a property of the beam source in snake case");
    }
    if (entry.IsAssumed())
    {
      self.Assumed.emplace_back(entry.name, entry.values);
    }
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::vtkInternals::ApplyPreset(const std::string& name, Source& self)
{
  const vtkAvianLidarSensorFile file = vtkAvianLidarSensorFile::Preset(name);
  Apply(file, self);
  const auto& known = PhotonSensors();
  if (std::any_of(known.begin(), known.end(),
        [&](const vtkAvianLidarSensorFile& one) { return one.name == file.name; }))
  {
    self.Assumed.clear(); // known by their values
  }
}

//------------------------------------------------------------------------------
std::vector<double> vtkAvianLidarBeamSource::vtkInternals::ValuesOf(
  const Source& self, const std::string& name)
{
  for (const Scalar& scalar : Scalars())
  {
    if (name == scalar.name.name)
    {
      return { self.*scalar.property };
    }
  }
  for (const auto& [table, values] : Tables())
  {
    if (name == table.name)
    {
      return self.*values;
    }
  }
  if (name == Arrays::AzimuthRange.name)
  {
    return { self.AzimuthRange[0], self.AzimuthRange[1] };
  }
  return { name == Arrays::Wavelength.name    ? WavelengthOf(self)
      : name == Arrays::NumberOfChannels.name ? self.NumberOfChannels
      : name == Arrays::BeamOutline.name      ? self.BeamOutline
      : name == Arrays::BeamProfile.name      ? self.BeamProfile
      : name == Arrays::ThresholdLaw.name     ? self.ThresholdLaw
                                              : self.ReceiverModel };
}

//------------------------------------------------------------------------------
const std::vector<vtkAvianLidarSensorFile>& vtkAvianLidarBeamSource::vtkInternals::PhotonSensors()
{
  static const std::vector<vtkAvianLidarSensorFile> all = {
    vtkAvianLidarSensorFile::Preset("Search905"), vtkAvianLidarSensorFile::Preset("Search1550"),
    vtkAvianLidarSensorFile::Preset("Automotive16")
  };
  return all;
}

//------------------------------------------------------------------------------
std::vector<std::string> vtkAvianLidarBeamSource::vtkInternals::AssumedOf(const Source& self)
{
  AssumedValues assumed = self.Assumed;
  if (assumed.empty())
  {
    // Not of a file: of the built-in sensor that is most alike.
    std::size_t most = 0;
    for (const vtkAvianLidarSensorFile& sensor : PhotonSensors())
    {
      AssumedValues own;
      std::size_t alike = 0;
      for (const vtkAvianLidarSensorFile::Entry& entry : sensor.entries)
      {
        const bool same = ValuesOf(self, entry.name) == entry.values;
        alike += same ? 1 : 0;
        if (same && entry.IsAssumed())
        {
          own.emplace_back(entry.name, entry.values);
        }
      }
      assumed = alike > most ? own : assumed;
      most = std::max(most, alike);
    }
  }
  std::vector<std::string> names;
  for (const auto& [name, values] : assumed)
  {
    if (ValuesOf(self, name) == values)
    {
      names.push_back(name);
    }
  }
  return names;
}
