// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarGuard.h"

#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarText.h"

#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkInformationVector.h"

namespace
{
namespace Arrays = vtkAvianLidarArrays;

constexpr char ProducerFailed[] = ": its producer failed: ";

bool IsEmpty(vtkDataObject* data)
{
  return !data ||
    data->GetNumberOfElements(vtkDataObject::POINT) +
      data->GetNumberOfElements(vtkDataObject::CELL) ==
    0;
}

/// The error text in the field data of `data` or of a block of `data`; empty without an error.
std::string ErrorOf(vtkDataObject* data)
{
  // Outputs of a failed filter are empty, except images. A field `error` of other data is the
  // user's.
  const bool may = data && (IsEmpty(data) || data->IsA("vtkImageData"));
  std::string error = may ? Arrays::TextAt(data->GetFieldData(), Arrays::Error, 0) : std::string();
  if (auto* blocks = vtkCompositeDataSet::SafeDownCast(data))
  {
    auto each = vtkSmartPointer<vtkCompositeDataIterator>::Take(blocks->NewIterator());
    if (auto* nodes = vtkDataObjectTreeIterator::SafeDownCast(each))
    {
      nodes->VisitOnlyLeavesOff(); // a failed filter may have made a composite, which is a node
    }
    for (each->InitTraversal(); error.empty() && !each->IsDoneWithTraversal(); each->GoToNextItem())
    {
      vtkDataObject* block = each->GetCurrentDataObject();
      error =
        IsEmpty(block) ? Arrays::TextAt(block->GetFieldData(), Arrays::Error, 0) : std::string();
    }
  }
  return error;
}

/// The error text of an input, or the error code of a VTK reader whose output is empty.
std::string ErrorOfInput(vtkAlgorithm* self, int port, int connection)
{
  vtkDataObject* data = self->GetInputDataObject(port, connection);
  vtkAlgorithm* producer = self->GetInputAlgorithm(port, connection);
  const std::string error = ErrorOf(data);
  const bool hasCode = producer && producer->GetErrorCode() != vtkErrorCode::NoError;
  return error.empty() && hasCode && IsEmpty(data)
    ? vtkErrorCode::GetStringFromErrorCode(producer->GetErrorCode())
    : error;
}

/// An error text that names the first input whose producer failed; empty if no producer failed.
std::string ErrorOfInputs(vtkAlgorithm* self)
{
  for (int port = 0; port < self->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < self->GetNumberOfInputConnections(port); ++i)
    {
      std::string error = ErrorOfInput(self, port, i);
      if (!error.empty())
      {
        // Keep only the text of the first error, without the texts of the filters downstream.
        const auto first = error.rfind(ProducerFailed);
        error.erase(0, first == std::string::npos ? 0 : first + sizeof(ProducerFailed) - 1);
        return "Input port " + std::to_string(port) + ProducerFailed + error;
      }
    }
  }
  return {};
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarGuard::CheckStart(vtkAlgorithm* self)
{
  vtkAvianLidarRequire(ErrorOfInputs(self));
  vtkAvianLidarAbort::StopIfWanted(self);
}

//------------------------------------------------------------------------------
std::vector<vtkMTimeType> vtkAvianLidarGuard::TimesOf(vtkInformationVector* outputs)
{
  std::vector<vtkMTimeType> times;
  for (int port = 0; port < outputs->GetNumberOfInformationObjects(); ++port)
  {
    vtkDataObject* output = vtkDataObject::GetData(outputs, port);
    times.push_back(output ? output->GetMTime() : 0);
  }
  return times;
}

//------------------------------------------------------------------------------
void vtkAvianLidarGuard::EmptyUnlessChanged(vtkAlgorithm* self, vtkInformationVector* outputs,
  const std::vector<vtkMTimeType>& before) noexcept
try
{
  const std::vector<vtkMTimeType> now = TimesOf(outputs);
  const std::string known = ErrorOfInputs(self);
  const std::string error =
    Sentence(known.empty() ? "An input is missing, or its producer failed" : known);
  for (std::size_t port = 0; port < now.size() && port < before.size(); ++port)
  {
    vtkDataObject* output = vtkDataObject::GetData(outputs, static_cast<int>(port));
    if (output && now[port] == before[port])
    {
      output->Initialize();
      Arrays::SetFieldStrings(output->GetFieldData(), Arrays::Error, { error });
    }
  }
}
catch (...)
{
  // There is no memory for the text. The request has failed already.
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarGuard::Sentence(const std::string& problem)
{
  const std::string text = vtkAvianLidarText(problem);
  return text.empty() || text.back() == '.' ? text : text + ".";
}

//------------------------------------------------------------------------------
void vtkAvianLidarGuard::Empty(vtkInformationVector* outputs, const std::string& error)
{
  for (int port = 0; port < outputs->GetNumberOfInformationObjects(); ++port)
  {
    if (vtkDataObject* output = vtkDataObject::GetData(outputs, port))
    {
      output->Initialize();
      if (!error.empty())
      {
        Arrays::SetFieldStrings(output->GetFieldData(), Arrays::Error, { error });
      }
    }
  }
}
