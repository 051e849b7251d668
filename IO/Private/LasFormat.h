// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LasFormat.h
 * @brief Reads and writes LAS, the ASPRS exchange format of point clouds.
 *
 * Source: "LAS Specification 1.4 - R15", American Society for Photogrammetry and Remote Sensing
 * (2019). Written: version 1.4, point data record format 6, or 7 with colours. Read: versions 1.0
 * to 1.4, formats 0 to 10, with extra bytes; waveforms (formats 4, 5, 9 and 10) are left out. LAZ
 * is the same with compressed point records, without waveforms, see LazFormat.h.
 *
 * **Rounding.** Coordinates are 32-bit integers: c = offset + scale * n. chooseAxis() takes the
 * finest scale of 10^-6, 10^-5, ... m that the extent leaves room for, so the error is at most half
 * of it, and the rounding of the double c itself: a cloud of up to 4.2 km is held to 0.5
 * micrometres, one of 42 km to 5.
 */
#ifndef AvianLidarLasFormat_h
#define AvianLidarLasFormat_h

#include "ByteSource.h"
#include "CloudData.h"
#include "OutputFile.h"

#include <limits>

namespace avianlidar::formats
{
constexpr std::size_t LasHeaderSize = 375;
constexpr std::size_t LasVlrHeaderSize = 54;
constexpr std::size_t LasExtraBytesSize = 192;
constexpr std::size_t LasLongestVlr = 65535;
constexpr int LasMostReturns = 15;
constexpr double LasGreatestCoordinate = 1e15; // m, a tenth of a light year
constexpr double LasScanAngleStep = 0.006;     // deg
constexpr double LasIntensityStep = 1.0 / 257; // of 0 to 255, so that 255 is 65535
constexpr std::size_t LasLongestName = 31;     // bytes
constexpr std::size_t LasMostExtraFields = LasLongestVlr / LasExtraBytesSize;

// Arrays of what other sensors' files hold in fields of LAS, and no scan of this project has.
constexpr const char* LasClassification = "classification";
constexpr const char* LasFlags = "classification_flags";
constexpr const char* LasUserData = "user_data";
constexpr const char* LasScanAngle = "scan_angle";
constexpr const char* LasPointSource = "point_source_id";

/// Offsets of the fields in a point record.
struct LasLayout
{
  int format = 0;
  bool extended = false; ///< formats 6 and above
  std::size_t core = 0;  ///< bytes
  std::size_t length = 0;
  int time = -1; ///< offsets, -1: not there
  int rgb = -1;
  int nir = -1;
  bool waveforms = false; ///< in packets behind the rest of the core
};

/// FormatError: a format that is not read, or records that are too short for theirs.
LasLayout layoutOf(int format, std::size_t length);

/// One coordinate of the points: offset + scale * integer.
struct LasAxis
{
  double scale = 1e-6;
  double offset = 0.0;
  double low = 0.0; ///< lowest coordinate of the points as read
  double high = 0.0;

  std::int32_t encode(double coordinate) const;
  double decode(std::int32_t integer) const { return integer * this->scale + this->offset; }
  /// Largest rounding error of a coordinate, m.
  double bound() const;
};

/// Finest scale (a power of ten, at least 1e-6 m) and whole offset for coordinates in that range.
LasAxis chooseAxis(double low, double high);

/// A field of the core of a point of format 6 or 7.
struct LasCoreField
{
  const char* name; ///< of the array
  bool ours;        ///< scans of this project have it
  bool whole;       ///< has whole numbers only
  double low;       ///< least and greatest values, in the array's unit
  double high;
  double step; ///< of the integers that stand for the values
  Scalar type;
  std::size_t offset; ///< in the record
};

constexpr double LasAnyNumber = std::numeric_limits<double>::max();
/// Two returns share a byte.
constexpr LasCoreField LasCore[] = {
  { "intensity", true, false, 0.0, 255.0, LasIntensityStep, Scalar::UInt16, 12 },
  { "return_number", true, true, 0.0, LasMostReturns, 1.0, Scalar::UInt8, 14 },
  { "number_of_returns", true, true, 0.0, LasMostReturns, 1.0 / 16, Scalar::UInt8, 14 },
  { "timestamp", true, false, -LasAnyNumber, LasAnyNumber, 1.0, Scalar::Float64, 22 },
  { LasClassification, false, true, 0.0, 255.0, 1.0, Scalar::UInt8, 16 },
  { LasFlags, false, true, 0.0, 15.0, 1.0, Scalar::UInt8, 15 },
  { LasUserData, false, true, 0.0, 255.0, 1.0, Scalar::UInt8, 17 },
  { LasScanAngle, false, false, -180.0, 180.0, LasScanAngleStep, Scalar::Int16, 18 },
  { LasPointSource, false, true, 0.0, 65535.0, 1.0, Scalar::UInt16, 20 },
};
enum LasCoreIndex
{
  LasIntensityIndex,
  LasReturnNumberIndex,
  LasReturnsIndex,
  LasTimeIndex,
  LasClassIndex,
  LasFlagsIndex,
  LasUserDataIndex,
  LasScanAngleIndex,
  LasPointSourceIndex,
  LasCoreSize
};

/// What is written.
struct LasOutput
{
  std::int64_t size = 0;
  std::function<Point(std::int64_t)> position;
  /// Values of the core; timestamps in seconds.
  std::array<std::function<double(std::int64_t)>, LasCoreSize> core;
  std::function<double(std::int64_t, int)> colour; ///< 0 to 255; empty: no colours
  bool compressed = false;                         ///< LAZ
  bool simulated = false; ///< the system that made the points is a simulation
  int sourceId = 0;       ///< source id of the file
  std::string software;
  std::string crs;         ///< WKT 1, or empty
  std::string description; ///< goes to a text area; at most LasLongestVlr bytes
  std::vector<Field> extra;
};

/// Result of a pass over the points.
struct LasMeasure
{
  std::array<LasAxis, 3> axes;
  std::array<std::uint64_t, LasMostReturns> returns{}; ///< points with that return number
};

/// The first pass: scale, offset and bounds of the axes; throws if a coordinate is not finite or
/// too large.
LasMeasure measureLas(const LasOutput& output, const KeepGoing& keepGoing);

/// The second pass writes. Points are requested one after the other and not kept.
void writeLas(
  OutputFile& file, const LasOutput& output, const LasMeasure& measure, const KeepGoing& keepGoing);

/// A name shortened to fit, with an ending, in whole characters of UTF-8.
std::string cutName(const std::string& name, const std::string& ending = {});

/// What the description of an array is in the extra bytes of a file: words and [unit], at most 31
/// characters.
std::string describeExtraBytes(const Field& field);

/// Reads a cloud. FormatError: not a LAS file, another version or format, cut short.
Cloud readLas(ByteSource& source, const KeepGoing& keepGoing);
}

#endif
