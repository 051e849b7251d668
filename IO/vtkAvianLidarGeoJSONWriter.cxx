// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarGeoJSONWriter.h"

#include "GeodeticFrame.h"
#include "Private/GeoJsonFormat.h"
#include "Private/vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"

#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"

#include <cmath>

namespace fields = vtkAvianLidarCloudFields;
namespace formats = avianlidar::formats;
namespace names = vtkAvianLidarArrays;
using avianlidar::Frame;
using avianlidar::GeodeticFrame;
using formats::FormatError;
using formats::Point;

namespace
{
/// Places of the points: from the arrays if all three are there, else from the origin.
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
    if (!this->FromArrays() && (!origin || !local) && input->GetNumberOfPoints() > 0)
    {
      throw FormatError(std::string("the input has neither the point arrays '") +
        names::Longitude.name + "', '" + names::Latitude.name + "', '" + names::Height.name +
        "' nor points in metres around the field data '" + names::GeodeticOrigin.name +
        "': let vtkAvianLidarGeodeticTransform add the arrays");
    }
    if (origin)
    {
      this->Geodesy.setOrigin((*origin)[0], (*origin)[1], (*origin)[2]);
    }
  }

  bool FromArrays() const { return this->Longitude && this->Latitude && this->Height; }

  Point operator()(std::int64_t i) const
  {
    Point place;
    std::string wrong;
    if (this->FromArrays())
    {
      place = { this->Longitude->GetComponent(i, 0), this->Latitude->GetComponent(i, 0),
        this->Height->GetComponent(i, 0) };
    }
    else
    {
      this->Input->GetPoint(i, place.data());
      wrong = GeodeticFrame::checkPoint(Frame::ENU, place);
      place = wrong.empty() ? this->Geodesy.convert(Frame::ENU, Frame::Geodetic, place) : place;
    }
    wrong = wrong.empty() ? GeodeticFrame::checkPoint(Frame::Geodetic, place) : wrong;
    if (!wrong.empty())
    {
      throw FormatError("point " + std::to_string(i) + ": " + wrong);
    }
    return place;
  }

private:
  vtkPointSet* Input;
  vtkDataArray *Longitude, *Latitude, *Height;
  GeodeticFrame Geodesy;
};

/// The text that an identifier leads to in the field data, if there are both.
void AddText(vtkPointSet* input, const char* property, const names::Name& id,
  const names::Name& texts, std::vector<formats::TextField>& to)
{
  vtkDataArray* ids = fields::Find(input, id.name);
  if (ids && fields::FindTexts(input, texts.name))
  {
    const char* name = texts.name;
    to.push_back({ property, [input, ids, name](std::int64_t i) {
                    return fields::TextAt(input, name, fields::IntegerOf(ids, i, -1));
                  } });
  }
}
}

vtkStandardNewMacro(vtkAvianLidarGeoJSONWriter);

//------------------------------------------------------------------------------
vtkAvianLidarGeoJSONWriter::vtkAvianLidarGeoJSONWriter() = default;

//------------------------------------------------------------------------------
vtkAvianLidarGeoJSONWriter::~vtkAvianLidarGeoJSONWriter() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarGeoJSONWriter::WriteCloud(vtkPointSet* input)
{
  vtkDataArray* energy = fields::Need(input, names::Energy.name);
  double limit = this->MinimumEnergy;
  if (this->UseFieldDataLimit)
  {
    limit = 0.0;
    const std::string wrong =
      names::ReadFieldValue(input->GetFieldData(), names::LowerEnergyLimit, limit);
    if (!wrong.empty())
    {
      throw FormatError("the " + wrong);
    }
  }
  else if (std::isnan(limit))
  {
    throw FormatError("MinimumEnergy is not a number, expected an energy in J");
  }
  const Places places(input);

  formats::GeoJsonOutput output;
  output.size = input->GetNumberOfPoints();
  output.wanted = [energy, limit](std::int64_t i)
  { return fields::ValueOf(energy, i, 0.0) >= limit; };
  output.place = [&places](std::int64_t i) { return places(i); };
  for (const formats::Field& field : fields::AllFields(input))
  {
    const bool isPlace = places.FromArrays() &&
      (field.name == names::Longitude.name || field.name == names::Latitude.name ||
        field.name == names::Height.name);
    if (!isPlace)
    {
      output.fields.push_back(field);
    }
  }
  AddText(input, "object", names::ObjectId, names::ObjectNames, output.texts);
  AddText(input, "object_class", names::ObjectId, names::ObjectClasses, output.texts);
  AddText(input, "material", names::MaterialId, names::MaterialNames, output.texts);
  output.description = "Echoes of a lidar; heights are metres above the WGS84 ellipsoid";

  formats::OutputFile file(this->FileName);
  formats::writeGeoJson(file, output, vtkAvianLidarAbort::KeepGoing(this));
  file.commit();
}

//------------------------------------------------------------------------------
void vtkAvianLidarGeoJSONWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "UseFieldDataLimit: " << this->UseFieldDataLimit << "\n";
  os << indent << "MinimumEnergy: " << this->MinimumEnergy << "\n";
}
