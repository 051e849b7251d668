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
#include <stdexcept>
#include <thread>

namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

/// Answers of a rank in Meet(), which returns the least answer of all ranks.
enum Answer
{
  Absent, ///< the rank threw
  No,
  Yes
};

constexpr char Stop = 's';
constexpr char Failure = 'f';

/// Result of this rank's step, for the other ranks; empty after success.
std::string ResultOf(const std::function<void()>& step)
{
  bool stopped = true;
  const std::string problem = vtkAvianLidarGuard::ProblemOf(
    [&]()
    {
      step();
      stopped = false;
    });
  return problem.empty() ? std::string(stopped, Stop) : Failure + problem;
}

std::uint64_t HashOfHostName()
{
  vtksys::SystemInformation system;
  system.RunOSCheck();
  const std::string name = system.GetHostname() ? system.GetHostname() : "";
  return avianlidar::hashOf(name.data(), name.size(), 0);
}

/// Thrown on all ranks if VTK could not send data.
class SendError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Thrown if another rank threw between exchanges.
class RankThrew
{
};

void ThrowUnlessSent(int sent)
{
  if (!sent)
  {
    throw SendError("VTK could not send the data: 2 GiB or more together, or no memory");
  }
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

/// Report the problem, then end the process and thereby the job, because VTK offers no call of
/// MPI_Abort(). If this rank returned, the other ranks would wait in the exchange for ever. There
/// may be no memory left, so the function must not throw.
[[noreturn]] void EndJob(vtkAlgorithm* self, const char* problem) noexcept
{
  constexpr char ending[] = ". The other ranks wait for it, so this rank ends the job.";
  try
  {
    vtkErrorWithObjectMacro(self, << problem << ending);
  }
  catch (...)
  {
    std::fputs(problem, stderr);
    std::fputs(ending, stderr);
    std::fputs("\n", stderr);
  }
  std::abort();
}
}

struct vtkAvianLidarRanks::Ended
{
  Outcome outcome;
};

//------------------------------------------------------------------------------
vtkAvianLidarRanks::Outcome vtkAvianLidarRanks::Run(vtkAlgorithm* self, const Body& body) const
{
  Outcome outcome = Outcome::Stopped;
  const std::string thrown = vtkAvianLidarGuard::ProblemOf(
    [&]()
    {
      try
      {
        outcome = this->RunTogether(self, body);
      }
      catch (const Ended& ended)
      {
        outcome = ended.outcome;
      }
    });
  if (!thrown.empty())
  {
    outcome = Outcome::Failed;
    this->Problem = thrown;
    vtkErrorWithObjectMacro(self, << vtkAvianLidarGuard::Sentence(thrown));
  }
  return outcome;
}

//------------------------------------------------------------------------------
vtkAvianLidarRanks::Outcome vtkAvianLidarRanks::RunTogether(
  vtkAlgorithm* self, const Body& body) const
{
  if (this->Alone())
  {
    body(*this);
    return Outcome::Done;
  }
  this->Exchanging = false;
  try
  {
    body(*this);
    this->Meet(Yes); // throws if another rank threw
    return Outcome::Done;
  }
  catch (const Ended&)
  {
    throw;
  }
  catch (const SendError&)
  {
    throw;
  }
  catch (const RankThrew&)
  {
    return this->Fail(self, nullptr);
  }
  catch (const std::bad_alloc&)
  {
    return this->Fail(self, vtkAvianLidarGuard::NoMemory);
  }
  catch (const std::exception& error)
  {
    return this->Fail(self, error.what());
  }
  catch (...)
  {
    return this->Fail(self, "An unknown exception was thrown");
  }
}

//------------------------------------------------------------------------------
vtkAvianLidarRanks::Outcome vtkAvianLidarRanks::Fail(
  vtkAlgorithm* self, const char* mine) const noexcept
{
  if (!this->Exchanging)
  {
    try
    {
      if (mine)
      {
        const int absent = Absent;
        int least = 0;
        this->Controller->AllReduce(&absent, &least, 1, vtkCommunicator::MIN_OP);
      }
      return this->Share(self, mine ? Failure + std::string(mine) : std::string(), false);
    }
    catch (...)
    {
      // There is not enough memory to share the problem.
    }
  }
  EndJob(self, mine ? mine : vtkAvianLidarGuard::NoMemory);
}

