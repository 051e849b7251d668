// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file FileNames.h
 * @brief Finds the format of a file by the extension of its name.
 */
#ifndef AvianLidarFileNames_h
#define AvianLidarFileNames_h

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>

namespace avianlidar
{
inline bool StartsWith(std::string_view text, std::string_view start)
{
  return text.substr(0, start.size()) == start;
}

/// Returns the file extension in lower case, with the dot: ".vtp".
inline std::string EndingOf(const std::string& file)
{
  return vtksys::SystemTools::LowerCase(vtksys::SystemTools::GetFilenameLastExtension(file));
}

/// Returns the file name without ".gz". The extension of the result gives the format.
inline std::string UncompressedName(const std::string& file)
{
  return EndingOf(file) == ".gz" ? file.substr(0, file.size() - 3) : file;
}

/// Returns whether a file has one of some file extensions.
inline bool EndsWithAny(const std::string& file, std::initializer_list<const char*> endings)
{
  return std::find(endings.begin(), endings.end(), EndingOf(file)) != endings.end();
}
}

#endif
