// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarCloudFields.h"

#include "CoordinateSystem.h"
#include "ScanPattern.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarRequire.h"

#include "vtkAlgorithm.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkVariant.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace vtkAvianLidarCloudFields
{
namespace formats = avianlidar::formats;
namespace names = vtkAvianLidarArrays;
using avianlidar::fail;
using avianlidar::failIf;
using formats::Scalar;
using Pipeline = vtkStreamingDemandDrivenPipeline;

namespace
{
constexpr double MetresPerDegree = 111320.0; // along the equator
enum Precision                               // as in the classes of the writers
{
  PRECISION_SINGLE,
  PRECISION_DOUBLE,
  PRECISION_AUTOMATIC
};

Scalar ScalarOf(vtkDataArray* array)
{
  const int type = array->GetDataType();
  const bool real = type == VTK_FLOAT || type == VTK_DOUBLE;
  const bool withSign = real || array->GetDataTypeMin() < 0.0;
  return formats::scalarOf(real ? 'F'
      : withSign                ? 'I'
                                : 'U',
    array->GetDataTypeSize())
    .value_or(Scalar::Float64);
}

std::string UnitOf(vtkAbstractArray* array)
{
  vtkInformation* information = array->HasInformation() ? array->GetInformation() : nullptr;
  const char* unit = information ? information->Get(vtkDataArray::UNITS_LABEL()) : nullptr;
  return unit ? unit : "";
}

/// Returns three numbers of the field data, or no value if the array is missing.
std::optional<Point> FindTriple(vtkPointSet* input, const names::Name& name)
{
  vtkAvianLidarWithin(
    "the ", [&] { names::RequireNumeric(input->GetFieldData(), name, "field data"); });
  vtkDataArray* array = input->GetFieldData()->GetArray(name.name);
  if (!array)
  {
    return std::nullopt;
  }
  failIf(array->GetNumberOfValues() != 3, "the field data '", name.name, "' has ",
    array->GetNumberOfValues(), " values, expected three");
  Point values;
  for (int i = 0; i < 3; ++i)
  {
    values[i] =
      array->GetComponent(i / array->GetNumberOfComponents(), i % array->GetNumberOfComponents());
    failIf(
      !std::isfinite(values[i]), "the field data '", name.name, "' has a value that is not finite");
  }
  return values;
}

Field CoordinateField(vtkPointSet* input, int axis, bool single)
{
  return { std::string(1, "xyz"[axis]), "m", single ? Scalar::Float32 : Scalar::Float64,
    [input, axis, single](std::int64_t i)
    {
      const double value = input->GetPoint(i)[axis];
      failIf(single && std::isfinite(value) && std::abs(value) > std::numeric_limits<float>::max(),
        "point ", i,
        " has a coordinate beyond the range of single precision: set Precision to Double");
      return value;
    } };
}

/// Returns the largest rounding error of a coordinate as float, m. Infinity if a float cannot hold
/// a coordinate.
double LargestRounding(vtkPointSet* input)
{
  const bool isDegrees = formats::hasDegrees(FindText(input, names::CrsWkt.name));
  const double across = isDegrees ? MetresPerDegree : 1.0; // length of a unit of x and y, m
  double most = 0.0;
  for (vtkIdType i = 0; i < input->GetNumberOfPoints(); ++i)
  {
    Point p;
    input->GetPoint(i, p.data());
    most =
      std::max({ most, across * RoundingOf({ p[0], p[1], 0.0 }), RoundingOf({ 0.0, 0.0, p[2] }) });
  }
  return most;
}

vtkSmartPointer<vtkDataArray> ToArray(const formats::Column& column)
{
  return std::visit(
    [&](const auto& values)
    {
      using Own = typename std::decay_t<decltype(values)>::value_type;
      // VTK has two types for 64-bit integers.
      using T = std::conditional_t<std::is_same_v<Own, std::int64_t>, vtkTypeInt64,
        std::conditional_t<std::is_same_v<Own, std::uint64_t>, vtkTypeUInt64, Own>>;
      auto array = vtkSmartPointer<vtkDataArray>::Take(
        vtkDataArray::CreateDataArray(vtkTypeTraits<T>::VTK_TYPE_ID));
      array->SetName(column.name.c_str());
      array->SetNumberOfComponents(column.components);
      auto* typed = vtkAOSDataArrayTemplate<T>::FastDownCast(array);
      names::SetTuples(typed, static_cast<vtkIdType>(values.size() / column.components));
      names::SetUnit(array, column.unit.c_str());
      std::copy(values.begin(), values.end(), typed->GetPointer(0));
      return array;
    },
    column.values);
}

void AddNote(const formats::Note& note, vtkFieldData* fields)
{
  if (!note.texts.empty())
  {
    // All comments of a file are in one array.
    if (auto* there = names::FindTexts(fields, { note.name.c_str(), "" }))
    {
      for (const std::string& text : note.texts)
      {
        there->InsertNextValue(text);
      }
      return;
    }
    names::SetFieldStrings(fields, { note.name.c_str(), note.unit.c_str() }, note.texts);
    return;
  }
  const bool triple = note.numbers.size() == 3;
  auto array = names::Make<vtkDoubleArray>({ note.name.c_str(), note.unit.c_str() },
    triple ? 1 : static_cast<vtkIdType>(note.numbers.size()), triple ? 3 : 1);
  std::copy(note.numbers.begin(), note.numbers.end(), array->GetPointer(0));
  fields->AddArray(array);
}
}

//------------------------------------------------------------------------------
bool IsTooLongForDouble(vtkDataArray* array)
{
  constexpr double limit = 9007199254740992.0; // 2^53, to which 2^53 + 1 is rounded
  bool tooLong = false;
  for (vtkIdType i = 0; array->GetDataTypeSize() == 8 && !formats::isFloat(ScalarOf(array)) &&
       i < array->GetNumberOfTuples() && !tooLong;
       ++i)
  {
    for (int c = 0; c < array->GetNumberOfComponents(); ++c)
    {
      tooLong = tooLong || std::abs(array->GetComponent(i, c)) >= limit;
    }
  }
  return tooLong;
}

//------------------------------------------------------------------------------
void RequireShape(vtkDataArray* array, int components, vtkPointSet* input)
{
  vtkAvianLidarWithin("the ",
    [&] { names::RequireShape(array, "point array", components, input->GetNumberOfPoints()); });
}

//------------------------------------------------------------------------------
vtkDataArray* Find(vtkPointSet* input, const char* name)
{
  vtkAvianLidarWithin("the ",
    [&] {
      names::RequireNumeric(input->GetPointData(), { name, "" }, "point array");
    });
  vtkDataArray* array = input->GetPointData()->GetArray(name);
  RequireShape(array, 1, input);
  return array;
}

//------------------------------------------------------------------------------
vtkDataArray* Need(vtkPointSet* input, const char* name)
{
  vtkDataArray* array = Find(input, name);
  failIf(
    !array && input->GetNumberOfPoints() > 0, "the input has no numeric point array '", name, "'");
  return array;
}

//------------------------------------------------------------------------------
Field ToField(vtkDataArray* array, int component)
{
  return { array->GetName(), UnitOf(array), ScalarOf(array),
    [array, component](std::int64_t i) { return array->GetComponent(i, component); } };
}

//------------------------------------------------------------------------------
std::vector<vtkDataArray*> NumericArrays(vtkPointSet* input)
{
  std::vector<vtkDataArray*> arrays;
  vtkPointData* data = input->GetPointData();
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    if (array && array->GetName() && *array->GetName())
    {
      RequireShape(array, array->GetNumberOfComponents(), input);
      arrays.push_back(array);
    }
  }
  return arrays;
}

