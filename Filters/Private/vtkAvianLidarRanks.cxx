// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarRanks.h"

#include "Hash.h"
#include "ParallelLoop.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarText.h"

#include "vtkAlgorithm.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <numeric>
#include <stdexcept>

namespace
{
using Outcome = vtkAvianLidarRanks::Outcome;
using Pipeline = vtkStreamingDemandDrivenPipeline;

constexpr char Stop = 's';
constexpr char Failure = 'f';

/// What a rank tells the others of its step: nothing if all is well.
std::string ResultOf(const std::function<std::string()>& step)
{
  bool stopped = false;
  const std::string problem = vtkAvianLidarGuard::ProblemOf(
    [&]() -> std::string
    {
      try
      {
        return step();
      }
      catch (const avianlidar::WorkStopped&)
      {
        stopped = true;
        return {};
      }
    });
  return problem.empty() ? std::string(stopped, Stop) : Failure + problem;
}

std::uint64_t HashOfHostName()
{
  char name[256] = {};
  gethostname(name, sizeof(name) - 1);
  return avianlidar::hashOf(name, sizeof(name), 0);
}

/// Ask an input for its data.
bool UpdateInput(vtkAlgorithm* self, vtkInformation* request, int port, int connection)
{
  int producerPort = 0;
  vtkAlgorithm* producer = self->GetInputAlgorithm(port, connection, producerPort);
  if (!producer)
  {
    return true;
  }
  vtkExecutive* executive = producer->GetExecutive();
  const int from = request->Get(vtkExecutive::FROM_OUTPUT_PORT());
  request->Set(vtkExecutive::FROM_OUTPUT_PORT(), producerPort);
  const int result = executive->ProcessRequest(
    request, executive->GetInputInformation(), executive->GetOutputInformation());
  request->Set(vtkExecutive::FROM_OUTPUT_PORT(), from);
  return result != 0;
}

constexpr char Ending[] = ". The other ranks cannot be told, so this rank ends the job.";

/// Tell what went wrong, then end the process: the launcher ends the others, who wait for it.
/// Whatever is left of memory: nothing here may throw, or the others would wait for ever.
[[noreturn]] void EndJob(vtkAlgorithm* self, const char* what) noexcept
{
  try
  {
    vtkErrorWithObjectMacro(self, << what << Ending);
  }
  catch (...)
  {
    std::fputs(what, stderr);
    std::fputs(Ending, stderr);
    std::fputs("\n", stderr);
  }
  std::abort();
}
}

struct vtkAvianLidarRanks::KnownToAll : std::runtime_error
{
  using std::runtime_error::runtime_error;
};

//------------------------------------------------------------------------------
bool vtkAvianLidarRanks::Run(vtkAlgorithm* self, const Body& body) const
{
  int done = 0;
  const std::string thrown = vtkAvianLidarGuard::ProblemOf(
    [&]() -> std::string
    {
      done = this->Alone() ? body(*this) : this->RunOrEndJob(self, body);
      return {};
    });
  if (!thrown.empty())
  {
    this->Problem = thrown;
    vtkErrorWithObjectMacro(self, << vtkAvianLidarGuard::Sentence(thrown));
  }
  return thrown.empty() && done;
}

//------------------------------------------------------------------------------
int vtkAvianLidarRanks::RunOrEndJob(vtkAlgorithm* self, const Body& body) const
{
  try
  {
    return body(*this);
  }
  catch (const KnownToAll&)
  {
    throw;
  }
  catch (const std::bad_alloc&)
  {
    EndJob(self, vtkAvianLidarGuard::NoMemory);
  }
  catch (const std::exception& error)
  {
    EndJob(self, error.what());
  }
  catch (...)
  {
    EndJob(self, "What was thrown is no std::exception");
  }
}

//------------------------------------------------------------------------------
int vtkAvianLidarRanks::Execute(vtkAlgorithm* self, vtkInformation* request,
  vtkInformationVector* outputs, bool errorsAsData, const Body& body)
try
{
  const std::string again = vtkAvianLidarGuard::FailedBefore(self, outputs);
  if (!again.empty())
  {
    return vtkAvianLidarGuard::End(self, outputs, again, errorsAsData);
  }
  const vtkAvianLidarRanks together(request, outputs);
  const bool done = together.Run(self,
    [&](const vtkAvianLidarRanks& ranks) -> int
    {
      const Outcome inputs =
        ranks.Together(self, [self]() { return vtkAvianLidarGuard::FailedInput(self); });
      return inputs == Outcome::Done && body(ranks);
    });
  return vtkAvianLidarGuard::End(
    self, outputs, done ? std::string() : together.Problem, errorsAsData);
}
catch (const std::bad_alloc&)
{
  return vtkAvianLidarGuard::GiveUp(self, outputs);
}

