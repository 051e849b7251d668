// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Glob.h
 * @brief Names picked by a pattern with wildcards.
 */
#ifndef avianlidar_Glob_h
#define avianlidar_Glob_h

#include <string>

namespace avianlidar
{
/// True if the whole of `name` fits `pattern`: `*` stands for any text (also none), `?` for any one
/// character, every other character for itself, upper and lower case apart. Time grows with the
/// product of the two lengths at most.
bool globMatches(const std::string& pattern, const std::string& name);
}

#endif
