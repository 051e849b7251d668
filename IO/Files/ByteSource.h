// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ByteSource.h
 * @brief Reads bytes from a source of known length, such as a file, and never beyond its end.
 */
#ifndef AvianLidarByteSource_h
#define AvianLidarByteSource_h

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace avianlidar
{
class ByteSource
{
public:
  virtual ~ByteSource() = default;

  virtual std::uint64_t size() const = 0;

  /// Copies `count` bytes from `offset` on. Throws FileError unless all bytes lie inside the
  /// source.
  virtual void read(std::uint64_t offset, std::uint64_t count, unsigned char* into) = 0;

  /// Returns whether `count` bytes from `offset` on lie inside the source, without overflow.
  bool holds(std::uint64_t offset, std::uint64_t count) const
  {
    return offset <= this->size() && count <= this->size() - offset;
  }

  std::vector<unsigned char> bytes(std::uint64_t offset, std::uint64_t count);

  /// Returns bytes that are valid until the next call. Reads pieces of 1 MiB or more.
  const unsigned char* at(std::uint64_t offset, std::uint64_t count);

private:
  std::vector<unsigned char> Piece;
  std::uint64_t PieceBegin = 0;
};

class FileSource : public ByteSource
{
public:
  /// Opens the file. Throws FileError with the reason if the file cannot be opened.
  explicit FileSource(const std::string& name);
  std::uint64_t size() const override { return this->Size; }
  void read(std::uint64_t offset, std::uint64_t count, unsigned char* into) override;

private:
  std::ifstream Stream;
  std::uint64_t Size = 0;
};

/// Calls record(i, bytes) for each of `count` records of `length` bytes. All records must lie
/// inside the source.
template <class F>
void forEachRecord(
  ByteSource& source, std::uint64_t offset, std::uint64_t length, std::uint64_t count, F record)
{
  for (std::uint64_t i = 0; i < count; ++i)
  {
    record(i, source.at(offset + i * length, length));
  }
}
}

#endif