//------------------------------------------------------------------------------
int vtkAvianLidarRanks::Meet(int mine) const
{
  int least = 0;
  this->Controller->AllReduce(&mine, &least, 1, vtkCommunicator::MIN_OP);
  if (least == Absent)
  {
    throw RankThrew{};
  }
  return least;
}

//------------------------------------------------------------------------------
template <class Work>
void vtkAvianLidarRanks::Exchange(Work work) const
{
  this->Meet(Yes);
  this->Exchanging = true;
  work();
  this->Exchanging = false;
}

//------------------------------------------------------------------------------
int vtkAvianLidarRanks::Execute(vtkAlgorithm* self, vtkMultiProcessController* controller,
  vtkInformation* request, vtkInformationVector* outputs, bool errorsAsData, const Body& body)
try
{
  const vtkAvianLidarRanks together(controller, request, outputs);
  const auto work = [&](const vtkAvianLidarRanks& ranks)
  {
    ranks.Together(self, [self]() { vtkAvianLidarGuard::RequireInputs(self); });
    body(ranks);
  };
  const Outcome outcome = together.Run(self, std::cref(work));
  if (outcome == Outcome::Stopped)
  {
    vtkAvianLidarGuard::Empty(outputs);
  }
  return vtkAvianLidarGuard::End(
    outputs, outcome == Outcome::Failed ? together.Problem : std::string(), errorsAsData);
}
catch (const std::bad_alloc&)
{
  return vtkAvianLidarGuard::GiveUp(self, outputs);
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
void vtkAvianLidarRanks::RunStep(vtkAlgorithm* self, const std::function<void()>& step) const
{
  const std::string mine = ResultOf(step);
  if (!this->All(mine.empty()))
  {
    throw Ended{ this->Share(self, mine, true) };
  }
}

//------------------------------------------------------------------------------
vtkAvianLidarRanks::Outcome vtkAvianLidarRanks::Share(
  vtkAlgorithm* self, const std::string& mine, bool meet) const
{
  const bool failed = !mine.empty() && mine[0] == Failure;
  std::string problem = failed ? mine.substr(1) : "";
  vtkMultiProcessStream stream;
  stream << mine;
  if (meet && !this->Alone())
  {
    this->Meet(Yes);
  }
  int rank = 0;
  for (vtkMultiProcessStream& other : this->GatherStreams(stream))
  {
    std::string result;
    other >> result;
    if (problem.empty() && !result.empty() && result[0] == Failure)
    {
      problem = "Rank " + std::to_string(rank) + ": " + result.substr(1);
    }
    ++rank;
  }
  if (problem.empty())
  {
    SetAborted(self, true);
    return Outcome::Stopped;
  }
  this->Problem = problem;
  if (failed || this->Mine == 0)
  {
    vtkErrorWithObjectMacro(self, << vtkAvianLidarGuard::Sentence(problem));
  }
  return Outcome::Failed;
}

//------------------------------------------------------------------------------
void vtkAvianLidarRanks::AgreeOn(vtkAlgorithm* self, const Settings& mine) const
{
  if (this->Alone())
  {
    return;
  }
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
  this->Together(self,
    [&]()
    {
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
    });
}

//------------------------------------------------------------------------------
bool vtkAvianLidarRanks::All(bool mine) const
{
  return this->Alone() ? mine : this->Meet(mine ? Yes : No) == Yes;
}

//------------------------------------------------------------------------------
double vtkAvianLidarRanks::Sum(double mine) const
{
  double sum = mine;
  if (!this->Alone())
  {
    this->Exchange([&]() { this->Controller->AllReduce(&mine, &sum, 1, vtkCommunicator::SUM_OP); });
  }
  return sum;
}

//------------------------------------------------------------------------------
double vtkAvianLidarRanks::Largest(double mine) const
{
  double largest = mine;
  if (!this->Alone())
  {
    this->Exchange(
      [&]() { this->Controller->AllReduce(&mine, &largest, 1, vtkCommunicator::MAX_OP); });
  }
  return largest;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarRanks::Same(std::optional<std::uint64_t> mine) const
{
  if (this->Alone())
  {
    return true;
  }
  // The type is not unsigned long, because VTK would treat unsigned long as long.
  const unsigned long long low = mine.value_or(std::numeric_limits<std::uint64_t>::max());
  const unsigned long long high = mine.value_or(0);
  unsigned long long least = 0;
  unsigned long long largest = 0;
  this->Exchange(
    [&]()
    {
      this->Controller->AllReduce(&low, &least, 1, vtkCommunicator::MIN_OP);
      this->Controller->AllReduce(&high, &largest, 1, vtkCommunicator::MAX_OP);
    });
  return least >= largest; // `least` is greater if no rank has a value
}

//------------------------------------------------------------------------------
std::vector<vtkMultiProcessStream> vtkAvianLidarRanks::Gather(
  const vtkMultiProcessStream& mine) const
{
  if (!this->Alone())
  {
    this->Meet(Yes);
  }
  return this->GatherStreams(mine);
}

//------------------------------------------------------------------------------
std::vector<vtkMultiProcessStream> vtkAvianLidarRanks::GatherStreams(
  const vtkMultiProcessStream& mine) const
{
  this->Exchanging = true;
  std::vector<vtkMultiProcessStream> all{ mine };
  if (!this->Alone())
  {
    ThrowUnlessSent(this->Controller->AllGather(mine, all));
  }
  this->Exchanging = false;
  return all;
}

//------------------------------------------------------------------------------
void vtkAvianLidarRanks::Gather(vtkDataArray* mine, vtkDataArray* all) const
{
  this->Exchange([&]() { ThrowUnlessSent(this->Controller->AllGatherV(mine, all)); });
}

//------------------------------------------------------------------------------
std::vector<vtkSmartPointer<vtkDataObject>> vtkAvianLidarRanks::Gather(vtkDataObject* mine) const
{
  std::vector<vtkSmartPointer<vtkDataObject>> all;
  ThrowUnlessSent(this->Sum(BytesOf(mine)) < MostBytes);
  this->Exchange(
    [&]()
    {
      ThrowUnlessSent(this->Controller->AllGather(mine, all));
      if (std::count(all.begin(), all.end(), nullptr) > 0)
      {
        throw std::bad_alloc(); // VTK had no memory to serialise the data
      }
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
      this->Controller->AllGather(reinterpret_cast<const char*>(&host),
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
  const auto update = [&]()
  {
    bool good = true;
    bool stopped = false;
    for (int port = 0; port < self->GetNumberOfInputPorts(); ++port)
    {
      for (int i = 0; i < self->GetNumberOfInputConnections(port); ++i)
      {
        vtkAlgorithmOutput* input = self->GetInputConnection(port, i);
        auto* pipeline = vtkDemandDrivenPipeline::SafeDownCast(self->GetInputExecutive(port, i));
        good = (!pipeline || pipeline->UpdateData(input->GetIndex())) && good;
        stopped = stopped || WasAborted(input->GetProducer());
      }
    }
    vtkAvianLidarRequire(
      good ? "" : "What is needed could not be made, see the errors of filters upstream");
    if (stopped)
    {
      throw avianlidar::WorkStopped{};
    }
  };
  const auto work = [&](const vtkAvianLidarRanks& ranks) { ranks.Together(self, update); };
  if (when != vtkExecutive::BeforeForward || !request->Has(Pipeline::REQUEST_DATA()))
  {
    return 1;
  }
  const vtkAvianLidarRanks ranks(controller, request, outputs);
  const Outcome outcome = ranks.Alone() ? Outcome::Done : ranks.Run(self, std::cref(work));
  if (outcome == Outcome::Stopped)
  {
    SetAborted(self, false); // the filter does not execute
    vtkAvianLidarGuard::Empty(outputs);
  }
  return outcome == Outcome::Done;
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
