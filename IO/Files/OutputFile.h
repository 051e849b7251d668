// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file OutputFile.h
 * @brief Writes a file as a whole or not at all. Python's _disk.py does the same.
 *
 * Bytes are written to a temporary file in the same folder, called the part. The name of the part
 * is the name of the file with .avianpart and a number. commit() writes the part to the disk and
 * gives it the name of the file. Without commit() the part is removed and an older file of that
 * name is unchanged. A part is locked (flock) while it is written. The part of a killed process is
 * not locked. The next OutputFile of the same name removes such a part.
 */
#ifndef AvianLidarOutputFile_h
#define AvianLidarOutputFile_h

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace avianlidar
{
class OutputFile
{
public:
  /// Opens a part. Throws FileError with the reason if the part cannot be made: the folder is
  /// missing, there is no permission, or the name belongs to a folder or a device.
  explicit OutputFile(const std::string& name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends bytes. Throws FileError if the bytes cannot be written, as on a full disk.
  void write(const void* bytes, std::size_t count);
  void write(std::string_view text) { this->write(text.data(), text.size()); }
  void write(const std::vector<unsigned char>& bytes) { this->write(bytes.data(), bytes.size()); }

  /// Moves the position of the next write() to the offset `at`, bytes. Throws FileError on
  /// failure.
  void seek(std::uint64_t at);

  /// Returns the absolute name of the file, without links.
  const std::string& name() const { return this->Name; }

  /// Returns whether the other file has the same name.
  bool isSameAs(const OutputFile& other) const { return this->Name == other.Name; }

  /// Ends the part and gives the part the name of the file, and the permissions of the file that
  /// the part replaces.
  void commit();

  /// Commits two files, or throws FileError and commits no file. If the file system
  /// cannot exchange two names, the first file may already be replaced. The error then names the
  /// replaced file.
  static void commitBoth(OutputFile& first, OutputFile& second);

private:
  void finish();
  void takeName();

  std::string Name;          ///< absolute name of the file, without links
  std::string Part;          ///< name of the part or, after an exchange, of the old file; or empty
  std::FILE* File = nullptr; ///< stream of the part, which is locked until this object is destroyed
  int Old = -1;              ///< the replaced file, locked while it has the name of the part
  unsigned int Mode = 0;     ///< st_mode of the file that is replaced; 0 without such a file
};
}

#endif