//------------------------------------------------------------------------------
std::vector<Field> ToFields(vtkDataArray* array)
{
  std::vector<Field> fields;
  const int components = array->GetNumberOfComponents();
  for (int c = 0; c < components; ++c)
  {
    fields.push_back(ToField(array, c));
    fields.back().name += components > 1 ? "_" + std::to_string(c) : std::string();
  }
  return fields;
}

//------------------------------------------------------------------------------
void Append(const std::string& array, const std::vector<Field>& fields, std::vector<Field>& all,
  std::vector<std::string>& left)
{
  const auto isTaken = [&](const Field& field)
  {
    return std::any_of(
      all.begin(), all.end(), [&](const Field& other) { return other.name == field.name; });
  };
  if (std::any_of(fields.begin(), fields.end(), isTaken))
  {
    left.push_back(array);
    return;
  }
  all.insert(all.end(), fields.begin(), fields.end());
}

//------------------------------------------------------------------------------
std::string Quoted(const std::vector<std::string>& names)
{
  std::string list;
  for (const std::string& name : names)
  {
    list += (list.empty() ? "'" : ", '") + name + "'";
  }
  return list;
}

//------------------------------------------------------------------------------
void WarnOfTaken(
  const std::vector<std::string>& left, const std::function<void(const std::string&)>& warn)
{
  if (!left.empty())
  {
    warn(
      " is without the point arrays " + Quoted(left) + ": another field of the file has the name.");
  }
}

