// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanPattern.h
 * @brief Directions and times of the beams of a rotating multichannel lidar.
 *
 * The sensor is a rotor with C channels at fixed elevations. A scan consists of columns, one per
 * azimuth. Every column consists of C firings. Beams are numbered column by column, and channel by
 * channel within a column.
 *
 * Frames. In the sensor's frame x points to the right, y forward and z up. If the sensor is not
 * turned, these axes are the scene's east, north and up. Azimuth is measured from north (y),
 * clockwise as seen from above. Elevation is measured upwards from the horizontal plane. The
 * orientation is R = yaw * pitch * roll: yaw clockwise from north, pitch nose up, roll to the
 * right. Angles are in degrees, as in specifications.
 *
 * Source: paper, Fig. 1 and Sec. 5.3.
 * Differs: with an odd number of channels the staggered order has steps of C/2 rounded up. Tables
 * of azimuth offsets and firing times, and sectors without beams, are added. Rotating prisms
 * (Prisms.h) may replace the rotor. With prisms, a scan is a window of 1 / RotationRate seconds in
 * which the lasers fire continuously. A column of such a scan is one firing of each laser. The next
 * scan continues where the last scan ended. A table of any beams may replace rotor and prisms.
 * Valid: rotations by multiples of 90 degrees are exact. All channels of a column share its
 * azimuth: the rotor's motion between the firings of one column is not modelled (at most
 * FiringInterval * C * RotationRate of the azimuth range).
 * Test: TestScanPattern.cxx, TestPrisms.cxx.
 */
#ifndef avianlidar_ScanPattern_h
#define avianlidar_ScanPattern_h

#include "Prisms.h"
#include "Vector.h"

