// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LasFormat.h
 * @brief Reads and writes LAS, the ASPRS exchange format of point clouds.
 *
 * Source: "LAS Specification 1.4 - R15", American Society for Photogrammetry and Remote Sensing
 * (2019). The code writes version 1.4, point data record format 6, or 7 with colours; with
 * waveforms 9 or 10, or the legacy formats 4 or 5. It reads versions 1.0 to 1.4, formats 0 to 10,
 * with extra bytes and uncompressed waveforms, and leaves out withheld points. LAZ files have
 * compressed point records and no waveforms (LazFormat.h).
 *
 * **Waveforms.** Packets of samples are an extended record of the file, or a file of the same name
 * with the ending .wdp. Sample k of a point at X lies at X + (k s - L) d, where s is the time
 * between two samples, L the time from the first sample to the point, and d, the change of a place
 * on the line with time, points away from the sensor.
 *
 * **Rounding.** Coordinates are 32-bit integers: c = offset + scale * n. chooseAxis() takes the
 * finest scale of 10^-6, 10^-5, ... m that the extent of the cloud allows (from 10^-9 for degrees).
 * The error is at most half of the scale, plus the rounding of the double c: 0.5 micrometres for a
 * cloud of up to 4.2 km, and 5 micrometres for a cloud of 42 km.
 */
#ifndef AvianLidarLasFormat_h
#define AvianLidarLasFormat_h

#include "ByteSource.h"
#include "CloudData.h"
#include "OutputFile.h"

#include <limits>
#include <utility>

namespace avianlidar::formats
{
constexpr std::size_t LasHeaderSize = 375;
constexpr std::size_t LasVlrHeaderSize = 54;
constexpr std::size_t LasExtraBytesSize = 192;
constexpr std::size_t LasLongestVlr = 65535;
constexpr int LasMostReturns = 15;
constexpr double LasGreatestCoordinate = 1e15; // greatest coordinate, m (a tenth of a light year)
constexpr double LasScanAngleStep = 0.006;     // unit of a stored scan angle, deg
constexpr double LasIntensityStep = 1.0 / 257; // unit of a stored intensity: 65535 is intensity 255
constexpr int LasWithheld = 4;                 // flag of a deleted point
constexpr std::size_t LasLongestName = 31;     // greatest length of a name, bytes
constexpr std::size_t LasEvlrHeaderSize = 60;
constexpr std::size_t LasPacketSize = 29;       // waveform packet of a point record, bytes
constexpr std::size_t LasDescriptorSize = 26;   // contents of a waveform packet descriptor, bytes
constexpr std::size_t LasMostDescriptors = 255; // records 100 to 354
constexpr int LasDescriptorRecord = 99;         // record of the descriptor 0, which does not exist
constexpr int LasPacketsRecord = 65535;         // extended record of all packets
constexpr int LasPacketsInside = 2;             // bit of the global encoding
constexpr int LasPacketsBeside = 4;             // bit of the global encoding
constexpr std::size_t LasMostExtraFields = LasLongestVlr / LasExtraBytesSize;

// Names of arrays for fields of LAS that only files of other sensors fill in.
constexpr const char* LasClassification = "classification";
constexpr const char* LasFlags = "classification_flags";
constexpr const char* LasUserData = "user_data";
constexpr const char* LasScanAngle = "scan_angle";
constexpr const char* LasPointSource = "point_source_id";

/// Offsets of the fields in a point record.
struct LasLayout
{
  std::size_t core = 0;   ///< length of the fields of the format, bytes
  int time = -1;          ///< offset of the time in a record, bytes; -1 without time
  int rgb = -1;           ///< offset of the colours, bytes; -1 without colours
  int nir = -1;           ///< offset of the near infrared, bytes; -1 without this field
  bool waveforms = false; ///< whether the core ends with a waveform packet
  int format = 0;
  bool extended = false;  ///< true for the formats 6 to 10
  std::size_t length = 0; ///< length of a record, bytes
};

/// Throws FormatError if the format is not 0 to 10 or if the records are too short for the format.
LasLayout layoutOf(int format, std::size_t length);

/// One coordinate of the points: offset + scale * integer.
struct LasAxis
{
  double scale = 1e-6; ///< step between two integers, m or deg
  double offset = 0.0;
  double low = 0.0;  ///< lowest coordinate of the points as decoded, m or deg
  double high = 0.0; ///< highest coordinate of the points as decoded, m or deg

