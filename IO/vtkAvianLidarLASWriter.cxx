// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarLASWriter.h"

#include "CoordinateSystem.h"
#include "GeodeticFrame.h"
#include "LasFormat.h"
#include "ReadCloud.h"
#include "Sensor.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRequire.h"

#include "vtkCellData.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>

namespace fields = vtkAvianLidarCloudFields;
namespace formats = avianlidar::formats;
namespace names = vtkAvianLidarArrays;
using avianlidar::failIf;
using avianlidar::Frame;
using avianlidar::GeodeticFrame;
using formats::Point;

namespace
{
constexpr const char* CrsName = names::CrsWkt.name;
constexpr int SyntheticFlag = 1;

const formats::LasCoreField* FindCoreField(const std::string& name)
{
  const auto* found = std::find_if(std::begin(formats::LasCore), std::end(formats::LasCore),
    [&](const formats::LasCoreField& core) { return core.name == name; });
  return found == std::end(formats::LasCore) ? nullptr : found;
}

bool Holds(const formats::LasCoreField& core, vtkDataArray* array)
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

/// Returns the array for a field of LAS, or null. An array of another sensor is returned only if
/// the field can hold all values.
vtkDataArray* FindCore(vtkPointSet* input, const formats::LasCoreField& core)
{
  if (core.ours)
  {
    return fields::Find(input, core.name);
  }
  vtkDataArray* array = input->GetPointData()->GetArray(core.name);
  if (!array || array->GetNumberOfComponents() != 1)
  {
    return nullptr;
  }
  fields::RequireShape(array, 1, input);
  return Holds(core, array) ? array : nullptr;
}

/// Sets the functions that give the fields of LAS, from the arrays of the input.
void TakeCore(vtkPointSet* input, formats::LasOutput& output)
{
  using Value = std::function<double(std::int64_t)>;
  const auto valueOf = [](vtkDataArray* array, double otherwise) -> Value
  { return [=](std::int64_t i) { return fields::ValueOf(array, i, otherwise); }; };
  const auto integerOf = [](vtkDataArray* array, int otherwise) -> Value
  { return [=](std::int64_t i) { return fields::IntegerOf(array, i, otherwise); }; };
  std::array<Value, formats::LasCoreSize> otherwise;
  otherwise.fill(valueOf(nullptr, 0.0));
  otherwise[formats::LasReturnNumberIndex] = otherwise[formats::LasReturnsIndex] =
    valueOf(nullptr, 1.0);
  otherwise[formats::LasFlagsIndex] = valueOf(nullptr, output.simulated ? SyntheticFlag : 0);
  otherwise[formats::LasPointSourceIndex] = valueOf(nullptr, output.sourceId);
  if (vtkDataArray* elevation = fields::Find(input, names::VerticalAngle.name))
  {
    otherwise[formats::LasScanAngleIndex] = [elevation](std::int64_t i)
    { return 90.0 + fields::ValueOf(elevation, i, 0.0); };
  }
  const auto labelOf = fields::LabelsOf(input);
  vtkDataArray* objects = fields::Find(input, names::ObjectId.name);
  otherwise[formats::LasClassIndex] = [objects, labelOf](std::int64_t i)
  { return labelOf(fields::IntegerOf(objects, i, -1)).las; };
  for (int k = 0; k < formats::LasCoreSize; ++k)
  {
    const formats::LasCoreField& core = formats::LasCore[k];
    vtkDataArray* array = FindCore(input, core);
    output.core[k] = !array ? otherwise[k] : core.whole ? integerOf(array, 0) : valueOf(array, 0.0);
  }
  output.core[formats::LasTimeIndex] = [time = output.core[formats::LasTimeIndex]](std::int64_t i)
  { return 1e-6 * time(i); };
  if (vtkDataArray* colours = fields::FindColours(input))
  {
    output.colour = [colours](std::int64_t i, int c) { return colours->GetComponent(i, c); };
  }
}

/// Returns whether a text begins as WKT does, with a keyword and a bracket. The rest is not
/// checked.
bool IsWkt(const std::string& text)
{
  const std::size_t bracket = text.find_first_of("[(");
  return bracket != std::string::npos && bracket > 0 &&
    std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(bracket),
      [](unsigned char c) { return std::isalnum(c) || c == '_' || std::isspace(c); });
}

