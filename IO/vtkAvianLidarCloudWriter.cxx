// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarCloudWriter.h"

#include "vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarText.h"

#include "vtkErrorCode.h"
#include "vtkInformation.h"
#include "vtkPointSet.h"

#include <cstring>

//------------------------------------------------------------------------------
vtkAvianLidarCloudWriter::~vtkAvianLidarCloudWriter()
{
  this->SetFileName(nullptr);
  this->SetGivenFileName(nullptr);
}

//------------------------------------------------------------------------------
void vtkAvianLidarCloudWriter::SetMadeFileName(const char* name)
{
  const bool bare = this->GivenFileName && !std::strpbrk(this->GivenFileName, "/\\");
  this->SetFileName(bare && name && *name == '/' ? name + 1 : name);
}

//------------------------------------------------------------------------------
int vtkAvianLidarCloudWriter::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPointSet");
  return 1;
}

//------------------------------------------------------------------------------
void vtkAvianLidarCloudWriter::WriteData()
{
  auto* input = vtkPointSet::SafeDownCast(this->GetInput());
  this->SetErrorCode(vtkErrorCode::UserError);
  if (!this->FileName || !*this->FileName)
  {
    this->SetErrorCode(vtkErrorCode::NoFileNameError);
    vtkErrorMacro("FileName is not set, expected the name of the file to write.");
    return;
  }
  const auto write = [&]
  {
    vtkAvianLidarGuard::CheckStart(this);
    this->WriteCloud(input);
    this->SetErrorCode(vtkErrorCode::NoError);
    this->UpdateProgress(1.0);
  };
  const std::string problem = vtkAvianLidarGuard::ProblemOf(
    [&]
    {
      vtkAvianLidarCloudFields::Within(
        this->FileName, "there is not enough memory to write the file", write);
    });
  if (!problem.empty())
  {
    vtkErrorMacro("" << vtkAvianLidarText(problem) << ".");
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarCloudWriter::Warn(const std::string& text)
{
  vtkWarningMacro("" << vtkAvianLidarText(this->FileName + text));
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarCloudWriter, FileName, GivenFileName);
