// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarImageArrays.h
 * @brief Makes the arrays of a range image, with the values of each cell's echo and beam. Not
 * installed.
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
/// A point array with the given number of components, or null with an error text in `problem`.
/// @param port words for the input in errors
vtkDataArray* Find(vtkPolyData* input, const vtkAvianLidarArrays::Name& name, const char* port,
  std::string& problem, int components = 1);

/// An error text unless each point array has one value per point; else an empty string.
std::string CheckLengths(vtkPolyData* input, const char* port);

/// True for the whole numbers that an integer type holds.
template <class T>
bool Fits(double value)
{
  const double least = static_cast<double>(std::numeric_limits<T>::min());
  return value >= least && value < -least && value == std::floor(value);
}

/// The error text if Fits() is false.
std::string NoInteger(const vtkAvianLidarArrays::Name& name, const char* port, vtkIdType point);

/// Add the arrays of the strongest echoes. @param beamOfCell beam of each cell, or -1 @param
/// strongest strongest echo of each beam, or -1 @param problem error text; unchanged without an
/// error
void AddEchoes(vtkPolyData* echoes, const std::vector<vtkIdType>& beamOfCell,
  const std::vector<vtkIdType>& strongest, vtkImageData* image, std::string& problem);

/// Add the arrays of a beam report, if `beams` is a beam report.
void AddReport(vtkPolyData* beams, const std::vector<vtkIdType>& beamOfCell, vtkImageData* image,
  std::string& problem);

/// If output port 0 is an image whose field data hold an error, fill the requested extent with NaN.
/// VTK's imaging filters read the announced extent, and crash without it. @return false, after an
/// error of `self`, if memory does not suffice
bool FillIfFailed(vtkAlgorithm* self, vtkInformationVector* outputs);
}

#endif
