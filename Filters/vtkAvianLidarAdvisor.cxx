// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarAdvisor.h"

#include "Advice.h"
#include "ValueError.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarAdviceNotes.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarScanFilterInternals.h"

#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <array>
#include <functional>
#include <vector>

vtkStandardNewMacro(vtkAvianLidarAdvisor);

namespace
{
using Outcome = vtkAvianLidarRanks::Outcome;
using avianlidar::AdviceTrial;

constexpr int FewestBeams = 50;
constexpr int MostBeams = 1000000;

template <class ArrayT, class Get>
void AddTrialColumn(const avianlidar::AdviceAnswer& answer, vtkTable* table, const char* name,
  const char* unit, Get get)
{
  const vtkAvianLidarArrays::Name column{ name, unit };
  auto array =
    vtkAvianLidarArrays::Make<ArrayT>(column, static_cast<vtkIdType>(answer.trials.size()));
  for (std::size_t t = 0; t < answer.trials.size(); ++t)
  {
    array->SetValue(static_cast<vtkIdType>(t), get(answer.trials[t]));
  }
  table->AddColumn(array);
}

void FillTrials(const avianlidar::AdviceAnswer& a, vtkTable* table)
{
  const auto whole = [&](const char* name, auto get)
  { AddTrialColumn<vtkIntArray>(a, table, name, "1", get); };
  whole("beam_samples", [](const AdviceTrial& t) { return static_cast<int>(t.settings.samples); });
  whole("rays_per_beam", [](const AdviceTrial& t) { return t.settings.rays; });
  whole("sampling", [](const AdviceTrial& t) { return static_cast<int>(t.settings.sampling); });
  whole("number_of_reflections", [](const AdviceTrial& t) { return t.settings.reflections; });
  whole("number_of_connections", [](const AdviceTrial& t) { return t.settings.connections; });
  whole("turns", [](const AdviceTrial& t) { return t.turns; });
  whole("verdict", [](const AdviceTrial& t) { return static_cast<int>(t.verdict); });
  AddTrialColumn<vtkDoubleArray>(
    a, table, "seconds_per_beam", "s", [](const AdviceTrial& t) { return t.seconds; });
  const char* const names[][2] = { { "energy_error", "energy_error_most" },
    { "range_error", "range_error_most" }, { "missed_share", "missed_share_most" } };
  for (int error = 0; error < avianlidar::ErrorKinds; ++error)
  {
    const char* unit = error == avianlidar::RangeError ? "m" : "1";
    AddTrialColumn<vtkDoubleArray>(a, table, names[error][0], unit,
      [error](const AdviceTrial& t) { return t.errors[error].value; });
    AddTrialColumn<vtkDoubleArray>(a, table, names[error][1], unit,
      [error](const AdviceTrial& t) { return t.errors[error].high; });
  }
}
}

//------------------------------------------------------------------------------
vtkAvianLidarAdvisor::vtkAvianLidarAdvisor()
{
  this->SetNumberOfOutputPorts(1);
}

//------------------------------------------------------------------------------
int vtkAvianLidarAdvisor::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkTable");
  return 1;
}

//------------------------------------------------------------------------------
vtkTable* vtkAvianLidarAdvisor::GetTable()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(0));
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarAdvisor::CheckQuestion() const
{
  const std::pair<const char*, double> asked[] = { { "EnergyError", this->EnergyError },
    { "RangeError", this->RangeError }, { "MissedShare", this->MissedShare } };
  for (const auto& [name, value] : asked)
  {
    if (!(value > 0.0 && value <= 1e30))
    {
      return avianlidar::valueError(name, value, "an error that is allowed, above 0");
    }
  }
  return this->SampleBeams >= FewestBeams && this->SampleBeams <= MostBeams
    ? std::string()
    : avianlidar::valueError("SampleBeams", this->SampleBeams, "50 to 1000000 beams");
}

