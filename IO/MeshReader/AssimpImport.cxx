// SPDX-License-Identifier: BSD-3-Clause
#include "Imports.h"

#include "AssimpFiles.h"
#include "FormatFacts.h"
#include "MeshFormats.h"

#include <assimp/IOStream.hpp>
#include <assimp/Importer.hpp>
#include <assimp/metadata.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <minizip/unzip.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <regex>

namespace avianlidar::scene
{
namespace
{
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
  double farthest = 0.0;
  for (unsigned int i = 0; i < source.mNumVertices; ++i)
  {
    const double x = source.mVertices[i].x, y = source.mVertices[i].y, z = source.mVertices[i].z;
    farthest = std::max({ farthest, std::abs(x), std::abs(y), std::abs(z) });
    mesh.points.push_back({ t[0] * x + t[1] * y + t[2] * z + t[3],
      t[4] * x + t[5] * y + t[6] * z + t[7], t[8] * x + t[9] * y + t[10] * z + t[11] });
  }
  const double scale = std::max(
    { std::hypot(t[0], t[4], t[8]), std::hypot(t[1], t[5], t[9]), std::hypot(t[2], t[6], t[10]) });
  mesh.rounding = std::max({ mesh.rounding, scale * SpacingAt(farthest), SpacingAt(t[3]),
    SpacingAt(t[7]), SpacingAt(t[11]) });
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

// Assimp's triangulation does not check the indices of a polygon's corners.
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
      // Assimp takes a face without vertices for a polygon, and crashes unless there is another
      // one.
      throw Error("is broken: a face has no vertex");
    }
  }
}

