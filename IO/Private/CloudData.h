// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CloudData.h
 * @brief A point cloud between its file and VTK: what reading a format gives and writing one takes.
 */
#ifndef AvianLidarCloudData_h
#define AvianLidarCloudData_h

#include "ParallelLoop.h"
#include "Scalars.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace avianlidar::formats
{
/// A file that is not what it should be, or that cannot be read or written.
class FormatError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Points between two calls of KeepGoing.
constexpr std::int64_t PointsPerBlock = 16384;

/// Says how far point `done` of `all` is, between two shares of the whole; throws WorkStopped.
inline void goOn(
  const KeepGoing& keepGoing, std::int64_t done, std::int64_t all, double from, double to)
{
  if (done % PointsPerBlock == 0 && keepGoing &&
    !keepGoing(from + (to - from) * static_cast<double>(done) / static_cast<double>(all)))
  {
    throw WorkStopped();
  }
}

using Values =
  std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
    std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
    std::vector<std::int64_t>, std::vector<std::uint64_t>, std::vector<float>, std::vector<double>>;

/// Zeros of that type.
Values makeValues(Scalar type, std::size_t size);
std::size_t sizeOf(const Values& values);
/// Value i from its little-endian bytes.
void setFromBytes(Values& values, std::size_t i, const unsigned char* bytes);
/// Keeps the values of those tuples whose mark is set.
void keepMarked(Values& values, int components, const std::vector<bool>& marks);

/// One array of a cloud that was read: `components` values for each point.
struct Column
{
  std::string name;
  std::string unit; ///< empty: not known, or none
  int components = 1;
  Values values;
};

/// One number or text that belongs to the whole cloud.
struct Note
{
  std::string name;
  std::string unit;
  std::vector<double> numbers;
  std::vector<std::string> texts; ///< in place of numbers
};

/// A cloud that was read.
struct Cloud
{
  std::vector<double> points; ///< x, y, z of each, metres
  std::vector<Column> columns;
  std::vector<Note> notes;
  /// Where the sensor stood, in the frame of the points; nothing if the format does not say.
  std::optional<std::array<double, 3>> sensor;
  std::string crs;                   ///< WKT, or empty
  std::vector<std::string> warnings; ///< what was left out or assumed

  std::size_t size() const { return this->points.size() / 3; }
};

/// Throws MemoryError unless there is room for a cloud whose points have so many bytes in the file.
void requireMemoryFor(std::uint64_t points, std::uint64_t length);

/// One array of a cloud to be written: one value for each point. Integers are exact up to 2^53.
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
