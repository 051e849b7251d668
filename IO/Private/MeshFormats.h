// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MeshFormats.h
 * @brief Which library reads a mesh file, by the ending of its name.
 */
#ifndef AvianLidarMeshFormats_h
#define AvianLidarMeshFormats_h

#include <vtksys/SystemTools.hxx>

#include <string>

namespace avianlidar::scene
{
/// The ending in lower case with its dot: ".vtp".
inline std::string EndingOf(const std::string& file)
{
  return vtksys::SystemTools::LowerCase(vtksys::SystemTools::GetFilenameLastExtension(file));
}

/// Returns the name without ".gz"; its ending gives the format.
inline std::string UncompressedName(const std::string& file)
{
  return EndingOf(file) == ".gz" ? file.substr(0, file.size() - 3) : file;
}

/// Whether VTK reads the file; Assimp reads all others.
inline bool IsVtkFile(const std::string& file)
{
  const std::string ending = EndingOf(file);
  for (const char* known : { ".vtp", ".vtu", ".vts", ".vtr", ".vti", ".vtm", ".vtmb", ".vtk" })
  {
    if (ending == known)
    {
      return true;
    }
  }
  return false;
}
}

#endif
