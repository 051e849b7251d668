// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarMacros.h"

#include "pqApplicationCore.h"
#include "pqPythonManager.h"

#include "vtkObject.h"
#include "vtksys/SystemTools.hxx"

#include <dlfcn.h>

#include <string>

namespace
{
//------------------------------------------------------------------------------
// The full path of the folder of the library that this function is in; empty if nobody knows. What
// the linker says is what it was told: that may start at the folder of work, which may change.
std::string PluginFolder()
{
  Dl_info plugin;
  return dladdr(reinterpret_cast<void*>(&AvianLidarAddMacros), &plugin) && plugin.dli_fname
    ? vtksys::SystemTools::GetFilenamePath(vtksys::SystemTools::CollapseFullPath(plugin.dli_fname))
    : std::string();
}

//------------------------------------------------------------------------------
// ParaView looks for macros in the folders that this variable names, too, parted by colons.
void AddMacroFolder(const std::string& folder)
{
  if (folder.find(':') != std::string::npos)
  {
    vtkGenericWarningMacro(
      "The macros are not listed, as ParaView parts folders at colons: " << folder);
    return;
  }
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
  const std::string folder = PluginFolder();
  if (!folder.empty())
  {
    AddMacroFolder(folder + "/Macros");
  }
  pqApplicationCore* application = pqApplicationCore::instance();
  pqPythonManager* python =
    application ? dynamic_cast<pqPythonManager*>(application->manager("PYTHON_MANAGER")) : nullptr;
  if (python)
  {
    python->updateMacroList();
  }
}
