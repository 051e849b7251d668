// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarRevolutions.h
 * @brief Information keys of a sensor's revolutions. Not installed.
 *
 * The beam source publishes several steps as VTK's TIME_STEPS, and the length of its revolutions
 * under another key. Filters downstream pass both keys on. So, before any filter executes, a filter
 * with beams and surfaces as inputs can find the start of the revolution that contains a given
 * time.
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

/// Choose the steps of a filter, in RequestInformation: the steps of the beams, else of the
/// surfaces, else of the movers. Beams of a file do not have steps. Beams of a sensor with only one
/// step do not have steps, either.
void ChooseSteps(vtkInformationVector** inputs, vtkInformationVector* outputs);

/**
 * In RequestUpdateExtent, request surfaces and movers at the start of the revolution that contains
 * the requested time, so that all steps of a revolution scan one scene. The requested time itself
 * is used if the beams do not give the length of revolutions (beams of a file), or if a filter has
 * changed the steps of the beams.
 */
void AskForStart(vtkInformationVector** inputs);

/// Give all outputs the time that is requested for one output, in RequestData.
/// @return the information of that output
vtkInformation* NoteTime(vtkInformation* request, vtkInformationVector* outputs);
}

#endif
