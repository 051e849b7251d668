// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarEchoFilter.h"

#include "EchoSettings.h"
#include "MoverReport.h"
#include "Scan.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarEchoOutput.h"
#include "vtkAvianLidarMovers.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarRevolutions.h"
#include "vtkAvianLidarScanFilterInternals.h"
#include "vtkAvianLidarScanShape.h"
#include "vtkAvianLidarText.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkAvianLidarEchoFilter);

//------------------------------------------------------------------------------
struct vtkAvianLidarEchoFilter::vtkMoved
{
  vtkAvianLidarMovers Movers;
  double TouchedBeams = 0.0; ///< number of beams touched by movers, on all ranks
  std::string Coincident;    ///< warning on coincident surfaces seen by beams of this rank
  vtkAvianLidarWarnings Warnings;
  vtkAvianLidarWarnings MoverWarnings;
};

//------------------------------------------------------------------------------
vtkAvianLidarEchoFilter::vtkAvianLidarEchoFilter()
  : Moved(new vtkMoved)
{
  this->SetNumberOfInputPorts(3);
  this->SetNumberOfOutputPorts(4);
}

//------------------------------------------------------------------------------
vtkAvianLidarEchoFilter::~vtkAvianLidarEchoFilter() = default;

//------------------------------------------------------------------------------
int vtkAvianLidarEchoFilter::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Superclass::RequestInformation(request, inputVector, outputVector))
  {
    return 0;
  }
  for (int port = 0; port < this->GetNumberOfOutputPorts(); ++port)
  {
    vtkAvianLidarScanShape::Follow(
      inputVector[0]->GetInformationObject(0), outputVector->GetInformationObject(port));
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarEchoFilter::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInternals& in = *this->Internals;
  in.TracedRays = in.TracedBeams = this->Moved->TouchedBeams = 0.0;
  in.Setup.settings.noise = this->Noise;
  in.Setup.settings.returnMode = static_cast<avianlidar::ReturnMode>(this->ReturnMode);
  in.Setup.settings.waveforms = this->RecordWaveforms;
  in.Setup.settings.waveformFloor = this->WaveformFloor;
  return vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks)
    {
      const std::array<vtkPolyData*, 4> outputs = { vtkPolyData::GetData(outputVector, 0),
        vtkPolyData::GetData(outputVector, 1), vtkPolyData::GetData(outputVector, 2),
        vtkPolyData::GetData(outputVector, 3) };
      vtkAvianLidarRevolutions::NoteTime(request, outputVector);
      this->Prepare(ranks, inputVector);
      this->Trace(outputs);
      for (double* count : { &in.TracedRays, &in.TracedBeams, &this->Moved->TouchedBeams })
      {
        *count = ranks.Sum(*count);
      }
      for (vtkPolyData* output : outputs)
      {
        this->FillFields(
          vtkPolyData::GetData(inputVector[0])->GetFieldData(), output->GetFieldData());
      }
      const std::string& warning = this->Moved->Coincident;
      if (this->Moved->Warnings.IsNew(vtkDataObject::GetData(inputVector[1]), in.Scene, warning))
      {
        vtkWarningMacro("Input port 1, " << vtkAvianLidarText(warning));
      }
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoFilter::Prepare(
  const vtkAvianLidarRanks& ranks, vtkInformationVector** inputVector)
{
  vtkInternals& in = *this->Internals;
  vtkDataObject* surfaces = vtkDataObject::GetData(inputVector[1]);
  vtkAvianLidarMovers& movers = this->Moved->Movers;
  this->PrepareBeams(ranks, vtkPolyData::GetData(inputVector[0]));
  in.Beams.CheckRanks(ranks);
  vtkAvianLidarRanks::Settings own;
  own.Add("ReportMovers", this->ReportMovers);
  ranks.AgreeOn(own);
  this->PrepareSurfaces(ranks, surfaces);
  vtkDataObject* moving = vtkDataObject::GetData(inputVector[2]);
  movers.Read(ranks, moving, *in.Surfaces);
  if (this->Moved->MoverWarnings.IsNew(moving, movers.checksum, movers.warning) &&
    ranks.Rank() == 0)
  {
    vtkWarningMacro("Input port 2 (movers), " << vtkAvianLidarText(movers.warning));
  }
  in.Setup.movers = movers.movers;
  in.Setup.largestReflectance = in.Summary.largestReflectance;
  in.Setup.largestGain = in.Summary.largestGain;
  avianlidar::includeMovers(in.Setup);
  if (in.Setup.movers)
  {
    in.Beams.RequireTimes("the movers (input port 2)");
  }
  this->PrepareTree(ranks, surfaces);
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoFilter::FillFields(vtkFieldData* beamFields, vtkFieldData* fields) const
{
  const vtkInternals& in = *this->Internals;
  vtkAvianLidarEchoOutput::FillFields(
    in.Setup, this->Preset, beamFields, this->Moved->Movers, in.Exchange.Fields, in.Scene, fields);
  this->AddAirTo(fields);
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoFilter::Trace(const std::array<vtkPolyData*, 4>& outputs)
{
  vtkInternals& in = *this->Internals;
  avianlidar::planModel(in.Setup);
  vtkAvianLidarRequire(
    avianlidar::checkNoise(in.Setup.noise, in.Beams.total), "Input port 0 (beams), field data: ");
  const avianlidar::KeepGoing keepGoing =
    vtkAvianLidarAbort::KeepGoing(this, vtkInternals::BuildShare, 1.0);
  const auto limit = static_cast<std::size_t>(this->MaximumCacheSize) << 20;
  if (this->RecordWaveforms && this->WaveformFloor == 0.0)
  {
    vtkAvianLidarEchoOutput::RequireMemoryForWholeBeams(in.Beams);
  }
  avianlidar::ScanResult result;
  vtkAvianLidarAbort::Require(avianlidar::simulateScan(
    in.Setup, in.Beams.beams, in.Threads, in.Cache, limit, keepGoing, result, this->ReportMovers));
  in.TracedRays = static_cast<double>(result.raysTraced);
  in.TracedBeams = static_cast<double>(result.beamsTraced);
  this->Moved->TouchedBeams = static_cast<double>(result.beamsTouched);
  this->Moved->Coincident = result.echoes.empty()
    ? std::string() // without echoes, coincident surfaces have no effect
    : in.Surfaces->WarningOnCoincidence(result.coincident);
  vtkAvianLidarEchoOutput::FillEchoes(result, in.Beams, in.Setup.noise, outputs[0]);
  vtkAvianLidarEchoOutput::FillReport(result, in.Beams, in.Setup.noise, outputs[1]);
  if (this->RecordWaveforms)
  {
    vtkAvianLidarEchoOutput::FillWaveforms(result, in.Beams, outputs[0], outputs[3]);
  }
  if (this->ReportMovers)
  {
    const auto wanted = [&] { return keepGoing(1.0); };
    vtkAvianLidarEchoOutput::FillMovers(in.Setup, in.Beams.beams,
      avianlidar::reportMovers(in.Setup, in.Beams.beams, result.sights, in.Threads, wanted), result,
      outputs[2]);
  }
}

//------------------------------------------------------------------------------
double vtkAvianLidarEchoFilter::GetNumberOfTouchedBeams() const
{
  return this->Moved->TouchedBeams;
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(
  vtkAvianLidarEchoFilter, Noise, ReturnMode, RecordWaveforms, WaveformFloor, ReportMovers);
