// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarRevolutions.h"

#include "vtkAvianLidarPassedKey.h"

#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <vector>

namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

/// Indices of the numbers under the key: rotation rate, Hz; steps of a revolution; number of
/// published steps (0 for a single step); time of the last step, s. The number of steps and the
/// last time show whether a filter has changed the steps.
enum
{
  Rate,
  Steps,
  Count,
  Last,
  Size
};

vtkAvianLidarPassedKey* Revolutions()
{
  static vtkAvianLidarPassedKey* const key =
    new vtkAvianLidarPassedKey("REVOLUTIONS", "vtkAvianLidarBeamSource", Size);
  return key;
}

/// Start of the revolution that contains `time`, s; `time` itself if the start is unknown.
double StartOf(vtkInformation* beams, double time)
{
  if (!Revolutions()->Has(beams) || !beams->Has(Pipeline::TIME_RANGE()))
  {
    return time;
  }
  const double* values = Revolutions()->Get(beams);
  const int count = beams->Length(Pipeline::TIME_STEPS());
  const double last = count > 0 ? beams->Get(Pipeline::TIME_STEPS())[count - 1]
                                : beams->Get(Pipeline::TIME_RANGE())[1];
  if (count != values[Count] || last != values[Last])
  {
    return time;
  }
  avianlidar::ScanClock clock;
  clock.rotationRate = values[Rate];
  clock.steps = static_cast<int>(values[Steps]);
  avianlidar::ScanMoment moment;
  return avianlidar::momentAt(clock, time, moment).empty()
    ? avianlidar::timeOf(clock, { moment.revolution, 0 })
    : time;
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarRevolutions::Publish(const avianlidar::ScanClock& clock, vtkInformation* output)
{
  const std::vector<double> times = avianlidar::timesOf(clock);
  const double range[2] = { times.front(), times.back() };
  // A single step is not listed, because ParaView would add it to the steps of all other sources.
  // With the range, VTK executes again for another time.
  const int count = times.size() > 1 ? static_cast<int>(times.size()) : 0;
  output->Remove(Pipeline::TIME_STEPS());
  if (count > 0)
  {
    output->Set(Pipeline::TIME_STEPS(), times.data(), count);
  }
  output->Set(Pipeline::TIME_RANGE(), range, 2);
  const double values[Size] = { clock.rotationRate, static_cast<double>(clock.steps),
    static_cast<double>(count), times.back() };
  Revolutions()->Set(output, values, Size);
}

//------------------------------------------------------------------------------
void vtkAvianLidarRevolutions::ChooseSteps(
  vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkInformation* beams = inputs[0]->GetInformationObject(0);
  vtkInformation* scene = inputs[1]->GetInformationObject(0);
  vtkInformation* movers = inputs[2]->GetInformationObject(0);
  if (!scene->Has(Pipeline::TIME_RANGE()) && movers)
  {
    scene = movers;
  }
  if (beams->Has(Pipeline::TIME_STEPS()) ||
    (beams->Has(Pipeline::TIME_RANGE()) && !scene->Has(Pipeline::TIME_RANGE())))
  {
    return; // the pipeline has copied the steps of the beams
  }
  for (int port = 0; port < outputs->GetNumberOfInformationObjects(); ++port)
  {
    vtkInformation* output = outputs->GetInformationObject(port);
    output->CopyEntry(scene, Pipeline::TIME_STEPS());
    output->CopyEntry(scene, Pipeline::TIME_RANGE());
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarRevolutions::AskForStart(vtkInformationVector** inputs)
{
  vtkInformation* beams = inputs[0]->GetInformationObject(0);
  for (const int port : { 1, 2 })
  {
    vtkInformation* scene = inputs[port]->GetInformationObject(0);
    if (scene && scene->Has(Pipeline::UPDATE_TIME_STEP()))
    {
      scene->Set(
        Pipeline::UPDATE_TIME_STEP(), StartOf(beams, scene->Get(Pipeline::UPDATE_TIME_STEP())));
    }
  }
}

//------------------------------------------------------------------------------
vtkInformation* vtkAvianLidarRevolutions::NoteTime(
  vtkInformation* request, vtkInformationVector* outputs)
{
  const int port = std::max(0, request->Get(vtkExecutive::FROM_OUTPUT_PORT()));
  vtkInformation* asked = outputs->GetInformationObject(port);
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    if (asked->Has(Pipeline::UPDATE_TIME_STEP()))
    {
      vtkDataObject::GetData(outputs, i)
        ->GetInformation()
        ->Set(vtkDataObject::DATA_TIME_STEP(), asked->Get(Pipeline::UPDATE_TIME_STEP()));
    }
  }
  return asked;
}
