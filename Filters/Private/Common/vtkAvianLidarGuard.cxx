// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarGuard.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarText.h"

#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <set>
#include <sstream>

namespace
{
namespace Arrays = vtkAvianLidarArrays;

constexpr char ProducerFailed[] = ": its producer failed: ";

/// Notes in the information of an algorithm.
struct NoteKeys
{
  static vtkInformationStringKey* Make(const char* name)
  {
    return vtkInformationStringKey::MakeKey(name, "vtkAvianLidarGuard");
  }

  vtkInformationStringKey* Failure = Make("FAILURE");              ///< of the last execution
  vtkInformationStringKey* FailedRequest = Make("FAILED_REQUEST"); ///< where errors are data
  vtkInformationStringKey* UpdatedInputs = Make("UPDATED_INPUTS"); ///< for RequestData: their state
  vtkInformationStringKey* LostInputs = Make("LOST_INPUTS");       ///< not updated: their state
};

const NoteKeys& Keys()
{
  static const NoteKeys keys;
  return keys;
}

std::string TextOf(vtkAlgorithm* algorithm, vtkInformationStringKey* key)
{
  vtkInformation* info = algorithm ? algorithm->GetInformation() : nullptr;
  return info && info->Has(key) ? info->Get(key) : "";
}

vtkMTimeType PipelineTime(vtkAlgorithm* algorithm)
{
  auto* pipeline =
    vtkDemandDrivenPipeline::SafeDownCast(algorithm ? algorithm->GetExecutive() : nullptr);
  return pipeline ? pipeline->GetPipelineMTime() : 0;
}

/// A time, and the pieces and times that are asked for.
std::string RequestOf(vtkMTimeType time, vtkInformationVector* outputs)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  std::ostringstream text;
  text.precision(17);
  text << time;
  for (int port = 0; port < outputs->GetNumberOfInformationObjects(); ++port)
  {
    vtkInformation* info = outputs->GetInformationObject(port);
    text << " " << info->Get(Pipeline::UPDATE_PIECE_NUMBER()) << " "
         << info->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) << " "
         << info->Get(Pipeline::UPDATE_TIME_STEP());
  }
  return text.str();
}

/// The last change of all that an algorithm's inputs are made from.
vtkMTimeType LastChange(vtkAlgorithm* consumer, std::set<vtkAlgorithm*>& seen)
{
  vtkMTimeType last = 0;
  for (int port = 0; port < consumer->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < consumer->GetNumberOfInputConnections(port); ++i)
    {
      vtkAlgorithm* producer = consumer->GetInputAlgorithm(port, i);
      if (producer && seen.insert(producer).second)
      {
        last = std::max({ last, producer->GetMTime(), LastChange(producer, seen) });
      }
    }
  }
  return last;
}

/// All that the inputs are made from, its last change, and the request.
std::string StateOfInputs(vtkAlgorithm* self)
{
  std::set<vtkAlgorithm*> makers;
  std::ostringstream text;
  text << RequestOf(LastChange(self, makers), self->GetExecutive()->GetOutputInformation());
  for (const vtkAlgorithm* maker : makers)
  {
    text << " " << static_cast<const void*>(maker);
  }
  return text.str();
}

bool IsEmpty(vtkDataObject* data)
{
  return !data ||
    data->GetNumberOfElements(vtkDataObject::POINT) +
      data->GetNumberOfElements(vtkDataObject::CELL) ==
    0;
}

/// The error of inputs that could not be updated, and have not changed since; else nothing.
std::string ErrorOfLostInputs(vtkAlgorithm* self)
{
  vtkInformation* notes = self->GetInformation();
  notes->Remove(Keys().UpdatedInputs);
  if (!notes->Has(Keys().LostInputs))
  {
    return {};
  }
  notes->Set(
    Keys().LostInputs, StateOfInputs(self)); // filters between may have modified themselves
  const std::string why = std::string(ProducerFailed) + "see the error of that time";
  for (int port = 0; port < self->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < self->GetNumberOfInputConnections(port); ++i)
    {
      if (IsEmpty(self->GetInputDataObject(port, i)))
      {
        return "Input port " + std::to_string(port) + why;
      }
    }
  }
  return "Input port 0 or another" + why;
}

std::string ErrorIn(vtkFieldData* fields)
{
  auto* error =
    fields ? vtkStringArray::SafeDownCast(fields->GetAbstractArray(Arrays::Error.name)) : nullptr;
  return error && error->GetNumberOfValues() > 0 ? error->GetValue(0) : std::string();
}

