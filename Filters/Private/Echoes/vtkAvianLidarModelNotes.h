// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarModelNotes.h
 * @brief Describes in sentences, for field data, what a scan left out and why. Not installed.
 *
 * The notes follow only from the setup, so the notes are the same for a new scan and for a scan of
 * which only the energies are computed again. The beam report says what was left out in each beam,
 * because the parts left out depend on results kept from earlier scans.
 */
#ifndef vtkAvianLidarModelNotes_h
#define vtkAvianLidarModelNotes_h

#include "ScanSetup.h"

#include <string>
#include <vector>

struct vtkAvianLidarModelNote
{
  const char* name; ///< name of the field array that holds the note
  std::string text; ///< one line; energies in J, ranges in m
};

/// A note for each part of the model that may be left out, always in the same order. Each note is
/// an array, because ParaView's Information panel shows the strings of an array in one line without
/// anything between them.
std::vector<vtkAvianLidarModelNote> vtkAvianLidarModelNotes(const avianlidar::ScanSetup& setup);

#endif
