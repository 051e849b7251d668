// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file OutputFile.h
 * @brief A file that is there as a whole or not at all.
 *
 * Bytes go to a file of a temporary name in the same folder, which takes the wanted name when
 * commit() is called. Without that, whatever the reason, it is removed, and a file that had the
 * wanted name stays as it was.
 */
#ifndef AvianLidarOutputFile_h
#define AvianLidarOutputFile_h

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace avianlidar::formats
{
class OutputFile
{
public:
  /// A FormatError says why it cannot be made: no such folder, no permission, the name belongs to a
  /// folder or a device.
  explicit OutputFile(const std::string& name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends; a FormatError if the disk is full.
  void write(const void* bytes, std::size_t count);
  void write(std::string_view text) { this->write(text.data(), text.size()); }
  void write(const std::vector<unsigned char>& bytes) { this->write(bytes.data(), bytes.size()); }

  /// Ends the file and gives it its name.
  void commit();

private:
  [[noreturn]] void fail(const std::string& what) const;

  std::string Name;
  std::string Temporary;
  std::FILE* File = nullptr;
};
}

#endif
