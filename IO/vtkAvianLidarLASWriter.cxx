// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarLASWriter.h"

#include "GeodeticFrame.h"
#include "Private/CoordinateSystem.h"
#include "Private/LasFormat.h"
#include "Private/ReadCloud.h"
#include "Private/SemanticLabels.h"
#include "Private/vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarText.h"

#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
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
constexpr int SyntheticFlag = 1;

/// An array that LAS has a field of its own for, and the numbers that this holds.
struct CoreField
{
  const char* name;
  double low;
  double high;
  bool whole;
};

constexpr double AnyNumber = std::numeric_limits<double>::max();
constexpr CoreField CoreFields[] = {
  { names::Intensity.name, 0.0, 255.0, false },
  { names::ReturnNumber.name, 0.0, formats::LasMostReturns, true },
  { names::NumberOfReturns.name, 0.0, formats::LasMostReturns, true },
  { names::Timestamp.name, -AnyNumber, AnyNumber, false },
  { formats::LasClassification, 0.0, 255.0, true },
  { formats::LasFlags, 0.0, 15.0, true },
  { formats::LasUserData, 0.0, 255.0, true },
  { formats::LasScanAngle, -180.0, 180.0, false },
  { formats::LasPointSource, 0.0, 65535.0, true },
};

const CoreField* FindCoreField(const std::string& name)
{
  const auto* found = std::find_if(std::begin(CoreFields), std::end(CoreFields),
    [&](const CoreField& core) { return core.name == name; });
  return found == std::end(CoreFields) ? nullptr : found;
}

bool Holds(const CoreField& core, vtkDataArray* array)
{
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    const double value = array->GetComponent(i, 0);
    if (!(core.low <= value && value <= core.high) || (core.whole && value != std::floor(value)))
    {
      return false;
    }
  }
  return true;
}

/// The core of a point, from the arrays that there are.
class PointMaker
{
public:
  PointMaker(vtkPointSet* input, int flags, int sourceId)
    : Input(input)
    , Intensity(fields::Find(input, names::Intensity.name))
    , ReturnNumber(fields::Find(input, names::ReturnNumber.name))
    , Returns(fields::Find(input, names::NumberOfReturns.name))
    , Timestamp(fields::Find(input, names::Timestamp.name))
    , Elevation(fields::Find(input, names::VerticalAngle.name))
    , Object(fields::Find(input, names::ObjectId.name))
    , Colours(fields::FindColours(input))
    , Classification(FindHeld(input, formats::LasClassification))
    , Flags(FindHeld(input, formats::LasFlags))
    , UserData(FindHeld(input, formats::LasUserData))
    , ScanAngle(FindHeld(input, formats::LasScanAngle))
    , PointSource(FindHeld(input, formats::LasPointSource))
    , CommonFlags(flags)
    , SourceId(sourceId)
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
    const double angle = this->Elevation ? 90.0 + fields::ValueOf(this->Elevation, i, 0.0) : 0.0;
    point.scanAngle = fields::ValueOf(this->ScanAngle, i, angle);
    const int object = fields::IntegerOf(this->Object, i, -1);
    const bool known = object >= 0 && object < static_cast<int>(this->Classes.size());
    point.classification = fields::IntegerOf(this->Classification, i,
      known ? this->Classes[object] : formats::labelWithoutObject(object).las);
    point.flags = fields::IntegerOf(this->Flags, i, this->CommonFlags);
    point.userData = fields::IntegerOf(this->UserData, i, 0);
    point.sourceId = fields::IntegerOf(this->PointSource, i, this->SourceId);
    for (int c = 0; this->Colours && c < 3; ++c)
    {
      point.rgb[c] = this->Colours->GetComponent(i, c);
    }
    return point;
  }

private:
  /// The array if LAS's own field holds it as it is.
  static vtkDataArray* FindHeld(vtkPointSet* input, const char* name)
  {
    vtkDataArray* array = input->GetPointData()->GetArray(name);
    if (!array || array->GetNumberOfComponents() != 1)
    {
      return nullptr;
    }
    fields::RequireShape(array, 1, input);
    return Holds(*FindCoreField(name), array) ? array : nullptr;
  }

  vtkPointSet* Input;
  vtkDataArray *Intensity, *ReturnNumber, *Returns, *Timestamp, *Elevation, *Object, *Colours;
  vtkDataArray *Classification, *Flags, *UserData, *ScanAngle, *PointSource;
  int CommonFlags, SourceId;
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

