// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarCloudFields.h
 * @brief Converts between VTK's arrays and the clouds of the file formats. Not installed.
 *
 * The functions throw std::runtime_error, which names the array, for bad input.
 */
#ifndef vtkAvianLidarCloudFields_h
#define vtkAvianLidarCloudFields_h

#include "CloudData.h"
#include "CloudNotes.h"
#include "FieldTable.h"
#include "GeodeticFrame.h"
#include "SemanticLabels.h"
#include "Vector.h"

#include "vtkSmartPointer.h"

#include <new>
#include <optional>
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

/// Position and orientation of a sensor.
class SensorPose
{
public:
  /// Makes a pose at the origin, without rotation.
  SensorPose() = default;

  /// Makes a pose from a position, m, and yaw, pitch and roll, deg, as in ScanPattern.h.
  SensorPose(const Point& position, const Point& orientation);

  /// Transforms a point from the scene's frame to the sensor's frame: x right, y forward, z up.
  Point toSensor(const Point& point) const;

  /// Returns the position, m, and the unit quaternion (w x y z, w >= 0) of the rotation from the
  /// sensor's frame to the scene's frame.
  std::array<double, 7> viewpoint() const;

private:
  Point Position{};
  /// Axes of the sensor in the scene's frame, unit vectors.
  std::array<avianlidar::Vec3, 3> Axes{ { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 },
    { 0.0, 0.0, 1.0 } } };
};

/// Returns the numeric point array of a name, or null. Throws if the array has several components.
vtkDataArray* Find(vtkPointSet* input, const char* name);

/// Returns what Find() returns. Throws also if the input has points but not the array.
vtkDataArray* Need(vtkPointSet* input, const char* name);

/// Returns a component of an array as a field, with the type and unit of the array.
Field ToField(vtkDataArray* array, int component = 0);

/// Returns whether an array has a 64-bit integer of 2^53 or more in magnitude, such as a checksum.
bool IsTooLongForDouble(vtkDataArray* array);

/// Throws unless the array has `components` components and a tuple for each point.
void RequireShape(vtkDataArray* array, int components, vtkPointSet* input);

/// Returns all numeric point arrays that have a name. Throws if an array lacks a value for a point.
std::vector<vtkDataArray*> NumericArrays(vtkPointSet* input);

/// Returns a field for each component of an array. Fields of several components are named `name_0`,
/// `name_1`, ...
std::vector<Field> ToFields(vtkDataArray* array);

/// Adds the fields of an array to `all`, unless one of their names is taken: then adds the name of
/// the array to `left`.
void Append(const std::string& array, const std::vector<Field>& fields, std::vector<Field>& all,
  std::vector<std::string>& left);

/// Returns a list such as "'energy', 'azimuth'".
std::string Quoted(const std::vector<std::string>& names);

/// Gives a warning that names the arrays that Append() left out, if any.
void WarnOfTaken(
  const std::vector<std::string>& left, const std::function<void(const std::string&)>& warn);

constexpr double NoticeableRounding = 1e-3; // rounding that gives a warning, m

/// Returns the largest rounding error of a coordinate as float, in the unit of the coordinates.
/// Infinity if a float cannot hold a coordinate.
double RoundingOf(const Point& point);

/// Returns the words " moves coordinates by up to 0.25 m".
std::string Moves(double rounding);

/// Returns x, y, z, intensity as float, the fields of all other numeric
/// arrays (`toColours` makes the fields of `rgb`), and the notes as comment. Blanks in names become
/// `_`, and 64-bit integers become doubles. A warning names arrays that are left out because
/// another field has their name. A second warning reports rounding by more than 1 mm, or double
/// precision that avoids the rounding.
/// @param precision of x, y and z: 0 single, 1 double, 2 double only if single precision rounds by
/// more than 1 mm
avianlidar::formats::TableOutput ToTable(vtkPointSet* input, int precision,
  const std::function<std::vector<Field>(vtkDataArray*)>& toColours,
  const std::function<void(const std::string&)>& warn);

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

/// Returns the texts of a name in the field data, or null. Throws if the array does not hold texts.
vtkStringArray* FindTexts(vtkPointSet* input, const char* name);

/// Returns the first text of a name in the field data, or an empty text.
std::string FindText(vtkPointSet* input, const char* name);

/// Returns a function that gives the labels of an object by its id, from the classes in the field
/// data. Throws as FindTexts() does.
std::function<avianlidar::formats::SemanticLabel(int)> LabelsOf(vtkPointSet* input);

/// Returns the pose that the field data `position` and `orientation` give, or no value without
/// `position`.
std::optional<SensorPose> FindPose(vtkPointSet* input);

/// Transforms point `i` to another frame. Throws if the point is outside the range of either frame.
Point Carry(const avianlidar::GeodeticFrame& geodesy, avianlidar::Frame from, avianlidar::Frame to,
  const Point& point, std::int64_t i);

/// Publishes the times of the time steps, s, unless `times` is empty. Also publishes that piece 0
/// has the whole output.
void SetTimes(const std::vector<double>& times, vtkInformation* output);

/// Returns the index of the last step up to the requested time, or of the first step.
std::size_t StepOf(const std::vector<double>& times, vtkInformation* output);

/// Returns whether a piece other than piece 0 is requested.
bool IsOtherPiece(vtkInformation* output);

/// Runs a step of reading, and puts the name of the file in front of its error.
template <class Step>
void Within(const std::string& fileName, const char* noMemory, const Step& step)
try
{
  step();
}
catch (const avianlidar::WorkStopped&)
{
  throw;
}
catch (const std::bad_alloc&)
{
  avianlidar::fail(fileName, ": ", noMemory);
}
catch (const std::exception& error)
{
  avianlidar::fail(fileName, ": ", error.what());
}

/// Converts a cloud to vtkPolyData with a vertex for each point. Frees the values of the cloud as
/// they are converted.
void ToPolyData(Cloud& cloud, vtkPolyData* output);
}

#endif