//------------------------------------------------------------------------------
int vtkAvianLidarAdvisor::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInternals& in = *this->Internals;
  this->Take({});
  in.Setup.settings.noise = false;
  in.Setup.settings.returnMode = static_cast<avianlidar::ReturnMode>(this->ReturnMode);
  return vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks) -> int
    {
      vtkPolyData* beams = vtkPolyData::GetData(inputVector[0]);
      vtkDataObject* surfaces = vtkDataObject::GetData(inputVector[1]);
      vtkTable* table = vtkTable::GetData(outputVector, 0);
      vtkAvianLidarRanks::Settings own;
      own.Add("EnergyError", this->EnergyError);
      own.Add("RangeError", this->RangeError);
      own.Add("MissedShare", this->MissedShare);
      own.Add("SampleBeams", this->SampleBeams);
      const bool done = in.GoOn(ranks.Together(this, [this] { return this->CheckQuestion(); })) &&
        this->PrepareBeams(ranks, beams) && in.GoOn(ranks.AgreeOn(this, own)) &&
        in.GoOn(in.Beams.CheckRanks(ranks, this, vtkInternals::WrongWithBeams)) &&
        this->PrepareSurfaces(ranks, surfaces) &&
        this->PrepareMovers(ranks, vtkDataObject::GetData(inputVector[2])) &&
        this->PrepareTree(ranks, surfaces) && this->Advise(ranks, table);
      if (!done)
      {
        table->Initialize();
      }
      return in.Last == Outcome::Failed ? 0 : 1; // stopped: empty and valid
    });
}

//------------------------------------------------------------------------------
bool vtkAvianLidarAdvisor::Advise(const vtkAvianLidarRanks& ranks, vtkTable* table)
{
  vtkInternals& in = *this->Internals;
  avianlidar::AdviceHost host;
  host.together = [&](const std::function<void()>& step)
  {
    return in.GoOn(ranks.Together(this,
      [&step]() -> std::string
      {
        step();
        return {};
      }));
  };
  host.sum = [&ranks](double mine) { return ranks.Sum(mine); };
  host.largest = [&ranks](double mine) { return ranks.Largest(mine); };
  host.keepGoing = vtkAvianLidarAbort::KeepGoing(this, vtkInternals::BuildShare, 1.0);
  const avianlidar::AdviceQuestion question{
    { { this->EnergyError, this->RangeError, this->MissedShare } }, this->SampleBeams, in.Threads
  };
  avianlidar::AdviceAnswer answer;
  return avianlidar::advise(in.Setup, in.Beams.beams, question, host, answer) &&
    in.GoOn(ranks.Together(this,
      [&]() -> std::string
      {
        this->Take(answer);
        const auto lines = vtkAvianLidarAdviceNotes::Lines(in.Setup, question, answer);
        for (const std::string& line : lines)
        {
          this->Advice += line + "\n";
        }
        if (ranks.Rank() == 0)
        {
          FillTrials(answer, table); // the same on all: one has it
        }
        vtkAvianLidarArrays::SetFieldInteger(
          table->GetFieldData(), { "advised", "" }, answer.advised);
        vtkAvianLidarArrays::SetFieldStrings(table->GetFieldData(), { "advice", "" }, lines);
        return {};
      }));
}

//------------------------------------------------------------------------------
void vtkAvianLidarAdvisor::Take(const avianlidar::AdviceAnswer& answer)
{
  this->Advice.clear();
  const bool any = answer.advised >= 0;
  const avianlidar::AdviceSettings s =
    any ? answer.trials[answer.advised].settings : avianlidar::AdviceSettings{};
  this->AdvisedBeamSamples = any ? static_cast<int>(s.samples) : -1;
  this->AdvisedRaysPerBeam = any ? s.rays : -1;
  this->AdvisedSampling = any ? static_cast<int>(s.sampling) : -1;
  this->AdvisedNumberOfReflections = any ? s.reflections : -1;
  this->AdvisedNumberOfConnections = any ? s.connections : -1;
}

//------------------------------------------------------------------------------
void vtkAvianLidarAdvisor::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "EnergyError: " << this->EnergyError << "\n";
  os << indent << "RangeError: " << this->RangeError << " m\n";
  os << indent << "MissedShare: " << this->MissedShare << "\n";
  os << indent << "SampleBeams: " << this->SampleBeams << "\n";
  os << indent << "AdvisedBeamSamples: " << this->AdvisedBeamSamples << "\n";
  os << indent << "AdvisedRaysPerBeam: " << this->AdvisedRaysPerBeam << "\n";
  os << indent << "AdvisedSampling: " << this->AdvisedSampling << "\n";
  os << indent << "AdvisedNumberOfReflections: " << this->AdvisedNumberOfReflections << "\n";
  os << indent << "AdvisedNumberOfConnections: " << this->AdvisedNumberOfConnections << "\n";
  os << indent << "Advice: " << this->Advice << "\n";
}
