// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTreeVisits.h"

#include "CollisionTreeBuilder.h"
#include "TreeVisits.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarBeams.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRevolutions.h"
#include "vtkAvianLidarSurfaceExchange.h"
#include "vtkAvianLidarSurfaces.h"
#include "vtkAvianLidarTreeAccess.h"
#include "vtkAvianLidarTreeDisplay.h"
#include "vtkAvianLidarTreeExchange.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkStandardNewMacro(vtkAvianLidarTreeVisits);

namespace
{
using Outcome = vtkAvianLidarRanks::Outcome;
}

struct vtkAvianLidarTreeVisits::vtkInternals
{
  vtkAvianLidarBeams Beams;
  vtkAvianLidarSurfaces Surfaces;
  vtkAvianLidarSurfaceExchange Exchange; ///< of surfaces between ranks
  std::shared_ptr<const avianlidar::CollisionTree> Tree;
  std::shared_ptr<const avianlidar::CollisionTree> OwnTree; ///< built because none came
  avianlidar::TreeVisits Visits;
  std::size_t TreeBytesSent = 0;
  Outcome Last = Outcome::Done; ///< of the execution so far

  /// Note how far the execution came. @return true to go on
  bool GoOn(Outcome outcome)
  {
    this->Last = outcome;
    return outcome == Outcome::Done;
  }
};

//------------------------------------------------------------------------------
vtkAvianLidarTreeVisits::vtkAvianLidarTreeVisits()
  : Internals(new vtkInternals)
{
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
vtkAvianLidarTreeVisits::~vtkAvianLidarTreeVisits() = default;

//------------------------------------------------------------------------------
int vtkAvianLidarTreeVisits::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Remove(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE());
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  if (port == 1)
  {
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarTreeVisits::ModifyRequest(vtkInformation* request, int when)
{
  return vtkAvianLidarRanks::UpdateInputs(this, request, when) &&
    this->Superclass::ModifyRequest(request, when);
}

//------------------------------------------------------------------------------
int vtkAvianLidarTreeVisits::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Superclass::RequestInformation(request, inputVector, outputVector))
  {
    return 0;
  }
  vtkAvianLidarRevolutions::ChooseSteps(inputVector, outputVector);
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarTreeVisits::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Superclass::RequestUpdateExtent(request, inputVector, outputVector))
  {
    return 0;
  }
  vtkAvianLidarRevolutions::AskForStart(inputVector);
  // Ranks count what they have; a process alone counts all, whatever piece is asked for.
  for (int port = 0; port < 2 && vtkAvianLidarRanks(request, outputVector).Alone(); ++port)
  {
    vtkInformation* info = inputVector[port]->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), 0);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), 1);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarTreeVisits::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks) -> int
    {
      vtkDataObject* surfaces = vtkDataObject::GetData(inputVector[1]);
      vtkPolyData* output = vtkPolyData::GetData(outputVector, 0);
      vtkAvianLidarRevolutions::NoteTime(request, outputVector);
      const bool done = this->ReadBeams(ranks, vtkPolyData::GetData(inputVector[0])) &&
        this->ReadSurfaces(ranks, surfaces) && this->FindTree(ranks, surfaces) &&
        this->Count(ranks) && this->Show(ranks, output);
      if (!done)
      {
        output->Initialize();
      }
      return this->Internals->Last == Outcome::Failed ? 0 : 1; // stopped: empty and valid
    });
}

//------------------------------------------------------------------------------
bool vtkAvianLidarTreeVisits::ReadBeams(const vtkAvianLidarRanks& ranks, vtkPolyData* input)
{
  vtkInternals& in = *this->Internals;
  const auto complaint = [](const std::string& what)
  { return what.empty() ? what : "Input port 0 (beams), " + what; };
  const Outcome read = ranks.Together(this,
    [&]()
    {
      vtkAvianLidarAbort::StopIfWanted(this);
      in.Beams.Read(input);
      return complaint(in.Beams.problem);
    });
  return in.GoOn(read) && in.GoOn(in.Beams.CheckRanks(ranks, this, complaint));
}

