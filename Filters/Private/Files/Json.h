// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Json.h
 * @brief Includes the JSON library nlohmann::json, for all other files.
 *
 * Headers of VTK 9.3 include VTK's own copy of the library, which has the include guards of
 * Debian's copy and renames the namespace by a macro. VTK's copy is used where it exists, so that
 * no source includes both copies. Otherwise (VTK 9.1 of Debian 12, programs without VTK) the
 * library's own header is used.
 */
#ifndef AvianLidarJson_h
#define AvianLidarJson_h

#if __has_include(<vtk_nlohmannjson.h>)
#include <vtk_nlohmannjson.h>
#include VTK_NLOHMANN_JSON(json.hpp)
#else
#include <nlohmann/json.hpp>
#endif

#include <string>

namespace avianlidar
{
/// Objects keep the order of the file: if two patterns fit a name, the first pattern counts.
using Json = nlohmann::ordered_json;

/// Returns one line of ASCII, with replacements for invalid UTF-8.
inline std::string asciiLine(const nlohmann::json& value)
{
  return value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}
}

#endif
