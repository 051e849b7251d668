// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarRanks.h
 * @brief The MPI ranks that execute a request together: what they agree on, and what one of them
 * gives to all. Not installed.
 *
 * Ranks execute together when the global controller has several processes and each asks for its own
 * piece of as many: so pvserver and pvbatch do. Any other request (one piece, or pieces of one's
 * own making) is a rank's own affair: nothing is sent, nobody waits.
 *
 * All ranks must make the same calls in the same order. So whatever may fail on one of them stands
 * in a step, after which all know and go the same way. Where one fails all the same between steps
 * (no memory for a list of a few bytes a rank), it cannot tell the others: it ends the job.
 */
#ifndef vtkAvianLidarRanks_h
#define vtkAvianLidarRanks_h

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

class vtkAlgorithm;
class vtkInformation;
class vtkInformationVector;
class vtkMultiProcessController;

class vtkAvianLidarRanks
{
public:
  enum class Outcome
  {
    Done,
    Stopped, ///< somebody wants the work to end: empty outputs, no error
    Failed   ///< the error was reported
  };

  using Body = std::function<int(const vtkAvianLidarRanks&)>;

  /// Run the body of a RequestData for those that execute the request, unless the producer of an
  /// input of one of them failed. It returns 0 or 1; no exception leaves it. What becomes of a
  /// failure: see vtkAvianLidarGuarded().
  template <class Filter>
  static int Execute(
    Filter* self, vtkInformation* request, vtkInformationVector* outputs, const Body& body)
  {
    return Execute(self, request, outputs, self->GetErrorsAsData(), body);
  }

  /// Those that execute a request. @param outputs informations of the output ports
  vtkAvianLidarRanks(vtkInformation* request, vtkInformationVector* outputs);

  bool Alone() const { return this->Controller == nullptr; }
  int Rank() const { return this->Mine; }
  int Size() const { return this->Count; }

  /// Do one's own part and hear how the others fared: the answer is the same on all ranks.
  /// @param step returns what is wrong, or nothing; throws avianlidar::WorkStopped to stop. Its
  /// errors are reported by `self`: on the rank itself, and on rank 0 with the rank's number.
  /// Alone, what it throws is not caught.
  Outcome Together(vtkAlgorithm* self, const std::function<std::string()>& step) const;

  /// True if it is so on every rank.
  bool All(bool mine) const;

  /// The sum over all ranks.
  double Sum(double mine) const;

  /// The largest on any rank.
  double Largest(double mine) const;

  /// The sums over all ranks of lists of one length. The places for them must be there.
  void Sum(const std::vector<std::int64_t>& mine, std::vector<std::int64_t>& sums) const;

  /// True if every rank has the same value.
  bool Same(std::uint64_t mine) const;

  /// A few bytes of every rank, by rank. Throws on all ranks if they are more than one message can
  /// hold (2 GiB together), or more than one of the ranks has memory for.
  std::vector<std::string> Gather(const std::string& mine) const;

  /// Give what rank `from` has to all. The places must be there: nothing here can fail.
  void Broadcast(void* data, std::size_t bytes, int from) const;

  /// Threads of a loop asked for `wanted`: that many, or for 0 this rank's share of the cores of
  /// its node (OMP_NUM_THREADS, where it is set, is a rank's share already).
  /// All ranks must call it.
  int Threads(int wanted) const;

  /// Update the inputs of an algorithm before its executive does, so that an error upstream of one
  /// rank ends the execution of all. For vtkAlgorithm::ModifyRequest(). @return 0 if there was one
  static int UpdateInputs(vtkAlgorithm* self, vtkInformation* request, int when);

private:
  /// What is thrown on all ranks at the same place.
  struct KnownToAll;

  static int Execute(vtkAlgorithm* self, vtkInformation* request, vtkInformationVector* outputs,
    bool errorsAsData, const Body& body);
  bool Run(vtkAlgorithm* self, const Body& body) const;
  int RunOrEndJob(vtkAlgorithm* self, const Body& body) const;

  vtkMultiProcessController* Controller = nullptr; ///< null: alone
  int Mine = 0;
  int Count = 1;
  mutable std::string Problem; ///< the last one, on all ranks
};

#endif
