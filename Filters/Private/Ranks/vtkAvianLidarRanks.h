// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarRanks.h
 * @brief Lets MPI ranks agree on outcomes and exchange data while they execute a request together.
 * Not installed.
 *
 * Ranks execute together when the controller of a filter has several processes, there are as many
 * pieces as processes, and each process requests its own piece, as in pvserver and pvbatch. A rank
 * executes any other request (one piece, or pieces of the user's choice) by itself: the rank sends
 * nothing and does not wait.
 *
 * All ranks must make the same calls in the same order. If a rank throws between two calls, the
 * next call throws on all ranks, and the error becomes the error of all ranks. So the execution
 * ends on all ranks, and its errors are shared once. If memory runs out while data or errors are
 * sent, the rank ends the job, because the other ranks would wait for ever.
 */
#ifndef vtkAvianLidarRanks_h
#define vtkAvianLidarRanks_h

#include "vtkCommunicator.h"
#include "vtkMultiProcessStream.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

class vtkAlgorithm;
class vtkDataArray;
class vtkDataObject;
class vtkInformation;
class vtkInformationVector;
class vtkMultiProcessController;

class vtkAvianLidarRanks
{
public:
  using Body = std::function<void(const vtkAvianLidarRanks&)>;

  /// Names of settings, and their values as text.
  class Settings
  {
  public:
    template <class T>
    void Add(const char* name, const T& value)
    {
      std::ostringstream text;
      text.precision(17);
      text << value;
      this->Each.emplace_back(name, text.str());
    }

  private:
    friend class vtkAvianLidarRanks;
    std::vector<std::pair<const char*, std::string>> Each;
  };

  /// Run the body of a RequestData on the ranks that execute the request. If the producer of an
  /// input failed on one of these ranks, the body is not run. Returns 0 or 1. No exception leaves
  /// the function. After an error, outputs are empty and hold the message, unless there is no
  /// memory for the message. If the work was stopped, outputs are empty.
  template <class Filter, class Work>
  static int Execute(
    Filter* self, vtkInformation* request, vtkInformationVector* outputs, const Work& body)
  {
    // The body is passed by reference, because a copy takes memory. The other ranks would wait for
    // a rank without memory.
    return Execute(self, vtkAvianLidarRanks(self->GetController(), request, outputs), outputs,
      self->GetErrorsAsData(), std::cref(body));
  }

  /// Run the body of a RequestData on given ranks.
  static int Execute(vtkAlgorithm* self, const vtkAvianLidarRanks& ranks,
    vtkInformationVector* outputs, bool errorsAsData, const Body& body);

  vtkAvianLidarRanks() = default; ///< only this process

  /// The ranks that execute a request. @param controller processes that may work together; null:
  /// only this process
  /// @param outputs information objects of the output ports
  vtkAvianLidarRanks(
    vtkMultiProcessController* controller, vtkInformation* request, vtkInformationVector* outputs);

  bool Alone() const { return this->Controller == nullptr; }
  int Piece() const { return this->Asked; } ///< requested piece; for several ranks, this rank
  const void* Group() const { return this->Controller; } ///< ranks' controller; null: one process
  int Rank() const { return this->Mine; }
  int Size() const { return this->Count; }

  /// Wait for all ranks. Throws on all ranks if one rank threw. To be called before results are
  /// kept that must be the same on all ranks in the next execution.
  void Meet() const { this->All(true); }

  /// Throws on all ranks if a rank's setting differs from the setting of rank 0, because results
  /// would be mixed.
  /// @param mine settings of this rank, with the same names on all ranks
  void AgreeOn(const Settings& mine) const;

  /// True if `mine` is true on every rank.
  bool All(bool mine) const;

  /// The sum of `mine` over all ranks.
  double Sum(double mine) const { return this->Reduce(mine, vtkCommunicator::SUM_OP); }

  /// The largest `mine` of all ranks.
  double Largest(double mine) const { return this->Reduce(mine, vtkCommunicator::MAX_OP); }

  /// True if all ranks that have a value have the same value.
  bool Same(std::optional<std::uint64_t> mine) const;

  /// A few numbers and texts of every rank, by rank. All functions Gather() throw if all
  /// ranks together have 2^31 or more values, which VTK cannot send.
  std::vector<vtkMultiProcessStream> Gather(const vtkMultiProcessStream& mine) const;

  /// The values of all ranks, rank by rank. Requires several processes.
  void Gather(vtkDataArray* mine, vtkDataArray* all) const;

  /// The data objects of all ranks, by rank. Requires several processes.
  std::vector<vtkSmartPointer<vtkDataObject>> Gather(vtkDataObject* mine) const;

  /// Approximate length of VTK's message with a data object, bytes.
  static double BytesOf(vtkDataObject* data);

  /// Length of the longest message that VTK sends, minus room for names and headers, bytes.
  static constexpr double MostBytes = 2147483648.0 - 1048576.0;

  /// An error text for a data object of 2 GiB or more, which VTK cannot send; else an empty string.
  static std::string CheckSize(vtkDataObject* data);

  /// Send rank `from`'s data object, accepted by CheckSize(), to all ranks. Requires several
  /// processes.
  /// @param data data object, overwritten on other ranks @param sent sum of bytes sent, to which
  /// this rank adds its bytes
  void Broadcast(vtkDataObject* data, int from, double& sent) const;

  /// Number of threads of a loop: `wanted`, or for 0 this rank's share of the cores of its node
  /// (OMP_NUM_THREADS, if set, is already the share of a rank). All ranks must call this function.
  int Threads(int wanted) const;

  /// Request this rank's piece of an input. To be called in vtkAlgorithm::RequestUpdateExtent().
  void RequestPiece(vtkInformationVector* input) const;

  /// Request the whole of an input, which may be absent.
  static void RequestAll(vtkInformationVector* input);

  /// Update the inputs of an algorithm before its executive does, so that an error upstream of one
  /// rank ends the execution of all ranks. Otherwise VTK would not call RequestData on a rank whose
  /// producer returned 0, such as a reader without its file, and the other ranks would wait for
  /// ever. To be called in vtkAlgorithm::ModifyRequest(). @return 0 after such an error
  template <class Filter>
  static int UpdateInputs(Filter* self, vtkInformation* request, int when)
  {
    return UpdateInputs(self, self->GetController(), request, when);
  }

private:
  static int UpdateInputs(
    vtkAlgorithm* self, vtkMultiProcessController* controller, vtkInformation* request, int when);
  /// Run the body, and call Share() if it throws on any rank. @return true after success on all
  /// ranks
  bool Run(vtkAlgorithm* self, const Body& body) const;
  /// Share the problem of this rank, and report the first problem of all ranks.
  void Share(vtkAlgorithm* self, const std::string& mine) const;
  double Reduce(double mine, int operation) const;
  /// Call Meet() and Send(), unless there is only one process.
  template <class Work>
  void Exchange(const Work& work) const;
  /// Call `work`, in which all ranks send and receive. Throws if `work` returns 0.
  template <class Work>
  void Send(const Work& work) const;
  std::vector<vtkMultiProcessStream> GatherStreams(const vtkMultiProcessStream& mine) const;

  vtkMultiProcessController* Controller = nullptr; ///< controller of the ranks; null: one process
  int Asked = 0;
  int Mine = 0;
  int Count = 1;
  mutable std::string Problem;     ///< problem that Run() reported; empty if the work was stopped
  mutable bool Exchanging = false; ///< true while data are sent
};

/// Run the body of a RequestData on this process. The body throws an error, or
/// avianlidar::WorkStopped to stop with empty outputs.
template <class Filter, class Body>
int vtkAvianLidarGuarded(Filter* self, vtkInformationVector* outputs, const Body& body)
{
  return vtkAvianLidarRanks::Execute(
    self, {}, outputs, self->GetErrorsAsData(), [&](const vtkAvianLidarRanks&) { body(); });
}

/// Defines what vtkAvianLidarControllerMacro() declares, except SetController().
#define vtkAvianLidarCxxRanksMacro(thisClass)                       \
  vtkMultiProcessController* thisClass::GetController()             \
  {                                                                 \
    return this->Controller;                                        \
  }                                                                 \
  int thisClass::ModifyRequest(vtkInformation* request, int when)   \
  {                                                                 \
    return vtkAvianLidarRanks::UpdateInputs(this, request, when) && \
      this->Superclass::ModifyRequest(request, when);               \
  }

/// Defines what vtkAvianLidarControllerMacro() declares.
#define vtkAvianLidarCxxControllerMacro(thisClass)                              \
  vtkCxxSetSmartPointerMacro(thisClass, Controller, vtkMultiProcessController); \
  vtkAvianLidarCxxRanksMacro(thisClass)

#endif
