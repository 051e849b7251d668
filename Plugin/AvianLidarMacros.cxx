// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarMacros.h"

#include "pqApplicationCore.h"
#include "pqPythonManager.h"

#include "vtksys/SystemTools.hxx"

#include <dlfcn.h>

#include <string>

namespace
{
//------------------------------------------------------------------------------
// The folder of the library that this function is in.
std::string PluginFolder()
{
  Dl_info plugin;
  return dladdr(reinterpret_cast<void*>(&AvianLidarAddMacros), &plugin)
    ? vtksys::SystemTools::GetFilenamePath(plugin.dli_fname)
    : std::string();
}

//------------------------------------------------------------------------------
// ParaView looks for macros in the folders that this variable names, too.
void AddMacroFolder(const std::string& folder)
{
  const std::string variable = "PV_MACRO_PATH";
  std::string folders;
  vtksys::SystemTools::GetEnv(variable, folders);
  if ((":" + folders + ":").find(":" + folder + ":") == std::string::npos)
  {
    vtksys::SystemTools::PutEnv(variable + "=" + (folders.empty() ? "" : folders + ":") + folder);
  }
}
}

//------------------------------------------------------------------------------
void AvianLidarAddMacros()
{
  // A plugin that is loaded at every start (Auto Load) comes before the window, which then lists
  // what it finds; one that is loaded later has the list made anew.
  AddMacroFolder(PluginFolder() + "/Macros");
  pqApplicationCore* application = pqApplicationCore::instance();
  pqPythonManager* python =
    application ? dynamic_cast<pqPythonManager*>(application->manager("PYTHON_MANAGER")) : nullptr;
  if (python)
  {
    python->updateMacroList();
  }
}
