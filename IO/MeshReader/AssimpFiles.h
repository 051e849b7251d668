// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AssimpFiles.h
 * @brief Lets Assimp read compressed meshes, and the files of materials and buffers that meshes
 * name.
 */
#ifndef AvianLidarAssimpFiles_h
#define AvianLidarAssimpFiles_h

#include "SceneTypes.h"

#include <assimp/IOSystem.hpp>

#include <string>

namespace avianlidar::scene
{
/**
 * File system of Assimp that changes only the mesh. The mesh has a name without ".gz", because
 * Assimp finds the format by the file extension. The bytes of the mesh are unpacked during reading.
 */
class AssimpFiles : public Assimp::IOSystem
{
public:
  explicit AssimpFiles(const std::string& mesh);

  /// Returns the name under which Assimp opens the mesh.
  const std::string& GetMeshName() const { return this->MeshName; }

  /// Returns ": <reason>" if the last file could not be opened, or an empty text without a reason.
  const std::string& GetReason() const { return this->Reason; }

  /// Returns the vector to be added to the vertices, in the unit of the file (MoveObjToOrigin()).
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
