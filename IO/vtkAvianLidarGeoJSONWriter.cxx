// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarGeoJSONWriter.h"

#include "GeodeticFrame.h"
#include "Json.h"
#include "OutputFile.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRequire.h"

#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkStringArray.h"

#include <charconv>
#include <cmath>

namespace fields = vtkAvianLidarCloudFields;
namespace formats = avianlidar::formats;
namespace names = vtkAvianLidarArrays;
using avianlidar::asciiLine;
using avianlidar::failIf;
using avianlidar::Frame;
using avianlidar::GeodeticFrame;
using formats::Point;

namespace
{
/// Places of the points, from the three geodetic arrays if the input has them, else from the
/// origin.
class Places
{
public:
  explicit Places(vtkPointSet* input)
    : Input(input)
    , Longitude(fields::Find(input, names::Longitude.name))
    , Latitude(fields::Find(input, names::Latitude.name))
    , Height(fields::Find(input, names::Height.name))
  {
    const std::optional<Point> origin = fields::FindOrigin(input);
    const bool local = fields::FindText(input, names::CrsWkt.name).empty();
    failIf(!this->FromArrays() && (!origin || !local) && input->GetNumberOfPoints() > 0,
      "the input has neither the point arrays '", names::Longitude.name, "', '",
      names::Latitude.name, "', '", names::Height.name,
      "' nor points in metres around the field data '", names::GeodeticOrigin.name,
      "': let vtkAvianLidarGeodeticTransform add the arrays");
    if (origin)
    {
      this->Geodesy.setOrigin((*origin)[0], (*origin)[1], (*origin)[2]);
    }
  }

  bool FromArrays() const { return this->Longitude && this->Latitude && this->Height; }

  Point operator()(std::int64_t i) const
  {
    if (this->FromArrays())
    {
      // Carry() only checks the place and does not change the place.
      return fields::Carry(this->Geodesy, Frame::Geodetic, Frame::Geodetic,
        { this->Longitude->GetComponent(i, 0), this->Latitude->GetComponent(i, 0),
          this->Height->GetComponent(i, 0) },
        i);
    }
    Point place;
    this->Input->GetPoint(i, place.data());
    return fields::Carry(this->Geodesy, Frame::ENU, Frame::Geodetic, place, i);
  }

private:
  vtkPointSet* Input;
  vtkDataArray *Longitude, *Latitude, *Height;
  GeodeticFrame Geodesy;
};

using nlohmann::json;

void appendFixed(std::string& text, double value, int decimals)
{
  char digits[400];
  text.append(digits,
    std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals).ptr);
}

void appendNumber(std::string& text, const formats::Field& field, double value)
{
  char digits[40];
  if (!std::isfinite(value))
  {
    text += "null";
    return;
  }
  // Integers must not have an exponent, because readers would take them for floating-point numbers.
  const auto end = formats::isFloat(field.type)
    ? std::to_chars(digits, digits + sizeof digits, value)
    : std::to_chars(digits, digits + sizeof digits, static_cast<std::int64_t>(value));
  text.append(digits, end.ptr);
}

/// Text property of a feature: the identifier is an index of texts in the field data.
struct TextField
{
  const char* property;
  vtkDataArray* ids;
  vtkStringArray* texts;
};

/// Returns the text properties for which the input has identifiers and texts.
std::vector<TextField> TextsOf(vtkPointSet* input)
{
  std::vector<TextField> all;
  const auto add = [&](const char* property, const names::Name& id, const names::Name& text)
  {
    vtkDataArray* ids = fields::Find(input, id.name);
    vtkStringArray* texts = ids ? fields::FindTexts(input, text.name) : nullptr;
    if (texts)
    {
      all.push_back({ property, ids, texts });
    }
  };
  add("object", names::ObjectId, names::ObjectNames);
  add("object_class", names::ObjectId, names::ObjectClasses);
  add("material", names::MaterialId, names::MaterialNames);
  return all;
}

std::string FeatureOf(const Point& place, const std::vector<formats::Field>& numbers,
  const std::vector<TextField>& texts, vtkIdType i)
{
  std::string text = R"({"type":"Feature","geometry":{"type":"Point","coordinates":[)";
  appendFixed(text, place[0], 9);
  text += ",";
  appendFixed(text, place[1], 9);
  text += ",";
  appendFixed(text, place[2], 4);
  text += R"(]},"properties":{)";
  const char* separator = "";
  for (const formats::Field& field : numbers)
  {
    text += separator + asciiLine(field.name) + ":";
    appendNumber(text, field, field.value(i));
    separator = ",";
  }
  for (const auto& [property, ids, values] : texts)
  {
    const int id = fields::IntegerOf(ids, i, -1);
    const bool isKnown = id >= 0 && id < values->GetNumberOfValues();
    text += separator + asciiLine(property) + ":" + asciiLine(isKnown ? values->GetValue(id) : "");
    separator = ",";
  }
  return text + "}}";
}
}

vtkStandardNewMacro(vtkAvianLidarGeoJSONWriter);

//------------------------------------------------------------------------------
void vtkAvianLidarGeoJSONWriter::WriteCloud(vtkPointSet* input)
{
  vtkDataArray* energy = fields::Need(input, names::Energy.name);
  double limit = this->MinimumEnergy;
  if (this->UseFieldDataLimit)
  {
    limit = 0.0;
    vtkAvianLidarWithin("the ",
      [&] { names::ReadFieldValue(input->GetFieldData(), names::LowerEnergyLimit, limit); });
  }
  failIf(std::isnan(limit), "MinimumEnergy is not a number, expected an energy in J");
  const Places places(input);

  const std::vector<TextField> texts = TextsOf(input);
  std::vector<formats::Field> numbers;
  std::vector<std::string> left;
  for (vtkDataArray* array : fields::NumericArrays(input))
  {
    const std::string name = array->GetName();
    const bool isPlace = places.FromArrays() &&
      (name == names::Longitude.name || name == names::Latitude.name || name == names::Height.name);
    if (!isPlace)
    {
      fields::Append(name, fields::ToFields(array), numbers, left);
    }
  }
  fields::WarnOfTaken(left, [this](const std::string& text) { this->Warn(text); });
  json units = json::object();
  for (const formats::Field& field : numbers)
  {
    if (!field.unit.empty())
    {
      units[field.name] = field.unit;
    }
  }

  const auto keepGoing = vtkAvianLidarAbort::KeepGoing(this);
  avianlidar::OutputFile file(this->FileName);
  file.write(R"({"type":"FeatureCollection",)"
             "\n"
             R"("description":"Echoes of a lidar; heights are metres above the WGS84 ellipsoid",)"
             "\n"
             R"("units":)" +
    asciiLine(units) + ",\n" + R"("features":[)");
  const char* separator = "\n";
  const vtkIdType size = input->GetNumberOfPoints();
  for (vtkIdType i = 0; i < size; ++i)
  {
    if (fields::ValueOf(energy, i, 0.0) >= limit)
    {
      file.write(separator + FeatureOf(places(i), numbers, texts, i));
      separator = ",\n";
    }
    formats::goOn(keepGoing, i, size);
  }
  file.write("\n]}\n");
  file.commit();
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarGeoJSONWriter, UseFieldDataLimit, MinimumEnergy);
