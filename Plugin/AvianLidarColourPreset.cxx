// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarInitializers.h"

#include "vtkSMTransferFunctionPresets.h"

namespace
{
struct Preset
{
  const char* name;
  const char* json;
};

const Preset Presets[] = {
#include "AvianLidarPresets.h" // made from Presets/*.json
};
}

//------------------------------------------------------------------------------
void AvianLidarAddColourPresets()
{
  vtkSMTransferFunctionPresets* known = vtkSMTransferFunctionPresets::GetInstance();
  for (const Preset& preset : Presets)
  {
    if (!known->HasPreset(preset.name))
    {
      known->AddPreset(preset.name, preset.json);
    }
  }
}
