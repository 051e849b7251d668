// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarImageArrays.h
 * @brief Makes the arrays of a range image, with the values of each cell's echo and beam. Not
 * installed.
 */
#ifndef vtkAvianLidarImageArrays_h
#define vtkAvianLidarImageArrays_h

#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarRequire.h"

#include "vtkType.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

class vtkAlgorithm;
class vtkDataArray;
class vtkImageData;
class vtkInformationVector;
class vtkPolyData;

namespace vtkAvianLidarImageArrays
{
// All functions except FillIfFailed() throw std::runtime_error. @param port name of the input in
// error messages

/// A point array with the given number of components.
vtkDataArray* Find(
  vtkPolyData* input, const vtkAvianLidarArrays::Name& name, const char* port, int components = 1);

/// Throws unless each point array has one tuple per point.
void RequireLengths(vtkPolyData* input, const char* port);

/// Throws unless the value is a whole number that `T` holds. @return the number
template <class T>
T RequireInteger(
  double value, const vtkAvianLidarArrays::Name& name, const char* port, vtkIdType point)
{
  const double least = static_cast<double>(std::numeric_limits<T>::min());
  if (!(value >= least && value < -least && value == std::floor(value)))
  {
    vtkAvianLidarRequire(std::string("point array '") + name.name + "' of " + port +
      " has a value that is not an integer, at point " + std::to_string(point));
  }
  return static_cast<T>(value);
}

/// Add the arrays of the strongest echoes. @param beamOfCell beam of each cell, or -1 @param
/// strongest strongest echo of each beam, or -1
void AddEchoes(vtkPolyData* echoes, const std::vector<vtkIdType>& beamOfCell,
  const std::vector<vtkIdType>& strongest, vtkImageData* image);

/// Add the arrays of a beam report, if `beams` is a beam report.
void AddReport(vtkPolyData* beams, const std::vector<vtkIdType>& beamOfCell, vtkImageData* image);

/// If output port 0 is an image whose field data hold an error, fill the requested extent with NaN.
/// VTK's imaging filters read the whole requested extent, and crash if the image is smaller.
/// @return false if memory does not suffice; `self` then reports an error
bool FillIfFailed(vtkAlgorithm* self, vtkInformationVector* outputs);
}

#endif
