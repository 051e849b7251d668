// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Json.h
 * @brief The one place that includes the JSON library, nlohmann's.
 *
 * Headers of VTK 9.3 include VTK's own copy, which has Debian's include guards and renames the
 * namespace by a macro. So that one source never sees both, VTK's copy is taken wherever there is
 * one: VTK 9.1 of Debian 12 has none, nor has a program without VTK.
 */
#ifndef AvianLidarJson_h
#define AvianLidarJson_h

#if __has_include(<vtk_nlohmannjson.h>)
#include <vtk_nlohmannjson.h>
#include VTK_NLOHMANN_JSON(json.hpp)
#else
#include <nlohmann/json.hpp>
#endif

namespace avianlidar
{
/// Ordered: of two patterns that fit a name, the one written first counts.
using Json = nlohmann::ordered_json;
}

#endif
