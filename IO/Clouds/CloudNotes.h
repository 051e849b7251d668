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
  std::map<std::string, std::string> units; ///< unit of each array, by name
  std::vector<Note> notes;
};

/// Returns one line of ASCII. If the line has more than `longest` characters, the notes with the
/// longest texts are left out. The names of these notes are added to `left`.
std::string toText(const CloudNotes& notes, std::size_t longest, std::vector<std::string>& left);

/// Returns the text with replacements for invalid UTF-8 and for control characters other than line
/// feeds. Files may contain any bytes, but names and field data must be valid UTF-8.
std::string cleaned(const std::string& text);

/// Reads the notes in a text. Returns false if the text has no notes.
bool fromText(const std::string& text, CloudNotes& notes);
}

#endif
