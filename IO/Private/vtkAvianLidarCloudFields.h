// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarCloudFields.h
 * @brief Converts between VTK's arrays and the clouds of the file formats. Not installed.
 *
 * The functions throw FormatError, which names the array, for bad input.
 */
#ifndef vtkAvianLidarCloudFields_h
#define vtkAvianLidarCloudFields_h

#include "CloudData.h"
#include "CloudNotes.h"
#include "FieldTable.h"
#include "GeodeticFrame.h"
#include "SensorPose.h"

#include "vtkSmartPointer.h"

#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

class vtkAbstractArray;
class vtkDataArray;
class vtkFieldData;
class vtkInformation;
class vtkPointSet;
class vtkPolyData;
class vtkStringArray;

namespace vtkAvianLidarCloudFields
{
using avianlidar::formats::Cloud;
using avianlidar::formats::CloudNotes;
using avianlidar::formats::Field;
using avianlidar::formats::FormatError;
using avianlidar::formats::Point;
using avianlidar::formats::SensorPose;

/// Runs a check of vtkAvianLidarArrays. Throws FormatError with the fault that the check finds.
template <class Check>
void Require(const Check& check)
try
{
  check();
}
catch (const std::runtime_error& error)
{
  throw FormatError(std::string("the ") + error.what());
}

/// Returns the numeric point array of a name, or null. Throws if the array has several components.
vtkDataArray* Find(vtkPointSet* input, const char* name);

/// Returns what Find() returns. Throws also if the input has points but not the array.
vtkDataArray* Need(vtkPointSet* input, const char* name);

/// Returns a component of an array as a field, with the type and unit of the array.
Field ToField(vtkDataArray* array, int component = 0);

/// True if an array of 64-bit integers has a magnitude of 2^53 or more, such as a checksum.
bool IsTooLongForDouble(vtkDataArray* array);

/// Throws unless the array has `components` components and a tuple for each point.
void RequireShape(vtkDataArray* array, int components, vtkPointSet* input);

/// Returns all numeric point arrays of one component. Throws if an array lacks a value for a point.
std::vector<vtkDataArray*> ArraysOfOne(vtkPointSet* input);

/// Returns whether one of the fields has the name.
bool HasName(const std::vector<Field>& fields, const std::string& name);

/// Returns a field of a table. Blanks in the name become `_`, and 64-bit integers become doubles.
Field TableField(vtkDataArray* array, int component = 0);

/// Returns x, y, z (as floats if `single`), intensity as float, all other fields of one component,
/// and the notes as comment. A warning names arrays that are left out because another field has
/// their name. Another warning is given if coordinates are rounded by more than 1 mm.
avianlidar::formats::TableOutput ToTable(
  vtkPointSet* input, bool single, const std::function<void(const std::string&)>& warn);

/// Returns value i of an array, or `otherwise` if the array is null. Throws if the value is not
/// finite.
double ValueOf(vtkDataArray* array, std::int64_t i, double otherwise);

/// Returns value i of an array, or `otherwise` if the array is null. Throws if the value is not a
/// whole number of 32 bits.
int IntegerOf(vtkDataArray* array, std::int64_t i, int otherwise);

/// Returns the array `rgb` of colours (three unsigned chars), or null if the array is missing or
/// has one component. Throws if `rgb` has any other shape or type.
vtkDataArray* FindColours(vtkPointSet* input);

/// Returns the units of the point arrays, and the numbers and texts of the field data.
CloudNotes ToNotes(vtkPointSet* input);

/// Returns the field data `geodetic_origin` (latitude deg, longitude deg, height m), if present.
/// Throws if the field data are not a valid origin.
std::optional<Point> FindOrigin(vtkPointSet* input);

/// Returns the texts of a name in the field data, or null. Throws if the array is not of texts.
vtkStringArray* FindTexts(vtkPointSet* input, const char* name);

/// Returns the first text of a name in the field data, or an empty text.
std::string FindText(vtkPointSet* input, const char* name);

/// Returns the pose that the field data `position` and `orientation` give; no value without
/// `position`.
std::optional<SensorPose> FindPose(vtkPointSet* input);

/// Transforms point `i` to another frame. Throws if the point is outside the range of either frame.
Point Carry(const avianlidar::GeodeticFrame& geodesy, avianlidar::Frame from, avianlidar::Frame to,
  const Point& point, std::int64_t i);

/// Publishes the times of the time steps, s, which may be empty, and that piece 0 has the whole
/// output.
void SetTimes(const std::vector<double>& times, vtkInformation* output);

/// Returns the last step up to the requested time, or the first step.
std::size_t StepOf(const std::vector<double>& times, vtkInformation* output);

/// Returns whether another piece than the first is requested.
bool IsOtherPiece(vtkInformation* output);

/// Runs a step of reading. Returns the name of the file and the error of the step, or an empty
/// text.
template <class Step>
std::string ErrorIn(const std::string& fileName, const char* noMemory, Step step)
{
  try
  {
    step();
    return {};
  }
  catch (const avianlidar::WorkStopped&)
  {
    throw;
  }
  catch (const std::bad_alloc&)
  {
    return fileName + ": " + noMemory;
  }
  catch (const std::exception& error)
  {
    return fileName + ": " + error.what();
  }
}

/// Converts a cloud to vtkPolyData with a vertex for each point. Frees the values of the cloud
/// meanwhile.
void ToPolyData(Cloud& cloud, vtkPolyData* output);
}

#endif
