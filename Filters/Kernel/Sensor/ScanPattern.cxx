// SPDX-License-Identifier: BSD-3-Clause
#include "ScanPattern.h"

#include "ValueError.h"
#include "Vector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace avianlidar
{
namespace
{
constexpr double MaximumBeams = 1e9;

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix multiply(const Matrix& a, const Matrix& b)
{
  Matrix product{};
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      for (int k = 0; k < 3; ++k)
      {
        product[row][column] += a[row][k] * b[k][column];
      }
    }
  }
  return product;
}

Matrix orientation(double yawDegrees, double pitchDegrees, double rollDegrees)
{
  double s, c;
  sinCosDegrees(yawDegrees, s, c);
  const Matrix yaw{ { { c, s, 0.0 }, { -s, c, 0.0 }, { 0.0, 0.0, 1.0 } } };
  sinCosDegrees(pitchDegrees, s, c);
  const Matrix pitch{ { { 1.0, 0.0, 0.0 }, { 0.0, c, -s }, { 0.0, s, c } } };
  sinCosDegrees(rollDegrees, s, c);
  const Matrix roll{ { { c, 0.0, s }, { 0.0, 1.0, 0.0 }, { -s, 0.0, c } } };
  return multiply(multiply(yaw, pitch), roll);
}

/// An angle turned into [0, 360).
double wrapDegrees(double degrees)
{
  double wrapped = std::fmod(degrees, 360.0);
  if (wrapped < 0.0)
  {
    wrapped += 360.0;
  }
  // A tiny negative angle rounds up to 360 itself.
  return wrapped < 360.0 ? wrapped : 0.0;
}

/// Azimuth and elevation of the direction.
void takeAngles(ScanBeam& beam)
{
  const double horizontal = std::hypot(beam.direction[0], beam.direction[1]);
  beam.azimuth = wrapDegrees(std::atan2(beam.direction[0], beam.direction[1]) / RadiansPerDegree);
  beam.elevation = std::atan2(beam.direction[2], horizontal) / RadiansPerDegree;
}

/// Time of a column with prisms, s.
double periodOf(const ScanPattern& pattern)
{
  return numberOfChannels(pattern) * pattern.firingInterval;
}

/// Of light before the prisms, in the frame of their axis.
std::array<double, 3> enterOf(const ScanPattern& pattern, int channel)
{
  double se, ce, sa, ca;
  sinCosDegrees(channelElevation(pattern, channel), se, ce);
  sinCosDegrees(pattern.azimuthOffsets.empty() ? 0.0 : pattern.azimuthOffsets[channel], sa, ca);
  return { { ce * sa, ce * ca, se } };
}

double columnCount(const ScanPattern& pattern)
{
  if (pattern.table)
  {
    return static_cast<double>(pattern.table->directions.size());
  }
  if (!pattern.prisms.none())
  {
    const double columns = 1.0 / (pattern.rotationRate * periodOf(pattern));
    return std::floor(columns * (1.0 + 1e-12) + 1e-9); // in spite of rounding
  }
  const double steps = (pattern.azimuthEnd - pattern.azimuthStart) / pattern.azimuthStep;
  return std::max(1.0, std::ceil(steps - 1e-9)); // the start is in, however short the range
}

std::string checkElevations(const ScanPattern& pattern)
{
  if (pattern.elevations.empty())
  {
    if (pattern.channels < 1)
    {
      return valueError("NumberOfChannels", pattern.channels, "at least 1");
    }
    if (!std::isfinite(pattern.minimumElevation))
    {
      return valueError("MinimumElevation", pattern.minimumElevation, "a finite angle in degrees");
    }
    if (!std::isfinite(pattern.elevationStep) ||
      (pattern.channels > 1 && !(pattern.elevationStep > 0.0)))
    {
      return valueError("ElevationStep", pattern.elevationStep, "an angle above 0 degrees");
    }
  }
  const int channels = numberOfChannels(pattern);
  // Regular elevations grow, so the last one speaks for all of them.
  const int first = pattern.elevations.empty() ? channels - 1 : 0;
  if (pattern.elevations.empty() && !(pattern.minimumElevation >= -90.0))
  {
    return valueError(
      "MinimumElevation", pattern.minimumElevation, "an elevation within [-90, 90] degrees");
  }
  for (int channel = first; channel < channels; ++channel)
  {
    const double elevation = channelElevation(pattern, channel);
    if (!(elevation >= -90.0 && elevation <= 90.0))
    {
      const std::string name = "the elevation of channel " + std::to_string(channel) +
        (pattern.elevations.empty() ? " (MinimumElevation + ElevationStep * (NumberOfChannels - 1))"
                                    : " (its ChannelElevation)");
      return valueError(name.c_str(), elevation, "an elevation within [-90, 90] degrees");
    }
  }
  return std::string();
}

