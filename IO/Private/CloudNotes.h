// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CloudNotes.h
 * @brief Writes and reads the notes of a cloud as one line of JSON in its file: units of the
 * arrays, and numbers and texts by name (the sensor, the settings, the origin).
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

/// One line, plain ASCII. If the line has more than `longest` characters, the notes with the
/// longest texts are left out, and their names are added to `left`.
std::string toText(const CloudNotes& notes, std::size_t longest, std::vector<std::string>& left);

/// The text with invalid UTF-8 replaced, and without control characters except ends of lines: files
/// may hold any bytes, but names and field data must be valid.
std::string cleaned(const std::string& text);

/// The notes in a text; false if it holds none (any other text).
bool fromText(const std::string& text, CloudNotes& notes);
}

#endif
