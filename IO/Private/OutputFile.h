// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file OutputFile.h
 * @brief Writes a file as a whole or not at all.
 *
 * Bytes are written to a temporary file in the same folder, the part (the name of the file with
 * .avianpart and a number). commit() gives the part the name of the file. Without commit() the part
 * is removed, and an older file of that name stays as it was. A part is locked (flock) while it is
 * written. The part of a killed process is not locked, and the next OutputFile of the same name
 * removes this part.
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
  /// Opens a part. Throws FormatError with the reason if the part cannot be made: the folder is
  /// missing, there is no permission, or the name belongs to a folder or a device.
  explicit OutputFile(const std::string& name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends bytes. Throws FormatError if the bytes cannot be written, as on a full disk.
  void write(const void* bytes, std::size_t count);
  void write(std::string_view text) { this->write(text.data(), text.size()); }
  void write(const std::vector<unsigned char>& bytes) { this->write(bytes.data(), bytes.size()); }

  /// Moves the position of the next write() to the offset `at`, bytes. Throws FormatError on
  /// failure.
  void seek(std::uint64_t at);

  /// True if the other file has the same name.
  bool isSameAs(const OutputFile& other) const;

  /// Ends the part and gives it the name of the file. The part gets the permissions of the file
  /// that it replaces.
  void commit();

  /// Commits two files, or throws FormatError and commits neither. If the file system cannot
  /// exchange two names, the first file may already be replaced, and the error says so.
  static void commitBoth(OutputFile& first, OutputFile& second);

private:
  /// Writes the bytes that are still in the buffer.
  void finish();
  void takeName();

  std::string Name;
  std::string Part;
  std::FILE* File = nullptr; ///< the part, locked until it is renamed or removed
  unsigned int Mode = 0;     ///< st_mode of the file that is replaced; 0 without such a file
};
}

#endif