/// Fields of the extra bytes, and texts on the arrays that are left out or changed.
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
  /// Names with reasons, separated by commas: arrays that are left out of the file, and arrays
  /// whose names or values are changed in the file.
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
      return; // colours are fields of LAS
    }
    fields::RequireShape(numbers, numbers->GetNumberOfComponents(), this->Input);
    const formats::LasCoreField* core = FindCoreField(name);
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

  /// Adds one field for each component.
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
  std::set<std::string> Listed; ///< names of the arrays that are written without WriteAllArrays
  std::set<std::string> Names;
};

/// Returns the levels of the digitiser, with 0 bits unless the field data have all of its values.
formats::LasDescriptor LevelsOf(vtkFieldData* data)
{
  using avianlidar::Sensor;
  Sensor sensor;
  sensor.digitiserBits = 0.0;
  for (double Sensor::*member : { &Sensor::upperEnergyLimit, &Sensor::samplingInterval,
         &Sensor::digitiserRate, &Sensor::digitiserBits })
  {
    const avianlidar::SensorField& field = avianlidar::sensorField(member);
    const bool isThere = names::GetFieldValue(data, { field.name, field.unit }, sensor.*member);
    if (!isThere && member != &Sensor::digitiserRate)
    {
      return {};
    }
  }
  formats::LasDescriptor levels;
  if (sensor.upperEnergyLimit > 0.0 && sensor.digitiserBits >= 4.0 && sensor.digitiserBits <= 32.0)
  {
    const avianlidar::DigitiserLevels own = sensor.levelsOfDigitiser(sensor.upperEnergyLimit);
    levels.bits = static_cast<int>(sensor.digitiserBits);
    levels.gain = own.step;
    levels.offset = -own.below * own.step;
  }
  return levels;
}

/// Line of input port 1.
struct Stretch
{
  vtkIdType begin = 0; ///< first sample
  vtkIdType size = 0;
  double first = 0.0; ///< time of the first sample, s
  double half = 0.0;  ///< half of the time between two samples, s
  std::int64_t number = -1;
};

/// Lines by beam, time of the beam, us, and end, s.
using Stretches = std::map<std::array<double, 3>, Stretch>;

Stretches FindStretches(vtkPolyData* from)
{
  const auto need = [](vtkFieldData* data, const names::Name& name, vtkIdType size)
  {
    vtkDataArray* array = data->GetArray(name.name);
    failIf(!array || array->GetNumberOfComponents() != 1 || array->GetNumberOfTuples() != size,
      "input port 1 (waveforms): the array '", name.name, "' is missing, expected ", size,
      " numbers");
    return array;
  };
  const vtkIdType lines = from->GetNumberOfLines();
  vtkDataArray* times = need(from->GetPointData(), names::SampleTime, from->GetNumberOfPoints());
  vtkDataArray* beams = need(from->GetCellData(), names::BeamId, lines);
  vtkDataArray* fired = need(from->GetCellData(), names::Timestamp, lines);
  need(from->GetPointData(), names::Sample, from->GetNumberOfPoints());
  vtkAvianLidarRequire(vtkAvianLidarCellsError(from->GetLines(), from->GetNumberOfPoints()),
    "input port 1 (waveforms): ");
  Stretches all;
  double half = 0.0;
  for (vtkIdType line = 0; line < lines; ++line)
  {
    Stretch one;
    const vtkIdType* ids = nullptr;
    from->GetLines()->GetCellAtId(line, one.size, ids);
    constexpr vtkIdType most = 1 << 28; // packets below 4 GiB, also with padding
    const vtkIdType last = one.size - 1;
    failIf(one.size < 1 || one.size > most || ids[last] != ids[0] + last,
      "input port 1 (waveforms): line ", line, " does not have 1 to ", most, " consecutive points");
    one.begin = ids[0];
    one.first = fields::ValueOf(times, ids[0], 0.0);
    const double end = fields::ValueOf(times, ids[last], 0.0);
    one.half = last > 0 ? 0.5 * (end - one.first) / static_cast<double>(last) : 0.0;
    half = half > 0.0 ? half : one.half;
    failIf(last > 0 && !(half > 0.0 && half < 1e-3 && std::abs(one.half - half) < 1e-13),
      "input port 1 (waveforms): line ", line, " has samples every ", 2.0 * one.half,
      " s, expected the same positive time for all lines");
    all[{ fields::ValueOf(beams, line, 0.0), fields::ValueOf(fired, line, 0.0), end + one.half }] =
      one;
  }
  return all;
}

