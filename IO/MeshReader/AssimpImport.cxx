// SPDX-License-Identifier: BSD-3-Clause
#include "Imports.h"

#include "FileNames.h"
#include "FormatFacts.h"
#include "GltfFile.h"
#include "PolygonTriangulation.h"
#include "UnpackedSize.h"
#include "Vector.h"

#include <assimp/DefaultLogger.hpp>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/metadata.h>
#include <assimp/scene.h>

#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>

#include "vtk_zlib.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <new>
#include <regex>
#include <set>
#include <vector>

namespace avianlidar::scene
{
namespace
{
struct Held
{
  std::shared_ptr<const std::vector<char>> bytes;
};

// Whole file in memory, because Assimp seeks and a compressed file does not allow seeking.
class MemoryStream
  : private Held
  , public Assimp::MemoryIOStream
{
public:
  explicit MemoryStream(std::shared_ptr<const std::vector<char>> all)
    : Held{ std::move(all) }
    , MemoryIOStream(
        reinterpret_cast<const std::uint8_t*>(this->bytes->data()), this->bytes->size())
  {
  }

  std::size_t Read(void* target, std::size_t size, std::size_t count) override
  {
    return size == 0 ? 0 : MemoryIOStream::Read(target, size, count);
  }
};

/// Reads the bytes of a file, and unpacks the bytes if gzip packed them. Returns the reason if the
/// file cannot be read or holds too much (UnpackedSize.h), else an empty text.
std::string ReadAll(const std::string& file, std::vector<char>& bytes)
{
  std::unique_ptr<gzFile_s, int (*)(gzFile)> handle(gzopen(file.c_str(), "rb"), gzclose);
  if (!handle)
  {
    return std::strerror(errno);
  }
  std::error_code ignored;
  const std::uintmax_t packed = std::filesystem::file_size(file, ignored);
  // Filling a large chunk with zeros takes longer than reading a small file.
  const std::size_t chunk = std::clamp<std::uintmax_t>(packed + 1, 1u << 12, 1u << 22);
  const bool isPacked = gzdirect(handle.get()) == 0;
  int got = 0;
  do
  {
    const std::size_t size = bytes.size();
    try
    {
      CheckUnpacked(isPacked ? size : 0, packed);
    }
    catch (const Error& error)
    {
      return error.what();
    }
    bytes.resize(size + chunk);
    got = gzread(handle.get(), bytes.data() + size, static_cast<unsigned int>(chunk));
    bytes.resize(size + static_cast<std::size_t>(std::max(got, 0)));
  } while (got > 0);
  int error = Z_OK;
  const std::string reason = gzerror(handle.get(), &error);
  // Only closing finds some damaged archives.
  const int closed = gzclose(handle.release());
  return error == Z_OK && closed == Z_OK ? ""
    : !reason.empty()                    ? reason
                                         : "the compressed file ends too early";
}

/**
 * File system of Assimp that changes only the mesh. The mesh has a name without ".gz", because
 * Assimp finds the format by the file extension. The bytes of the mesh are unpacked during reading.
 */
class AssimpFiles : public Assimp::IOSystem
{
public:
  explicit AssimpFiles(const std::string& mesh)
    : Mesh(mesh)
    , MeshName(UncompressedName(mesh))
  {
  }

  /// Returns the name under which Assimp opens the mesh.
  const std::string& GetMeshName() const { return this->MeshName; }

  /// Returns ": <reason>" if the last file could not be opened, or an empty text without a reason.
  const std::string& GetReason() const { return this->Reason; }

  /// Returns the vector to be added to the vertices, in the unit of the file (MoveObjToOrigin()).
  const Point3& GetOffset() const { return this->Offset; }

  /// Makes Assimp read another text in place of the mesh.
  /// @param ending file extension that tells Assimp the format of the text
  void Replace(const std::string& ending, std::string text)
  {
    this->MeshName.resize(this->MeshName.size() - EndingOf(this->MeshName).size());
    this->MeshName += ending;
    this->Add(vtksys::SystemTools::GetFilenameName(this->MeshName), std::move(text));
  }

  /// Makes Assimp read a text in place of a file beside the mesh. @param name without a folder
  void Add(const std::string& name, std::string text) { this->Texts[name] = std::move(text); }

