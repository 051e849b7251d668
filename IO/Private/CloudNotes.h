// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CloudNotes.h
 * @brief What belongs to a cloud as a whole, as one line of JSON in a text of its file: units of
 * the arrays, and numbers and texts by name (the sensor, the settings, the origin).
 */
#ifndef AvianLidarCloudNotes_h
#define AvianLidarCloudNotes_h

#include "CloudData.h"

#include <map>

namespace avianlidar::formats
{
struct CloudNotes
{
  std::map<std::string, std::string> units; ///< units by array
  std::vector<Note> notes;
};

/// One line, plain ASCII. Notes of more than `longest` characters all together lose those with the
/// longest texts, whose names come back in `left`.
std::string toText(const CloudNotes& notes, std::size_t longest, std::vector<std::string>& left);

/// The text with what is no UTF-8 replaced, and without control characters but the ends of lines:
/// files hold any bytes, names and field data must not.
std::string cleaned(const std::string& text);

/// The notes in a text; false if it holds none (any other text).
bool fromText(const std::string& text, CloudNotes& notes);
}

#endif