std::string checkNumberOfBeams(const ScanPattern& pattern, const char* by)
{
  const double beams = columnCount(pattern) * numberOfChannels(pattern);
  if (!(beams <= MaximumBeams))
  {
    const std::string expected = std::string("at most 1e9 (") + by + " or " +
      (pattern.elevations.empty() ? "NumberOfChannels)" : "NumberOfChannelElevations)");
    return valueError("the number of beams", beams, expected.c_str());
  }
  return std::string();
}

std::string checkAzimuths(const ScanPattern& pattern)
{
  if (!pattern.prisms.none())
  {
    return std::string();
  }
  if (!(std::abs(pattern.azimuthStart) <= 360.0))
  {
    return valueError(
      "the start of AzimuthRange", pattern.azimuthStart, "an angle within [-360, 360] degrees");
  }
  if (!(pattern.azimuthEnd > pattern.azimuthStart &&
        pattern.azimuthEnd <= pattern.azimuthStart + 360.0))
  {
    return valueError("the end of AzimuthRange", pattern.azimuthEnd,
      "an angle after the start and at most 360 degrees after it");
  }
  if (!(pattern.azimuthStep > 0.0 && std::isfinite(pattern.azimuthStep)))
  {
    return valueError("AzimuthStep", pattern.azimuthStep, "an angle above 0 degrees");
  }
  return checkNumberOfBeams(pattern, "AzimuthStep");
}

std::string wrongSize(const char* name, std::size_t size, int channels)
{
  return std::string(name) + " has " + std::to_string(size) +
    " values, expected one for each of the " + std::to_string(channels) + " channels";
}

/// @param column s that a column lasts
std::string checkFiringTimes(const ScanPattern& pattern, double column)
{
  const int channels = numberOfChannels(pattern);
  if (pattern.firingTimes.size() != static_cast<std::size_t>(channels))
  {
    return wrongSize("ChannelFiringTimes", pattern.firingTimes.size(), channels);
  }
  for (const double time : pattern.firingTimes)
  {
    if (!(time >= 0.0 && time <= column))
    {
      std::ostringstream text;
      text << "0 s to the " << column << " s that a column lasts";
      return valueError("ChannelFiringTimes", time, text.str().c_str());
    }
  }
  return std::string();
}

std::string checkTables(const ScanPattern& pattern)
{
  const int channels = numberOfChannels(pattern);
  const std::vector<double>& offsets = pattern.azimuthOffsets;
  if (!offsets.empty() && offsets.size() != static_cast<std::size_t>(channels))
  {
    return wrongSize("ChannelAzimuthOffsets", offsets.size(), channels);
  }
  for (const double offset : offsets)
  {
    if (!(std::abs(offset) <= 180.0))
    {
      return valueError("ChannelAzimuthOffsets", offset, "an angle within [-180, 180] degrees");
    }
  }
  const std::vector<double>& sectors = pattern.blankedSectors;
  if (sectors.size() % 2 != 0)
  {
    return "BlankedSectors has an odd number of values, expected pairs: from, to";
  }
  for (std::size_t i = 0; i + 1 < sectors.size(); i += 2)
  {
    if (!(std::abs(sectors[i]) <= 360.0))
    {
      return valueError(
        "the start of BlankedSectors", sectors[i], "an angle within [-360, 360] degrees");
    }
    if (!(sectors[i + 1] > sectors[i] && sectors[i + 1] <= sectors[i] + 360.0))
    {
      return valueError("the end of BlankedSectors", sectors[i + 1],
        "an angle after the start and at most 360 degrees after it");
    }
  }
  return std::string();
}

/// Of a pattern whose tables are good.
std::string checkTrain(const ScanPattern& pattern)
{
  const PrismTrain& train = pattern.prisms;
  if (train.none())
  {
    return train.refractiveIndices.empty() && train.rotationRates.empty() && train.phases.empty() &&
        train.axisElevation == 0.0 && train.axisRotationRate == 0.0
      ? std::string()
      : "PrismWedgeAngles is empty, expected one angle for each prism, as other numbers of prisms "
        "are given";
  }
  if (!pattern.blankedSectors.empty())
  {
    return "BlankedSectors has values, expected none with prisms, whose beams have no columns by "
           "azimuth";
  }
  std::vector<std::array<double, 3>> enters;
  for (int channel = 0; channel < numberOfChannels(pattern); ++channel)
  {
    enters.push_back(enterOf(pattern, channel));
  }
  return checkPrisms(train, enters);
}