  /// Returns the contents of a file that a glTF file names. Throws Error if the file cannot be
  /// read.
  std::string Read(const std::string& uri)
  {
    const std::string file = vtksys::SystemTools::GetFilenamePath(this->Mesh) + '/' + uri;
    const std::unique_ptr<Assimp::IOStream> stream(this->Open(file.c_str(), "rb"));
    failIf(!stream, "names the file ", uri, ", which cannot be read", this->Reason);
    std::string text(stream->FileSize(), '\0');
    stream->Read(text.data(), 1, text.size());
    return text;
  }

  bool Exists(const char* file) const override
  {
    return this->TextOf(file) != nullptr || !this->OnDisk(file).empty();
  }

  char getOsSeparator() const override { return '/'; }

  Assimp::IOStream* Open(const char* file, const char* mode) override
  {
    // Reading a pipe may never begin, and reading a device may never end.
    if (!this->Exists(file) || std::strchr(mode, 'r') == nullptr)
    {
      return nullptr;
    }
    const bool isMesh = this->MeshName == file;
    const std::string* const text = this->TextOf(file);
    if (isMesh && !text && (this->Unpacked || !this->Reason.empty()))
    {
      return this->Unpacked ? new MemoryStream(this->Unpacked) : nullptr;
    }
    std::vector<char> bytes;
    std::string reason;
    if (text)
    {
      bytes.assign(text->begin(), text->end());
    }
    else
    {
      reason = ReadAll(this->OnDisk(file), bytes);
    }
    if (!reason.empty())
    {
      this->Reason = ": " + reason;
      return nullptr;
    }
    if (isMesh && EndingOf(file) == ".obj")
    {
      const char mark[] = { '\xEF', '\xBB', '\xBF' }; // byte-order mark of UTF-8
      if (bytes.size() > sizeof mark && std::equal(std::begin(mark), std::end(mark), bytes.begin()))
      {
        bytes.erase(bytes.begin(), bytes.begin() + sizeof mark);
      }
      this->Offset = MoveObjToOrigin(bytes);
    }
    const auto all = std::make_shared<const std::vector<char>>(std::move(bytes));
    if (isMesh && this->Mesh != this->MeshName)
    {
      this->Unpacked = all;
    }
    return new MemoryStream(all);
  }

  void Close(Assimp::IOStream* stream) override { delete stream; }

private:
  /// Returns a text that was added, or null.
  const std::string* TextOf(const std::string& file) const
  {
    const auto found = this->Texts.find(vtksys::SystemTools::GetFilenameName(file));
    return found == this->Texts.end() ? nullptr : &found->second;
  }

  /// Returns the path of a file, or an empty text if the file does not exist. glTF files name other
  /// files by URIs.
  std::string OnDisk(const std::string& file) const
  {
    std::string path = this->MeshName == file ? this->Mesh : file;
    if (this->MeshName != file && EndsWithAny(this->MeshName, { ".gltf", ".glb" }))
    {
      const std::string folder = vtksys::SystemTools::GetFilenamePath(file);
      const std::string decoded = folder + PercentDecoded(path.substr(folder.size()));
      path = vtksys::SystemTools::FileExists(decoded) ? decoded : path;
    }
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored) ? path : std::string();
  }

  std::string Mesh;
  std::string MeshName;
  std::map<std::string, std::string> Texts; ///< by the name without a folder
  std::string Reason;
  Point3 Offset{};
  // Assimp opens a file of unknown format once for each format.
  std::shared_ptr<const std::vector<char>> Unpacked;
};

// Returns a matrix in double precision. Assimp multiplies matrices in single precision.
glm::dmat4 ToDouble(const aiMatrix4x4& m)
{
  return { { m.a1, m.b1, m.c1, m.d1 }, { m.a2, m.b2, m.c2, m.d2 }, { m.a3, m.b3, m.c3, m.d3 },
    { m.a4, m.b4, m.c4, m.d4 } };
}

// Adds the faces of Assimp's meshes. Assimp's own triangulation cuts ears, and gives a fan if it
// finds no ear.
class Faces
{
public:
  // Adds a face of at least three corners. @param first index of the first point of Assimp's mesh
  // @param rounding rounding of coordinates
  void Add(const aiFace& face, std::int64_t first, int material, double rounding, Mesh& mesh)
  {
    this->Corners.clear();
    for (unsigned int k = 0; k < face.mNumIndices; ++k)
    {
      const Point3& p = mesh.points[first + face.mIndices[k]];
      this->Corners.emplace_back(p[0], p[1], p[2]);
    }
    this->Polygon.Divide(this->Corners);
    this->Lost.Check(this->Polygon, this->Number, rounding);
    const auto added = static_cast<std::int64_t>(mesh.points.size()) - face.mNumIndices;
    for (const glm::dvec3& p : this->Polygon.GetAdded())
    {
      mesh.points.push_back({ p.x, p.y, p.z });
    }
    for (PolygonTriangulation::Triangle triangle : this->Polygon.GetTriangles())
    {
      for (std::int64_t& corner : triangle)
      {
        corner = corner < face.mNumIndices ? first + face.mIndices[corner] : added + corner;
      }
      mesh.triangles.push_back(triangle);
      mesh.materials.push_back(material);
    }
  }