/// The error that data, or one of their blocks, hold.
std::string ErrorOf(vtkDataObject* data)
{
  // Outputs of what failed are empty, but for images; a field of that name of others is theirs.
  const bool may = data && (IsEmpty(data) || data->IsA("vtkImageData"));
  std::string error = may ? ErrorIn(data->GetFieldData()) : std::string();
  if (auto* blocks = vtkCompositeDataSet::SafeDownCast(data))
  {
    auto each = vtkSmartPointer<vtkCompositeDataIterator>::Take(blocks->NewIterator());
    for (each->InitTraversal(); error.empty() && !each->IsDoneWithTraversal(); each->GoToNextItem())
    {
      vtkDataObject* block = each->GetCurrentDataObject();
      error = IsEmpty(block) ? ErrorIn(block->GetFieldData()) : std::string();
    }
  }
  return error;
}

/// The error of an input or of what it was made from: filters between may have lost it.
std::string ErrorOfInput(
  vtkAlgorithm* consumer, int port, int connection, std::set<vtkAlgorithm*>& seen)
{
  vtkAlgorithm* producer = consumer->GetInputAlgorithm(port, connection);
  std::string error = TextOf(producer, Keys().Failure);
  if (error.empty())
  {
    error = ErrorOf(consumer->GetInputDataObject(port, connection));
  }
  const bool isNew = producer && seen.insert(producer).second;
  for (int p = 0; isNew && p < producer->GetNumberOfInputPorts(); ++p)
  {
    for (int c = 0; error.empty() && c < producer->GetNumberOfInputConnections(p); ++c)
    {
      error = ErrorOfInput(producer, p, c, seen);
    }
  }
  return error;
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarGuard::NoteInputs(vtkAlgorithm* self, vtkInformation* request, int when)
{
  if (!request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()))
  {
    return;
  }
  vtkInformation* notes = self->GetInformation();
  const std::string now = StateOfInputs(self);
  if (when == vtkExecutive::AfterForward)
  {
    notes->Set(Keys().UpdatedInputs, now);
    return;
  }
  const bool lost = notes->Has(Keys().UpdatedInputs); // no RequestData followed
  if (TextOf(self, lost ? Keys().UpdatedInputs : Keys().LostInputs) != now)
  {
    notes->Remove(Keys().LostInputs);
  }
  else if (lost)
  {
    notes->Set(Keys().LostInputs, now);
  }
  notes->Remove(Keys().UpdatedInputs);
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarGuard::FailedInput(vtkAlgorithm* self)
{
  const std::string lost = ErrorOfLostInputs(self);
  std::set<vtkAlgorithm*> seen;
  for (int port = 0; port < self->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < self->GetNumberOfInputConnections(port); ++i)
    {
      std::string error = ErrorOfInput(self, port, i, seen);
      if (error.empty())
      {
        continue;
      }
      // The first error alone, not those of all filters between.
      const auto first = error.rfind(ProducerFailed);
      error.erase(0, first == std::string::npos ? 0 : first + sizeof(ProducerFailed) - 1);
      return "Input port " + std::to_string(port) + ProducerFailed + error;
    }
  }
  return lost;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarGuard::FailedBefore(vtkAlgorithm* self, vtkInformationVector* outputs)
{
  self->GetInformation()->Remove(Keys().UpdatedInputs); // RequestData followed
  return TextOf(self, Keys().FailedRequest) == RequestOf(PipelineTime(self), outputs)
    ? TextOf(self, Keys().Failure)
    : std::string();
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarGuard::Sentence(const std::string& problem)
{
  const std::string text = vtkAvianLidarText(problem);
  return text.empty() || text.back() == '.' ? text : text + ".";
}

//------------------------------------------------------------------------------
int vtkAvianLidarGuard::End(
  vtkAlgorithm* self, vtkInformationVector* outputs, const std::string& problem, bool errorsAsData)
{
  vtkInformation* notes = self->GetInformation();
  notes->Remove(Keys().Failure);
  notes->Remove(Keys().FailedRequest);
  if (problem.empty())
  {
    return 1;
  }
  const std::string error = Sentence(problem);
  notes->Set(Keys().Failure, error);
  if (errorsAsData)
  {
    notes->Set(Keys().FailedRequest, RequestOf(PipelineTime(self), outputs));
  }
  for (int port = 0; port < outputs->GetNumberOfInformationObjects(); ++port)
  {
    if (vtkDataObject* output = vtkDataObject::GetData(outputs, port))
    {
      output->Initialize();
      if (errorsAsData)
      {
        Arrays::SetFieldStrings(output->GetFieldData(), Arrays::Error, { error });
      }
    }
  }
  return errorsAsData;
}

//------------------------------------------------------------------------------
int vtkAvianLidarGuard::GiveUp(vtkAlgorithm* self, vtkInformationVector* outputs)
{
  for (int port = 0; port < outputs->GetNumberOfInformationObjects(); ++port)
  {
    if (vtkDataObject* output = vtkDataObject::GetData(outputs, port))
    {
      output->Initialize();
    }
  }
  try
  {
    vtkErrorWithObjectMacro(self, << NoMemory);
  }
  catch (const std::bad_alloc&)
  {
    // The return value says it.
  }
  return 0;
}
