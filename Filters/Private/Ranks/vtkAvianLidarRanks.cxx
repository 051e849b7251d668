// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarRanks.h"

#include "Hash.h"
#include "ParallelLoop.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarRequire.h"

#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkVersionMacros.h"

#include "vtksys/SystemInformation.hxx"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>
#include <thread>

namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

/// Answers of a rank in All(), which finds the least answer of all ranks.
enum Answer
{
  Threw,
  No,
  Yes
};

/// Thrown if another rank threw.
class RankThrew
{
};

std::uint64_t HashOfHostName()
{
  vtksys::SystemInformation system;
  system.RunOSCheck();
  const std::string name = system.GetHostname() ? system.GetHostname() : "";
  return avianlidar::hashOf(name.data(), name.size(), 0);
}

void RequireSent(bool sent)
{
  vtkAvianLidarRequire(
    sent ? "" : "VTK could not send the data: 2 GiB or more together, or no memory");
}

/// Mark a filter as aborted or not, in the same way on all ranks. Newer executives empty the
/// outputs of an aborted filter, and skip filters downstream.
void SetAborted(vtkAlgorithm* algorithm, bool aborted)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20230111)
  algorithm->SetAbortOutput(aborted);
#else
  static_cast<void>(algorithm), static_cast<void>(aborted);
#endif
}

bool WasAborted(vtkAlgorithm* algorithm)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20230111)
  return algorithm->GetAbortOutput();
#else
  return algorithm->GetAbortExecute() != 0;
#endif
}

/// Key in the information of a filter whose inputs were stopped, the same on all ranks. The filter
/// does not execute, so VTK does not mark it as aborted.
vtkInformationIntegerKey* InputsStopped()
{
  static auto* key = vtkInformationIntegerKey::MakeKey("INPUTS_STOPPED", "vtkAvianLidarRanks");
  return key;
}

/// Write the problem, then end the process and thereby the job, because VTK offers no call of
/// MPI_Abort(). If this rank returned, the other ranks would wait in the exchange for ever. There
/// may be no memory left, which VTK's messages need.
[[noreturn]] void EndJob(const char* problem) noexcept
{
  std::fputs(problem, stderr);
  std::fputs(". The other ranks wait for it, so this rank ends the job.\n", stderr);
  std::abort();
}
}

//------------------------------------------------------------------------------
bool vtkAvianLidarRanks::Run(vtkAlgorithm* self, const Body& body) const
try
{
  bool done = false;
  bool otherThrew = false;
  const std::string mine = vtkAvianLidarGuard::ProblemOf(
    [&]()
    {
      try
      {
        body(*this);
        this->Meet();
        done = true;
      }
      catch (const RankThrew&)
      {
        otherThrew = true;
      }
    });
  if (done)
  {
    return true;
  }
  if (this->Exchanging)
  {
    EndJob(mine.c_str());
  }
  if (!this->Alone() && !otherThrew)
  {
    const int threw = Threw;
    int least = 0;
    this->Controller->AllReduce(&threw, &least, 1, vtkCommunicator::MIN_OP);
  }
  try
  {
    this->Share(self, mine);
  }
  catch (...)
  {
    if (!this->Alone() && !mine.empty())
    {
      EndJob(mine.c_str());
    }
    throw;
  }
  return false;
}
catch (...)
{
  if (this->Alone())
  {
    throw;
  }
  EndJob(vtkAvianLidarGuard::NoMemory); // there is no memory for the problem
}

//------------------------------------------------------------------------------
void vtkAvianLidarRanks::Share(vtkAlgorithm* self, const std::string& mine) const
{
  vtkMultiProcessStream stream;
  stream << mine;
  this->Problem = mine;
  int rank = 0;
  for (vtkMultiProcessStream& other : this->GatherStreams(stream))
  {
    std::string problem;
    other >> problem;
    if (this->Problem.empty() && !problem.empty())
    {
      this->Problem = "Rank " + std::to_string(rank) + ": " + problem;
    }
    ++rank;
  }
  if (!mine.empty() || (this->Mine == 0 && !this->Problem.empty()))
  {
    vtkErrorWithObjectMacro(self, << vtkAvianLidarGuard::Sentence(this->Problem));
  }
}

//------------------------------------------------------------------------------
template <class Work>
void vtkAvianLidarRanks::Exchange(const Work& work) const
{
  if (!this->Alone())
  {
    this->Meet();
    this->Send(work);
  }
}

//------------------------------------------------------------------------------
template <class Work>
void vtkAvianLidarRanks::Send(const Work& work) const
{
  this->Exchanging = true;
  const int sent = work();
  this->Exchanging = false;
  RequireSent(sent != 0);
}

//------------------------------------------------------------------------------
int vtkAvianLidarRanks::Execute(vtkAlgorithm* self, const vtkAvianLidarRanks& ranks,
  vtkInformationVector* outputs, bool errorsAsData, const Body& body)
