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
#include "SensorPose.h"

#include "vtkSmartPointer.h"

#include <optional>
#include <vector>

class vtkAbstractArray;
class vtkDataArray;
class vtkFieldData;
class vtkObject;
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
std::vector<Field> AllFields(vtkPointSet* input);

/// x, y, z (as floats with `single`), intensity as float, and all other fields, their names as
/// words and integers of 64 bits as doubles. The writer warns of what is left out, as another has
/// its name, and of coordinates that are rounded by 1 mm or more.
std::vector<Field> TableFields(
  vtkObject* writer, const char* fileName, vtkPointSet* input, bool single);

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

/// The texts of an array of the field data by index; empty ones where there is none.
std::string TextAt(vtkPointSet* input, const char* name, std::int64_t index);

/// Where the field data's `position` and `orientation` say that the sensor is; nothing without
/// `position`.
std::optional<SensorPose> FindPose(vtkPointSet* input);

/// A cloud that was read, with a vertex for each point; its values are freed as they are taken
/// over.
void ToPolyData(Cloud& cloud, vtkPolyData* output);
}

#endif
