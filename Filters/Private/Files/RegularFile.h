// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RegularFile.h
 * @brief Checks that a file is regular, or a link to a regular file. Reading a pipe or a device may
 * never end.
 */
#ifndef AvianLidarRegularFile_h
#define AvianLidarRegularFile_h

#include <filesystem>
#include <string>

namespace avianlidar
{
/// Reason why an existing file must not be read; empty for a regular or a missing file.
inline std::string whyNotRegular(const std::string& file)
{
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status))
  {
    return {};
  }
  return std::filesystem::is_directory(status) ? "it is a folder"
                                               : "it is not a regular file but a pipe or a device";
}
}

#endif
