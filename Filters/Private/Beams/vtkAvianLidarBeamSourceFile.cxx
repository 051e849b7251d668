// SPDX-License-Identifier: BSD-3-Clause
// Sets properties of vtkAvianLidarBeamSource from sensor files and tables of beams, and lists the
// properties whose values are assumed.
#include "vtkAvianLidarBeamSourceInternals.h"

#include "AvailableMemory.h"
#include "Table.h"
#include "ValueError.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarRequire.h"

#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>

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
  const auto unlessZero = [&](double Source::*property, double Sensor::*member) -> Scalar
  {
    Scalar scalar = ofSensor(property, member);
    scalar.onlyWith = property;
    return scalar;
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
    { Arrays::PrismLaserRotationRate, &Source::PrismLaserRotationRate, nullptr,
      &Source::PrismLaserRotationRate },
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
    unlessZero(&Source::ResponseTime, &Sensor::responseTime),
    unlessZero(&Source::DigitiserRate, &Sensor::digitiserRate),
    unlessZero(&Source::DigitiserBits, &Sensor::digitiserBits),
    { Arrays::DisplayLength, &Source::DisplayLength, nullptr },
    { Arrays::SwayAmplitude, &Source::SwayAmplitude, nullptr, &Source::SwayAmplitude },
    { Arrays::SwayFrequency, &Source::SwayFrequency, nullptr, &Source::SwayAmplitude },
    { Arrays::EncoderJitter, &Source::EncoderJitter, nullptr, &Source::EncoderJitter } };
  return all;
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::vtkInternals::ReadTable(
  vtkPolyData* beams, avianlidar::BeamTable& table)
{
  const vtkIdType count = beams->GetNumberOfPoints();
  vtkAvianLidarRequire(count > 0 ? "" : "it has no points, expected one for each beam");
  avianlidar::requireMemory(static_cast<double>(count), "beams", sizeof(double) * 7.0 * count);
  vtkPointData* arrays = beams->GetPointData();
  Arrays::RequireNumeric(arrays, Arrays::Direction, "point array");
  Arrays::RequireNumeric(arrays, Arrays::Timestamp, "point array");
  vtkDataArray* directions = arrays->GetArray(Arrays::Direction.name);
  vtkDataArray* timestamps = arrays->GetArray(Arrays::Timestamp.name);
  vtkAvianLidarRequire(
    directions ? "" : "point array 'direction' is missing, expected 3 numbers per beam");
  Arrays::RequireShape(directions, "point array", 3, count);
  Arrays::RequireShape(timestamps, "point array", 1, count);
  table.times.assign(static_cast<std::size_t>(count), 0.0);
  for (vtkIdType i = 0; i < count; ++i)
  {
    avianlidar::Vec3 d;
    avianlidar::Vec3 origin;
    directions->GetTuple(i, &d.x);
    beams->GetPoint(i, &origin.x);
    const std::string bad = !avianlidar::isFinite(d) || (d.x == 0.0 && d.y == 0.0 && d.z == 0.0)
      ? "point array 'direction' is zero or not finite, expected any length above 0"
      : avianlidar::checkPosition(origin);
    if (!bad.empty())
    {
      vtkAvianLidarRequire(bad, "beam " + std::to_string(i) + ": ");
    }
    table.directions.push_back(avianlidar::unitVector(d));
    table.origins.push_back(origin);
    if (timestamps)
    {
      table.times[static_cast<std::size_t>(i)] = 1e-6 * timestamps->GetComponent(i, 0);
    }
  }
}

//------------------------------------------------------------------------------
std::vector<double> vtkAvianLidarBeamSource::vtkInternals::PulseOf(const Source& self)
{
  std::vector<double> samples;
  if (!self.PulseFileName.empty())
  {
    const auto add = [&](const avianlidar::TableLine& line, std::size_t)
    {
      samples.push_back(line.number(0, "time_s", -1e23, 1e23));
      samples.push_back(line.number(1, "power", 0.0, avianlidar::MaximumEnergy));
    };
    avianlidar::readTable(avianlidar::textOfFile("PulseFileName", self.PulseFileName),
      self.PulseFileName, { "time_s,power" }, add);
    return samples;
  }
  vtkAvianLidarRequire(avianlidar::sizeError(
    "PulsePowers", self.PulsePowers.size(), self.PulseTimes.size(), "PulseTimes"));
  for (std::size_t i = 0; i < self.PulseTimes.size(); ++i)
  {
    samples.push_back(self.PulseTimes[i]);
    samples.push_back(self.PulsePowers[i]);
  }
  return samples;
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
    const auto is = [&](const Arrays::Name& name) { return entry.name == name.name; };
    const auto findIn = [&](const auto& all) {
      return std::find_if(all.begin(), all.end(), [&](const auto& one) { return is(one.first); });
    };
    const std::vector<Scalar>& all = Scalars();
    const auto scalar =
      std::find_if(all.begin(), all.end(), [&](const Scalar& one) { return is(one.name); });
    const auto integer = findIn(Integers());
    const auto table = findIn(Tables());
    if (scalar != all.end())
    {
      require(scalar->name, 1);
      self.*scalar->property = entry.values[0];
    }
    else if (integer != Integers().end())
    {
      require(integer->first, 1);
      if (!Arrays::IsInt(entry.values[0]))
      {
        file.Fail(entry, "expected a whole number");
      }
      self.*integer->second = static_cast<int>(entry.values[0]);
    }
    else if (is(Arrays::Wavelength))
    {
      require(Arrays::Wavelength, 1);
      self.Frequency = avianlidar::SpeedOfLight / (1e-9 * entry.values[0]);
    }
    else if (is(Arrays::AzimuthRange))
    {
      require(Arrays::AzimuthRange, 2);
      std::copy(entry.values.begin(), entry.values.end(), self.AzimuthRange);
    }
    else if (table != Tables().end())
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
  Apply(vtkAvianLidarSensorFile::Preset(name), self);
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
  for (const auto& [integer, value] : Integers())
  {
    if (name == integer.name)
    {
      return { static_cast<double>(self.*value) };
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
  return { WavelengthOf(self) };
}

//------------------------------------------------------------------------------
std::vector<std::string> vtkAvianLidarBeamSource::vtkInternals::AssumedOf(const Source& self)
{
  AssumedValues assumed = self.Assumed;
  if (assumed.empty())
  {
    // Without a file, take the assumed values of the most similar sensor with a photon receiver.
    static const vtkAvianLidarSensorFile known[] = { vtkAvianLidarSensorFile::Preset("Search905"),
      vtkAvianLidarSensorFile::Preset("Search1550"),
      vtkAvianLidarSensorFile::Preset("Automotive16") };
    std::size_t most = 0;
    for (const vtkAvianLidarSensorFile& sensor : known)
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