//------------------------------------------------------------------------------
double RoundingOf(const Point& point)
{
  double most = 0.0;
  for (const double value : point)
  {
    const bool isBeyond = std::abs(value) > std::numeric_limits<float>::max();
    const double rounding = isBeyond ? INFINITY : std::abs(value - static_cast<float>(value));
    most = std::isfinite(value) ? std::max(most, rounding) : most;
  }
  return most;
}

//------------------------------------------------------------------------------
std::string Moves(double rounding)
{
  return std::isfinite(rounding)
    ? avianlidar::joined(" moves coordinates by up to ", std::round(1e3 * rounding) / 1e3, " m")
    : " cannot hold all coordinates";
}

//------------------------------------------------------------------------------
formats::TableOutput ToTable(vtkPointSet* input, int precision,
  const std::function<std::vector<Field>(vtkDataArray*)>& toColours,
  const std::function<void(const std::string&)>& warn)
{
  const double rounding = precision == PRECISION_DOUBLE ? 0.0 : LargestRounding(input);
  const bool single = precision == PRECISION_SINGLE ||
    (precision == PRECISION_AUTOMATIC && rounding <= NoticeableRounding);
  if (rounding > NoticeableRounding)
  {
    warn(single
        ? ": single precision" + Moves(rounding) + ": set Precision to Double."
        : ": x, y and z are in double precision, because single precision" + Moves(rounding) + ".");
  }
  formats::TableOutput output;
  std::vector<Field>& all = output.fields;
  for (int axis = 0; axis < 3; ++axis)
  {
    all.push_back(CoordinateField(input, axis, single));
  }
  if (vtkDataArray* intensity = Find(input, names::Intensity.name))
  {
    all.push_back(ToField(intensity));
    all.back().type = Scalar::Float32;
  }
  std::vector<std::string> left;
  const vtkDataArray* colours = FindColours(input);
  for (vtkDataArray* array : NumericArrays(input))
  {
    const std::string name = array->GetName();
    if (name == names::Intensity.name)
    {
      continue;
    }
    // The limit is checked before the fields are made, because an array may have any width.
    failIf(all.size() + array->GetNumberOfComponents() > formats::MostFields,
      "the file would have more than ", formats::MostFields, " fields: take away point arrays");
    std::vector<Field> fields = array == colours ? toColours(array) : ToFields(array);
    for (Field& field : fields)
    {
      std::replace_if(
        field.name.begin(), field.name.end(), [](unsigned char c) { return c <= ' '; }, '_');
      // PCD and PLY do not have 64-bit integers.
      const bool isLong = field.type == Scalar::Int64 || field.type == Scalar::UInt64;
      field.type = isLong ? Scalar::Float64 : field.type;
    }
    Append(name, fields, all, left);
  }
  WarnOfTaken(left, warn);
  std::vector<std::string> cut; // not used, because a comment may have any length
  CloudNotes notes = ToNotes(input);
  for (std::size_t i = 3; i < all.size(); ++i)
  {
    if (!all[i].unit.empty())
    {
      notes.units[all[i].name] = all[i].unit;
    }
  }
  output.comment = formats::toText(notes, std::numeric_limits<std::size_t>::max(), cut);
  return output;
}

//------------------------------------------------------------------------------
double ValueOf(vtkDataArray* array, std::int64_t i, double otherwise)
{
  const double value = array ? array->GetComponent(i, 0) : otherwise;
  if (!std::isfinite(value))
  {
    fail("the point array '", array->GetName(), "' is not finite, at point ", i);
  }
  return value;
}

//------------------------------------------------------------------------------
int IntegerOf(vtkDataArray* array, std::int64_t i, int otherwise)
{
  const double value = array ? array->GetComponent(i, 0) : otherwise;
  if (!names::IsInt(value))
  {
    fail("the point array '", array->GetName(), "' is not a whole number of 32 bits, at point ", i);
  }
  return static_cast<int>(value);
}

//------------------------------------------------------------------------------
vtkDataArray* FindColours(vtkPointSet* input)
{
  vtkDataArray* array = input->GetPointData()->GetArray(names::Rgb.name);
  vtkAvianLidarWithin(
    "the ", [&] { names::RequireNumeric(input->GetPointData(), names::Rgb, "point array"); });
  if (!array || array->GetNumberOfComponents() == 1)
  {
    return nullptr;
  }
  RequireShape(array, 3, input);
  failIf(array->GetDataType() != VTK_UNSIGNED_CHAR, "the point array '", names::Rgb.name,
    "' has values of type ", array->GetDataTypeAsString(), ", expected unsigned char");
  return array;
}

