// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MeshStream.h
 * @brief Messages to and from the program that reads meshes: the name of a file; a mesh, or the
 * reason why a mesh cannot be read.
 *
 * Numbers are sent as in memory, because sender and receiver run on one machine and are built
 * together.
 */
#ifndef AvianLidarMeshStream_h
#define AvianLidarMeshStream_h

#include "SceneTypes.h"

#include <functional>

namespace avianlidar::scene
{
/// Function that writes `size` bytes, and throws if the bytes cannot be written.
using WriteBytes = std::function<void(const void* bytes, std::size_t size)>;
/// Function that reads `size` bytes, and throws if fewer bytes are left.
using ReadBytes = std::function<void(void* bytes, std::size_t size)>;

void SendName(const std::string& file, const WriteBytes& write);
/// Returns the name of a file that was sent.
std::string ReceiveName(const ReadBytes& read);

void SendMesh(const Mesh& mesh, const WriteBytes& write);
void SendError(const std::string& reason, const WriteBytes& write);
void SendNoMemory(const WriteBytes& write);

/// Returns the mesh that was sent. Throws Error with the reason that was sent, or std::bad_alloc.
Mesh ReceiveMesh(const ReadBytes& read);
}

#endif
