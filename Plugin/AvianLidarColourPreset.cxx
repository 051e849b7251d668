// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarColourPreset.h"

#include "AvianLidarCoverageStatusPreset.h" // made from Presets/AvianLidarCoverageStatus.json
#include "AvianLidarHSBPreset.h"            // made from Presets/AvianLidarHSB.json
#include "AvianLidarStatusPreset.h"         // made from Presets/AvianLidarStatus.json

#include "vtkSMTransferFunctionPresets.h"

#include <string>

namespace
{
void Add(const char* name, const std::string& file)
{
  vtkSMTransferFunctionPresets* presets = vtkSMTransferFunctionPresets::GetInstance();
  if (presets->HasPreset(name))
  {
    return;
  }
  // A file of presets is a JSON array, AddPreset() takes one object: the only one in ours.
  const std::string::size_type begin = file.find('{');
  const std::string::size_type end = file.rfind('}');
  presets->AddPreset(name, file.substr(begin, end - begin + 1));
}
}

//------------------------------------------------------------------------------
void AvianLidarAddColourPresets()
{
  Add("Avian lidar coverage status", AvianLidarCoverageStatusPreset);
  Add("Avian lidar HSB", AvianLidarHSBPreset);
  Add("Avian lidar status", AvianLidarStatusPreset);
}