//------------------------------------------------------------------------------
CloudNotes ToNotes(vtkPointSet* input)
{
  CloudNotes notes;
  vtkPointData* points = input->GetPointData();
  for (int i = 0; i < points->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = points->GetAbstractArray(i);
    const std::string unit = UnitOf(array);
    if (array->GetName() && !unit.empty())
    {
      notes.units[array->GetName()] = unit;
    }
  }
  vtkFieldData* fields = input->GetFieldData();
  for (int i = 0; i < fields->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = fields->GetAbstractArray(i);
    formats::Note note{ array->GetName() ? array->GetName() : "", UnitOf(array), {}, {} };
    auto* numbers = vtkDataArray::SafeDownCast(array);
    // Long numbers become text, which keeps all digits.
    const bool asText = !numbers || IsTooLongForDouble(numbers);
    for (vtkIdType j = 0; j < array->GetNumberOfValues(); ++j)
    {
      if (asText)
      {
        note.texts.push_back(array->GetVariantValue(j).ToString());
      }
      else
      {
        const int width = numbers->GetNumberOfComponents();
        note.numbers.push_back(numbers->GetComponent(j / width, static_cast<int>(j % width)));
      }
    }
    if (!note.name.empty() && note.numbers.empty() != note.texts.empty())
    {
      notes.notes.push_back(std::move(note));
    }
  }
  return notes;
}

//------------------------------------------------------------------------------
std::optional<Point> FindOrigin(vtkPointSet* input)
{
  const std::optional<Point> origin = FindTriple(input, names::GeodeticOrigin);
  const std::string bad = origin
    ? avianlidar::GeodeticFrame::checkOrigin((*origin)[0], (*origin)[1], (*origin)[2])
    : std::string();
  failIf(!bad.empty(), "the field data '", names::GeodeticOrigin.name, "': ", bad);
  return origin;
}

//------------------------------------------------------------------------------
vtkStringArray* FindTexts(vtkPointSet* input, const char* name)
{
  vtkAvianLidarWithin("the ", [&] { names::RequireText(input->GetFieldData(), { name, "" }); });
  return names::FindTexts(input->GetFieldData(), { name, "" });
}

//------------------------------------------------------------------------------
std::string FindText(vtkPointSet* input, const char* name)
{
  FindTexts(input, name); // checks the type
  return names::TextAt(input->GetFieldData(), { name, "" }, 0);
}

//------------------------------------------------------------------------------
std::function<formats::SemanticLabel(int)> LabelsOf(vtkPointSet* input)
{
  std::vector<formats::SemanticLabel> labels;
  auto* classes = FindTexts(input, names::ObjectClasses.name);
  for (vtkIdType i = 0; classes && i < classes->GetNumberOfValues(); ++i)
  {
    labels.push_back(formats::labelOfClass(classes->GetValue(i)));
  }
  return [labels](int object)
  {
    const bool isKnown = object >= 0 && object < static_cast<int>(labels.size());
    return isKnown ? labels[object] : formats::labelWithoutObject(object);
  };
}

//------------------------------------------------------------------------------
SensorPose::SensorPose(const Point& position, const Point& orientation)
  : Position(position)
{
  // The axes are the beams forward (azimuth 0), right (azimuth 90) and up (elevation 90 deg).
  avianlidar::ScanPattern pattern;
  pattern.yaw = orientation[0];
  pattern.pitch = orientation[1];
  pattern.roll = orientation[2];
  pattern.elevations = { 0.0, 90.0 };
  pattern.azimuthStep = 90.0;
  const avianlidar::ScanGenerator beams(pattern);
  this->Axes = { beams.beam(2).direction, beams.beam(0).direction, beams.beam(1).direction };
}

//------------------------------------------------------------------------------
Point SensorPose::toSensor(const Point& point) const
{
  const Point& p = this->Position;
  const avianlidar::Vec3 d(point[0] - p[0], point[1] - p[1], point[2] - p[2]);
  return { dot(this->Axes[0], d), dot(this->Axes[1], d), dot(this->Axes[2], d) };
}

