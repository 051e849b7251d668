// SPDX-License-Identifier: BSD-3-Clause
// The sensor as field data of its beams.
#include "vtkAvianLidarBeamSource.h"

#include "ScanPattern.h"
#include "vtkAvianLidarArrays.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"

namespace
{
namespace Arrays = vtkAvianLidarArrays;

void SetVector(vtkFieldData* fields, const Arrays::Name& name, const double* values, int components)
{
  auto array = Arrays::Make<vtkDoubleArray>(name, 1, components);
  array->SetTypedTuple(0, values);
  fields->AddArray(array);
}

void SetInteger(vtkFieldData* fields, const Arrays::Name& name, int value)
{
  auto array = Arrays::Make<vtkIntArray>(name, 1);
  array->SetValue(0, value);
  fields->AddArray(array);
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamSource::AddSensor(int revolution, vtkFieldData* fields) const
{
  SetVector(fields, Arrays::Position, this->Position, 3);
  SetVector(fields, Arrays::Orientation, this->Orientation, 3);
  SetInteger(fields, Arrays::NumberOfChannels, avianlidar::numberOfChannels(this->MakePattern()));
  Arrays::SetFieldValue(fields, Arrays::MinimumElevation, this->MinimumElevation);
  Arrays::SetFieldValue(fields, Arrays::ElevationStep, this->ElevationStep);
  if (!this->ChannelElevations.empty())
  {
    auto table =
      Arrays::Make<vtkDoubleArray>(Arrays::ChannelElevations, this->GetNumberOfChannelElevations());
    for (int channel = 0; channel < this->GetNumberOfChannelElevations(); ++channel)
    {
      table->SetValue(channel, this->ChannelElevations[channel]);
    }
    fields->AddArray(table);
  }
  SetVector(fields, Arrays::AzimuthRange, this->AzimuthRange, 2);
  Arrays::SetFieldValue(fields, Arrays::AzimuthStep, this->AzimuthStep);
  Arrays::SetFieldValue(fields, Arrays::HalfBeamwidth, this->HalfBeamwidth);
  SetInteger(fields, Arrays::BeamProfile, this->BeamProfile);
  Arrays::SetFieldValue(fields, Arrays::RotationRate, this->RotationRate);
  Arrays::SetFieldValue(fields, Arrays::FiringInterval, this->FiringInterval);
  SetInteger(fields, Arrays::NumberOfRevolutions, this->NumberOfRevolutions);
  SetInteger(fields, Arrays::StepsPerRevolution, this->StepsPerRevolution);
  SetInteger(fields, Arrays::Revolution, revolution);
  Arrays::SetFieldValue(fields, Arrays::PulseEnergy, this->PulseEnergy);
  Arrays::SetFieldValue(fields, Arrays::PulseWidth, this->PulseWidth);
  Arrays::SetFieldValue(fields, Arrays::Frequency, this->Frequency);
  Arrays::SetFieldValue(fields, Arrays::SamplingInterval, this->SamplingInterval);
  Arrays::SetFieldValue(fields, Arrays::RangeGate, this->RangeGate);
  Arrays::SetFieldValue(fields, Arrays::NoisePhotonRate, this->NoisePhotonRate);
  Arrays::SetFieldValue(fields, Arrays::LowerEnergyLimit, this->LowerEnergyLimit);
  Arrays::SetFieldValue(fields, Arrays::UpperEnergyLimit, this->UpperEnergyLimit);
  Arrays::SetFieldValue(fields, Arrays::ReceiverAperture, this->ReceiverAperture);
  Arrays::SetFieldValue(fields, Arrays::DisplayLength, this->DisplayLength);
}