// Assimp never ends on a PLY file whose header has no end.
void CheckPlyHeader(const std::string& text)
{
  if (text.empty())
  {
    return; // Assimp reports that the file cannot be opened
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

/// Returns the text of the mesh, or nothing if it cannot be opened: Assimp reports that.
std::string TextOf(AssimpFiles& files)
{
  const std::unique_ptr<Assimp::IOStream> stream(files.Open(files.GetMeshName().c_str(), "rb"));
  std::string text(stream ? stream->FileSize() : 0, '\0');
  if (!text.empty() && stream->Read(&text[0], 1, text.size()) != text.size())
  {
    text.clear();
  }
  return text;
}

/// Returns the first 64 KiB of a part of an archive, or nothing if the part is missing.
/// @param name without a slash in front
std::string BeginOf(unzFile archive, const std::string& name)
{
  constexpr int anyCase = 2;
  if (unzLocateFile(archive, name.c_str(), anyCase) != UNZ_OK ||
    unzOpenCurrentFile(archive) != UNZ_OK)
  {
    return {};
  }
  std::string text(1u << 16, '\0');
  const int got = unzReadCurrentFile(archive, &text[0], static_cast<unsigned int>(text.size()));
  text.resize(static_cast<std::size_t>(std::max(got, 0)));
  unzCloseCurrentFile(archive);
  return text;
}

/// Returns the first 64 KiB of the model that the relationships of a 3MF file name, or nothing if
/// the file cannot be opened: Assimp reports that.
std::string BeginOfModel(const std::string& file)
{
  const std::unique_ptr<void, int (*)(unzFile)> archive(unzOpen64(file.c_str()), unzClose);
  if (!archive)
  {
    return {};
  }
  static const std::regex target("Target *= *[\"']/?([^\"']*\\.model)[\"']");
  const std::string relationships = BeginOf(archive.get(), "_rels/.rels");
  std::smatch named;
  return BeginOf(archive.get(),
    std::regex_search(relationships, named, target) ? named[1].str() : "3D/3dmodel.model");
}

/// Refuses files that Assimp reads wrong, and adds warnings. Returns the length of the file's unit,
/// m.
double CheckFormat(AssimpFiles& files, std::vector<std::string>& warnings)
{
  const std::string& name = files.GetMeshName();
  const std::string ending = EndingOf(name);
  if (ending == ".ply")
  {
    CheckPlyHeader(TextOf(files));
  }
  else if (ending == ".gltf" || ending == ".glb")
  {
    warnings = CheckGltf(TextOf(files));
  }
  if (ending == ".ifc" || ending == ".stp" || ending == ".step")
  {
    return IfcUnit(TextOf(files));
  }
  if (ending == ".amf")
  {
    const std::string text = TextOf(files);
    CheckAmf(text);
    return PrintUnit(text);
  }
  return ending == ".3mf" ? PrintUnit(BeginOfModel(name)) : 1.0;
}

/// The axis of an FBX file's coordinates that `name` ("Coord", "Up" or "Front") points along, or 3
/// if it says none, and the sign.
std::pair<int, int> FbxAxis(const aiMetadata& data, const std::string& name)
{
  int axis = 3;
  int sign = 1;
  data.Get(name + "Axis", axis);
  data.Get(name + "AxisSign", sign);
  return { axis < 0 ? 3 : std::min(axis, 3), sign < 0 ? -1 : 1 };
}

/// Turns what Assimp made of an FBX file to x right, y up and z towards the viewer, or with z up to
/// y away from the viewer. Assimp 5.4 does so in the transformation of the root, always to y up,
/// Assimp 5.2 does not. Returns the axis that points up then, 'y' or 'z'.
char TurnFbx(const aiScene& scene)
{
  constexpr int yAxis = 1, zAxis = 2;
  std::pair<int, int> right{ 0, 1 }, up{ yAxis, 1 }, front{ zAxis, 1 };
  if (scene.mMetaData)
  {
    right = FbxAxis(*scene.mMetaData, "Coord");
    up = FbxAxis(*scene.mMetaData, "Up");
    front = FbxAxis(*scene.mMetaData, "Front");
    if (((1 << right.first) | (1 << up.first) | (1 << front.first)) != 7)
    {
      if (up.first == 0)
      {
        throw Error("says that x points up, and not which axes point right and to the front");
      }
      right = { 0, 1 };
      up.second = 1;
      front = up.first == zAxis ? std::pair(yAxis, -1) : std::pair(zAxis, 1);
      up.first = up.first == zAxis ? zAxis : yAxis;
    }
  }
  aiMatrix4x4 turn(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1);
  turn[0][right.first] = static_cast<float>(right.second);
  const bool zUp = up.first == zAxis;
  turn[zUp ? zAxis : yAxis][up.first] = static_cast<float>(up.second);
  turn[zUp ? yAxis : zAxis][front.first] = static_cast<float>(zUp ? -front.second : front.second);
  scene.mRootNode->mTransformation = turn;
  return zUp ? 'z' : 'y';
}

/// The length of an FBX file's unit, m.
double FbxUnit(const aiScene& scene)
{
  constexpr double centimetre = 0.01;
  float centimetres = 1.0f;
  if (scene.mMetaData)
  {
    scene.mMetaData->Get("UnitScaleFactor", centimetres);
  }
  return centimetre * centimetres;
}
}

Mesh ReadAssimpMesh(const std::string& file)
{
  // The importer owns the files. It is never deleted: some files crash Assimp 5.2 in its
  // destructor, after they have been read.
  Assimp::Importer& importer = *new Assimp::Importer;
  auto* files = new AssimpFiles(file);
  importer.SetIOHandler(files);
  Mesh mesh;
  double unit = CheckFormat(*files, mesh.warnings);
  const aiScene* scene = importer.ReadFile(files->GetMeshName(), 0);
  if (scene)
  {
    CheckFaces(*scene);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
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
  for (unsigned int i = 0; i < scene->mNumMaterials; ++i)
  {
    mesh.materialNames.emplace_back(scene->mMaterials[i]->GetName().C_Str());
  }
  if (EndingOf(files->GetMeshName()) == ".fbx")
  {
    unit *= FbxUnit(*scene);
    mesh.upAxis = TurnFbx(*scene);
  }
  AddNode(*scene, *scene->mRootNode, { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 }, mesh);
  const Vec3& moved = files->GetOffset();
  for (Vec3& p : mesh.points)
  {
    p = { unit * (p[0] + moved[0]), unit * (p[1] + moved[1]), unit * (p[2] + moved[2]) };
  }
  mesh.rounding *= unit;
  return mesh;
}
}
