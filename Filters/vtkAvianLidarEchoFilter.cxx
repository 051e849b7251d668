// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarEchoFilter.h"

#include "EchoSettings.h"
#include "Scan.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarEchoFilterInternals.h"
#include "vtkAvianLidarEchoOutput.h"
#include "vtkAvianLidarRevolutions.h"
#include "vtkAvianLidarScanShape.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkStandardNewMacro(vtkAvianLidarEchoFilter);

namespace
{
using Outcome = vtkAvianLidarRanks::Outcome;
using Pipeline = vtkStreamingDemandDrivenPipeline;
}

//------------------------------------------------------------------------------
vtkAvianLidarEchoFilter::vtkAvianLidarEchoFilter()
  : Internals(new vtkInternals)
{
  this->SetController(vtkMultiProcessController::GetGlobalController());
  this->SetNumberOfInputPorts(3);
  this->SetNumberOfOutputPorts(3);
}

//------------------------------------------------------------------------------
vtkAvianLidarEchoFilter::~vtkAvianLidarEchoFilter()
{
  this->SetController(nullptr);
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoFilter::SetController(vtkMultiProcessController* controller)
{
  if (controller != this->Controller)
  {
    // Both are known by the address of the controller, which another one may get.
    this->Internals->State.clear();
    this->Internals->Beams.ForgetRanks();
  }
  vtkSetObjectBodyMacro(Controller, vtkMultiProcessController, controller);
}

//------------------------------------------------------------------------------
int vtkAvianLidarEchoFilter::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 0)
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
    return 1;
  }
  // Both are declared: otherwise the pipeline would run the filter once per block, and blocks would
  // not hide each other.
  info->Remove(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE());
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  if (port == 2)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarEchoFilter::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Superclass::RequestInformation(request, inputVector, outputVector))
  {
    return 0;
  }
  vtkAvianLidarRevolutions::ChooseSteps(inputVector, outputVector);
  for (int port = 0; port < this->GetNumberOfOutputPorts(); ++port)
  {
    vtkAvianLidarScanShape::Follow(
      inputVector[0]->GetInformationObject(0), outputVector->GetInformationObject(port));
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarEchoFilter::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Superclass::RequestUpdateExtent(request, inputVector, outputVector))
  {
    return 0;
  }
  vtkAvianLidarRevolutions::AskForStart(inputVector);
  if (!vtkAvianLidarRanks(this->Controller, request, outputVector).Alone())
  {
    return 1; // each rank its piece of both; surfaces are exchanged
  }
  // A piece of the beams, but all of the surfaces and movers: anything may hide anything.
  for (const int port : { 1, 2 })
  {
    if (vtkInformation* input = inputVector[port]->GetInformationObject(0))
    {
      input->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
      input->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
      input->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarEchoFilter::ModifyRequest(vtkInformation* request, int when)
{
  return vtkAvianLidarRanks::UpdateInputs(this, request, when) &&
    this->Superclass::ModifyRequest(request, when);
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarEchoFilter::PrepareSettings()
{
  avianlidar::EchoSettings& s = this->Internals->Setup.settings;
  s.raysPerBeam = this->RaysPerBeam;
  s.sampling = static_cast<avianlidar::Sampling>(this->Sampling);
  s.targetRelativeError = this->TargetRelativeError;
  s.seed = this->Seed;
  s.attenuationCoefficient = this->AttenuationCoefficient;
  s.reflectanceModel = static_cast<avianlidar::ReflectanceModel>(this->ReflectanceModel);
  s.numberOfReflections = this->NumberOfReflections;
  s.beamConstraint = this->BeamConstraint;
  s.lightEnergyConstraint = this->LightEnergyConstraint;
  s.traceMode = static_cast<avianlidar::TraceMode>(this->BatchCollisionDetection);
  s.planeIntegration = this->PlaneIntegration;
  s.refineNearLimit = this->RefineNearLimit;
  s.noise = this->Noise;
  s.smallTargets = this->SmallTargets;
  s.fullModel = this->FullModel;
  s.returnMode = static_cast<avianlidar::ReturnMode>(this->ReturnMode);
  s.numberOfConnections = this->NumberOfConnections;
  std::string problem =
    avianlidar::applyPreset(static_cast<avianlidar::EchoPreset>(this->Preset), s);
  if (problem.empty())
  {
    problem = avianlidar::checkSettings(s);
  }
  if (problem.empty() && this->NumberOfThreads < 0)
  {
    problem = "NumberOfThreads is negative, expected at least 0 (0: all cores)";
  }
  if (problem.empty() && this->MaximumCacheSize < 0)
  {
    problem = "MaximumCacheSize is negative, expected at least 0 MiB";
  }
  return problem;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarEchoFilter::CheckUnits() const
{
  const vtkInternals& in = *this->Internals;
  const std::string problem = avianlidar::checkUnits(in.Setup.sensor, in.Setup.settings);
  const std::string preset = this->Preset == PRESET_CUSTOM
    ? std::string()
    : " (Preset " + std::to_string(this->Preset) + " says RaysPerBeam)";
  return problem.empty() ? problem : "Input port 0 (beams), field data: " + problem + preset;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarEchoFilter::PrepareBeams(const vtkAvianLidarRanks& ranks, vtkPolyData* input)
{
  vtkInternals& in = *this->Internals;
  const auto wrongWithBeams = [](const std::string& what)
  { return what.empty() ? what : "Input port 0 (beams), " + what; };
  const Outcome read = ranks.Together(this,
    [&]()
    {
      vtkAvianLidarAbort::StopIfWanted(this);
      in.Beams.Read(input);
      in.Setup.sensor = in.Beams.sensor;
      in.Setup.revolution = in.Beams.revolution;
      std::string problem = wrongWithBeams(in.Beams.problem);
      problem = problem.empty() ? this->PrepareSettings() : problem;
      return problem.empty() ? this->CheckUnits() : problem;
    });
  if (!in.GoOn(read))
  {
    return false;
  }
  return in.GoOn(in.Beams.CheckRanks(ranks, this, wrongWithBeams));
}

//------------------------------------------------------------------------------
int vtkAvianLidarEchoFilter::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInternals& in = *this->Internals;
  in.TracedRays = in.TracedBeams = in.TouchedBeams = 0.0;
  return vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks) -> int
    {
      vtkPolyData* beams = vtkPolyData::GetData(inputVector[0]);
      vtkDataObject* surfaces = vtkDataObject::GetData(inputVector[1]);
      vtkDataObject* movers = vtkDataObject::GetData(inputVector[2]);
      vtkPolyData* echoes = vtkPolyData::GetData(outputVector, 0);
      vtkPolyData* report = vtkPolyData::GetData(outputVector, 1);
      vtkPolyData* moved = vtkPolyData::GetData(outputVector, 2);
      vtkAvianLidarRevolutions::NoteTime(request, outputVector);
      const bool done = this->PrepareBeams(ranks, beams) &&
        this->PrepareSurfaces(ranks, surfaces) && this->PrepareMovers(ranks, movers) &&
        this->PrepareTree(ranks, surfaces) &&
        this->Scan(ranks, beams->GetFieldData(), { echoes, report, moved });
      for (vtkPolyData* output : { echoes, report, moved })
      {
        if (!done)
        {
          output->Initialize();
        }
      }
      return this->Internals->Last == Outcome::Failed ? 0 : 1; // stopped: empty and valid
    });
}

//------------------------------------------------------------------------------
bool vtkAvianLidarEchoFilter::PrepareMovers(const vtkAvianLidarRanks& ranks, vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  if (!in.GoOn(in.Movers.Read(ranks, this, input, in.Surfaces)))
  {
    return false;
  }
  in.Setup.movers = in.Movers.movers;
  in.Setup.largestReflectance = in.Summary.largestReflectance();
  in.Setup.largestGain = in.Summary.largestGain();
  avianlidar::includeMovers(in.Setup);
  const bool untimed = in.Setup.movers && in.Beams.beams.size() > 0 && !in.Beams.isTimed;
  return in.GoOn(ranks.Together(this,
    [untimed]() -> std::string
    {
      return untimed
        ? "Input port 0 (beams), point array 'timestamp' is missing, expected the time "
          "in microseconds at which each beam meets the movers (input port 2)"
        : "";
    }));
}

//------------------------------------------------------------------------------
bool vtkAvianLidarEchoFilter::Scan(const vtkAvianLidarRanks& ranks, vtkFieldData* beamFields,
  const std::array<vtkPolyData*, 3>& outputs)
{
  vtkInternals& in = *this->Internals;
  const Outcome traced = ranks.Together(this,
    [&]() -> std::string
    {
      avianlidar::planModel(in.Setup);
      const std::string problem = avianlidar::checkNoise(in.Setup.noise, in.Beams.total);
      if (!problem.empty())
      {
        return "Input port 0 (beams), field data: " + problem;
      }
      this->Trace(outputs);
      return {};
    });
  if (!in.GoOn(traced))
  {
    return false;
  }
  for (double* count : { &in.TracedRays, &in.TracedBeams, &in.TouchedBeams })
  {
    *count = ranks.Sum(*count);
  }
  const int crowded = static_cast<int>(ranks.Sum(in.CrowdedBeams));
  const Outcome outcome = ranks.Together(this,
    [&]() -> std::string
    {
      for (vtkPolyData* output : outputs)
      {
        vtkAvianLidarEchoOutput::FillFields(in.Setup, this->Preset, crowded, beamFields, in.Movers,
          in.Exchange.Fields, in.Scene, output->GetFieldData());
      }
      return {};
    });
  return in.GoOn(outcome);
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoFilter::Trace(const std::array<vtkPolyData*, 3>& outputs)
{
  vtkInternals& in = *this->Internals;
  const auto keepGoing = [this](double fraction)
  {
    this->UpdateProgress(vtkInternals::BuildShare + (1.0 - vtkInternals::BuildShare) * fraction);
    return !vtkAvianLidarAbort::Wanted(this);
  };
  const auto limit = static_cast<std::size_t>(this->MaximumCacheSize) << 20;
  avianlidar::ScanResult result;
  if (!avianlidar::simulateScan(
        in.Setup, in.Beams.beams, in.Threads, in.Cache, limit, keepGoing, result))
  {
    throw avianlidar::WorkStopped{};
  }
  in.TracedRays = static_cast<double>(result.raysTraced);
  in.TracedBeams = static_cast<double>(result.beamsTraced);
  in.TouchedBeams = static_cast<double>(result.beamsTouched);
  in.CrowdedBeams = vtkAvianLidarEchoOutput::CrowdedBeams(result);
  vtkAvianLidarEchoOutput::FillEchoes(result, in.Beams, outputs[0]);
  vtkAvianLidarEchoOutput::FillReport(result, in.Beams, in.Setup.noise, outputs[1]);
  vtkAvianLidarEchoOutput::FillMovers(in.Setup, in.Beams.beams,
    avianlidar::reportMovers(in.Setup, in.Beams.beams, result.sights, in.Threads), result,
    outputs[2]);
}

//------------------------------------------------------------------------------
double vtkAvianLidarEchoFilter::GetNumberOfTracedRays() const
{
  return this->Internals->TracedRays;
}

//------------------------------------------------------------------------------
double vtkAvianLidarEchoFilter::GetNumberOfTracedBeams() const
{
  return this->Internals->TracedBeams;
}

//------------------------------------------------------------------------------
double vtkAvianLidarEchoFilter::GetNumberOfTouchedBeams() const
{
  return this->Internals->TouchedBeams;
}

//------------------------------------------------------------------------------
int vtkAvianLidarEchoFilter::GetNumberOfTreeBuilds() const
{
  return this->Internals->TreeBuilds;
}

//------------------------------------------------------------------------------
double vtkAvianLidarEchoFilter::GetNumberOfBytesSent() const
{
  return this->Internals->Exchange.BytesSent + this->Internals->TreeBytesSent;
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Controller: " << this->Controller << "\n";
  os << indent << "ErrorsAsData: " << this->ErrorsAsData << "\n";
  os << indent << "Preset: " << this->Preset << "\n";
  os << indent << "RaysPerBeam: " << this->RaysPerBeam << "\n";
  os << indent << "Sampling: " << this->Sampling << "\n";
  os << indent << "TargetRelativeError: " << this->TargetRelativeError << "\n";
  os << indent << "Seed: " << this->Seed << "\n";
  os << indent << "AttenuationCoefficient: " << this->AttenuationCoefficient << " 1/m\n";
  os << indent << "ReflectanceModel: " << this->ReflectanceModel << "\n";
  os << indent << "NumberOfReflections: " << this->NumberOfReflections << "\n";
  os << indent << "BeamConstraint: " << this->BeamConstraint << "\n";
  os << indent << "LightEnergyConstraint: " << this->LightEnergyConstraint << "\n";
  os << indent << "BatchCollisionDetection: " << this->BatchCollisionDetection << "\n";
  os << indent << "PlaneIntegration: " << this->PlaneIntegration << "\n";
  os << indent << "RefineNearLimit: " << this->RefineNearLimit << "\n";
  os << indent << "Noise: " << this->Noise << "\n";
  os << indent << "SmallTargets: " << this->SmallTargets << "\n";
  os << indent << "FullModel: " << this->FullModel << "\n";
  os << indent << "ReturnMode: " << this->ReturnMode << "\n";
  os << indent << "NumberOfConnections: " << this->NumberOfConnections << "\n";
  os << indent << "Precision: " << this->Precision << "\n";
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "MaximumCacheSize: " << this->MaximumCacheSize << " MiB\n";
}
