// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarImageArrays.h
 * @brief The arrays of a range image: of each cell what its echo and its beam say. Not installed.
 */
#ifndef vtkAvianLidarImageArrays_h
#define vtkAvianLidarImageArrays_h

#include "vtkAvianLidarNames.h"

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
/// A point array of that many components, or a null pointer and what is wrong in `problem`.
/// @param port what is said of the input
vtkDataArray* Find(vtkPolyData* input, const vtkAvianLidarArrays::Name& name, const char* port,
  std::string& problem, int components = 1);

/// What is wrong with the lengths of point arrays: each must have one value per point.
std::string CheckLengths(vtkPolyData* input, const char* port);

/// True for the whole numbers that an integer type holds.
template <class T>
bool Fits(double value)
{
  const double least = static_cast<double>(std::numeric_limits<T>::min());
  return value >= least && value < -least && value == std::floor(value);
}

/// What to say if it cannot.
std::string NoInteger(const vtkAvianLidarArrays::Name& name, const char* port, vtkIdType point);

/// What the strongest echoes say. @param beamOfCell the beam that each cell shows, -1 where there
/// is none @param strongest the echo of each beam, or -1 @param problem what is wrong, or untouched
void AddEchoes(vtkPolyData* echoes, const std::vector<vtkIdType>& beamOfCell,
  const std::vector<vtkIdType>& strongest, vtkImageData* image, std::string& problem);

/// What beams say that are a beam report.
void AddReport(vtkPolyData* beams, const std::vector<vtkIdType>& beamOfCell, vtkImageData* image,
  std::string& problem);

/// Where output port 0 is an image whose field data hold an error: fill what is asked for of it
/// with numbers that are none. VTK's imaging filters look for the extent that they were promised,
/// and crash without it. @return false, after an error of `self`, for want of memory
bool FillIfFailed(vtkAlgorithm* self, vtkInformationVector* outputs);
}

#endif
