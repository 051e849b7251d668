// SPDX-License-Identifier: BSD-3-Clause
// A filter of which one rank throws between exchanges. TestRanksThrow.py loads it.

#include "vtkAvianLidarRanks.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyDataAlgorithm.h"

#include <stdexcept>

namespace
{
class ThrowingFilter : public vtkPolyDataAlgorithm
{
public:
  static ThrowingFilter* New();
  vtkTypeMacro(ThrowingFilter, vtkPolyDataAlgorithm);

  vtkMultiProcessController* GetController()
  {
    return vtkMultiProcessController::GetGlobalController();
  }
  bool GetErrorsAsData() const { return false; }

  int Who = -1;          ///< rank that throws
  int Where = 0;         ///< before which exchange; 4: after the last
  bool Anything = false; ///< throws what is no std::exception

protected:
  ThrowingFilter() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    outputs->GetInformationObject(0)->Set(CAN_HANDLE_PIECE_REQUEST(), 1); // else rank 0 alone runs
    return 1;
  }

  int RequestData(
    vtkInformation* request, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    return vtkAvianLidarRanks::Execute(this, request, outputs,
      [&](const vtkAvianLidarRanks& ranks) -> int
      {
        const auto pass = [&](int where)
        {
          if (where == this->Where && ranks.Rank() == this->Who)
          {
            if (this->Anything)
            {
              throw 7;
            }
            throw std::runtime_error("A planted error");
          }
        };
        pass(0);
        const double size = ranks.Sum(1.0);
        pass(1);
        vtkMultiProcessStream mine;
        mine << ranks.Rank();
        const auto all = ranks.Gather(mine);
        pass(2);
        const bool same = ranks.Same(3);
        pass(3);
        const auto done = ranks.Together(this, []() { return std::string(); });
        pass(4);
        return same && size == static_cast<double>(all.size()) &&
          done == vtkAvianLidarRanks::Outcome::Done;
      });
  }

private:
  ThrowingFilter(const ThrowingFilter&) = delete;
  void operator=(const ThrowingFilter&) = delete;
};
vtkStandardNewMacro(ThrowingFilter);

vtkNew<ThrowingFilter>& Filter()
{
  static vtkNew<ThrowingFilter> filter;
  return filter;
}
}

/// The filter, to observe it.
extern "C" void* throwing_rank_filter()
{
  return Filter().Get();
}

/// Update as one of all ranks. @return 1 if all went well
extern "C" int throwing_rank_update(int who, int where, bool anything)
{
  ThrowingFilter* filter = Filter();
  filter->Who = who;
  filter->Where = where;
  filter->Anything = anything;
  filter->Modified();
  vtkMultiProcessController* ranks = filter->GetController();
  return filter->UpdatePiece(ranks->GetLocalProcessId(), ranks->GetNumberOfProcesses(), 0);
}
