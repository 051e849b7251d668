// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CloudData.h
 * @brief Point clouds without VTK: the result of reading a file and the input of writing a file.
 */
#ifndef AvianLidarCloudData_h
#define AvianLidarCloudData_h

#include "AvailableMemory.h"
#include "FileError.h"
#include "ParallelLoop.h"
#include "Scalars.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace avianlidar::formats
{
/// Error about a file that is invalid, or that cannot be read or written.
using FormatError = FileError;

/// Number of points between two calls of KeepGoing.
constexpr std::int64_t PointsPerBlock = 16384;

/// Reports the progress, and throws WorkStopped if KeepGoing returns false.
inline void goOn(const KeepGoing& keepGoing, double progress)
{
  if (keepGoing && !keepGoing(progress))
  {
    throw WorkStopped();
  }
}

/// Calls goOn() at the first point of each block, with point `done` of `all` as a share between
/// `from` and `to`.
template <class Index>
void goOn(const KeepGoing& keepGoing, Index done, Index all, double from = 0.0, double to = 1.0)
{
  if (done % static_cast<Index>(PointsPerBlock) == 0)
  {
    goOn(keepGoing, from + (to - from) * static_cast<double>(done) / static_cast<double>(all));
  }
}

using Values =
  std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
    std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
    std::vector<std::int64_t>, std::vector<std::uint64_t>, std::vector<float>, std::vector<double>>;

inline std::size_t sizeOf(const Values& values)
{
  return std::visit([](const auto& typed) { return typed.size(); }, values);
}

/// One array of a cloud that was read: `components` values for each point.
struct Column
{
  std::string name;
  std::string unit; ///< unit of the values; empty without a known unit
  int components = 1;
  Values values;
};

/// Numbers or texts of one name that belong to the whole cloud.
struct Note
{
  std::string name;
  std::string unit;
  std::vector<double> numbers;
  std::vector<std::string> texts; ///< texts of a note without numbers
};

/// A cloud that was read.
struct Cloud
{
  std::vector<double> points; ///< x, y, z of each point, m
  std::vector<Column> columns;
  std::vector<Note> notes;
  /// Position of the sensor, m, in the frame of the points. No value if the format lacks it.
  std::optional<std::array<double, 3>> sensor;
  std::string crs;                     ///< coordinate reference system, WKT; empty if unknown
  std::vector<Cloud> waveforms;        ///< samples of all waveforms as one cloud, or empty
  std::vector<std::size_t> lineEnds;   ///< one past the last sample of each waveform
  std::vector<std::size_t> linePoints; ///< a point that each waveform belongs to
  std::vector<std::string> warnings;   ///< sentences on parts left out and on assumptions

  std::size_t size() const { return this->points.size() / 3; }
};

/// Throws MemoryError unless a cloud of `points` points, each of `length` bytes in the file, fits
/// into memory.
inline void requireMemoryFor(std::uint64_t points, std::uint64_t length)
{
  // Bytes of a point in Cloud and in VTK's arrays: 100 for coordinates, vertex, range and angles,
  // and 3 * length for the unpacked fields of the file.
  const double bytes = 100.0 + 3.0 * static_cast<double>(length);
  const auto count = static_cast<double>(points);
  requireMemory(count, "points", count * bytes);
}

/// Array of a cloud to be written, with one value for each point. Integers are exact up to 2^53.
struct Field
{
  std::string name;
  std::string unit;
  Scalar type = Scalar::Float64;
  std::function<double(std::int64_t)> value;
};

using Point = std::array<double, 3>;
}

#endif