  std::int32_t encode(double coordinate) const;
  double decode(std::int32_t integer) const { return integer * this->scale + this->offset; }
  /// Largest rounding error of a coordinate, m.
  double bound() const;
};

/// Returns the finest scale (a power of ten, at least 10^-decimals) and an offset that is a whole
/// number, for coordinates from low to high, m or deg.
LasAxis chooseAxis(double low, double high, int decimals = 6);

/// A field of the core of a point of format 6 or 7.
struct LasCoreField
{
  const char* name; ///< name of the array
  bool ours;        ///< whether scans of this project have the array
  bool whole;       ///< whether all values are whole numbers
  double low;       ///< least value, in the unit of the array
  double high;      ///< greatest value, in the unit of the array
  double step;      ///< value of one unit of the stored number, in the unit of the array
  Scalar type;
  std::size_t offset; ///< offset in the record, bytes
};

constexpr double LasAnyNumber = std::numeric_limits<double>::max();
/// Fields of the core. `return_number` and `number_of_returns` share a byte.
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

/// Contents of a waveform packet descriptor.
struct LasDescriptor
{
  int bits = 0; ///< bits of a sample; 0 if the descriptor is missing
  int compression = 0;
  std::uint32_t samples = 0;
  std::uint32_t spacing = 0; ///< time between two samples, ps
  double gain = 1.0;         ///< value of a step of the stored number
  double offset = 0.0;       ///< value of the stored number 0
};

/// Waveforms to be written.
struct LasWaveforms
{
  std::vector<std::pair<std::int64_t, std::uint32_t>> stretches; ///< first and number of samples
  std::function<double(std::int64_t)> sample;                    ///< value of a sample, J
  std::vector<std::int64_t> ofPoint;                             ///< stretch of a point, or -1
  /// Function that gives L, ps, and d, m/ps, of a point on a stretch.
  std::function<std::array<float, 4>(std::int64_t point, std::int64_t stretch)> line;
  LasDescriptor levels; ///< levels of the digitiser; 0 bits without levels
  bool legacy = false;  ///< whether points have format 4 or 5
};

/// Contents of a file to be written.
struct LasOutput
{
  std::int64_t size = 0;
  std::function<Point(std::int64_t)> position;
  /// Values of the fields of the core, in the units of the arrays; timestamps in s.
  std::array<std::function<double(std::int64_t)>, LasCoreSize> core;
  std::function<double(std::int64_t, int)> colour; ///< red, green, blue, 0 to 255, or empty
  bool compressed = false;                         ///< whether the file is LAZ
  bool simulated = false;                          ///< whether the points come from a simulation
  int sourceId = 0;                                ///< source id of the file
  std::string software;
  std::string crs;         ///< coordinate reference system, WKT; empty if unknown
  bool degrees = false;    ///< whether x and y are in degrees
  std::string description; ///< text of the text area, at most LasLongestVlr bytes
  std::vector<Field> extra;
  std::optional<LasWaveforms> waveforms;
};

/// Result of a pass over the points.
struct LasMeasure
{
  std::array<LasAxis, 3> axes;
  std::array<std::uint64_t, LasMostReturns> returns{}; ///< number of points of each return number
  LasDescriptor levels;                                ///< levels of all packets
  std::vector<std::uint32_t> lengths;                  ///< number of samples of each descriptor
  /// Offset of each packet from their header, bytes, and index in `lengths`.
  std::vector<std::pair<std::uint64_t, std::uint8_t>> packets;
  std::uint64_t packetsEnd = LasEvlrHeaderSize; ///< offset of the end of the packets, bytes
};

/// Makes the first pass, which finds scale, offset and bounds of each axis, and levels and places
/// of the packets. Throws FormatError if a coordinate is not finite or too large, or if a sample is
/// not finite.
LasMeasure measureLas(const LasOutput& output, const KeepGoing& keepGoing);

/// Makes the second pass, which writes the file. Points and samples are requested one after the
/// other and not kept. @param packets file of the waveform packets, or null for packets inside
void writeLas(OutputFile& file, OutputFile* packets, const LasOutput& output,
  const LasMeasure& measure, const KeepGoing& keepGoing);

/// Returns a name of at most LasLongestName bytes: whole UTF-8 characters of `name`, then `ending`.
std::string cutName(const std::string& name, const std::string& ending = {});

/// Reads a cloud. Throws FormatError if the file is not a LAS file, has another version or format,
/// or is cut short. @param packets file of the waveform packets beside the file, or null
Cloud readLas(ByteSource& source, ByteSource* packets, const KeepGoing& keepGoing);
}

#endif