/// Returns the waveforms of the points. @param place function from a point of the input, with its
/// number, to the system of the file
formats::LasWaveforms WaveformsOf(vtkPointSet* input, vtkPolyData* from,
  const std::function<Point(const Point&, std::int64_t)>& place,
  const avianlidar::KeepGoing& keepGoing)
{
  Stretches all = FindStretches(from);
  vtkDataArray* beams = fields::Need(input, names::BeamId.name);
  vtkDataArray* fired = fields::Need(input, names::Timestamp.name);
  vtkDataArray* ranges = fields::Need(input, names::Distance.name);
  const auto timeOf = [ranges](std::int64_t i)
  { return 2.0 / avianlidar::SpeedOfLight * fields::ValueOf(ranges, i, 0.0); };
  formats::LasWaveforms waveforms;
  waveforms.levels = LevelsOf(from->GetFieldData());
  std::vector<Stretch> used;
  for (vtkIdType i = 0; i < input->GetNumberOfPoints(); ++i)
  {
    const double beam = fields::ValueOf(beams, i, 0.0), time = fields::ValueOf(fired, i, 0.0);
    const auto found = all.lower_bound({ beam, time, timeOf(i) });
    const bool isThere = found != all.end() && found->first[0] == beam && found->first[1] == time &&
      found->second.first - found->second.half <= timeOf(i);
    if (isThere && found->second.number < 0)
    {
      Stretch& one = found->second;
      one.number = static_cast<std::int64_t>(used.size());
      used.push_back(one);
      waveforms.stretches.emplace_back(one.begin, static_cast<std::uint32_t>(one.size));
      waveforms.levels.spacing = std::max(
        waveforms.levels.spacing, static_cast<std::uint32_t>(std::lround(2e12 * one.half)));
    }
    waveforms.ofPoint.push_back(isThere ? found->second.number : -1);
    formats::goOn(keepGoing, i, input->GetNumberOfPoints(), 0.0, 0.0);
  }
  vtkDataArray* samples = from->GetPointData()->GetArray(names::Sample.name);
  waveforms.sample = [samples](std::int64_t i) { return samples->GetComponent(i, 0); };
  waveforms.line = [=](std::int64_t i, std::int64_t stretch) -> std::array<float, 4>
  {
    constexpr double apart = 1e-8; // time between two places on the line, s
    const Stretch& one = used[stretch];
    Point at, ahead, begin, end;
    input->GetPoint(i, at.data());
    from->GetPoint(one.begin, begin.data());
    from->GetPoint(one.begin + one.size - 1, end.data());
    const double span = 2.0 * one.half * static_cast<double>(one.size - 1); // s
    for (int axis = 0; axis < 3; ++axis)
    {
      ahead[axis] = at[axis] + (span > 0.0 ? apart / span * (end[axis] - begin[axis]) : 0.0);
    }
    at = place(at, i);
    ahead = place(ahead, i);
    const auto slope = [&](int axis)
    { return static_cast<float>(1e-12 / apart * (ahead[axis] - at[axis])); };
    return { static_cast<float>(1e12 * (timeOf(i) - one.first)), slope(0), slope(1), slope(2) };
  };
  return waveforms;
}

/// Chooses the frame of the written points. Sets origin and zone of `geodesy` and the output's WKT.
Frame PlaceFile(vtkPointSet* input, int system, int zone,
  const std::function<void(std::string)>& warn, GeodeticFrame& geodesy, formats::LasOutput& output)
{
  const std::optional<Point> origin = fields::FindOrigin(input);
  output.crs = fields::FindText(input, CrsName);
  failIf(!output.crs.empty() && !IsWkt(output.crs), "the field data '", CrsName,
    "' is not WKT, expected a word and a bracket at its beginning, as 'PROJCS['");
  if (system == vtkAvianLidarLASWriter::COORDINATE_SYSTEM_LOCAL || !output.crs.empty())
  {
    return Frame::ENU;
  }
  if (!origin)
  {
    warn(std::string(" has no coordinate reference system: the input has no field data '") +
      names::GeodeticOrigin.name + "' or '" + CrsName +
      "'. The coordinates of the points are written. Set CoordinateSystem to Local to write them "
      "without this warning.");
    return Frame::ENU;
  }
  geodesy.setOrigin((*origin)[0], (*origin)[1], (*origin)[2]);
  if (system == vtkAvianLidarLASWriter::COORDINATE_SYSTEM_GEOCENTRIC)
  {
    output.crs = formats::geocentricWkt();
    return Frame::ECEF;
  }
  zone = zone != 0 ? zone : GeodeticFrame::zoneOf((*origin)[0], (*origin)[1]);
  geodesy.setZone(zone);
  output.crs = formats::utmWkt(zone);
  return Frame::UTM;
}
}

