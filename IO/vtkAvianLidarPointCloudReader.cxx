// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarPointCloudReader.h"

#include "GeodeticFrame.h"
#include "Private/CoordinateSystem.h"
#include "Private/ReadCloud.h"
#include "Private/vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarText.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <exception>
#include <new>
#include <vector>

namespace formats = avianlidar::formats;
namespace names = vtkAvianLidarArrays;
using avianlidar::Frame;
using avianlidar::GeodeticFrame;
using formats::Cloud;
using formats::Note;

namespace
{
std::vector<Note>::iterator FindOrigin(Cloud& cloud)
{
  return std::find_if(cloud.notes.begin(), cloud.notes.end(),
    [](const Note& note)
    { return note.name == names::GeodeticOrigin.name && note.numbers.size() == 3; });
}

/// Points on the Earth to metres around the origin that the file says; true if that is done.
bool MoveToOrigin(Cloud& cloud, int zone)
{
  const auto origin = FindOrigin(cloud);
  const bool geocentric = cloud.crs.find("GEOCCS") == 0 && cloud.crs.find("4978") != cloud.crs.npos;
  if (origin == cloud.notes.end() || (zone == 0 && !geocentric))
  {
    return false;
  }
  const std::vector<double>& o = origin->numbers;
  if (!GeodeticFrame::checkOrigin(o[0], o[1], o[2]).empty())
  {
    throw formats::FormatError("the origin that it says is no place on the Earth");
  }
  const Frame from = geocentric ? Frame::ECEF : Frame::UTM;
  GeodeticFrame geodesy;
  geodesy.setOrigin(o[0], o[1], o[2]);
  geodesy.setZone(geocentric ? 31 : zone);
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    double* at = cloud.points.data() + 3 * i;
    const formats::Point p{ at[0], at[1], at[2] };
    const std::string wrong = GeodeticFrame::checkPoint(from, p);
    if (!wrong.empty())
    {
      throw formats::FormatError("point " + std::to_string(i) + ": " + wrong);
    }
    const formats::Point moved = geodesy.convert(from, Frame::ENU, p);
    std::copy(moved.begin(), moved.end(), at);
  }
  return true;
}

/// The frame of the points: either local, with the origin, or of a system on the Earth.
void Place(Cloud& cloud, bool wantLocal, vtkFieldData* fields)
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
  names::SetFieldStrings(fields, names::CrsWkt, { cloud.crs });
  if (zone != 0)
  {
    auto array = names::Make<vtkIntArray>(names::UTMZone, 1);
    array->SetValue(0, zone);
    fields->AddArray(array);
  }
}
}

struct vtkAvianLidarPointCloudReader::vtkInternals
{
  formats::PacketIndex Packets;
  std::string Problem; ///< why packets cannot be read; empty if they can
};

vtkStandardNewMacro(vtkAvianLidarPointCloudReader);

//------------------------------------------------------------------------------
vtkAvianLidarPointCloudReader::vtkAvianLidarPointCloudReader()
  : FileName(nullptr)
  , LocalCoordinates(true)
  , SensorAddress(nullptr)
  , Internals(new vtkInternals)
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
    formats::FileSource source(fileName);
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
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* info = outputVector->GetInformationObject(0);
  info->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  info->Remove(Pipeline::TIME_STEPS());
  info->Remove(Pipeline::TIME_RANGE());
  formats::PacketIndex& packets = this->Internals->Packets;
  packets = formats::PacketIndex();
  this->Internals->Problem.clear();
  const formats::CloudFormat* const format =
    this->FileName ? formats::formatOf(this->FileName) : nullptr;
  if (format && format->hasTurns)
  {
    try
    {
      formats::FileSource source(this->FileName);
      packets = formats::indexPackets(source, this->SensorAddress ? this->SensorAddress : "", {});
    }
    catch (const std::bad_alloc&)
    {
      this->Internals->Problem = "there is not enough memory for it";
      return 1; // RequestData says it
    }
    catch (const std::exception& error)
    {
      this->Internals->Problem = error.what();
      return 1;
    }
    if (!packets.warning.empty())
    {
      this->Warn(packets.warning);
    }
    std::vector<double> times;
    for (const formats::PacketIndex::Turn& turn : packets.turns)
    {
      times.push_back(turn.time);
    }
    double range[] = { times.front(), times.back() };
    info->Set(Pipeline::TIME_STEPS(), times.data(), static_cast<int>(times.size()));
    info->Set(Pipeline::TIME_RANGE(), range, 2);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarPointCloudReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]() -> std::string
    {
      vtkInformation* info = outputVector->GetInformationObject(0);
      vtkPolyData* output = vtkPolyData::GetData(info);
      output->Initialize();
      if (!this->FileName || !*this->FileName)
      {
        return "FileName is not set, expected the name of a " + formats::knownEndings() + " file";
      }
      if (info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER()) &&
        info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER()) > 0)
      {
        return {};
      }
      if (!this->Internals->Problem.empty())
      {
        return this->FileName + (": " + this->Internals->Problem);
      }
      vtkAvianLidarAbort::StopIfWanted(this);
      try
      {
        const formats::PacketIndex& packets = this->Internals->Packets;
        const std::vector<formats::PacketIndex::Turn>& turns = packets.turns;
        std::size_t turn = 0;
        if (!turns.empty() && info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()))
        {
          const double time = info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
          const auto after = std::upper_bound(turns.begin(), turns.end(), time,
            [](double t, const formats::PacketIndex::Turn& one) { return t < one.time; });
          turn = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - turns.begin() - 1, 0));
        }
        Cloud cloud = formats::readCloud(this->FileName, vtkAvianLidarAbort::KeepGoing(this),
          turns.empty() ? nullptr : &packets, turn);
        if (!turns.empty())
        {
          output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), turns[turn].time);
        }
        if (!cloud.warnings.empty())
        {
          std::string all;
          for (const std::string& warning : cloud.warnings)
          {
            all += (all.empty() ? "" : "; ") + warning;
          }
          this->Warn(all);
        }
        Place(cloud, this->LocalCoordinates, output->GetFieldData());
        vtkAvianLidarCloudFields::ToPolyData(cloud, output);
        const bool simulated = output->GetPointData()->HasArray(names::Energy.name) != 0;
        output->GetPointData()->SetActiveScalars(
          simulated ? names::Energy.name : names::Intensity.name);
        return {};
      }
      catch (const avianlidar::WorkStopped&)
      {
        throw;
      }
      catch (const std::bad_alloc&)
      {
        return std::string(this->FileName) + ": there is not enough memory for it";
      }
      catch (const std::exception& error)
      {
        return std::string(this->FileName) + ": " + error.what();
      }
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarPointCloudReader::Warn(const std::string& what)
{
  vtkWarningMacro("" << vtkAvianLidarText(this->FileName + (": " + what)) << ".");
}

//------------------------------------------------------------------------------
void vtkAvianLidarPointCloudReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ErrorsAsData: " << this->ErrorsAsData << "\n";
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "LocalCoordinates: " << this->LocalCoordinates << "\n";
  os << indent << "SensorAddress: " << (this->SensorAddress ? this->SensorAddress : "(none)")
     << "\n";
}
