// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MeshImport.h
 * @brief Mesh files of any format to triangles with named materials.
 */
#ifndef AvianLidarMeshImport_h
#define AvianLidarMeshImport_h

#include "SceneTypes.h"

#include <functional>

namespace avianlidar::scene
{
/**
 * Read a mesh: VTK's own formats (vtp, vtu, vtk, vtm and the like) through VTK, all others through
 * Assimp; ".gz" may follow the latter's endings. Polygons are triangulated, the nodes of a scene
 * graph applied in double precision, and vertices of identical coordinates made one, over all parts
 * of the file. Triangles carry indices in materialNames, which never carry colours.
 *
 * The libraries run in a program of their own, `avianlidar/mesh-reader` beside the library that
 * contains this code: a file on which they crash, never end or take all memory is an error like any
 * other. The program is started by posix_spawn, not by fork: other threads may hold locks.
 * Environment variables set its limits:
 *
 * | variable                  | meaning             | default                         |
 * |---------------------------|---------------------|---------------------------------|
 * | AVIANLIDAR_MESH_SECONDS   | most time, s        | 3600                            |
 * | AVIANLIDAR_MESH_GIGABYTES | most memory, GB     | nine tenths of available memory |
 * | AVIANLIDAR_MESH_READER    | path of the program | the one beside the library      |
 *
 * Throws Error if the file cannot be read, holds no triangle, or has a coordinate that is not
 * finite; std::bad_alloc if the memory does not suffice; WorkStopped if keepGoing returns false,
 * which is called about ten times a second.
 */
Mesh ReadMesh(const std::string& file, const std::function<bool()>& keepGoing);

/// Turn what ReadMesh() made of a file so that z is up. `upAxis`: 'y' or 'z', 0 for what the format
/// says.
void TurnUp(const std::string& file, char upAxis, Mesh& mesh);
}

#endif
