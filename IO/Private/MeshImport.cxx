// SPDX-License-Identifier: BSD-3-Clause
#include "MeshImport.h"

#include "AssimpFiles.h"
#include "FileLook.h"
#include "VirtualFiles.h"

#include <vtksys/SystemTools.hxx>

#include <assimp/IOStream.hpp>
#include <assimp/Importer.hpp>
#include <assimp/ProgressHandler.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <unordered_map>

namespace avianlidar::scene
{
namespace
{
class AbortHandler : public Assimp::ProgressHandler
{
public:
  explicit AbortHandler(const std::function<bool()>& keepGoing)
    : KeepGoing(keepGoing)
  {
  }
  bool Update(float) override { return this->KeepGoing(); }

private:
  const std::function<bool()>& KeepGoing;
};

// A 4 x 4 matrix of a scene graph's node, rows one after the other; Assimp's own products are in
// single precision.
using Transform = std::array<double, 16>;

Transform operator*(const Transform& a, const aiMatrix4x4& m)
{
  const double b[16] = { m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4,
    m.d1, m.d2, m.d3, m.d4 };
  Transform c{};
  for (int i = 0; i < 4; ++i)
  {
    for (int j = 0; j < 4; ++j)
    {
      for (int k = 0; k < 4; ++k)
      {
        c[4 * i + j] += a[4 * i + k] * b[4 * k + j];
      }
    }
  }
  return c;
}

void AddMesh(const aiMesh& source, const Transform& t, Mesh& mesh)
{
  const auto first = static_cast<std::int64_t>(mesh.points.size());
  for (unsigned int i = 0; i < source.mNumVertices; ++i)
  {
    const double x = source.mVertices[i].x, y = source.mVertices[i].y, z = source.mVertices[i].z;
    mesh.points.push_back({ t[0] * x + t[1] * y + t[2] * z + t[3],
      t[4] * x + t[5] * y + t[6] * z + t[7], t[8] * x + t[9] * y + t[10] * z + t[11] });
  }
  for (unsigned int i = 0; i < source.mNumFaces; ++i)
  {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices != 3)
    {
      ++mesh.skippedFaces;
      continue;
    }
    mesh.triangles.push_back(
      { first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2] });
    mesh.materials.push_back(static_cast<int>(source.mMaterialIndex));
  }
}

void AddNode(const aiScene& scene, const aiNode& node, const Transform& parent, Mesh& mesh)
{
  const Transform transform = parent * node.mTransformation;
  for (unsigned int i = 0; i < node.mNumMeshes; ++i)
  {
    AddMesh(*scene.mMeshes[node.mMeshes[i]], transform, mesh);
  }
  for (unsigned int i = 0; i < node.mNumChildren; ++i)
  {
    AddNode(scene, *node.mChildren[i], transform, mesh);
  }
}

// The axis that points up after Assimp's reading: it turns Collada, 3DS and IFC to y, and the
// specifications of glTF, AC3D, FBX and X3D say y. The others say nothing: z, as everywhere in
// surveying.
char UpAxis(const std::string& file)
{
  const std::string ending = vtksys::SystemTools::LowerCase(
    vtksys::SystemTools::GetFilenameLastExtension(UncompressedName(file)));
  for (const char* y :
    { ".dae", ".3ds", ".ifc", ".gltf", ".glb", ".ac", ".acc", ".ac3d", ".fbx", ".x3d" })
  {
    if (ending == y)
    {
      return 'y';
    }
  }
  return 'z';
}

