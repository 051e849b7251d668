// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AssimpFiles.h
 * @brief Lets Assimp read compressed meshes, and materials and buffers beside them.
 */
#ifndef AvianLidarAssimpFiles_h
#define AvianLidarAssimpFiles_h

#include "SceneTypes.h"

#include <assimp/IOSystem.hpp>

#include <string>

namespace avianlidar::scene
{
/**
 * All files as they are, except that the mesh itself goes by its name without ".gz" (Assimp finds
 * formats by the ending) and is unpacked as it is read.
 */
class AssimpFiles : public Assimp::IOSystem
{
public:
  explicit AssimpFiles(const std::string& mesh);

  /// The name under which to ask Assimp for the mesh.
  const std::string& GetMeshName() const { return this->MeshName; }

  /// Why the mesh could not be opened, as ": <reason>"; empty if no reason is given.
  const std::string& GetReason() const { return this->Reason; }

  /// What must be added to the vertices (MoveObjToOrigin()).
  const Vec3& GetOffset() const { return this->Offset; }

  bool Exists(const char* file) const override;
  char getOsSeparator() const override;
  Assimp::IOStream* Open(const char* file, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;

private:
  std::string Mesh;
  std::string MeshName;
  std::string Reason;
  Vec3 Offset{};
};
}

#endif
