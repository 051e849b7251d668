// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarScanStream.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarRequire.h"

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"

#include <algorithm>
#include <cmath>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
}

//------------------------------------------------------------------------------
double vtkAvianLidarScanStream::TimeOf(vtkDataObject* cloud) const
{
  vtkFieldData* fields = cloud->GetFieldData();
  double revolution = 0.0;
  double rate = 0.0;
  double steps = 0.0;
  const bool turns = Arrays::GetFieldValue(fields, Arrays::Revolution, revolution) &&
    Arrays::GetFieldValue(fields, Arrays::RotationRate, rate) && rate > 0.0;
  if (turns && Arrays::GetFieldValue(fields, Arrays::StepsPerRevolution, steps) && steps > 1.0)
  {
    return revolution / rate;
  }
  if (cloud->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()))
  {
    const double time = cloud->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP());
    vtkAvianLidarRequire(std::isfinite(time) ? "" : "its time is not a finite number");
    return time;
  }
  const bool same = this->Cloud == cloud && this->MadeAt == Made(cloud);
  double time = turns ? revolution / rate : !this->Has ? 0.0 : this->Last + (same ? 0.0 : 1.0);
  Arrays::ReadFieldValue(fields, Arrays::TimeValue, time);
  return time;
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanStream::Accept(vtkDataObject* cloud, double time)
{
  this->Has = true;
  this->Last = time;
  this->Cloud = cloud;
  this->MadeAt = Made(cloud);
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanStream::ReadPosition(vtkDataObject* cloud, double position[3])
{
  vtkFieldData* fields = cloud->GetFieldData();
  if (!fields || !fields->GetAbstractArray(Arrays::Position.name))
  {
    return;
  }
  vtkDataArray* array = fields->GetArray(Arrays::Position.name);
  bool good = array && array->GetNumberOfTuples() == 1 && array->GetNumberOfComponents() == 3;
  for (int axis = 0; good && axis < 3; ++axis)
  {
    position[axis] = array->GetComponent(0, axis);
    good = std::isfinite(position[axis]);
  }
  vtkAvianLidarRequire(good ? "" : "field data 'position' are not 3 finite numbers");
}

//------------------------------------------------------------------------------
vtkMTimeType vtkAvianLidarScanStream::Made(vtkDataObject* cloud)
{
  return std::max(cloud->GetMTime(), cloud->GetUpdateTime());
}