struct PointHash
{
  std::size_t operator()(const Vec3& p) const
  {
    std::uint64_t hash = 0;
    for (double value : p)
    {
      std::uint64_t bits;
      // -0 and 0 are the same coordinate.
      value += 0.0;
      std::memcpy(&bits, &value, sizeof bits);
      hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
};

// Assimp's triangulation does not look whether the corners of a polygon are there.
void CheckFaces(const aiScene& scene)
{
  for (unsigned int i = 0; i < scene.mNumMeshes; ++i)
  {
    const aiMesh& mesh = *scene.mMeshes[i];
    bool hasPolygon = false;
    for (unsigned int f = 0; f < mesh.mNumFaces; ++f)
    {
      const aiFace& face = mesh.mFaces[f];
      hasPolygon = hasPolygon || face.mNumIndices > 3;
      for (unsigned int k = 0; k < face.mNumIndices; ++k)
      {
        if (face.mIndices[k] >= mesh.mNumVertices)
        {
          throw Error("is broken: a face has vertex " + std::to_string(face.mIndices[k]) + " of " +
            std::to_string(mesh.mNumVertices));
        }
      }
    }
    if ((mesh.mPrimitiveTypes & aiPrimitiveType_POLYGON) != 0 && !hasPolygon)
    {
      // Assimp takes it for a polygon, and ends the process where there is no other.
      throw Error("is broken: a face has no vertex");
    }
  }
}

// Assimp looks for the end of a PLY header for ever.
void CheckPlyHeader(AssimpFiles& files, const std::string& file)
{
  if (vtksys::SystemTools::LowerCase(
        vtksys::SystemTools::GetFilenameLastExtension(UncompressedName(file))) != ".ply")
  {
    return;
  }
  const std::unique_ptr<Assimp::IOStream> stream(files.Open(files.GetMeshName().c_str(), "rb"));
  std::string text(stream ? stream->FileSize() : 0, '\0');
  if (text.empty() || stream->Read(&text[0], 1, text.size()) != text.size())
  {
    return; // which Assimp says
  }
  const char* const end = "end_header";
  for (std::size_t at = text.find(end); at != std::string::npos; at = text.find(end, at + 1))
  {
    const std::size_t before = text.find_last_not_of(" \t", at - 1);
    if (at > 0 && before != std::string::npos && (text[before] == '\n' || text[before] == '\r'))
    {
      return;
    }
  }
  throw Error("is broken: its header has no line end_header");
}
}

Mesh ReadAssimpMesh(const std::string& file, const std::function<bool()>& keepGoing)
{
  LookAtAssimpFile(file);
  // The importer owns and deletes both handlers.
  Assimp::Importer importer;
  auto* files = new AssimpFiles(file);
  importer.SetIOHandler(files);
  importer.SetProgressHandler(new AbortHandler(keepGoing));
  CheckPlyHeader(*files, file);
  const aiScene* scene = importer.ReadFile(files->GetMeshName(), 0);
  if (scene && keepGoing())
  {
    CheckFaces(*scene);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  }
  if (!keepGoing())
  {
    throw WorkStopped();
  }
  if (!scene || !scene->mRootNode)
  {
    // Assimp knows a compressed mesh by another name.
    std::string reason = importer.GetErrorString();
    // Assimp says the second where memory runs out again while it reports the first.
    if (reason == std::bad_alloc().what() || reason == "Unknown exception")
    {
      throw std::bad_alloc();
    }
    vtksys::SystemTools::ReplaceString(reason, files->GetMeshName(), file);
    if (!files->GetReason().empty() && !reason.empty() && reason.back() == '.')
    {
      reason.pop_back();
    }
    throw Error("Assimp cannot read it: " + reason + files->GetReason());
  }
  Mesh mesh;
  for (unsigned int i = 0; i < scene->mNumMaterials; ++i)
  {
    mesh.materialNames.emplace_back(scene->mMaterials[i]->GetName().C_Str());
  }
  AddNode(*scene, *scene->mRootNode, { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 }, mesh);
  return mesh;
}

void MergePoints(Mesh& mesh)
{
  std::unordered_map<Vec3, std::int64_t, PointHash> index;
  index.reserve(mesh.points.size());
  std::vector<Vec3> points;
  std::vector<std::int64_t> target(mesh.points.size());
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
  {
    const auto inserted = index.emplace(mesh.points[i], static_cast<std::int64_t>(points.size()));
    if (inserted.second)
    {
      points.push_back(mesh.points[i]);
    }
    target[i] = inserted.first->second;
  }
  for (auto& triangle : mesh.triangles)
  {
    triangle = { target[triangle[0]], target[triangle[1]], target[triangle[2]] };
  }
  mesh.points = std::move(points);
}

Mesh ReadMesh(const std::string& file, const std::function<bool()>& keepGoing)
{
  const bool isVtk = IsVtkFile(file);
  Mesh mesh = isVtk ? ReadVtkMesh(file) : ReadAssimpMesh(file, keepGoing);
  if (mesh.triangles.empty())
  {
    throw Error("holds no triangle");
  }
  for (const Vec3& p : mesh.points)
  {
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
    {
      throw Error("has a vertex whose coordinates are not finite");
    }
  }
  MergePoints(mesh);
  return mesh;
}

void TurnUp(const std::string& file, char upAxis, Mesh& mesh)
{
  if ((upAxis ? upAxis : UpAxis(file)) == 'y')
  {
    for (Vec3& p : mesh.points)
    {
      p = { p[0], -p[2], p[1] };
    }
  }
}
}