/// The arrays that go to the extra bytes, and what is to be said about those that do not.
class ExtraBytes
{
public:
  ExtraBytes(vtkPointSet* input, bool all)
    : Input(input)
  {
    for (const names::Name& name : { names::Energy, names::EnergyReceived, names::ReturnEnergy,
           names::EnergyStdError, names::ObjectId, names::MaterialId, names::SecondaryShare,
           names::IncidenceAngle, names::Distance, names::LaserId })
    {
      if (vtkDataArray* array = fields::Find(input, name.name))
      {
        this->Listed.insert(name.name);
        this->Add(array);
      }
    }
    for (int i = 0; all && i < input->GetPointData()->GetNumberOfArrays(); ++i)
    {
      this->Consider(input->GetPointData()->GetAbstractArray(i), i);
    }
  }

  std::vector<formats::Field> Fields;
  /// Names with reasons, separated by commas: arrays that are not in the file, and those that come
  /// out of it otherwise than as they were.
  std::string Left, Changed;

private:
  static void Note(std::string& list, const std::string& name, const std::string& reason)
  {
    list += (list.empty() ? "'" : ", '") + name + "' (" + reason + ")";
  }

  void Consider(vtkAbstractArray* array, int index)
  {
    const std::string name = array->GetName() ? array->GetName() : "";
    auto* numbers = vtkDataArray::SafeDownCast(array);
    if (this->Listed.count(name) != 0)
    {
      return;
    }
    if (name.empty())
    {
      Note(this->Left, "point array " + std::to_string(index), "it has no name");
      return;
    }
    if (!numbers)
    {
      Note(this->Left, name, "no numbers");
      return;
    }
    const bool single = numbers->GetNumberOfComponents() == 1;
    if (name == names::Rgb.name && !single)
    {
      return; // colours
    }
    fields::RequireShape(numbers, numbers->GetNumberOfComponents(), this->Input);
    const CoreField* core = FindCoreField(name);
    if (core && single && Holds(*core, numbers))
    {
      return;
    }
    if (core)
    {
      Note(this->Changed, name, "no numbers of LAS's own field: whole in the extra bytes");
    }
    this->Add(numbers);
  }

  /// One field for each component.
  void Add(vtkDataArray* array)
  {
    const std::string name = array->GetName();
    const int components = array->GetNumberOfComponents();
    if (fields::IsTooLongForDouble(array))
    {
      Note(this->Left, name, "whole numbers beyond 2^53");
      return;
    }
    if (this->Fields.size() + components > formats::LasMostExtraFields)
    {
      Note(this->Left, name, "no room");
      return;
    }
    const auto cut = [&](int c) {
      return formats::cutName(
        name, components > 1 ? " [" + std::to_string(c) + "]" : std::string());
    };
    if (!this->Names.insert(cut(0)).second)
    {
      Note(this->Left, name, "another's name begins with the same 31 bytes");
      return;
    }
    if (cut(0).compare(0, name.size(), name) != 0)
    {
      Note(this->Changed, name, "its name is cut to 31 bytes");
    }
    for (int c = 0; c < components; ++c)
    {
      this->Fields.push_back(fields::ToField(array, c));
      this->Fields.back().name = cut(c);
    }
  }

  vtkPointSet* Input;
  std::set<std::string> Listed; ///< those that are always written, if they are there
  std::set<std::string> Names;
};
}

//------------------------------------------------------------------------------
// One writing: where the points go, and what is said about them.
class vtkAvianLidarLASWriter::vtkWork
{
public:
  vtkWork(vtkAvianLidarLASWriter* self, vtkPointSet* input)
    : Self(self)
    , Input(input)
    , Points(input, IsSimulated(input) ? SyntheticFlag : 0, self->SourceId)
  {
    this->Output.size = input->GetNumberOfPoints();
    this->Output.compressed = formats::endingOf(self->FileName) == ".laz";
    this->Output.colours = this->Points.HasColours();
    this->Output.simulated = IsSimulated(input);
    this->Output.sourceId = self->SourceId;
    this->Output.software = "avian-lidar " AVIANLIDAR_VERSION;
    this->TakeExtraBytes();
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
    const auto keepGoing = vtkAvianLidarAbort::KeepGoing(this->Self);
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
  static bool IsSimulated(vtkPointSet* input)
  {
    return input->GetFieldData()->HasArray("avian_lidar_version") != 0;
  }

  void TakeExtraBytes()
  {
    const ExtraBytes extra(this->Input, this->Self->WriteAllArrays);
    this->Output.extra = extra.Fields;
    const std::string file = this->Self->FileName;
    if (!extra.Left.empty())
    {
      vtkWarningWithObjectMacro(this->Self,
        "" << vtkAvianLidarText(file + " is without the point arrays " + extra.Left)
           << ": LAS has no place for these.");
    }
    if (!extra.Changed.empty())
    {
      vtkWarningWithObjectMacro(this->Self,
        "" << vtkAvianLidarText(
                file + " has other values or names of the point arrays " + extra.Changed)
           << ".");
    }
  }

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
vtkAvianLidarLASWriter::vtkAvianLidarLASWriter() = default;

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
