// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarPointCloudReader.h"

#include "CoordinateSystem.h"
#include "GeodeticFrame.h"
#include "ReadCloud.h"
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
  formats::PacketIndex Packets;
  std::vector<double> Times; ///< times of the revolutions, s
  std::string Problem;       ///< reason why packets cannot be read, or empty
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
  this->SetFileName(nullptr);
  this->SetSensorAddress(nullptr);
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
  internals = vtkInternals();
  const formats::CloudFormat* const format =
    this->FileName ? formats::formatOf(this->FileName) : nullptr;
  if (format && format->hasTurns)
  {
    // RequestData() reports the error.
    const auto index = [&]
    {
      avianlidar::FileSource source(this->FileName);
      internals.Packets =
        formats::indexPackets(source, this->SensorAddress ? this->SensorAddress : "", {});
    };
    internals.Problem =
      vtkAvianLidarGuard::ProblemOf([&] { fields::Within(this->FileName, NoMemory, index); });
    if (!internals.Packets.warning.empty())
    {
      this->Warn(internals.Packets.warning);
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
      avianlidar::failIf(!this->FileName || !*this->FileName,
        "FileName is not set, expected the name of a ", formats::knownEndings(), " file");
      if (fields::IsOtherPiece(info))
      {
        return;
      }
      vtkAvianLidarRequire(this->Internals->Problem);
      fields::Within(this->FileName, NoMemory,
        [&]
        {
          const std::vector<double>& times = this->Internals->Times;
          const std::size_t turn = fields::StepOf(times, info);
          Cloud cloud = formats::readCloud(this->FileName, vtkAvianLidarAbort::KeepGoing(this),
            times.empty() ? nullptr : &this->Internals->Packets, turn);
          if (!times.empty())
          {
            output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), times[turn]);
          }
          std::string all;
          for (const std::string& warning : cloud.warnings)
          {
            all += (all.empty() ? "" : "; ") + warning;
          }
          if (!all.empty())
          {
            this->Warn(all);
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
void vtkAvianLidarPointCloudReader::Warn(const std::string& what)
{
  vtkWarningMacro("" << vtkAvianLidarText(this->FileName + (": " + what)) << ".");
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(
  vtkAvianLidarPointCloudReader, ErrorsAsData, FileName, LocalCoordinates, SensorAddress);