try
{
  const auto work = [&](const vtkAvianLidarRanks&)
  {
    vtkAvianLidarGuard::CheckStart(self);
    body(ranks);
  };
  if (ranks.Run(self, std::cref(work)))
  {
    return 1;
  }
  SetAborted(self, ranks.Problem.empty());
  vtkAvianLidarGuard::Empty(outputs, vtkAvianLidarGuard::Sentence(ranks.Problem));
  return ranks.Problem.empty() || errorsAsData;
}
catch (...)
{
  try
  {
    vtkAvianLidarGuard::Empty(outputs);
    vtkErrorWithObjectMacro(self, << vtkAvianLidarGuard::NoMemory);
  }
  catch (...)
  {
    // The return value 0 reports the failure.
  }
  return 0;
}

//------------------------------------------------------------------------------
vtkAvianLidarRanks::vtkAvianLidarRanks(
  vtkMultiProcessController* all, vtkInformation* request, vtkInformationVector* outputs)
{
  const int port = std::max(0, request->Get(vtkExecutive::FROM_OUTPUT_PORT()));
  vtkInformation* output = outputs->GetInformationObject(port);
  if (!output || !output->Has(Pipeline::UPDATE_PIECE_NUMBER()) ||
    !output->Has(Pipeline::UPDATE_NUMBER_OF_PIECES()))
  {
    return;
  }
  this->Asked = output->Get(Pipeline::UPDATE_PIECE_NUMBER());
  if (all && all->GetNumberOfProcesses() > 1 && this->Asked == all->GetLocalProcessId() &&
    output->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) == all->GetNumberOfProcesses())
  {
    this->Controller = all;
    this->Mine = all->GetLocalProcessId();
    this->Count = all->GetNumberOfProcesses();
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarRanks::AgreeOn(const Settings& mine) const
{
  std::uint64_t hash = 0;
  vtkMultiProcessStream stream;
  for (const auto& [name, value] : mine.Each)
  {
    hash = avianlidar::hashOf(value.c_str(), value.size() + 1, hash);
    stream << value;
  }
  if (this->Same(hash))
  {
    return;
  }
  std::vector<vtkMultiProcessStream> all = this->Gather(stream);
  for (const auto& [name, value] : mine.Each)
  {
    std::string first;
    all[0] >> first;
    for (std::size_t rank = 1; rank < all.size(); ++rank)
    {
      std::string other;
      all[rank] >> other;
      if (other != first)
      {
        vtkAvianLidarRequire(std::string(name) + " is " + first + " on rank 0 and " + other +
          " on rank " + std::to_string(rank) + ", expected the same on all ranks");
      }
    }
  }
}

//------------------------------------------------------------------------------
bool vtkAvianLidarRanks::All(bool mine) const
{
  if (this->Alone())
  {
    return mine;
  }
  const int answer = mine ? Yes : No;
  int least = 0;
  this->Controller->AllReduce(&answer, &least, 1, vtkCommunicator::MIN_OP);
  if (least == Threw)
  {
    throw RankThrew{};
  }
  return least == Yes;
}

//------------------------------------------------------------------------------
double vtkAvianLidarRanks::Reduce(double mine, int operation) const
{
  double result = mine;
  this->Exchange([&]() { return this->Controller->AllReduce(&mine, &result, 1, operation); });
  return result;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarRanks::Same(std::optional<std::uint64_t> mine) const
{
  // The type is not unsigned long, because VTK would treat unsigned long as long.
  const unsigned long long low = mine.value_or(std::numeric_limits<std::uint64_t>::max());
  const unsigned long long high = mine.value_or(0);
  unsigned long long least = 0;
  unsigned long long largest = 0;
  this->Exchange(
    [&]()
    {
      // Every rank makes both calls.
      const int lowSent = this->Controller->AllReduce(&low, &least, 1, vtkCommunicator::MIN_OP);
      const int highSent = this->Controller->AllReduce(&high, &largest, 1, vtkCommunicator::MAX_OP);
      return lowSent && highSent;
    });
  return least >= largest; // `least` is greater if no rank has a value
}

//------------------------------------------------------------------------------
std::vector<vtkMultiProcessStream> vtkAvianLidarRanks::Gather(
  const vtkMultiProcessStream& mine) const
{
  this->Meet();
  return this->GatherStreams(mine);
}

//------------------------------------------------------------------------------
std::vector<vtkMultiProcessStream> vtkAvianLidarRanks::GatherStreams(
  const vtkMultiProcessStream& mine) const
{
  std::vector<vtkMultiProcessStream> all{ mine };
  if (!this->Alone())
  {
    this->Send([&]() { return this->Controller->AllGather(mine, all); });
  }
  return all;
}

//------------------------------------------------------------------------------
void vtkAvianLidarRanks::Gather(vtkDataArray* mine, vtkDataArray* all) const
{
  this->Exchange([&]() { return this->Controller->AllGatherV(mine, all); });
}

//------------------------------------------------------------------------------
std::vector<vtkSmartPointer<vtkDataObject>> vtkAvianLidarRanks::Gather(vtkDataObject* mine) const
{
  std::vector<vtkSmartPointer<vtkDataObject>> all;
  RequireSent(this->Sum(BytesOf(mine)) < MostBytes);
  this->Exchange(
    [&]()
    {
      const int sent = this->Controller->AllGather(mine, all);
      if (std::count(all.begin(), all.end(), nullptr) > 0)
      {
        throw std::bad_alloc(); // VTK had no memory to serialise the data
      }
      return sent;
    });
  return all;
}

//------------------------------------------------------------------------------
double vtkAvianLidarRanks::BytesOf(vtkDataObject* data)
{
  return 1024.0 * static_cast<double>(data->GetActualMemorySize());
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarRanks::CheckSize(vtkDataObject* data)
{
  return BytesOf(data) < MostBytes ? ""
                                   : "too large to send to other ranks, expected less than 2 GiB";
}

//------------------------------------------------------------------------------
void vtkAvianLidarRanks::Broadcast(vtkDataObject* data, int from, double& sent) const
{
  this->Exchange(
    [&]()
    {
      if (!this->Controller->Broadcast(data, from))
      {
        throw std::bad_alloc(); // VTK had no memory to serialise the data
      }
      return 1;
    });
  sent += from == this->Mine ? BytesOf(data) : 0.0;
}

//------------------------------------------------------------------------------
int vtkAvianLidarRanks::Threads(int wanted) const
{
  if (this->Alone())
  {
    return wanted;
  }
  const std::uint64_t host = HashOfHostName();
  std::vector<std::uint64_t> hosts(this->Count);
  this->Exchange(
    [&]()
    {
      return this->Controller->AllGather(reinterpret_cast<const char*>(&host),
        reinterpret_cast<char*>(hosts.data()), static_cast<vtkIdType>(sizeof(host)));
    });
  if (wanted > 0)
  {
    return wanted;
  }
  if (std::getenv("OMP_NUM_THREADS"))
  {
    return avianlidar::loopThreads(0);
  }
  // The cores of the node are divided among its ranks. The upper limit is OpenMP's choice, because
  // a launcher that binds ranks to cores has already divided the cores.
  const long cores = std::thread::hardware_concurrency();
  const long neighbours = std::count(hosts.begin(), hosts.end(), host);
  return static_cast<int>(
    std::clamp<long>(cores / neighbours, 1, static_cast<long>(avianlidar::loopThreads(0))));
}

//------------------------------------------------------------------------------
int vtkAvianLidarRanks::UpdateInputs(
  vtkAlgorithm* self, vtkMultiProcessController* controller, vtkInformation* request, int when)
{
  vtkInformationVector* outputs = self->GetExecutive()->GetOutputInformation();
  const auto update = [&](const vtkAvianLidarRanks&)
  {
    bool good = true;
    bool stopped = false;
    std::string problem; // every input is updated, because ranks may work together for the next one
    for (int port = 0; port < self->GetNumberOfInputPorts(); ++port)
    {
      for (int i = 0; i < self->GetNumberOfInputConnections(port); ++i)
      {
        vtkAlgorithmOutput* input = self->GetInputConnection(port, i);
        auto* pipeline = vtkDemandDrivenPipeline::SafeDownCast(self->GetInputExecutive(port, i));
        bool isUpdated = false;
        const std::string wrong = vtkAvianLidarGuard::ProblemOf(
          [&]() { isUpdated = !pipeline || pipeline->UpdateData(input->GetIndex()); });
        problem = problem.empty() ? wrong : problem;
        vtkAlgorithm* producer = input->GetProducer();
        const bool isStopped =
          WasAborted(producer) || producer->GetInformation()->Has(InputsStopped());
        stopped = stopped || isStopped;
        good = good && (isUpdated || isStopped);
      }
    }
    vtkAvianLidarRequire(problem);
    vtkAvianLidarRequire(
      good ? "" : "What is needed could not be made, see the errors of filters upstream");
    if (stopped)
    {
      throw avianlidar::WorkStopped{};
    }
  };
  if (when != vtkExecutive::BeforeForward || !request->Has(Pipeline::REQUEST_DATA()))
  {
    return 1;
  }
  const vtkAvianLidarRanks ranks(controller, request, outputs);
  self->GetInformation()->Remove(InputsStopped());
  if (ranks.Alone() || ranks.Run(self, std::cref(update)))
  {
    return 1;
  }
  if (ranks.Problem.empty())
  {
    self->GetInformation()->Set(InputsStopped(), 1);
  }
  vtkAvianLidarGuard::Empty(outputs, vtkAvianLidarGuard::Sentence(ranks.Problem));
  return 0;
}

//------------------------------------------------------------------------------
void vtkAvianLidarRanks::RequestPiece(vtkInformationVector* input) const
{
  vtkInformation* info = input->GetInformationObject(0);
  info->Set(Pipeline::UPDATE_PIECE_NUMBER(), this->Mine);
  info->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), this->Count);
  info->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
}

//------------------------------------------------------------------------------
void vtkAvianLidarRanks::RequestAll(vtkInformationVector* input)
{
  if (vtkInformation* info = input->GetInformationObject(0))
  {
    info->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
    info->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
    info->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  }
}
