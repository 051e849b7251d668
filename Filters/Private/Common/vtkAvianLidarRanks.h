// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarRanks.h
 * @brief The MPI ranks that execute a request together: what they agree on, and what one of them
 * gives to all. Not installed.
 *
 * Ranks execute together when the controller of a filter has several processes and each asks for
 * its own piece of as many: so pvserver and pvbatch do. Any other request (one piece, or pieces of
 * one's own making) is a rank's own affair: nothing is sent, nobody waits.
 *
 * All ranks must make the same calls in the same order. So whatever may fail on one of them stands
 * in a step, after which all know and go the same way. Before each exchange they ask whether all
 * are there: a rank that throws between exchanges says no, and its error is that of all. Only if it
 * throws within an exchange, as for want of memory, the others wait for it, so it ends the job.
 */
#ifndef vtkAvianLidarRanks_h
#define vtkAvianLidarRanks_h

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
  enum class Outcome
  {
    Done,
    Stopped, ///< somebody wants the work to end: empty outputs, no error
    Failed   ///< the error was reported
  };

  using Body = std::function<int(const vtkAvianLidarRanks&)>;

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

  /// Run the body of a RequestData for those that execute the request, unless the producer of an
  /// input of one of them failed. It returns 0 or 1; no exception leaves it. What becomes of a
  /// failure: see vtkAvianLidarGuarded().
  template <class Filter, class Work>
  static int Execute(
    Filter* self, vtkInformation* request, vtkInformationVector* outputs, const Work& body)
  {
    // By reference: a Body of its own takes memory, and a rank without it would be missed by
    // others.
    return Execute(
      self, self->GetController(), request, outputs, self->GetErrorsAsData(), std::cref(body));
  }

  /// Those that execute a request. @param controller of all that may, null: this process alone
  /// @param outputs informations of the output ports
  vtkAvianLidarRanks(
    vtkMultiProcessController* controller, vtkInformation* request, vtkInformationVector* outputs);

  bool Alone() const { return this->Controller == nullptr; }
  const void* Group() const { return this->Controller; } ///< whose ranks they are; null: alone
  int Rank() const { return this->Mine; }
  int Size() const { return this->Count; }

  /// Run this rank's part of a step. The outcome is the same on all ranks.
  /// @param step returns what is wrong, or nothing; throws avianlidar::WorkStopped to stop. Its
  /// errors are reported by `self`: on the rank itself, and on rank 0 with the rank's number.
  Outcome Together(vtkAlgorithm* self, const std::function<std::string()>& step) const;

  /// An error on all ranks if a setting of one is another than on rank 0: they would mix results.
  /// @param mine the same names on all ranks
  Outcome AgreeOn(vtkAlgorithm* self, const Settings& mine) const;

  /// True if it is so on every rank.
  bool All(bool mine) const;

  /// The sum over all ranks.
  double Sum(double mine) const;

  /// The largest on any rank.
  double Largest(double mine) const;

  /// True if all ranks that have a value have the same.
  bool Same(std::optional<std::uint64_t> mine) const;

  /// A few numbers and texts of every rank, by rank. This and what follows throws on all ranks if
  /// VTK cannot send what they have together, 2^31 values or more.
  std::vector<vtkMultiProcessStream> Gather(const vtkMultiProcessStream& mine) const;

  /// The values of all ranks, one rank's after the other's; of ranks that are not alone.
  void Gather(vtkDataArray* mine, vtkDataArray* all) const;

  /// The data objects of all ranks that are not alone, by rank.
  std::vector<vtkSmartPointer<vtkDataObject>> Gather(vtkDataObject* mine) const;

  /// About how long VTK's message with a data object is, bytes.
  static double BytesOf(vtkDataObject* data);

  /// The longest message that VTK sends, less room for names and headers, bytes.
  static constexpr double MostBytes = 2147483648.0 - 1048576.0;

  /// What is wrong with a data object of 2 GiB or more, which VTK cannot send; else nothing.
  static std::string CheckSize(vtkDataObject* data);

  /// Give the data object of rank `from`, whose size is good, to all. They are not alone.
  /// @param data is overwritten on other ranks @param sent bytes that this rank gave are added
  void Broadcast(vtkDataObject* data, int from, double& sent) const;

  /// Threads of a loop asked for `wanted`: that many, or for 0 this rank's share of the cores of
  /// its node (OMP_NUM_THREADS, where it is set, is a rank's share already).
  /// All ranks must call it.
  int Threads(int wanted) const;

  /// Update the inputs of an algorithm before its executive does, so that an error upstream of one
  /// rank ends the execution of all. Without it VTK does not call RequestData on a rank whose
  /// producer returned 0, as a reader does whose file is missing, and the others wait for ever.
  /// For vtkAlgorithm::ModifyRequest(). @return 0 if there was one
  template <class Filter>
  static int UpdateInputs(Filter* self, vtkInformation* request, int when)
  {
    return UpdateInputs(self, self->GetController(), request, when);
  }

private:
  static int Execute(vtkAlgorithm* self, vtkMultiProcessController* controller,
    vtkInformation* request, vtkInformationVector* outputs, bool errorsAsData, const Body& body);
  static int UpdateInputs(
    vtkAlgorithm* self, vtkMultiProcessController* controller, vtkInformation* request, int when);
  bool Run(vtkAlgorithm* self, const Body& body) const;
  int RunTogether(vtkAlgorithm* self, const Body& body) const;
  /// After an exception, null if another rank threw it: its error becomes that of all. @return 0
  int Fail(vtkAlgorithm* self, const char* mine) const noexcept;
  /// Throws on all ranks that are here if one threw. @return the least that any rank says
  int Meet(int mine) const;
  /// Meet, then let all ranks send and receive.
  template <class Work>
  void Exchange(Work work) const;
  /// Give the result of a step to all, and report the first problem.
  Outcome Share(vtkAlgorithm* self, const std::string& mine, bool meet) const;
  std::vector<vtkMultiProcessStream> GatherStreams(const vtkMultiProcessStream& mine) const;

  vtkMultiProcessController* Controller = nullptr; ///< null: alone
  int Mine = 0;
  int Count = 1;
  mutable std::string Problem;     ///< the last one, on all ranks
  mutable bool Exchanging = false; ///< data are under way
};

#endif