  std::int64_t Number = 0; // number of the face, among all faces
  LostAreas Lost;

private:
  PolygonTriangulation Polygon;
  std::vector<glm::dvec3> Corners;
};

void AddMesh(const aiMesh& source, const glm::dmat4x3& t, Faces& faces, Mesh& mesh)
{
  const auto first = static_cast<std::int64_t>(mesh.points.size());
  double farthest = 0.0;
  for (unsigned int i = 0; i < source.mNumVertices; ++i)
  {
    const aiVector3D& v = source.mVertices[i];
    farthest = std::max<double>({ farthest, std::abs(v.x), std::abs(v.y), std::abs(v.z) });
    const glm::dvec3 p = t * glm::dvec4(v.x, v.y, v.z, 1);
    mesh.points.push_back({ p.x, p.y, p.z });
  }
  const double scale = std::max({ safeLength(t[0]), safeLength(t[1]), safeLength(t[2]) });
  const double rounding = scale * SpacingAt(farthest);
  mesh.rounding =
    std::max({ mesh.rounding, rounding, SpacingAt(t[3].x), SpacingAt(t[3].y), SpacingAt(t[3].z) });
  for (unsigned int i = 0; i < source.mNumFaces; ++i, ++faces.Number)
  {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices > 3)
    {
      faces.Add(face, first, static_cast<int>(source.mMaterialIndex), rounding, mesh);
      continue;
    }
    if (face.mNumIndices < 3)
    {
      ++mesh.skippedFaces;
      continue;
    }
    mesh.triangles.push_back(
      { first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2] });
    mesh.materials.push_back(static_cast<int>(source.mMaterialIndex));
  }
}

void AddNode(
  const aiScene& scene, const aiNode& node, const glm::dmat4& parent, Faces& faces, Mesh& mesh)
{
  const glm::dmat4 transform = parent * ToDouble(node.mTransformation);
  for (unsigned int i = 0; i < node.mNumMeshes; ++i)
  {
    AddMesh(*scene.mMeshes[node.mMeshes[i]], glm::dmat4x3(transform), faces, mesh);
  }
  for (unsigned int i = 0; i < node.mNumChildren; ++i)
  {
    AddNode(scene, *node.mChildren[i], transform, faces, mesh);
  }
}

// Checks the indices of the corners of faces.
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
        failIf(face.mIndices[k] >= mesh.mNumVertices, "is broken: a face has vertex ",
          face.mIndices[k], " of ", mesh.mNumVertices);
      }
    }
    if ((mesh.mPrimitiveTypes & aiPrimitiveType_POLYGON) != 0 && !hasPolygon)
    {
      // Assimp takes a face without vertices for a polygon, and crashes unless the mesh has another
      // polygon.
      fail("is broken: a face has no vertex");
    }
  }
}

/// Returns the text of the mesh, or an empty text if the mesh cannot be opened. Assimp then reports
/// the error.
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

/// Makes Assimp read none of the formats that this project refuses, not even by the contents of a
/// file. Throws Error if the file has the extension of such a format.
void RefuseFormats(Assimp::Importer& importer, const std::string& file)
{
  for (const std::string ending : { ".3mf", ".amf", ".nff", ".off", ".ogex", ".x3d" })
  {
    importer.UnregisterLoader(importer.GetImporter(ending.c_str()));
    failIf(EndingOf(file) == ending, "is of a format that is not read: convert it to OBJ with ",
      "the program of Assimp (Debian: assimp-utils), \"assimp export in", ending,
      " out.obj\", and give its unit as scale and its axis as up_axis");
  }
}

