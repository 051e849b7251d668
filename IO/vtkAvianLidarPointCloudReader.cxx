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

#include "vtkInformation.h"
#include "vtkInformationVector.h"
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
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    double* at = cloud.points.data() + 3 * i;
    const formats::Point moved =
      fields::Carry(geodesy, from, Frame::ENU, { at[0], at[1], at[2] }, static_cast<vtkIdType>(i));
    std::copy(moved.begin(), moved.end(), at);
  }
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
  fields::SetTimes(internals.Times, outputVector->GetInformationObject(0));
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarPointCloudReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      vtkInformation* info = outputVector->GetInformationObject(0);
      vtkPolyData* output = vtkPolyData::GetData(info);
      output->Initialize();
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
            output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), times[step]);
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
