// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarLASWriter.h"

#include "GeodeticFrame.h"
#include "Private/CoordinateSystem.h"
#include "Private/LasFormat.h"
#include "Private/SemanticLabels.h"
#include "Private/vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarText.h"
#include "vtkAvianLidarVersion.h"

#include "vtkObjectFactory.h"
#include "vtkPointSet.h"

#include <algorithm>
#include <cctype>
#include <set>

namespace fields = vtkAvianLidarCloudFields;
namespace formats = avianlidar::formats;
namespace names = vtkAvianLidarArrays;
using avianlidar::Frame;
using avianlidar::GeodeticFrame;
using formats::FormatError;
using formats::Point;

namespace
{
constexpr const char* CrsName = names::CrsWkt.name;

/// The core of a point, from the arrays that there are.
class PointMaker
{
public:
  explicit PointMaker(vtkPointSet* input)
    : Input(input)
    , Intensity(fields::Find(input, names::Intensity.name))
    , ReturnNumber(fields::Find(input, names::ReturnNumber.name))
    , Returns(fields::Find(input, names::NumberOfReturns.name))
    , Timestamp(fields::Find(input, names::Timestamp.name))
    , Elevation(fields::Find(input, names::VerticalAngle.name))
    , Object(fields::Find(input, names::ObjectId.name))
    , Colours(fields::FindColours(input))
  {
    auto* classes = fields::FindTexts(input, names::ObjectClasses.name);
    for (vtkIdType i = 0; classes && i < classes->GetNumberOfValues(); ++i)
    {
      this->Classes.push_back(formats::labelOfClass(classes->GetValue(i)).las);
    }
  }

  bool HasColours() const { return this->Colours != nullptr; }

  formats::LasPoint Make(std::int64_t i) const
  {
    formats::LasPoint point;
    this->Input->GetPoint(i, point.position.data());
    point.intensity = fields::ValueOf(this->Intensity, i, 0.0);
    point.returnNumber = fields::IntegerOf(this->ReturnNumber, i, 1);
    point.numberOfReturns = fields::IntegerOf(this->Returns, i, 1);
    point.gpsTime = 1e-6 * fields::ValueOf(this->Timestamp, i, 0.0);
    point.scanAngle = this->Elevation ? 90.0 + fields::ValueOf(this->Elevation, i, 0.0) : 0.0;
    const int object = fields::IntegerOf(this->Object, i, -1);
    point.classification =
      object >= 0 && object < static_cast<int>(this->Classes.size()) ? this->Classes[object] : 1;
    for (int c = 0; this->Colours && c < 3; ++c)
    {
      point.rgb[c] = this->Colours->GetComponent(i, c);
    }
    return point;
  }

private:
  vtkPointSet* Input;
  vtkDataArray *Intensity, *ReturnNumber, *Returns, *Timestamp, *Elevation, *Object, *Colours;
  std::vector<int> Classes;
};

/// It begins as WKT does: a keyword and a bracket. What stands in it is the business of others.
bool IsWkt(const std::string& text)
{
  const std::size_t bracket = text.find_first_of("[(");
  return bracket != std::string::npos && bracket > 0 &&
    std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(bracket),
      [](unsigned char c) { return std::isalnum(c) || c == '_' || std::isspace(c); });
}

std::vector<formats::Field> ExtraFields(vtkPointSet* input, bool all)
{
  std::vector<formats::Field> extra;
  std::set<std::string> taken;
  for (const names::Name& name : { names::Energy, names::EnergyReceived, names::ReturnEnergy,
         names::EnergyStdError, names::ObjectId, names::MaterialId, names::SecondaryShare,
         names::IncidenceAngle, names::Distance, names::LaserId })
  {
    if (vtkDataArray* array = fields::Find(input, name.name))
    {
      extra.push_back(fields::ToField(array));
      taken.insert(name.name);
    }
  }
  if (all)
  {
    for (const formats::Field& field : fields::AllFields(input))
    {
      if (taken.count(field.name) == 0)
      {
        extra.push_back(field);
      }
    }
  }
  return extra;
}
}

//------------------------------------------------------------------------------
// One writing: where the points go, and what is said about them.
class vtkAvianLidarLASWriter::vtkWork
{
public:
  vtkWork(vtkAvianLidarLASWriter* self, vtkPointSet* input)
    : Self(self)
    , Input(input)
    , Points(input)
  {
    this->Output.size = input->GetNumberOfPoints();
    this->Output.colours = this->Points.HasColours();
    this->Output.simulated = input->GetFieldData()->HasArray("avian_lidar_version") != 0;
    this->Output.sourceId = self->SourceId;
    this->Output.software = std::string("avian-lidar ") + vtkAvianLidarVersion();
    this->Output.extra = ExtraFields(input, self->WriteAllArrays);
    this->Place();
    this->Output.point = [this](std::int64_t i)
    {
      formats::LasPoint point = this->Points.Make(i);
      point.position = this->Carry(point.position, i);
      return point;
    };
  }

