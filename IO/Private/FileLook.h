// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file FileLook.h
 * @brief A look at a mesh file before VTK's or Assimp's readers get it: they call themselves level
 * by level and take any number for true, which may end the process.
 *
 * Seen are: values, elements and nodes one in the other more than 1000 deep, or within themselves,
 * in JSON (glTF), XML (Collada, X3D, VTK), AC3D and DirectX's text; nodes placed so often that they
 * do not fit into memory (glTF, Collada, X3D); in VTK's files the numbers of points, cells and
 * values, by the length of the file or the memory there is, and cells that end behind the others.
 * What is wrong in any other way is left to the readers. Not seen are: other formats that nest
 * (FBX, 3DS, Blender), and what compressed or binary data of VTK's XML files say of their own
 * length.
 */
#ifndef AvianLidarFileLook_h
#define AvianLidarFileLook_h

#include <string>

namespace avianlidar::scene
{
/// Throws Error or MemoryError, which say what is wrong. O(bytes of the file).
void LookAtVtkFile(const std::string& file);
void LookAtAssimpFile(const std::string& file);
}

#endif