#include <glm/mat3x3.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace avianlidar
{
// Limits of the rotation rate, Hz. The limits are far beyond any rotor and keep times finite.
constexpr double MinimumRotationRate = 1e-20;
constexpr double MaximumRotationRate = 1e20;

/// Arbitrary beams, in the frame of the sensor.
struct BeamTable
{
  std::vector<Vec3> directions; ///< unit vectors
  std::vector<Vec3> origins;    ///< origins relative to the sensor's position, m; may be empty
  std::vector<double> times;    ///< times since the scan began, s
};

/// Geometry and clock of a scan. The defaults describe the 16-channel airport lidar (paper, Sec.
/// 5.3).
struct ScanPattern
{
  double yaw = 0.0;               ///< heading of the sensor, deg, clockwise from north
  double pitch = 0.0;             ///< upward tilt of the nose, deg
  double roll = 0.0;              ///< tilt to the right, deg
  int channels = 16;              ///< number of channels; unused with a table of elevations
  double minimumElevation = 0.0;  ///< elevation of channel 0, deg; unused with a table
  double elevationStep = 0.375;   ///< step between channels, deg; unused with a table
  std::vector<double> elevations; ///< optional table: elevation of each channel, deg
  double azimuthStart = 0.0;      ///< azimuth of the first column, deg
  double azimuthEnd = 360.0;      ///< end of the azimuth range, excluded, deg
  double azimuthStep = 0.375;     ///< step between columns, deg
  double rotationRate = 0.5;      ///< sweeps across the azimuth range per second, Hz, 1e-20 to 1e20
  double firingInterval = 30e-6;  ///< time between two firings of a column, s
  /// Optional table: azimuth of each channel's beam minus the azimuth of the column, deg.
  std::vector<double> azimuthOffsets;
  /// Optional table: time of each channel's firing since the column began, s. Without this table
  /// the firing order is staggered.
  std::vector<double> firingTimes;
  /// Optional pairs of azimuths, deg: columns from the first azimuth of a pair to below the second
  /// azimuth do not fire.
  std::vector<double> blankedSectors;
  /// Optional prisms, which replace the rotor. Elevations and azimuth offsets are the lasers'
  /// before the prisms, in the frame of their axis. A column takes channels times firingInterval.
  PrismTrain prisms;
  /// Optional beams, each a column of one channel. The table replaces all values above except yaw,
  /// pitch, roll and rotationRate.
  std::shared_ptr<const BeamTable> table;
};

/// One beam of a scan.
struct ScanBeam
{
  Vec3 direction;     ///< unit vector in the scene's frame
  int channel;        ///< index of the channel
  double azimuth;     ///< azimuth in the scene's frame, deg, in [0, 360)
  double elevation;   ///< elevation in the scene's frame, deg
  double time;        ///< time since the start of the beam's scan, s
  Vec3 origin{ 0.0 }; ///< origin relative to the sensor's position, in the scene's frame, m
};

/// Number of channels: the length of the table of elevations, or `channels` without a table.
int numberOfChannels(const ScanPattern& pattern);

/// Number of columns, at the azimuths start, start + step, ... below the end. A column less than
/// 1e-9 steps below the end is left out, unless it is the first. With prisms, a scan has as many
/// columns as fit into its duration.
std::int64_t numberOfColumns(const ScanPattern& pattern);

/// Number of beams: columns times channels, whether or not a column fires.
std::int64_t numberOfBeams(const ScanPattern& pattern);

/// Elevation of a channel in the sensor's frame, deg.
double channelElevation(const ScanPattern& pattern, int channel);

/// Slot of a channel in the staggered order of the paper's Fig. 1b, 0, C/2, 1, C/2 + 1, ... (odd C:
/// C/2 rounded up).
int firingSlot(int channel, int channels);

/// Time from the beginning of a column to the firing of a channel, s.
double firingTime(const ScanPattern& pattern, int channel);

/// Time from the beginning of the scan to the firing of a beam, s.
double beamTime(const ScanPattern& pattern, std::int64_t column, int channel);

/// Time between two pulses into the same receiver, s. Channels that fire one after the other share
/// one receiver. Channels that have firing times or fire together have one receiver each. The time
/// is infinite for a table of beams, which does not name receivers.
double pulseInterval(const ScanPattern& pattern);

/// True if a column does not fire.
bool isBlanked(const ScanPattern& pattern, std::int64_t column);

/// Number of beams of a whole scan, without the columns that do not fire.
std::int64_t numberOfFirings(const ScanPattern& pattern);

/// The first bad value in words ("AzimuthStep is 0, expected ..."), or an empty string if the
/// pattern is valid.
std::string checkPattern(const ScanPattern& pattern);

/// Time from the start of a scan to its last firing, s.
double durationOf(const ScanPattern& pattern);

/// Rotation from a sensor's frame to the frame in which it stands. Angles are as in ScanPattern.
glm::dmat3 rotationOf(double yawDegrees, double pitchDegrees, double rollDegrees);

/// Yaw, pitch and roll of a rotation, deg.
Vec3 anglesOf(const glm::dmat3& rotation);

/// Sine and cosine of an angle in degrees, exact at multiples of 90 degrees.
std::array<double, 2> sinCosDegrees(double degrees);

/// Makes the beams of a pattern that checkPattern() accepted.
class ScanGenerator
{
public:
  /// @param revolution number of the scan, on which directions depend if there are prisms
  explicit ScanGenerator(const ScanPattern& pattern, int revolution = 0);

  std::int64_t size() const { return this->Beams; }

  /// Beam `index` of [0, size()): column index / C, channel index % C. Calls do not depend on each
  /// other.
  ScanBeam beam(std::int64_t index) const;

  /// Column of a beam.
  std::int64_t column(std::int64_t index) const { return index / this->Channels; }

  /// Upward unit vector of the axis about which the sensor turns, in the scene's frame.
  Vec3 rotor() const { return this->Rotation[2]; }

private:
  ScanPattern Pattern;
  double Start; ///< start of the scan, s since time 0
  int Channels;
  std::int64_t Beams;
  bool Tilted;
  glm::dmat3 Rotation; ///< rotation from the sensor's frame to the scene's frame
};
}

#endif