/// Of a pattern with prisms and a good rate.
std::string checkPeriod(const ScanPattern& pattern)
{
  if (!(pattern.firingInterval > 0.0 && std::isfinite(pattern.firingInterval)))
  {
    return valueError("FiringInterval", pattern.firingInterval, "a time above 0 s with prisms");
  }
  const double scan = 1.0 / pattern.rotationRate;
  if (!(columnCount(pattern) >= 1.0))
  {
    std::ostringstream text;
    text << "FiringInterval is " << pattern.firingInterval << " s, so the "
         << numberOfChannels(pattern) << " firings of a column take " << periodOf(pattern)
         << " s, expected at most the " << scan << " s that RotationRate leaves to a scan";
    return text.str();
  }
  const std::string bad = checkNumberOfBeams(pattern, "FiringInterval, RotationRate");
  return bad.empty() && !pattern.firingTimes.empty() ? checkFiringTimes(pattern, periodOf(pattern))
                                                     : bad;
}

/// Of a table of beams.
std::string checkTimes(const ScanPattern& pattern)
{
  const std::vector<double>& times = pattern.table->times;
  const double turn = 1.0 / pattern.rotationRate;
  for (std::size_t i = 0; i < times.size(); ++i)
  {
    if (!(times[i] >= 0.0 && times[i] <= turn))
    {
      std::ostringstream text;
      text << "0 to the " << turn << " s of a scan (RotationRate)";
      return valueError(
        ("the time of beam " + std::to_string(i)).c_str(), times[i], text.str().c_str());
    }
  }
  return std::string();
}

std::string checkClock(const ScanPattern& pattern)
{
  if (!(pattern.rotationRate >= MinimumRotationRate && pattern.rotationRate <= MaximumRotationRate))
  {
    return valueError("RotationRate", pattern.rotationRate, "1e-20 to 1e20 Hz");
  }
  if (pattern.table)
  {
    return checkTimes(pattern);
  }
  if (!pattern.prisms.none())
  {
    return checkPeriod(pattern);
  }
  if (!(pattern.firingInterval >= 0.0 && std::isfinite(pattern.firingInterval)))
  {
    return valueError("FiringInterval", pattern.firingInterval, "a time of at least 0 s");
  }
  const double column = 1.0 / (columnCount(pattern) * pattern.rotationRate);
  if (!pattern.firingTimes.empty())
  {
    return checkFiringTimes(pattern, column);
  }
  const double firings = numberOfChannels(pattern) * pattern.firingInterval;
  // The slack admits a column that is filled to the last firing.
  if (!(firings <= column * (1.0 + 1e-12)))
  {
    std::ostringstream text;
    text << "FiringInterval is " << pattern.firingInterval << " s, so the "
         << numberOfChannels(pattern) << " firings of a column take " << firings
         << " s, expected at most the " << column
         << " s that RotationRate and AzimuthStep leave to a column";
    return text.str();
  }
  return std::string();
}
}