vtkStandardNewMacro(vtkAvianLidarLASWriter);

//------------------------------------------------------------------------------
vtkAvianLidarLASWriter::vtkAvianLidarLASWriter()
{
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
int vtkAvianLidarLASWriter::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkPointSet" : "vtkPolyData");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), port);
  return 1;
}

//------------------------------------------------------------------------------
void vtkAvianLidarLASWriter::WriteCloud(vtkPointSet* input)
{
  this->RoundingBound = 0.0;
  const auto warn = [this](const std::string& text) { this->Warn(text); };
  formats::LasOutput output;
  output.size = input->GetNumberOfPoints();
  output.compressed = formats::endingOf(this->FileName) == ".laz";
  output.simulated = input->GetFieldData()->HasArray(names::Version.name) != 0;
  output.sourceId = this->SourceId;
  output.software = "avian-lidar " AVIANLIDAR_VERSION;
  TakeCore(input, output);
  const ExtraBytes extra(input, this->WriteAllArrays);
  output.extra = extra.Fields;
  if (!extra.Left.empty())
  {
    warn(" is without the point arrays " + extra.Left + ": LAS has no place for these.");
  }
  if (!extra.Changed.empty())
  {
    warn(" has other values or names of the point arrays " + extra.Changed + ".");
  }
  GeodeticFrame geodesy;
  const Frame target =
    PlaceFile(input, this->CoordinateSystem, this->UTMZone, warn, geodesy, output);
  output.degrees = formats::hasDegrees(output.crs);
  const auto place = [&](const Point& point, std::int64_t i)
  { return target == Frame::ENU ? point : fields::Carry(geodesy, Frame::ENU, target, point, i); };
  output.position = [&](std::int64_t i)
  {
    Point point;
    input->GetPoint(i, point.data());
    return place(point, i);
  };
  const auto keepGoing = vtkAvianLidarAbort::KeepGoing(this);
  auto* waveforms = vtkPolyData::SafeDownCast(this->GetInputDataObject(1, 0));
  if (waveforms && waveforms->GetNumberOfLines() > 0)
  {
    failIf(output.compressed, "LAZ cannot hold waveforms (input port 1): write LAS");
    output.waveforms = WaveformsOf(input, waveforms, place, keepGoing);
    output.waveforms->legacy = this->LegacyFormat;
    const auto& of = output.waveforms->ofPoint;
    const auto missing = std::count(of.begin(), of.end(), -1);
    if (missing > 0)
    {
      warn(" has " + std::to_string(missing) + " of " + std::to_string(of.size()) +
        " points without a waveform.");
    }
  }

  avianlidar::OutputFile file(this->FileName);
  std::optional<avianlidar::OutputFile> packets;
  if (output.waveforms && this->ExternalWaveforms)
  {
    packets.emplace(std::filesystem::path(file.name()).replace_extension(".wdp").string());
    failIf(packets->isSameAs(file),
      "FileName is the name of the waveforms beside it, expected another ending, such as .las");
  }
  const formats::LasMeasure measure = formats::measureLas(output, keepGoing);
  const double bound =
    std::max({ measure.axes[0].bound(), measure.axes[1].bound(), measure.axes[2].bound() });
  formats::CloudNotes notes = fields::ToNotes(input);
  const names::Name& name = names::LasRoundingBound;
  notes.notes.push_back({ name.name, name.unit, { bound }, {} });
  std::vector<std::string> left;
  output.description = formats::toText(notes, formats::LasLongestVlr, left);
  if (!left.empty())
  {
    warn(" is without the field data " + fields::Quoted(left) +
      ": they do not fit into the 65535 bytes of a text area.");
  }
  formats::writeLas(file, packets ? &*packets : nullptr, output, measure, keepGoing);
  packets ? avianlidar::OutputFile::commitBoth(*packets, file) : file.commit();
  this->RoundingBound = bound;
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarLASWriter, CoordinateSystem, UTMZone, SourceId,
  WriteAllArrays, LegacyFormat, ExternalWaveforms, RoundingBound);
