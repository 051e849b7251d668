// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarColourPreset.h"

#include "AvianLidarHSBPreset.h" // made from Presets/AvianLidarHSB.json

#include "vtkSMTransferFunctionPresets.h"

#include <string>

//------------------------------------------------------------------------------
void AvianLidarAddColourPreset()
{
  const char* name = "Avian lidar HSB";
  vtkSMTransferFunctionPresets* presets = vtkSMTransferFunctionPresets::GetInstance();
  if (presets->HasPreset(name))
  {
    return;
  }
  // A file of presets is a JSON array, AddPreset() takes one object: the only one in ours.
  const std::string file = AvianLidarHSBPreset;
  const std::string::size_type begin = file.find('{');
  const std::string::size_type end = file.rfind('}');
  presets->AddPreset(name, file.substr(begin, end - begin + 1));
}
