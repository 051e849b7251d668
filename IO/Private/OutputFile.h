// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file OutputFile.h
 * @brief Writes a file as a whole or not at all.
 *
 * Bytes go to a part beside the file (its name with .avianpart and a number), which takes the
 * wanted name when commit() is called. Without commit() the part is removed, and a file that had
 * the wanted name stays as it was. A part is locked (flock) while it is written. The part of a
 * killed process is not locked, and the next writing of the file removes it.
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

  /// Writes on; a FormatError if the disk is full.
  void write(const void* bytes, std::size_t count);
  void write(std::string_view text) { this->write(text.data(), text.size()); }
  void write(const std::vector<unsigned char>& bytes) { this->write(bytes.data(), bytes.size()); }

  /// Moves to the offset `at` from the beginning for the next write(); a FormatError if it cannot.
  void seek(std::uint64_t at);

  /// True if the other would take the same name.
  bool isSameAs(const OutputFile& other) const;

  /// Ends the file and gives it its name. It takes the permissions of a file that had the name.
  void commit();

  /// Commits two files: both, or a FormatError and neither. Where the file system cannot exchange
  /// two names, the error may say that the first is new already.
  static void commitBoth(OutputFile& first, OutputFile& second);

private:
  /// Writes what is still buffered.
  void finish();
  void takeName();

  std::string Name;
  std::string Part;
  std::FILE* File = nullptr; ///< the part, locked until it has its name or is removed
  unsigned int Mode = 0;     ///< st_mode of the file that is replaced, 0 if there is none
};
}

#endif