void sinCosDegrees(double degrees, double& sine, double& cosine)
{
  int quadrant = 0;
  const double rest = std::remquo(degrees, 90.0, &quadrant);
  const double s = std::sin(rest * RadiansPerDegree);
  const double c = std::cos(rest * RadiansPerDegree);
  switch (static_cast<unsigned int>(quadrant) & 3u)
  {
    case 0u:
      sine = s;
      cosine = c;
      break;
    case 1u:
      sine = c;
      cosine = -s;
      break;
    case 2u:
      sine = -s;
      cosine = -c;
      break;
    default:
      sine = -c;
      cosine = s;
      break;
  }
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

double pulseInterval(const ScanPattern& pattern)
{
  if (pattern.table)
  {
    return std::numeric_limits<double>::infinity();
  }
  const bool oneReceiver = pattern.firingTimes.empty() && pattern.firingInterval > 0.0 &&
    (numberOfChannels(pattern) > 1 || !pattern.prisms.none());
  return oneReceiver ? pattern.firingInterval : columnTime(pattern, 1);
}

double columnTime(const ScanPattern& pattern, std::int64_t column)
{
  return pattern.prisms.none() ? column / (columnCount(pattern) * pattern.rotationRate)
                               : static_cast<double>(column) * periodOf(pattern);
}

bool isBlanked(const ScanPattern& pattern, std::int64_t column)
{
  const double azimuth = pattern.azimuthStart + column * pattern.azimuthStep;
  for (std::size_t i = 0; i + 1 < pattern.blankedSectors.size(); i += 2)
  {
    const double from = pattern.blankedSectors[i];
    if (wrapDegrees(azimuth - from) < pattern.blankedSectors[i + 1] - from)
    {
      return true;
    }
  }
  return false;
}

std::int64_t numberOfFirings(const ScanPattern& pattern)
{
  std::int64_t columns = numberOfColumns(pattern);
  for (std::int64_t column = columns;
       !pattern.table && !pattern.blankedSectors.empty() && column-- > 0;)
  {
    columns -= isBlanked(pattern, column) ? 1 : 0;
  }
  return columns * numberOfChannels(pattern);
}

Vec3 upOf(double yaw, double pitch, double roll)
{
  const Matrix turned = orientation(yaw, pitch, roll);
  return { turned[0][2], turned[1][2], turned[2][2] };
}

std::string checkPattern(const ScanPattern& pattern)
{
  if (!std::isfinite(pattern.yaw) || !std::isfinite(pattern.pitch) || !std::isfinite(pattern.roll))
  {
    return "Orientation is not finite, expected yaw, pitch and roll in degrees";
  }
  if (pattern.table)
  {
    return checkClock(pattern);
  }
  for (auto check : { checkElevations, checkAzimuths, checkTables, checkTrain, checkClock })
  {
    std::string bad = check(pattern);
    if (!bad.empty())
    {
      return bad;
    }
  }
  return std::string();
}

ScanGenerator::ScanGenerator(const ScanPattern& pattern, int revolution)
  : Pattern(pattern)
  , Start(revolution / pattern.rotationRate)
  , Channels(numberOfChannels(pattern))
  , Columns(numberOfColumns(pattern))
  , Beams(numberOfBeams(pattern))
  , Tilted(pattern.pitch != 0.0 || pattern.roll != 0.0)
  , Rotation(orientation(pattern.yaw, pattern.pitch, pattern.roll))
{
}

std::array<double, 3> ScanGenerator::toScene(const std::array<double, 3>& local) const
{
  std::array<double, 3> turned{};
  for (int row = 0; row < 3; ++row)
  {
    turned[row] = this->Rotation[row][0] * local[0] + this->Rotation[row][1] * local[1] +
      this->Rotation[row][2] * local[2];
  }
  return turned;
}

ScanBeam ScanGenerator::tableBeam(std::size_t index) const
{
  const BeamTable& table = *this->Pattern.table;
  ScanBeam result;
  result.channel = 0;
  result.time = table.times[index];
  result.direction = this->toScene(table.directions[index]);
  takeAngles(result);
  if (!table.origins.empty())
  {
    result.origin = this->toScene(table.origins[index]);
  }
  return result;
}

ScanBeam ScanGenerator::prismBeam(std::int64_t index) const
{
  ScanBeam result;
  result.channel = static_cast<int>(index % this->Channels);
  result.time =
    columnTime(this->Pattern, this->column(index)) + firingTime(this->Pattern, result.channel);
  result.direction = this->toScene(
    steer(this->Pattern.prisms, this->Start, result.time, enterOf(this->Pattern, result.channel)));
  takeAngles(result);
  return result;
}

ScanBeam ScanGenerator::beam(std::int64_t index) const
{
  if (this->Pattern.table)
  {
    return this->tableBeam(static_cast<std::size_t>(index));
  }
  if (!this->Pattern.prisms.none())
  {
    return this->prismBeam(index);
  }
  const std::int64_t column = this->column(index);
  const int channel = static_cast<int>(index % this->Channels);
  const std::vector<double>& offsets = this->Pattern.azimuthOffsets;
  const double azimuth = this->Pattern.azimuthStart + column * this->Pattern.azimuthStep +
    (offsets.empty() ? 0.0 : offsets[channel]);
  const double elevation = channelElevation(this->Pattern, channel);

  ScanBeam result;
  result.channel = channel;
  result.time =
    column / (this->Columns * this->Pattern.rotationRate) + firingTime(this->Pattern, channel);

  double sa, ca, se, ce;
  sinCosDegrees(elevation, se, ce);
  if (!this->Tilted)
  {
    // No detour through the arctangent: the angles come out as they were put in.
    result.azimuth = wrapDegrees(azimuth + this->Pattern.yaw);
    result.elevation = elevation;
    sinCosDegrees(azimuth + this->Pattern.yaw, sa, ca);
    result.direction = { { ce * sa, ce * ca, se } };
    return result;
  }
  sinCosDegrees(azimuth, sa, ca);
  result.direction = this->toScene({ { ce * sa, ce * ca, se } });
  takeAngles(result);
  return result;
}
}
