// SPDX-License-Identifier: BSD-3-Clause
#include "ScanPattern.h"

#include "ValueError.h"
#include "Vector.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace avianlidar
{
namespace
{
Vec3 directionOf(double azimuthDegrees, double elevationDegrees)
{
  const auto [se, ce] = sinCosDegrees(elevationDegrees);
  const auto [sa, ca] = sinCosDegrees(azimuthDegrees);
  return { ce * sa, ce * ca, se };
}

/// An angle turned into [0, 360), deg.
double wrapDegrees(double degrees)
{
  double wrapped = std::fmod(degrees, 360.0);
  wrapped += wrapped < 0.0 ? 360.0 : 0.0;
  // A tiny negative angle rounds up to 360 itself.
  return wrapped < 360.0 ? wrapped : 0.0;
}

double offsetOf(const ScanPattern& pattern, int channel)
{
  return pattern.azimuthOffsets.empty() ? 0.0 : pattern.azimuthOffsets[channel];
}

/// Light of a channel before the prisms at time 0, in the frame of their axis.
Vec3 enterOf(const ScanPattern& pattern, int channel)
{
  return directionOf(offsetOf(pattern, channel), channelElevation(pattern, channel));
}

double columnCount(const ScanPattern& pattern)
{
  if (pattern.table)
  {
    return static_cast<double>(pattern.table->directions.size());
  }
  if (!pattern.prisms.none())
  {
    const double columns =
      1.0 / (pattern.rotationRate * (numberOfChannels(pattern) * pattern.firingInterval));
    return std::floor(columns * (1.0 + 1e-12) + 1e-9); // the margins cover rounding
  }
  const double steps = (pattern.azimuthEnd - pattern.azimuthStart) / pattern.azimuthStep;
  return std::max(1.0, std::ceil(steps - 1e-9)); // the start is included, however short the range
}

/// Time that a column lasts, s.
double columnLength(const ScanPattern& pattern)
{
  return pattern.prisms.none() ? 1.0 / (columnCount(pattern) * pattern.rotationRate)
                               : numberOfChannels(pattern) * pattern.firingInterval;
}

/// Error of a sector of azimuths, deg; empty if the sector is valid.
std::string checkSector(const std::string& name, double from, double to)
{
  return firstError({ rangeError("the start of " + name, from, -360.0, 360.0,
                        "an angle within [-360, 360] degrees"),
    rangeError("the end of " + name, to, std::nextafter(from, Infinity), from + 360.0,
      "an angle after the start and at most 360 degrees after it") });
}

std::string checkElevations(const ScanPattern& pattern)
{
  const char* const expected = "an elevation within [-90, 90] degrees";
  const int channels = numberOfChannels(pattern);
  if (pattern.elevations.empty())
  {
    // The elevations increase, so that the checks of the first and the last elevation suffice.
    return firstError({
      rangeError("NumberOfChannels", channels, 1.0, LargestFinite, "at least 1"),
      rangeError("MinimumElevation", pattern.minimumElevation, -90.0, LargestFinite, expected),
      rangeError("ElevationStep", pattern.elevationStep, channels > 1 ? AboveZero : -LargestFinite,
        LargestFinite, "an angle above 0 degrees"),
      rangeError("the elevation of channel " + std::to_string(channels - 1) +
          " (MinimumElevation + ElevationStep * (NumberOfChannels - 1))",
        channelElevation(pattern, channels - 1), -90.0, 90.0, expected),
    });
  }
  std::string error;
  for (int channel = 0; channel < channels && error.empty(); ++channel)
  {
    error =
      rangeError("the elevation of channel " + std::to_string(channel) + " (its ChannelElevation)",
        pattern.elevations[channel], -90.0, 90.0, expected);
  }
  return error;
}

std::string checkNumberOfBeams(const ScanPattern& pattern, const std::string& by)
{
  return rangeError("the number of beams", columnCount(pattern) * numberOfChannels(pattern), 0.0,
    1e9,
    "at most 1e9 (" + by + " or " +
      (pattern.elevations.empty() ? "NumberOfChannels)" : "NumberOfChannelElevations)"));
}

std::string checkAzimuths(const ScanPattern& pattern)
{
  return pattern.prisms.none()
    ? firstError({ checkSector("AzimuthRange", pattern.azimuthStart, pattern.azimuthEnd),
        rangeError(
          "AzimuthStep", pattern.azimuthStep, AboveZero, LargestFinite, "an angle above 0 degrees"),
        checkNumberOfBeams(pattern, "AzimuthStep") })
    : std::string();
}

std::string checkTables(const ScanPattern& pattern)
{
  const auto channels = static_cast<std::size_t>(numberOfChannels(pattern));
  const std::vector<double>& offsets = pattern.azimuthOffsets;
  const std::vector<double>& sectors = pattern.blankedSectors;
  std::string error = firstError({
    sizeError(
      "ChannelAzimuthOffsets", offsets.empty() ? channels : offsets.size(), channels, "channels"),
    rangeErrorOf(
      "ChannelAzimuthOffsets", offsets, -180.0, 180.0, "an angle within [-180, 180] degrees"),
    sectors.size() % 2 != 0 ? "BlankedSectors has an odd number of values, expected pairs: from, to"
                            : "",
  });
  for (std::size_t i = 0; i + 1 < sectors.size() && error.empty(); i += 2)
  {
    error = checkSector("BlankedSectors", sectors[i], sectors[i + 1]);
  }
  return error;
}

/// Error of the prisms of a pattern with valid tables; empty if the prisms are valid.
std::string checkTrain(const ScanPattern& pattern)
{
  const PrismTrain& train = pattern.prisms;
  if (train.none())
  {
    return train.refractiveIndices.empty() && train.rotationRates.empty() && train.phases.empty() &&
        train.axisElevation == 0.0 && train.axisRotationRate == 0.0 &&
        train.laserRotationRate == 0.0
      ? std::string()
      : "PrismWedgeAngles is empty, expected one angle for each prism, as other numbers of prisms "
        "are given";
  }
  if (!pattern.blankedSectors.empty())
  {
    return "BlankedSectors has values, expected none with prisms, whose beams have no columns by "
           "azimuth";
  }
  std::vector<Vec3> enters;
  for (int channel = 0; channel < numberOfChannels(pattern); ++channel)
  {
    enters.push_back(enterOf(pattern, channel));
  }
  return checkPrisms(train, enters);
}

/// Error of the firings within a column. @param steered true if prisms steer the beams
std::string checkFirings(const ScanPattern& pattern, bool steered)
{
  std::string error =
    rangeError("FiringInterval", pattern.firingInterval, steered ? AboveZero : 0.0, LargestFinite,
      steered ? "a time above 0 s with prisms" : "a time of at least 0 s");
  if (!error.empty())
  {
    return error;
  }
  const int channels = numberOfChannels(pattern);
  const double firings = channels * pattern.firingInterval;
  const double room = steered ? 1.0 / pattern.rotationRate : columnLength(pattern);
  // The slack admits a column that is filled to the last firing.
  const bool fits = steered ? columnCount(pattern) >= 1.0
                            : !pattern.firingTimes.empty() || firings <= room * (1.0 + 1e-12);
  std::ostringstream text;
  if (!fits)
  {
    text << "FiringInterval is " << pattern.firingInterval << " s, so the " << channels
         << " firings of a column take " << firings << " s, expected at most the " << room
         << (steered ? " s that RotationRate leaves to a scan"
                     : " s that RotationRate and AzimuthStep leave to a column");
    return text.str();
  }
  error = steered ? checkNumberOfBeams(pattern, "FiringInterval, RotationRate") : "";
  if (error.empty() && !pattern.firingTimes.empty())
  {
    text << "0 s to the " << columnLength(pattern) << " s that a column lasts";
    error = firstError({ sizeError("ChannelFiringTimes", pattern.firingTimes.size(),
                           static_cast<std::size_t>(channels), "channels"),
      rangeErrorOf(
        "ChannelFiringTimes", pattern.firingTimes, 0.0, columnLength(pattern), text.str()) });
  }
  return error;
}

std::string checkClock(const ScanPattern& pattern)
{
  std::string error = rangeError("RotationRate", pattern.rotationRate, MinimumRotationRate,
    MaximumRotationRate, "1e-20 to 1e20 Hz");
  if (!error.empty() || !pattern.table)
  {
    return error.empty() ? checkFirings(pattern, !pattern.prisms.none()) : error;
  }
  const double turn = 1.0 / pattern.rotationRate;
  std::ostringstream text;
  text << "0 to the " << turn << " s of a scan (RotationRate)";
  const std::vector<double>& times = pattern.table->times;
  for (std::size_t i = 0; i < times.size() && error.empty(); ++i)
  {
    error = rangeError("the time of beam " + std::to_string(i), times[i], 0.0, turn, text.str());
  }
  return error;
}
}

std::array<double, 2> sinCosDegrees(double degrees)
{
  int quadrant = 0;
  const double rest = std::remquo(degrees, 90.0, &quadrant) * RadiansPerDegree;
  const double s = std::sin(rest);
  const double c = std::cos(rest);
  const std::array<double, 2> turned[] = { { s, c }, { c, -s }, { -s, -c }, { -c, s } };
  return turned[static_cast<unsigned int>(quadrant) & 3u];
}

int numberOfChannels(const ScanPattern& pattern)
{
  return pattern.table           ? 1
    : pattern.elevations.empty() ? pattern.channels
                                 : static_cast<int>(pattern.elevations.size());
}

std::int64_t numberOfColumns(const ScanPattern& pattern)
{
  return static_cast<std::int64_t>(columnCount(pattern));
}

std::int64_t numberOfBeams(const ScanPattern& pattern)
{
  return numberOfColumns(pattern) * numberOfChannels(pattern);
}

double channelElevation(const ScanPattern& pattern, int channel)
{
  return pattern.elevations.empty() ? pattern.minimumElevation + channel * pattern.elevationStep
                                    : pattern.elevations[channel];
}

int firingSlot(int channel, int channels)
{
  const int half = (channels + 1) / 2;
  return channel < half ? 2 * channel : 2 * (channel - half) + 1;
}

double firingTime(const ScanPattern& pattern, int channel)
{
  return pattern.firingTimes.empty()
    ? firingSlot(channel, numberOfChannels(pattern)) * pattern.firingInterval
    : pattern.firingTimes[channel];
}

double beamTime(const ScanPattern& pattern, std::int64_t column, int channel)
{
  if (pattern.table)
  {
    return pattern.table->times[static_cast<std::size_t>(column)];
  }
  return firingTime(pattern, channel) +
    (pattern.prisms.none() ? column / (columnCount(pattern) * pattern.rotationRate)
                           : static_cast<double>(column) * columnLength(pattern));
}

double pulseInterval(const ScanPattern& pattern)
{
  if (pattern.table)
  {
    return Infinity;
  }
  const bool oneReceiver = pattern.firingTimes.empty() && pattern.firingInterval > 0.0 &&
    (numberOfChannels(pattern) > 1 || !pattern.prisms.none());
  return oneReceiver ? pattern.firingInterval : columnLength(pattern);
}

bool isBlanked(const ScanPattern& pattern, std::int64_t column)
{
  const std::vector<double>& sectors = pattern.blankedSectors;
  const double azimuth = pattern.azimuthStart + column * pattern.azimuthStep;
  bool blanked = false;
  for (std::size_t i = 0; i + 1 < sectors.size() && !pattern.table; i += 2)
  {
    blanked = blanked || wrapDegrees(azimuth - sectors[i]) < sectors[i + 1] - sectors[i];
  }
  return blanked;
}

std::int64_t numberOfFirings(const ScanPattern& pattern)
{
  std::int64_t columns = numberOfColumns(pattern);
  for (std::int64_t column = pattern.blankedSectors.empty() ? 0 : columns; column-- > 0;)
  {
    columns -= isBlanked(pattern, column) ? 1 : 0;
  }
  return columns * numberOfChannels(pattern);
}

glm::dmat3 rotationOf(double yawDegrees, double pitchDegrees, double rollDegrees)
{
  const auto [sy, cy] = sinCosDegrees(yawDegrees);
  const auto [sp, cp] = sinCosDegrees(pitchDegrees);
  const auto [sr, cr] = sinCosDegrees(rollDegrees);
  // Each matrix is given by its columns.
  const glm::dmat3 yaw(Vec3(cy, -sy, 0.0), Vec3(sy, cy, 0.0), Vec3(0.0, 0.0, 1.0));
  const glm::dmat3 pitch(Vec3(1.0, 0.0, 0.0), Vec3(0.0, cp, sp), Vec3(0.0, -sp, cp));
  const glm::dmat3 roll(Vec3(cr, 0.0, -sr), Vec3(0.0, 1.0, 0.0), Vec3(sr, 0.0, cr));
  return yaw * pitch * roll;
}

Vec3 anglesOf(const glm::dmat3& rotation)
{
  const Vec3& ahead = rotation[1];
  const double yaw = std::atan2(ahead.x, ahead.y) / RadiansPerDegree;
  const double pitch = std::atan2(ahead.z, std::hypot(ahead.x, ahead.y)) / RadiansPerDegree;
  // The rest after yaw and pitch, so that the roll also holds for a sensor that looks straight up.
  const Vec3 up = glm::transpose(rotationOf(yaw, pitch, 0.0)) * rotation[2];
  return { yaw, pitch, std::atan2(up.x, up.z) / RadiansPerDegree };
}

double durationOf(const ScanPattern& pattern)
{
  double last = 0.0;
  const std::int64_t columns = numberOfColumns(pattern);
  for (std::int64_t column = pattern.table ? 0 : columns - 1; column < columns; ++column)
  {
    for (int channel = 0; channel < numberOfChannels(pattern); ++channel)
    {
      last = std::max(last, beamTime(pattern, column, channel));
    }
  }
  return last;
}

std::string checkPattern(const ScanPattern& pattern)
{
  if (!isFinite({ pattern.yaw, pattern.pitch, pattern.roll }))
  {
    return "Orientation is not finite, expected yaw, pitch and roll in degrees";
  }
  std::string error;
  for (auto check : { checkElevations, checkAzimuths, checkTables, checkTrain })
  {
    error = error.empty() && !pattern.table ? check(pattern) : error;
  }
  return error.empty() ? checkClock(pattern) : error;
}

ScanGenerator::ScanGenerator(const ScanPattern& pattern, int revolution)
  : Pattern(pattern)
  , Start(revolution / pattern.rotationRate)
  , Channels(numberOfChannels(pattern))
  , Beams(numberOfBeams(pattern))
  , Tilted(pattern.pitch != 0.0 || pattern.roll != 0.0)
  , Rotation(rotationOf(pattern.yaw, pattern.pitch, pattern.roll))
{
}

ScanBeam ScanGenerator::beam(std::int64_t index) const
{
  const ScanPattern& pattern = this->Pattern;
  const std::int64_t column = this->column(index);
  ScanBeam beam;
  beam.channel = static_cast<int>(index % this->Channels);
  beam.time = beamTime(pattern, column, beam.channel);
  const double azimuth =
    pattern.azimuthStart + column * pattern.azimuthStep + offsetOf(pattern, beam.channel);
  if (pattern.table)
  {
    const auto number = static_cast<std::size_t>(index);
    beam.direction = this->Rotation * pattern.table->directions[number];
    beam.origin =
      pattern.table->origins.empty() ? Vec3(0.0) : this->Rotation * pattern.table->origins[number];
  }
  else if (!pattern.prisms.none())
  {
    beam.direction = this->Rotation *
      steer(pattern.prisms, this->Start, beam.time, enterOf(pattern, beam.channel));
  }
  else if (this->Tilted)
  {
    beam.direction = this->Rotation * directionOf(azimuth, channelElevation(pattern, beam.channel));
  }
  else
  {
    // The arctangent is not used here, so that the angles equal the input angles.
    beam.azimuth = wrapDegrees(azimuth + pattern.yaw);
    beam.elevation = channelElevation(pattern, beam.channel);
    beam.direction = directionOf(azimuth + pattern.yaw, beam.elevation);
    return beam;
  }
  const Vec3& d = beam.direction;
  beam.azimuth = wrapDegrees(std::atan2(d.x, d.y) / RadiansPerDegree);
  beam.elevation = std::atan2(d.z, std::hypot(d.x, d.y)) / RadiansPerDegree;
  return beam;
}
}
