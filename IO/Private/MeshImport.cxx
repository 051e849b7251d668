// SPDX-License-Identifier: BSD-3-Clause
#include "MeshImport.h"

#include "MeshFormats.h"
#include "MeshReaderProcess.h"
#include "MeshStream.h"

namespace avianlidar::scene
{
namespace
{
// The axis that points up after Assimp's reading: it turns Collada, 3DS, IFC and DXF to y, and the
// specifications of glTF, AC3D, FBX and X3D say y. The others say nothing: z, as everywhere in
// surveying.
char UpAxis(const std::string& file)
{
  const std::string ending = EndingOf(UncompressedName(file));
  for (const char* y : { ".dae", ".zae", ".3ds", ".ifc", ".stp", ".step", ".dxf", ".gltf", ".glb",
         ".ac", ".acc", ".ac3d", ".fbx", ".x3d" })
  {
    if (ending == y)
    {
      return 'y';
    }
  }
  return 'z';
}
}

Mesh ReadMesh(const std::string& file, const std::function<bool()>& keepGoing)
{
  MeshReaderProcess reader(file, keepGoing);
  return ReceiveMesh([&reader](void* bytes, std::size_t size) { reader.Read(bytes, size); });
}

void TurnUp(const std::string& file, char upAxis, Mesh& mesh)
{
  const char said = mesh.upAxis ? mesh.upAxis : UpAxis(file);
  if ((upAxis ? upAxis : said) == 'y')
  {
    for (Vec3& p : mesh.points)
    {
      p = { p[0], -p[2], p[1] };
    }
  }
}
}
