// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarModelNotes.h
 * @brief What a scan left out and why, in sentences for who looks at its field data. Not installed.
 *
 * They follow from the setup alone: a scan lit again says what a
 * fresh one does. What was left out of single beams stands in the beam report, as it depends on
 * what was known before.
 */
#ifndef vtkAvianLidarModelNotes_h
#define vtkAvianLidarModelNotes_h

#include "ScanSetup.h"

#include <string>
#include <vector>

struct vtkAvianLidarModelNote
{
  const char* name; ///< name of the field array that holds it
  std::string text; ///< one line; energies in J, ranges in m
};

/// One for each part of the model that may be left out, always in the same order.
/// ParaView's Information panel shows the first strings of an array in one line, without anything
/// between them: so each note is an array of its own.
std::vector<vtkAvianLidarModelNote> vtkAvianLidarModelNotes(const avianlidar::ScanSetup& setup);

#endif