//------------------------------------------------------------------------------
std::array<double, 7> SensorPose::viewpoint() const
{
  // The columns of the rotation matrix R are the axes. Shepperd (1978) takes the largest of the
  // four squares, so that the square root is far from zero.
  const auto r = [this](int row, int column) { return this->Axes[column][row]; };
  std::array<double, 4> squares{ 1.0 + r(0, 0) + r(1, 1) + r(2, 2),
    1.0 + r(0, 0) - r(1, 1) - r(2, 2), 1.0 - r(0, 0) + r(1, 1) - r(2, 2),
    1.0 - r(0, 0) - r(1, 1) + r(2, 2) };
  const auto largest =
    static_cast<int>(std::max_element(squares.begin(), squares.end()) - squares.begin());
  const double sums[4][4] = {
    { squares[0], r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1) },
    { r(2, 1) - r(1, 2), squares[1], r(0, 1) + r(1, 0), r(0, 2) + r(2, 0) },
    { r(0, 2) - r(2, 0), r(0, 1) + r(1, 0), squares[2], r(1, 2) + r(2, 1) },
    { r(1, 0) - r(0, 1), r(0, 2) + r(2, 0), r(1, 2) + r(2, 1), squares[3] },
  };
  const double scale = 0.5 / std::sqrt(squares[largest]);
  const double sign = sums[largest][0] < 0.0 ? -scale : scale;
  // Adding 0 turns -0 into 0.
  return { this->Position[0], this->Position[1], this->Position[2], sign * sums[largest][0] + 0.0,
    sign * sums[largest][1] + 0.0, sign * sums[largest][2] + 0.0, sign * sums[largest][3] + 0.0 };
}

//------------------------------------------------------------------------------
std::optional<SensorPose> FindPose(vtkPointSet* input)
{
  const std::optional<Point> position = FindTriple(input, names::Position);
  const std::optional<Point> orientation = FindTriple(input, names::Orientation);
  return position
    ? std::optional<SensorPose>(SensorPose(*position, orientation.value_or(Point{ 0.0, 0.0, 0.0 })))
    : std::nullopt;
}

//------------------------------------------------------------------------------
Point Carry(const avianlidar::GeodeticFrame& geodesy, avianlidar::Frame from, avianlidar::Frame to,
  const Point& point, std::int64_t i)
{
  using avianlidar::GeodeticFrame;
  std::string wrong = GeodeticFrame::checkPoint(from, point);
  const Point carried = wrong.empty() && from != to ? geodesy.convert(from, to, point) : point;
  wrong = wrong.empty() ? GeodeticFrame::checkPoint(to, carried) : wrong;
  failIf(!wrong.empty(), "point ", i, ": ", wrong);
  return carried;
}

//------------------------------------------------------------------------------
void SetTimes(const std::vector<double>& times, vtkInformation* output)
{
  output->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  output->Remove(Pipeline::TIME_STEPS());
  output->Remove(Pipeline::TIME_RANGE());
  if (!times.empty())
  {
    const double range[] = { times.front(), times.back() };
    output->Set(Pipeline::TIME_STEPS(), times.data(), static_cast<int>(times.size()));
    output->Set(Pipeline::TIME_RANGE(), range, 2);
  }
}

//------------------------------------------------------------------------------
std::size_t StepOf(const std::vector<double>& times, vtkInformation* output)
{
  if (times.empty() || !output->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    return 0;
  }
  const auto after =
    std::upper_bound(times.begin(), times.end(), output->Get(Pipeline::UPDATE_TIME_STEP()));
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - times.begin() - 1, 0));
}

//------------------------------------------------------------------------------
bool IsOtherPiece(vtkInformation* output)
{
  return output->Has(Pipeline::UPDATE_PIECE_NUMBER()) &&
    output->Get(Pipeline::UPDATE_PIECE_NUMBER()) > 0;
}

//------------------------------------------------------------------------------
void ToPolyData(Cloud& cloud, vtkPolyData* output)
{
  auto points = vtkAvianLidarArrays::MakePoints(static_cast<vtkIdType>(cloud.size()));
  std::copy(cloud.points.begin(), cloud.points.end(),
    vtkDoubleArray::SafeDownCast(points->GetData())->GetPointer(0));
  cloud.points = {};
  output->SetPoints(points);
  output->SetVerts(vtkAvianLidarMakeCells(output->GetNumberOfPoints(), 1));
  for (formats::Column& column : cloud.columns)
  {
    output->GetPointData()->AddArray(ToArray(column));
    column.values = {};
  }
  for (const formats::Note& note : cloud.notes)
  {
    AddNote(note, output->GetFieldData());
  }
}
}
