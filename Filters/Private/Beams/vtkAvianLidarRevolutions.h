// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarRevolutions.h
 * @brief Information keys of a sensor's revolutions. Not installed.
 *
 * The beam source publishes its steps as VTK's TIME_STEPS, if they are several, and how long its
 * revolutions last under a key of its own. Filters between pass both on, so filters of beams and
 * surfaces know before anything executes when the revolution begins that a time falls into.
 */
#ifndef vtkAvianLidarRevolutions_h
#define vtkAvianLidarRevolutions_h

#include "ScanClock.h"

class vtkInformation;
class vtkInformationVector;

namespace vtkAvianLidarRevolutions
{
/// In RequestInformation: say what there is to play.
void Publish(const avianlidar::ScanClock& clock, vtkInformation* output);

/// In RequestInformation of a filter of beams, surfaces and movers: its steps are those of the
/// beams; where beams (a file's, or of a sensor with one step alone) have none, those of the
/// surfaces, else of the movers.
void ChooseSteps(vtkInformationVector** inputs, vtkInformationVector* outputs);

/**
 * In its RequestUpdateExtent: ask for surfaces and movers at the start of the revolution that the
 * time asked for falls into, so that a sweep sees one scene. At that time itself, where the beams
 * do not say how long revolutions last (those of a file), or a filter between gave them other
 * steps.
 */
void AskForStart(vtkInformationVector** inputs);

/// In RequestData: all outputs are of the time for which one of them is asked, and say so.
/// @return the information of that output
vtkInformation* NoteTime(vtkInformation* request, vtkInformationVector* outputs);
}

#endif
