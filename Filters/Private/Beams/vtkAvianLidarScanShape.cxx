// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarScanShape.h"

#include "AvailableMemory.h"
#include "vtkAvianLidarPassedKey.h"

#include "vtkInformation.h"

#include <algorithm>

namespace
{
/// Indices of the numbers under the key: six angles, deg, and the first elevation. The azimuth
/// offsets of all channels follow the elevations of all channels.
enum
{
  Yaw,
  Pitch,
  Roll,
  Start,
  End,
  Step,
  Channels
};

/// Memory of a beam's angles, channel and cell, and of sorted copies of the angles, bytes.
constexpr double BytesPerPlacedBeam = 64.0;

vtkAvianLidarPassedKey* Shape()
{
  static vtkAvianLidarPassedKey* const key =
    new vtkAvianLidarPassedKey("SCAN_SHAPE", "vtkAvianLidarBeamSource");
  return key;
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanShape::Publish(const avianlidar::ScanPattern& pattern, vtkInformation* output)
{
  Shape()->Remove(output);
  if (pattern.table || !pattern.prisms.none() || !avianlidar::checkPattern(pattern).empty())
  {
    return;
  }
  std::vector<double> values{ pattern.yaw, pattern.pitch, pattern.roll, pattern.azimuthStart,
    pattern.azimuthEnd, pattern.azimuthStep };
  for (int channel = 0; channel < avianlidar::numberOfChannels(pattern); ++channel)
  {
    values.push_back(avianlidar::channelElevation(pattern, channel));
  }
  std::vector<double> offsets = pattern.azimuthOffsets;
  offsets.resize(avianlidar::numberOfChannels(pattern), 0.0);
  values.insert(values.end(), offsets.begin(), offsets.end());
  Shape()->Set(output, values.data(), static_cast<int>(values.size()));
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanShape::Follow(vtkInformation* input, vtkInformation* output)
{
  if (!Shape()->Has(input))
  {
    Shape()->Remove(output);
  }
}

//------------------------------------------------------------------------------
vtkAvianLidarScanShape::WholeScan vtkAvianLidarScanShape::Read(vtkInformation* beams)
{
  WholeScan whole;
  if (!Shape()->Has(beams))
  {
    return whole;
  }
  const double* values = Shape()->Get(beams);
  avianlidar::ScanPattern pattern;
  pattern.yaw = values[Yaw];
  pattern.pitch = values[Pitch];
  pattern.roll = values[Roll];
  pattern.azimuthStart = values[Start];
  pattern.azimuthEnd = values[End];
  pattern.azimuthStep = values[Step];
  const double* const elevations = values + Channels;
  const double* const offsets = elevations + (Shape()->Length(beams) - Channels) / 2;
  pattern.elevations.assign(elevations, offsets);
  pattern.azimuthOffsets.assign(offsets, values + Shape()->Length(beams));
  const avianlidar::ScanGenerator scan(pattern);
  const double count = static_cast<double>(scan.size());
  avianlidar::requireMemory(count, "beams of the whole scan", BytesPerPlacedBeam * count);
  std::vector<int> channels;
  channels.reserve(scan.size());
  whole.Azimuths.reserve(scan.size());
  whole.Elevations.reserve(scan.size());
  for (std::int64_t i = 0; i < scan.size(); ++i)
  {
    const avianlidar::ScanBeam beam = scan.beam(i);
    whole.Azimuths.push_back(beam.azimuth);
    whole.Elevations.push_back(beam.elevation);
    channels.push_back(beam.channel);
  }
  const bool apart = std::any_of(pattern.azimuthOffsets.begin(), pattern.azimuthOffsets.end(),
    [](double offset) { return offset != 0.0; });
  whole.Grid = avianlidar::makeScanGrid(whole.Azimuths, whole.Elevations, channels, apart);
  return whole;
}
