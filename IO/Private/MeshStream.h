// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MeshStream.h
 * @brief The program that reads meshes sends through its pipe a mesh, or the reason why it could
 * not read one.
 *
 * Both ends run on one machine and are built together, so numbers travel as they lie in memory.
 */
#ifndef AvianLidarMeshStream_h
#define AvianLidarMeshStream_h

#include "SceneTypes.h"

#include <functional>

namespace avianlidar::scene
{
/// Writes `size` bytes; throws where it cannot.
using WriteBytes = std::function<void(const void* bytes, std::size_t size)>;
/// Reads `size` bytes; throws where there are fewer.
using ReadBytes = std::function<void(void* bytes, std::size_t size)>;

void SendMesh(const Mesh& mesh, const WriteBytes& write);
void SendError(const std::string& reason, const WriteBytes& write);
void SendNoMemory(const WriteBytes& write);

/// The mesh that was sent. Throws Error with the reason that was sent, or std::bad_alloc.
Mesh ReceiveMesh(const ReadBytes& read);
}

#endif
