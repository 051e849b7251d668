// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MeshImport.h
 * @brief Reads mesh files of any format as triangles with named materials.
 */
#ifndef AvianLidarMeshImport_h
#define AvianLidarMeshImport_h

#include "FileNames.h"
#include "SceneTypes.h"

#include <functional>
#include <memory>
#include <string>

namespace avianlidar::scene
{
/// Returns whether VTK reads the file. Assimp reads all other files.
inline bool IsVtkFile(const std::string& file)
{
  return EndsWithAny(file, { ".vtp", ".vtu", ".vts", ".vtr", ".vti", ".vtm", ".vtmb", ".vtk" });
}

/**
 * Reads meshes: VTK's formats (IsVtkFile()) with VTK, all other formats with Assimp. Files that
 * Assimp reads may be compressed, with the extension ".gz". Polygons are triangulated.
 * Transformations of a scene graph are applied in double precision. Vertices with identical
 * coordinates are merged over all parts of the file. The material of a triangle is an index in
 * materialNames. Colours are not read.
 *
 * VTK and Assimp run in a separate program, `avianlidar/mesh-reader` beside the library that
 * contains this code. A file on which the program crashes, never ends or takes all memory therefore
 * gives an Error. One process of the program reads many files, because its start takes longer than
 * a small file. After an Error of this kind, the next file has a new process. The program is
 * started by posix_spawn, not by fork, because other threads may hold locks. Environment variables
 * set the limits of the program:
 *
 * | variable                  | meaning                       | default                         |
 * |---------------------------|-------------------------------|---------------------------------|
 * | AVIANLIDAR_MESH_SECONDS   | limit of time for one file, s | 3600                            |
 * | AVIANLIDAR_MESH_GIGABYTES | limit of memory, GB           | nine tenths of available memory |
 * | AVIANLIDAR_MESH_READER    | path of the program           | program beside the library      |
 */
class MeshReader
{
public:
  MeshReader();
  ~MeshReader();
  MeshReader(const MeshReader&) = delete;
  MeshReader& operator=(const MeshReader&) = delete;

  /// Reads a file. Throws Error if the file cannot be read, contains no triangle, or has a
  /// coordinate that is not finite. Throws std::bad_alloc if the memory does not suffice. Throws
  /// WorkStopped if keepGoing returns false. The function keepGoing is called about ten times a
  /// second.
  Mesh Read(const std::string& file, const std::function<bool()>& keepGoing);

private:
  class Process;
  std::unique_ptr<Process> Running; // the process that has read the last file
};

/// Turns a mesh of MeshReader so that z is up. `upAxis`: 'y' or 'z', or 0 for the axis that the
/// file or its format gives.
void TurnUp(const std::string& file, char upAxis, Mesh& mesh);
}

#endif
