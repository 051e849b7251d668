// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarPointCloudReader.h"

#include "CoordinateSystem.h"
#include "GeodeticFrame.h"
#include "ReadCloud.h"
#include "ScanTimes.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarText.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkExecutive.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <exception>
#include <vector>

namespace fields = vtkAvianLidarCloudFields;
namespace formats = avianlidar::formats;
namespace names = vtkAvianLidarArrays;
using avianlidar::Frame;
using avianlidar::GeodeticFrame;
using formats::Cloud;
using formats::Note;

namespace
{
constexpr char NoMemory[] = "there is not enough memory for it";

std::vector<Note>::iterator FindOrigin(Cloud& cloud)
{
  return std::find_if(cloud.notes.begin(), cloud.notes.end(),
    [](const Note& note)
    { return note.name == names::GeodeticOrigin.name && note.numbers.size() == 3; });
}

/// Transforms points to metres east, north and up of the file's origin. Returns false if the file
/// has no origin or another system than UTM and geocentric WGS84.
bool MoveToOrigin(Cloud& cloud, int zone)
{
  const auto origin = FindOrigin(cloud);
  const bool geocentric = cloud.crs.find("GEOCCS") == 0 && cloud.crs.find("4978") != cloud.crs.npos;
  if (origin == cloud.notes.end() || (zone == 0 && !geocentric))
  {
    return false;
  }
  const std::vector<double>& o = origin->numbers;
  avianlidar::failIf(!GeodeticFrame::checkOrigin(o[0], o[1], o[2]).empty(),
    "the origin in the file is not a place on the Earth");
  const Frame from = geocentric ? Frame::ECEF : Frame::UTM;
  GeodeticFrame geodesy;
  geodesy.setOrigin(o[0], o[1], o[2]);
  geodesy.setZone(geocentric ? 31 : zone);
  const auto move = [&](Cloud& one)
  {
    for (std::size_t i = 0; i < one.size(); ++i)
    {
      double* at = one.points.data() + 3 * i;
      const formats::Point moved = fields::Carry(
        geodesy, from, Frame::ENU, { at[0], at[1], at[2] }, static_cast<vtkIdType>(i));
      std::copy(moved.begin(), moved.end(), at);
    }
  };
  move(cloud);
  std::for_each(cloud.waveforms.begin(), cloud.waveforms.end(), move);
  return true;
}

/// Transforms points to the local frame if wanted, or adds the coordinate system to the field data.
void Place(Cloud& cloud, bool wantLocal, vtkFieldData* data)
{
  const int zone = formats::utmZoneOf(cloud.crs);
  if (cloud.crs.empty() || (wantLocal && MoveToOrigin(cloud, zone)))
  {
    return;
  }
  const auto origin = FindOrigin(cloud);
  if (origin != cloud.notes.end())
  {
    cloud.notes.erase(origin);
  }
  names::SetFieldStrings(data, names::CrsWkt, { cloud.crs });
  if (zone != 0)
  {
    names::SetFieldInteger(data, names::UTMZone, zone);
  }
}

/// Fills in the waveforms of a cloud, with arrays of the points to which they belong.
void FillWaveforms(Cloud& cloud, vtkPolyData* points, vtkPolyData* output)
{
  fields::ToPolyData(cloud.waveforms.front(), output);
  vtkNew<vtkCellArray> lines;
  vtkIdType sample = 0;
  for (const std::size_t end : cloud.lineEnds)
  {
    lines->InsertNextCell(static_cast<int>(end - static_cast<std::size_t>(sample)));
    for (; sample < static_cast<vtkIdType>(end); ++sample)
    {
      lines->InsertCellPoint(sample);
    }
  }
  output->SetVerts(nullptr);
  output->SetLines(lines);
  for (const names::Name& name : { names::BeamId, names::Timestamp })
  {
    if (vtkDataArray* from = points->GetPointData()->GetArray(name.name))
    {
      auto array = vtkSmartPointer<vtkDataArray>::Take(from->NewInstance());
      array->SetName(name.name);
      names::SetUnit(array, name.unit);
      for (const std::size_t point : cloud.linePoints)
      {
        array->InsertNextTuple(static_cast<vtkIdType>(point), from);
      }
      output->GetCellData()->AddArray(array);
    }
  }
  output->GetFieldData()->ShallowCopy(points->GetFieldData());
  output->GetPointData()->SetActiveScalars(names::Sample.name);
}
}

struct vtkAvianLidarPointCloudReader::vtkInternals
{
  std::vector<std::string> Files;
  formats::PacketIndex Packets;
  formats::ScanTimes Scans;  ///< scans of several files
  std::vector<double> Times; ///< times of the revolutions or of several files, s
  std::string Problem;       ///< reason why packets or several files cannot be read, or empty
};

vtkStandardNewMacro(vtkAvianLidarPointCloudReader);

//------------------------------------------------------------------------------
vtkAvianLidarPointCloudReader::vtkAvianLidarPointCloudReader()
  : Internals(new vtkInternals)
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
vtkAvianLidarPointCloudReader::~vtkAvianLidarPointCloudReader()
{
  this->SetSensorAddress(nullptr);
}