/// Refuses files that Assimp reads wrong. Adds the file's warnings and its up axis to the mesh.
/// Returns the length of the file's unit, m.
/// @param elements becomes the numbers of elements that ReadIfc() gives
/// @param schema becomes the schema that a STEP file names
double CheckFormat(
  AssimpFiles& files, Mesh& mesh, std::map<std::string, std::size_t>& elements, std::string& schema)
{
  const std::string& name = files.GetMeshName();
  const std::string ending = EndingOf(name);
  static const std::map<std::string, void (*)(const std::string&)> checks{ { ".ply", CheckPly },
    { ".obj", CheckObj } };
  if (const auto check = checks.find(ending); check != checks.end())
  {
    const std::string text = TextOf(files);
    if (!text.empty()) // otherwise Assimp reports the error
    {
      check->second(text);
    }
    return 1.0;
  }
  static const std::set<std::string> looked{ ".gltf", ".glb", ".ifc", ".stp", ".step" };
  const std::string text = looked.count(ending) > 0 ? TextOf(files) : "";
  if (ending == ".gltf" || ending == ".glb")
  {
    mesh.warnings = CheckGltf(text);
    GltfFiles changed =
      GltfInFloats(text, [&files](const std::string& uri) { return files.Read(uri); });
    if (!changed.json.empty())
    {
      files.Replace(".gltf", std::move(changed.json));
      for (auto& [buffer, bytes] : changed.buffers)
      {
        files.Add(buffer, std::move(bytes));
      }
    }
  }
  else if (!text.empty())
  {
    const double unit = ReadIfc(text, elements);
    schema = SchemaOf(text);
    if (StartsWith(schema, "IFC4"))
    {
      // Assimp 5.4 refuses the name, and both versions read what is as in IFC2X3.
      std::string renamed = text;
      renamed.replace(renamed.find('\'' + schema + '\''), schema.size() + 2, "'IFC2X3'");
      files.Replace(ending, std::move(renamed));
    }
    return unit;
  }
  return 1.0;
}

/// Returns whether a node or a node below it has triangles.
bool HasMesh(const aiNode& node)
{
  return node.mNumMeshes > 0 ||
    std::any_of(node.mChildren, node.mChildren + node.mNumChildren,
      [](const aiNode* child) { return HasMesh(*child); });
}

/// Subtracts the nodes with triangles from the numbers of elements of an IFC file. Assimp begins
/// the name of a node with the type of the element.
void TakeFound(const aiNode& node, std::map<std::string, std::size_t>& elements)
{
  std::string type(node.mName.C_Str());
  type.erase(std::min(type.find('_'), type.size()));
  type = vtksys::SystemTools::UpperCase(type);
  const auto element = elements.find(type);
  if (element != elements.end() && element->second > 0 && HasMesh(node))
  {
    --element->second;
  }
  std::for_each(node.mChildren, node.mChildren + node.mNumChildren,
    [&elements](const aiNode* child) { TakeFound(*child, elements); });
}

/// Keeps Assimp's log messages about geometry that Assimp leaves out.
class LossLog : public Assimp::LogStream
{
public:
  void write(const char* line) override
  {
    static const std::regex loss(
      "skip|ignor|unsupported|not supported|discard|dropp?ed|invalid|out[- ]of[- "
      "]range|fail|unable|unknown|missing|omitt|resolve",
      std::regex::icase);
    static const std::regex harmless(
      "material|texture|shad(?:er|ing)|\\buv|normal|tangent|bone|skin|anim|camera|light|colou?r|"
      "comment|ambient|diffuse|image|Ignored file",
      std::regex::icase);
    // The line has the form "Warn,  T0: text\n".
    std::string text(line);
    text.erase(0, text.find(": ") + 2);
    text.erase(std::min(text.find_last_not_of(" .\r\n") + 1, text.size()));
    if (std::regex_search(text, loss) && !std::regex_search(text, harmless))
    {
      ++this->Count;
      if (std::find(this->Texts.begin(), this->Texts.end(), text) == this->Texts.end() &&
        this->Texts.size() < most)
      {
        this->Texts.push_back(text);
      }
    }
  }

