// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarCloudFields.h
 * @brief Converts between VTK's arrays and the clouds of the file formats. Not installed.
 *
 * A bad input gives a FormatError that names the array.
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
using avianlidar::formats::Point;
using avianlidar::formats::SensorPose;

/// Throws what vtkAvianLidarArrays finds wrong, unless it is empty.
void Require(const std::string& wrong);

/// The numeric point array of that name, or null; one of more than one component is an error.
vtkDataArray* Find(vtkPointSet* input, const char* name);

/// The numeric point array of a name; a missing array is also an error.
vtkDataArray* Need(vtkPointSet* input, const char* name);

/// A component of an array as a field, of its own type, with its unit.
Field ToField(vtkDataArray* array, int component = 0);

/// True for 64-bit integers with a value that a double cannot hold, such as checksums.
bool IsTooLongForDouble(vtkDataArray* array);

/// An array has so many components, and a tuple for each point; else it is an error.
void RequireShape(vtkDataArray* array, int components, vtkPointSet* input);

/// All numeric point arrays of one component; one without a value for each point is an error.
std::vector<vtkDataArray*> ArraysOfOne(vtkPointSet* input);

/// Whether one of the fields has that name.
bool HasName(const std::vector<Field>& fields, const std::string& name);

/// A field of a table: its name is a word, and integers of 64 bits become doubles.
Field TableField(vtkDataArray* array, int component = 0);

/// x, y, z (as floats with `single`), intensity as float, all other fields of one component, and
/// the notes as comment. Warnings name what is left out, as another has its name, and coordinates
/// that are rounded by 1 mm or more.
avianlidar::formats::TableOutput ToTable(
  vtkPointSet* input, bool single, const std::function<void(const std::string&)>& warn);

/// Value i of an array, or `otherwise` where there is no array. It must be finite.
double ValueOf(vtkDataArray* array, std::int64_t i, double otherwise);

/// The same of whole numbers that an int holds; anything else is an error.
int IntegerOf(vtkDataArray* array, std::int64_t i, int otherwise);

/// The colours of `rgb` (three unsigned chars), or null if it is not there or one number; of any
/// other shape or type it is an error.
vtkDataArray* FindColours(vtkPointSet* input);

/// Units of the point arrays, numbers and texts of the field data.
CloudNotes ToNotes(vtkPointSet* input);

/// The field data's `geodetic_origin` (latitude deg, longitude deg, height m) if it is there; an
/// error if it is not what it should be.
std::optional<Point> FindOrigin(vtkPointSet* input);

/// The field data's texts of that name, or null; of another kind they are an error.
vtkStringArray* FindTexts(vtkPointSet* input, const char* name);

/// The field data's text of that name, or an empty one.
std::string FindText(vtkPointSet* input, const char* name);

/// Where the field data's `position` and `orientation` say that the sensor is; nothing without
/// `position`.
std::optional<SensorPose> FindPose(vtkPointSet* input);

/// Point `i` in another frame; one that either frame does not hold is an error.
Point Carry(const avianlidar::GeodeticFrame& geodesy, avianlidar::Frame from, avianlidar::Frame to,
  const Point& point, std::int64_t i);

/// Publish the times of steps, s, of which there may be none; the whole output is piece 0.
void SetTimes(const std::vector<double>& times, vtkInformation* output);

/// The last step up to the time that is wanted, or the first.
std::size_t StepOf(const std::vector<double>& times, vtkInformation* output);

/// Whether another piece than the first is wanted.
bool IsOtherPiece(vtkInformation* output);

/// The error text of a step that reads, with the name of the file.
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

/// A cloud that was read, with a vertex for each point; its values are freed as they are taken
/// over.
void ToPolyData(Cloud& cloud, vtkPolyData* output);
}

#endif