//------------------------------------------------------------------------------
void vtkAvianLidarPointCloudReader::SetFileName(const char* name)
{
  std::vector<std::string> files;
  if (name && *name)
  {
    files.emplace_back(name);
  }
  if (files != this->Internals->Files)
  {
    this->Internals->Files = files;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
const char* vtkAvianLidarPointCloudReader::GetFileName()
{
  return this->Internals->Files.empty() ? nullptr : this->Internals->Files.front().c_str();
}

//------------------------------------------------------------------------------
void vtkAvianLidarPointCloudReader::AddFileName(const char* name)
{
  if (name && *name)
  {
    this->Internals->Files.emplace_back(name);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarPointCloudReader::RemoveAllFileNames()
{
  this->SetFileName(nullptr);
}

//------------------------------------------------------------------------------
int vtkAvianLidarPointCloudReader::GetNumberOfFileNames()
{
  return static_cast<int>(this->Internals->Files.size());
}

//------------------------------------------------------------------------------
const char* vtkAvianLidarPointCloudReader::GetScanFileName(int step)
{
  const std::vector<std::string>& files = this->Internals->Scans.files;
  const bool known = step >= 0 && static_cast<std::size_t>(step) < files.size();
  return known ? files[static_cast<std::size_t>(step)].c_str() : nullptr;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarPointCloudReader::GetScanTimes()
{
  return this->Internals->Scans.origin;
}

//------------------------------------------------------------------------------
int vtkAvianLidarPointCloudReader::CanReadFile(const char* fileName)
{
  const formats::CloudFormat* const format = fileName ? formats::formatOf(fileName) : nullptr;
  if (!format)
  {
    return 0;
  }
  try
  {
    avianlidar::FileSource source(fileName);
    return format->fits(source) ? 1 : 0;
  }
  catch (const std::exception&)
  {
    return 0;
  }
}

//------------------------------------------------------------------------------
int vtkAvianLidarPointCloudReader::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkInternals& internals = *this->Internals;
  internals = vtkInternals{ internals.Files, {}, {}, {}, {} };
  const std::vector<std::string>& files = internals.Files;
  const auto hasTurns = [](const std::string& file)
  {
    const formats::CloudFormat* const format = formats::formatOf(file);
    return format && format->hasTurns;
  };
  // RequestData() reports the errors.
  if (files.size() > 1)
  {
    internals.Problem = vtkAvianLidarGuard::ProblemOf(
      [&]
      {
        const double rate = this->GetScanRate();
        avianlidar::failIf(!(rate >= 0.0 && rate <= 1e6), "ScanRate is ", rate,
          ", expected 0 to 1e6 scans a second");
        const auto packets = std::find_if(files.begin(), files.end(), hasTurns);
        avianlidar::failIf(packets != files.end(),
          packets == files.end() ? std::string() : *packets,
          " has packets, expected this file alone: each revolution is a time step");
        internals.Scans = formats::timesOfScans(files, rate);
        internals.Times = internals.Scans.seconds;
      });
  }
  else if (!files.empty() && hasTurns(files.front()))
  {
    const auto index = [&]
    {
      avianlidar::FileSource source(files.front());
      internals.Packets =
        formats::indexPackets(source, this->SensorAddress ? this->SensorAddress : "", {});
    };
    internals.Problem =
      vtkAvianLidarGuard::ProblemOf([&] { fields::Within(files.front(), NoMemory, index); });
    if (!internals.Packets.warning.empty())
    {
      this->Warn(files.front(), internals.Packets.warning);
    }
  }
  for (const formats::PacketIndex::Turn& turn : internals.Packets.turns)
  {
    internals.Times.push_back(turn.time);
  }
  for (int port = 0; port < 2; ++port)
  {
    fields::SetTimes(internals.Times, outputVector->GetInformationObject(port));
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarPointCloudReader::RequestData(
  vtkInformation* request, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      const int port = std::max(0, request->Get(vtkExecutive::FROM_OUTPUT_PORT()));
      vtkInformation* info = outputVector->GetInformationObject(port);
      vtkPolyData* output = vtkPolyData::GetData(outputVector, 0);
      vtkPolyData* waveforms = vtkPolyData::GetData(outputVector, 1);
      output->Initialize();
      waveforms->Initialize();
      const vtkInternals& internals = *this->Internals;
      avianlidar::failIf(internals.Files.empty(), "FileName is not set, expected the name of a ",
        formats::knownEndings(), " file");
      if (fields::IsOtherPiece(info))
      {
        return;
      }
      vtkAvianLidarRequire(internals.Problem);
      const std::vector<double>& times = internals.Times;
      const std::size_t step = fields::StepOf(times, info);
      const bool isSeries = !internals.Scans.files.empty();
      const std::string& file = isSeries ? internals.Scans.files[step] : internals.Files.front();
      fields::Within(file, NoMemory,
        [&]
        {
          Cloud cloud = formats::readCloud(file, vtkAvianLidarAbort::KeepGoing(this),
            times.empty() || isSeries ? nullptr : &internals.Packets, step);
          if (!times.empty())
          {
            for (vtkPolyData* one : { output, waveforms })
            {
              one->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), times[step]);
            }
          }
          std::string all;
          for (const std::string& warning : cloud.warnings)
          {
            all += (all.empty() ? "" : "; ") + warning;
          }
          if (!all.empty())
          {
            this->Warn(file, all);
          }
          if (isSeries)
          {
            names::SetFieldStrings(
              output->GetFieldData(), names::ScanTimes, { internals.Scans.origin });
          }
          Place(cloud, this->LocalCoordinates, output->GetFieldData());
          fields::ToPolyData(cloud, output);
          const bool simulated = output->GetPointData()->HasArray(names::Energy.name) != 0;
          output->GetPointData()->SetActiveScalars(
            simulated ? names::Energy.name : names::Intensity.name);
          if (!cloud.waveforms.empty())
          {
            FillWaveforms(cloud, output, waveforms);
          }
        });
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarPointCloudReader::Warn(const std::string& file, const std::string& what)
{
  vtkWarningMacro("" << vtkAvianLidarText(file + ": " + what) << ".");
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarPointCloudReader, ErrorsAsData, GetFileName(),
  GetNumberOfFileNames(), LocalCoordinates, SensorAddress, ScanRate);