  /// Returns one sentence about all messages, or an empty text without a message.
  std::string Sentence() const
  {
    std::string sentence;
    for (const std::string& text : this->Texts)
    {
      sentence +=
        (sentence.empty() ? "Assimp may have left out something: \"" : "; \"") + text + '"';
    }
    return this->Count > this->Texts.size()
      ? sentence + " (" + std::to_string(this->Count) + " messages)"
      : sentence;
  }

private:
  static constexpr std::size_t most = 3;
  std::vector<std::string> Texts;
  std::size_t Count = 0;
};

/// Returns the axis of an FBX file's coordinates along which `name` ("Coord", "Up" or "Front")
/// points, or 3 if the file does not give the axis, and the sign.
std::pair<int, int> FbxAxis(const aiMetadata& data, const std::string& name)
{
  int axis = 3;
  int sign = 1;
  data.Get(name + "Axis", axis);
  data.Get(name + "AxisSign", sign);
  return { axis < 0 ? 3 : std::min(axis, 3), sign < 0 ? -1 : 1 };
}

/// Turns Assimp's scene of an FBX file to x right, y up and z towards the viewer, or, if z is up,
/// to y away from the viewer. Assimp 5.4 turns the scene to y up in the transformation of the root.
/// Assimp 5.2 does not turn the scene. Returns the axis that points up afterwards, 'y' or 'z'.
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
      failIf(
        up.first == 0, "says that x points up, and not which axes point right and to the front");
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

/// Returns the length of an FBX file's unit, m.
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
  // Assimp's logger owns the object.
  auto* losses = new LossLog;
  Assimp::DefaultLogger::create(nullptr, Assimp::Logger::NORMAL, 0);
  Assimp::DefaultLogger::get()->attachStream(losses, Assimp::Logger::Warn | Assimp::Logger::Err);
  // The importer owns the files. The importer is never deleted, because some files crash Assimp 5.2
  // in the destructor, after reading.
  Assimp::Importer& importer = *new Assimp::Importer;
  auto* files = new AssimpFiles(file);
  importer.SetIOHandler(files);
  RefuseFormats(importer, files->GetMeshName());
  Mesh mesh;
  std::map<std::string, std::size_t> elements;
  std::string schema;
  double unit = CheckFormat(*files, mesh, elements, schema);
  const aiScene* scene = importer.ReadFile(files->GetMeshName(), 0);
  if (scene)
  {
    CheckFaces(*scene);
  }
  if (!scene || !scene->mRootNode)
  {
    // Assimp's messages name a compressed mesh without ".gz".
    std::string reason = importer.GetErrorString();
    // Assimp gives "Unknown exception" if memory also runs out during the report of bad_alloc.
    if (reason == std::bad_alloc().what() || reason == "Unknown exception")
    {
      throw std::bad_alloc();
    }
    vtksys::SystemTools::ReplaceString(reason, files->GetMeshName(), file);
    if (!files->GetReason().empty() && !reason.empty() && reason.back() == '.')
    {
      reason.pop_back();
    }
    failIf(!schema.empty() && schema != "IFC2X3", "is written in the schema ", schema,
      ", expected IFC2X3. Assimp cannot read it: ", reason, files->GetReason());
    fail("Assimp cannot read it: ", reason, files->GetReason());
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
  Faces faces;
  AddNode(*scene, *scene->mRootNode, glm::dmat4(1), faces, mesh);
  if (const std::string lost = faces.Lost.Sentence("face"); !lost.empty())
  {
    mesh.warnings.push_back(lost);
  }
  const Point3& moved = files->GetOffset();
  for (Point3& p : mesh.points)
  {
    p = { unit * (p[0] + moved[0]), unit * (p[1] + moved[1]), unit * (p[2] + moved[2]) };
  }
  mesh.rounding *= unit;
  TakeFound(*scene->mRootNode, elements);
  std::string absent;
  for (const auto& [type, count] : elements)
  {
    absent += count == 0 ? "" : (absent.empty() ? "" : ", ") + std::to_string(count) + ' ' + type;
  }
  if (!absent.empty())
  {
    mesh.warnings.push_back("elements have no triangles and are left out: " + absent);
  }
  if (const std::string lost = losses->Sentence(); !lost.empty())
  {
    mesh.warnings.push_back(lost);
  }
  return mesh;
}
}
