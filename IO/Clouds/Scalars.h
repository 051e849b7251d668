// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Scalars.h
 * @brief Converts between numbers and the ten types that point cloud files store, little endian.
 */
#ifndef AvianLidarScalars_h
#define AvianLidarScalars_h

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

namespace avianlidar::formats
{
enum class Scalar
{
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64
};

/// Returns the size of a value: 1, 2, 4 or 8 bytes.
std::size_t sizeOf(Scalar type);

bool isFloat(Scalar type);
bool isSigned(Scalar type);

/// Returns the type of a kind ('I', 'U' or 'F') and a size, bytes, or no value without such a type.
std::optional<Scalar> scalarOf(char kind, std::size_t size);

/// Calls f with a value of the C++ type of the scalar type.
template <class F>
decltype(auto) withType(Scalar type, F f)
{
  switch (type)
  {
    case Scalar::Int8:
      return f(std::int8_t{});
    case Scalar::UInt8:
      return f(std::uint8_t{});
    case Scalar::Int16:
      return f(std::int16_t{});
    case Scalar::UInt16:
      return f(std::uint16_t{});
    case Scalar::Int32:
      return f(std::int32_t{});
    case Scalar::UInt32:
      return f(std::uint32_t{});
    case Scalar::Int64:
      return f(std::int64_t{});
    case Scalar::UInt64:
      return f(std::uint64_t{});
    case Scalar::Float32:
      return f(float{});
    default:
      return f(double{});
  }
}

/// Unsigned integer of `Size` bytes.
template <std::size_t Size>
using BitsOf = std::conditional_t<Size == 1, std::uint8_t,
  std::conditional_t<Size == 2, std::uint16_t,
    std::conditional_t<Size == 4, std::uint32_t, std::uint64_t>>>;

/// Returns the value whose little-endian bytes begin at `bytes`. No alignment is needed.
template <class T>
T load(const unsigned char* bytes)
{
  using Bits = BitsOf<sizeof(T)>;
  Bits bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i)
  {
    bits = static_cast<Bits>(bits | static_cast<Bits>(Bits{ bytes[i] } << (8 * i)));
  }
  T value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// Writes the little-endian bytes of the value to `bytes`.
template <class T>
void store(T value, unsigned char* bytes)
{
  BitsOf<sizeof(T)> bits;
  std::memcpy(&bits, &value, sizeof value);
  for (std::size_t i = 0; i < sizeof(T); ++i)
  {
    bytes[i] = static_cast<unsigned char>(bits >> (8 * i));
  }
}

/// Returns the nearest value that the type can hold: rounded, and limited to the range of the type.
/// NaN becomes 0 if the type is an integer.
double nearest(Scalar type, double value);

/// Writes the result of nearest() as store() does. Integers are exact up to 2^53.
void storeAs(Scalar type, double value, unsigned char* bytes);

/// Reads a value as load() does, and converts the value to double.
double loadAs(Scalar type, const unsigned char* bytes);
}

#endif
