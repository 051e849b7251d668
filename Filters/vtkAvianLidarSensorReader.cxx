// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSensorReader.h"

#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"

#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkAvianLidarSensorReader);

//------------------------------------------------------------------------------
vtkAvianLidarSensorReader::vtkAvianLidarSensorReader()
  : FileName(nullptr)
{
  this->Reload();
}

//------------------------------------------------------------------------------
vtkAvianLidarSensorReader::~vtkAvianLidarSensorReader()
{
  delete[] this->FileName;
}

//------------------------------------------------------------------------------
void vtkAvianLidarSensorReader::SetFileName(const char* fileName)
{
  const vtkMTimeType before = this->GetMTime();
  vtkSetStringBodyMacro(FileName, fileName);
  if (this->GetMTime() != before)
  {
    this->Reload();
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarSensorReader::Reload()
{
  this->Problem = this->FileName && *this->FileName
    ? this->ReadSensor(this->FileName, true)
    : "FileName is not set, expected the name of a .lidarsensor.json file";
  this->Modified();
}

//------------------------------------------------------------------------------
int vtkAvianLidarSensorReader::RequestData(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  if (this->Problem.empty())
  {
    return this->Superclass::RequestData(request, inputs, outputs);
  }
  return vtkAvianLidarGuarded(this, outputs, [this]() { vtkAvianLidarRequire(this->Problem); });
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarSensorReader, FileName);