//------------------------------------------------------------------------------
bool vtkAvianLidarTreeVisits::ReadSurfaces(const vtkAvianLidarRanks& ranks, vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  const auto merged = vtkAvianLidarTreeAccess::FindMerged(input);
  if (!ranks.All(merged != nullptr) || !ranks.Same(merged->checksum))
  {
    return in.GoOn(
      in.Exchange.Merge(ranks, this, input, "Input port 1, ", 0, in.Surfaces, in.Surfaces));
  }
  return in.GoOn(ranks.Together(this,
    [&]() -> std::string
    {
      in.Exchange.Forget();
      in.Surfaces = *merged;
      return {};
    }));
}

//------------------------------------------------------------------------------
bool vtkAvianLidarTreeVisits::FindTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  bool found = false;
  const Outcome outcome = ranks.Together(this,
    [&]() -> std::string
    {
      const std::uint64_t checksum = in.Surfaces.checksum;
      in.Tree = vtkAvianLidarTreeAccess::Find(input, in.Surfaces.mesh, checksum).tree;
      found = in.Tree != nullptr;
      if (!found && in.OwnTree && in.OwnTree->checksum == checksum)
      {
        in.Tree = in.OwnTree;
      }
      return {};
    });
  if (!in.GoOn(outcome))
  {
    return false;
  }
  const int threads = ranks.Threads(0);
  const auto keepGoing = [this](double fraction)
  {
    this->UpdateProgress(0.5 * fraction);
    return !vtkAvianLidarAbort::Wanted(this);
  };
  const auto build = [&]()
  {
    return avianlidar::buildCollisionTree(
      in.Surfaces.mesh, avianlidar::TreeOptions{}, keepGoing, threads);
  };
  const Outcome shared = vtkAvianLidarTreeExchange::Share(
    ranks, this, in.Surfaces.mesh, threads, in.Tree, build, in.TreeBytesSent);
  in.OwnTree = found ? in.OwnTree : in.Tree;
  return in.GoOn(shared);
}

//------------------------------------------------------------------------------
bool vtkAvianLidarTreeVisits::Count(const vtkAvianLidarRanks& ranks)
{
  vtkInternals& in = *this->Internals;
  if (this->DisplayLevel < 0)
  {
    return true;
  }
  const auto keepGoing = [this](double fraction)
  {
    this->UpdateProgress(0.5 + 0.5 * fraction);
    return !vtkAvianLidarAbort::Wanted(this);
  };
  const int threads = ranks.Threads(0);
  avianlidar::TreeVisits mine;
  const Outcome counted = ranks.Together(this,
    [&]() -> std::string
    {
      if (!avianlidar::countVisits(*in.Tree, in.Beams.beams, in.Beams.sensor.halfBeamwidth,
            static_cast<std::uint32_t>(this->DisplayLevel), threads, keepGoing, mine))
      {
        throw avianlidar::WorkStopped{};
      }
      in.Visits.tested.resize(mine.tested.size());
      in.Visits.met.resize(mine.met.size());
      return {};
    });
  if (!in.GoOn(counted))
  {
    return false;
  }
  ranks.Sum(mine.tested, in.Visits.tested);
  ranks.Sum(mine.met, in.Visits.met);
  return true;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarTreeVisits::Show(const vtkAvianLidarRanks& ranks, vtkPolyData* output)
{
  vtkInternals& in = *this->Internals;
  return in.GoOn(ranks.Together(this,
    [&]() -> std::string
    {
      if (ranks.Rank() == 0)
      {
        vtkAvianLidarMakeTreeDisplay(*in.Tree, this->DisplayLevel, output);
        vtkAvianLidarAddTreeVisits(in.Visits, output);
      }
      return {};
    }));
}

//------------------------------------------------------------------------------
void vtkAvianLidarTreeVisits::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ErrorsAsData: " << this->ErrorsAsData << "\n";
  os << indent << "DisplayLevel: " << this->DisplayLevel << "\n";
}