//------------------------------------------------------------------------------
vtkAvianLidarRanks::vtkAvianLidarRanks(vtkInformation* request, vtkInformationVector* outputs)
{
  const int port = std::max(0, request->Get(vtkExecutive::FROM_OUTPUT_PORT()));
  vtkInformation* output = outputs->GetInformationObject(port);
  vtkMultiProcessController* all = vtkMultiProcessController::GetGlobalController();
  if (!all || !output || all->GetNumberOfProcesses() < 2 ||
    !output->Has(Pipeline::UPDATE_PIECE_NUMBER()) ||
    !output->Has(Pipeline::UPDATE_NUMBER_OF_PIECES()))
  {
    return;
  }
  if (output->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) == all->GetNumberOfProcesses() &&
    output->Get(Pipeline::UPDATE_PIECE_NUMBER()) == all->GetLocalProcessId())
  {
    this->Controller = all;
    this->Mine = all->GetLocalProcessId();
    this->Count = all->GetNumberOfProcesses();
  }
}

//------------------------------------------------------------------------------
Outcome vtkAvianLidarRanks::Together(
  vtkAlgorithm* self, const std::function<std::string()>& step) const
{
  if (this->Alone())
  {
    try
    {
      const std::string problem = step();
      if (!problem.empty())
      {
        this->Problem = problem;
        vtkErrorWithObjectMacro(self, << vtkAvianLidarGuard::Sentence(problem));
      }
      return problem.empty() ? Outcome::Done : Outcome::Failed;
    }
    catch (const avianlidar::WorkStopped&)
    {
      return Outcome::Stopped;
    }
  }
  const std::vector<std::string> results = this->Gather(ResultOf(step));
  const auto failed = std::find_if(results.begin(), results.end(),
    [](const std::string& result) { return !result.empty() && result[0] == Failure; });
  if (failed == results.end())
  {
    const bool done = std::all_of(
      results.begin(), results.end(), [](const std::string& result) { return result.empty(); });
    return done ? Outcome::Done : Outcome::Stopped;
  }
  const std::string& own = results[this->Mine];
  const bool mine = !own.empty() && own[0] == Failure;
  this->Problem = mine
    ? own.substr(1)
    : "Rank " + std::to_string(failed - results.begin()) + ": " + failed->substr(1);
  if (mine || this->Mine == 0)
  {
    vtkErrorWithObjectMacro(self, << vtkAvianLidarGuard::Sentence(this->Problem));
  }
  return Outcome::Failed;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarRanks::All(bool mine) const
{
  if (this->Alone())
  {
    return mine;
  }
  const int sent = mine;
  int least = 0;
  this->Controller->AllReduce(&sent, &least, 1, vtkCommunicator::MIN_OP);
  return least != 0;
}

//------------------------------------------------------------------------------
double vtkAvianLidarRanks::Sum(double mine) const
{
  double sum = mine;
  if (!this->Alone())
  {
    this->Controller->AllReduce(&mine, &sum, 1, vtkCommunicator::SUM_OP);
  }
  return sum;
}

//------------------------------------------------------------------------------
double vtkAvianLidarRanks::Largest(double mine) const
{
  double largest = mine;
  if (!this->Alone())
  {
    this->Controller->AllReduce(&mine, &largest, 1, vtkCommunicator::MAX_OP);
  }
  return largest;
}

//------------------------------------------------------------------------------
void vtkAvianLidarRanks::Sum(
  const std::vector<std::int64_t>& mine, std::vector<std::int64_t>& sums) const
{
  if (this->Alone())
  {
    std::copy(mine.begin(), mine.end(), sums.begin());
  }
  else if (!mine.empty())
  {
    this->Controller->AllReduce(
      mine.data(), sums.data(), static_cast<vtkIdType>(mine.size()), vtkCommunicator::SUM_OP);
  }
}

//------------------------------------------------------------------------------
bool vtkAvianLidarRanks::Same(std::uint64_t mine) const
{
  if (this->Alone())
  {
    return true;
  }
  std::vector<std::uint64_t> all(this->Count);
  this->Controller->AllGather(reinterpret_cast<const char*>(&mine),
    reinterpret_cast<char*>(all.data()), static_cast<vtkIdType>(sizeof(mine)));
  return std::count(all.begin(), all.end(), mine) == this->Count;
}

//------------------------------------------------------------------------------
std::vector<std::string> vtkAvianLidarRanks::Gather(const std::string& mine) const
{
  if (this->Alone())
  {
    return { mine };
  }
  const vtkIdType length = static_cast<vtkIdType>(mine.size());
  std::vector<vtkIdType> lengths(this->Count);
  this->Controller->AllGather(&length, lengths.data(), 1);
  std::vector<vtkIdType> offsets(this->Count + 1, 0);
  std::partial_sum(lengths.begin(), lengths.end(), offsets.begin() + 1);
  std::vector<std::string> all(this->Count);
  const vtkIdType total = offsets.back();
  if (total > VTK_INT_MAX)
  {
    throw KnownToAll("What the ranks have to tell each other is longer than 2 GiB together");
  }
  if (total == 0)
  {
    return all;
  }
  std::string joined;
  bool room = true;
  try
  {
    joined.resize(static_cast<std::size_t>(total));
    for (int rank = 0; rank < this->Count; ++rank)
    {
      all[rank].resize(static_cast<std::size_t>(lengths[rank]));
    }
  }
  catch (const std::bad_alloc&)
  {
    room = false;
  }
  if (!this->All(room))
  {
    throw KnownToAll("There is not enough memory on one of the ranks for the lists of all");
  }
  this->Controller->AllGatherV(mine.data(), &joined[0], length, lengths.data(), offsets.data());
  for (int rank = 0; rank < this->Count; ++rank)
  {
    joined.copy(&all[rank][0], all[rank].size(), static_cast<std::size_t>(offsets[rank]));
  }
  return all;
}

//------------------------------------------------------------------------------
void vtkAvianLidarRanks::Broadcast(void* data, std::size_t bytes, int from) const
{
  // Far below MPI's limit of 2^31 elements, and many enough for one to be passed on while the next
  // arrives.
  constexpr std::size_t Chunk = std::size_t{ 1 } << 20;
  char* place = static_cast<char*>(data);
  for (std::size_t begin = 0; begin < bytes && !this->Alone(); begin += Chunk)
  {
    this->Controller->Broadcast(
      place + begin, static_cast<vtkIdType>(std::min(Chunk, bytes - begin)), from);
  }
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
  this->Controller->AllGather(reinterpret_cast<const char*>(&host),
    reinterpret_cast<char*>(hosts.data()), static_cast<vtkIdType>(sizeof(host)));
  if (wanted > 0)
  {
    return wanted;
  }
  if (std::getenv("OMP_NUM_THREADS"))
  {
    return avianlidar::loopThreads(0);
  }
  // Of the node's cores, as a launcher that binds ranks to cores has shared them out already.
  const long cores = sysconf(_SC_NPROCESSORS_ONLN);
  const long neighbours = std::count(hosts.begin(), hosts.end(), host);
  return static_cast<int>(
    std::clamp<long>(cores / neighbours, 1, static_cast<long>(avianlidar::loopThreads(0))));
}

//------------------------------------------------------------------------------
int vtkAvianLidarRanks::UpdateInputs(vtkAlgorithm* self, vtkInformation* request, int when)
{
  vtkAvianLidarGuard::NoteInputs(self, request, when);
  if (when != vtkExecutive::BeforeForward || !request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()))
  {
    return 1;
  }
  vtkInformationVector* outputs = self->GetExecutive()->GetOutputInformation();
  if (!vtkAvianLidarGuard::FailedBefore(self, outputs).empty())
  {
    return 1;
  }
  return vtkAvianLidarRanks(request, outputs)
    .Run(self,
      [&](const vtkAvianLidarRanks& ranks) -> int
      {
        if (ranks.Alone())
        {
          return 1; // the executive does it
        }
        const Outcome outcome = ranks.Together(self,
          [&]() -> std::string
          {
            bool good = true;
            for (int input = 0; input < self->GetNumberOfInputPorts(); ++input)
            {
              for (int i = 0; i < self->GetNumberOfInputConnections(input); ++i)
              {
                good = UpdateInput(self, request, input, i) && good;
              }
            }
            return good ? ""
                        : "What is needed could not be made, see the errors of filters upstream";
          });
        return outcome == Outcome::Failed ? 0 : 1;
      });
}
