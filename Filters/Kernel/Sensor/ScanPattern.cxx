// SPDX-License-Identifier: BSD-3-Clause
#include "ScanPattern.h"

#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace avianlidar
{
namespace
{
constexpr double RadiansPerDegree = 3.14159265358979323846 / 180.0;
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

Matrix orientation(const ScanPattern& pattern)
{
  double s, c;
  sinCosDegrees(pattern.yaw, s, c);
  const Matrix yaw{ { { c, s, 0.0 }, { -s, c, 0.0 }, { 0.0, 0.0, 1.0 } } };
  sinCosDegrees(pattern.pitch, s, c);
  const Matrix pitch{ { { 1.0, 0.0, 0.0 }, { 0.0, c, -s }, { 0.0, s, c } } };
  sinCosDegrees(pattern.roll, s, c);
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

double columnCount(const ScanPattern& pattern)
{
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

std::string checkAzimuths(const ScanPattern& pattern)
{
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
  const double beams = columnCount(pattern) * numberOfChannels(pattern);
  if (!(beams <= MaximumBeams))
  {
    return valueError("the number of beams", beams,
      pattern.elevations.empty() ? "at most 1e9 (AzimuthStep or NumberOfChannels)"
                                 : "at most 1e9 (AzimuthStep or NumberOfChannelElevations)");
  }
  return std::string();
}

std::string checkClock(const ScanPattern& pattern)
{
  if (!(pattern.rotationRate >= MinimumRotationRate && pattern.rotationRate <= MaximumRotationRate))
  {
    return valueError("RotationRate", pattern.rotationRate, "1e-20 to 1e20 Hz");
  }
  if (!(pattern.firingInterval >= 0.0 && std::isfinite(pattern.firingInterval)))
  {
    return valueError("FiringInterval", pattern.firingInterval, "a time of at least 0 s");
  }
  const double firings = numberOfChannels(pattern) * pattern.firingInterval;
  const double column = 1.0 / (columnCount(pattern) * pattern.rotationRate);
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
  return pattern.elevations.empty() ? pattern.channels
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

std::string checkPattern(const ScanPattern& pattern)
{
  if (!std::isfinite(pattern.yaw) || !std::isfinite(pattern.pitch) || !std::isfinite(pattern.roll))
  {
    return "Orientation is not finite, expected yaw, pitch and roll in degrees";
  }
  for (auto check : { checkElevations, checkAzimuths, checkClock })
  {
    std::string bad = check(pattern);
    if (!bad.empty())
    {
      return bad;
    }
  }
  return std::string();
}

ScanGenerator::ScanGenerator(const ScanPattern& pattern)
  : Pattern(pattern)
  , Channels(numberOfChannels(pattern))
  , Columns(numberOfColumns(pattern))
  , Beams(numberOfBeams(pattern))
  , Tilted(pattern.pitch != 0.0 || pattern.roll != 0.0)
  , Rotation(orientation(pattern))
{
}

ScanBeam ScanGenerator::beam(std::int64_t index) const
{
  const std::int64_t column = index / this->Channels;
  const int channel = static_cast<int>(index % this->Channels);
  const double azimuth = this->Pattern.azimuthStart + column * this->Pattern.azimuthStep;
  const double elevation = channelElevation(this->Pattern, channel);

  ScanBeam result;
  result.channel = channel;
  result.time = column / (this->Columns * this->Pattern.rotationRate) +
    firingSlot(channel, this->Channels) * this->Pattern.firingInterval;

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
  const std::array<double, 3> local{ { ce * sa, ce * ca, se } };
  for (int row = 0; row < 3; ++row)
  {
    result.direction[row] = this->Rotation[row][0] * local[0] + this->Rotation[row][1] * local[1] +
      this->Rotation[row][2] * local[2];
  }
  const double horizontal = std::hypot(result.direction[0], result.direction[1]);
  result.azimuth =
    wrapDegrees(std::atan2(result.direction[0], result.direction[1]) / RadiansPerDegree);
  result.elevation = std::atan2(result.direction[2], horizontal) / RadiansPerDegree;
  return result;
}
}
