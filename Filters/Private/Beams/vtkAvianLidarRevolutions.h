// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarRevolutions.h
 * @brief Information keys of a sensor's revolutions. Not installed.
 *
 * The beam source publishes several steps as VTK's TIME_STEPS, and the length of its revolutions
 * under another key. Filters in between pass both keys on. So filters of beams and surfaces can
 * find, before any execution, the start of the revolution at a given time.
 */
#ifndef vtkAvianLidarRevolutions_h
#define vtkAvianLidarRevolutions_h

#include "ScanClock.h"

class vtkInformation;
class vtkInformationVector;

namespace vtkAvianLidarRevolutions
{
/// Publish the steps of a sensor, in RequestInformation.
void Publish(const avianlidar::ScanClock& clock, vtkInformation* output);

/// Choose the steps of a filter, in RequestInformation: the steps of the beams if they have any
/// (beams of a file or of a sensor with only one step have none), else the steps of the surfaces,
/// else the steps of the movers.
void ChooseSteps(vtkInformationVector** inputs, vtkInformationVector* outputs);

/**
 * In RequestUpdateExtent, request surfaces and movers at the start of the revolution that contains
 * the requested time, so that all steps of a revolution see one scene. If the beams do not give the
 * length of revolutions (beams of a file), or if a filter in between changed the steps of the
 * beams, the requested time itself is used.
 */
void AskForStart(vtkInformationVector** inputs);

/// Give all outputs the time that is requested for one of them, in RequestData.
/// @return the information of that output
vtkInformation* NoteTime(vtkInformation* request, vtkInformationVector* outputs);
}

#endif