  double Write()
  {
    const formats::KeepGoing keepGoing = [this](double p) { return this->Self->KeepGoing(p); };
    formats::OutputFile file(this->Self->FileName);
    const formats::LasMeasure measure = formats::measureLas(this->Output, keepGoing);
    const double bound =
      std::max({ measure.axes[0].bound(), measure.axes[1].bound(), measure.axes[2].bound() });
    this->Describe(bound);
    formats::writeLas(file, this->Output, measure, keepGoing);
    file.commit();
    return bound;
  }

private:
  // Where the points are to go: sets Target, and the output's system.
  void Place()
  {
    const std::optional<Point> origin = fields::FindOrigin(this->Input);
    const bool local = this->Self->CoordinateSystem == COORDINATE_SYSTEM_LOCAL;
    this->Output.crs = fields::FindText(this->Input, CrsName);
    if (!this->Output.crs.empty() && !IsWkt(this->Output.crs))
    {
      throw FormatError(std::string("the field data '") + CrsName +
        "' is no WKT, expected a word and a bracket at its beginning, as 'PROJCS['");
    }
    if (local || !this->Output.crs.empty())
    {
      return;
    }
    if (!origin)
    {
      vtkWarningWithObjectMacro(this->Self,
        "" << vtkAvianLidarText(this->Self->FileName)
           << " gets no coordinate reference system: the input has no field "
           << "data '" << names::GeodeticOrigin.name << "' (nor '" << CrsName
           << "'). Its coordinates are those of the points; CoordinateSystem Local says that this "
              "is meant.");
      return;
    }
    this->Geodesy.setOrigin((*origin)[0], (*origin)[1], (*origin)[2]);
    if (this->Self->CoordinateSystem == COORDINATE_SYSTEM_GEOCENTRIC)
    {
      this->Target = Frame::ECEF;
      this->Output.crs = formats::geocentricWkt();
      return;
    }
    const int zone = this->Self->UTMZone != 0 ? this->Self->UTMZone
                                              : GeodeticFrame::zoneOf((*origin)[0], (*origin)[1]);
    this->Geodesy.setZone(zone);
    this->Target = Frame::UTM;
    this->Output.crs = formats::utmWkt(zone);
  }

  Point Carry(const Point& point, std::int64_t i) const
  {
    if (this->Target == Frame::ENU)
    {
      return point;
    }
    std::string wrong = GeodeticFrame::checkPoint(Frame::ENU, point);
    const Point carried =
      wrong.empty() ? this->Geodesy.convert(Frame::ENU, this->Target, point) : point;
    wrong = wrong.empty() ? GeodeticFrame::checkPoint(this->Target, carried) : wrong;
    if (!wrong.empty())
    {
      throw FormatError("point " + std::to_string(i) + ": " + wrong);
    }
    return carried;
  }

  void Describe(double bound)
  {
    formats::CloudNotes notes = fields::ToNotes(this->Input);
    notes.notes.push_back({ "las_rounding_bound", "m", { bound }, {} });
    std::vector<std::string> left;
    this->Output.description = formats::toText(notes, formats::LasLongestVlr, left);
    if (!left.empty())
    {
      std::string list;
      for (const std::string& name : left)
      {
        list += (list.empty() ? "'" : ", '") + name + "'";
      }
      vtkWarningWithObjectMacro(this->Self,
        "" << vtkAvianLidarText(this->Self->FileName + (" is without the field data " + list))
           << ": they do not fit into the 65535 bytes of a text area.");
    }
  }

  vtkAvianLidarLASWriter* Self;
  vtkPointSet* Input;
  PointMaker Points;
  GeodeticFrame Geodesy;
  Frame Target = Frame::ENU;
  formats::LasOutput Output;
};

vtkStandardNewMacro(vtkAvianLidarLASWriter);

//------------------------------------------------------------------------------
vtkAvianLidarLASWriter::vtkAvianLidarLASWriter()
  : CoordinateSystem(COORDINATE_SYSTEM_UTM)
  , UTMZone(0)
  , SourceId(0)
  , WriteAllArrays(false)
  , RoundingBound(0.0)
{
}

//------------------------------------------------------------------------------
vtkAvianLidarLASWriter::~vtkAvianLidarLASWriter() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarLASWriter::WriteCloud(vtkPointSet* input)
{
  this->RoundingBound = 0.0;
  vtkWork work(this, input);
  this->RoundingBound = work.Write();
}

//------------------------------------------------------------------------------
void vtkAvianLidarLASWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "CoordinateSystem: " << this->CoordinateSystem << "\n";
  os << indent << "UTMZone: " << this->UTMZone << "\n";
  os << indent << "SourceId: " << this->SourceId << "\n";
  os << indent << "WriteAllArrays: " << this->WriteAllArrays << "\n";
  os << indent << "RoundingBound: " << this->RoundingBound << "\n";
}
