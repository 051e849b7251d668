// SPDX-License-Identifier: BSD-3-Clause
#include "AssimpFiles.h"

#include "FormatFacts.h"
#include "MeshFormats.h"

#include <assimp/MemoryIOWrapper.h>

#include "vtk_zlib.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <vector>

namespace avianlidar::scene
{
namespace
{
struct Held
{
  std::vector<char> bytes;
};

// Whole file in memory, because Assimp seeks and a compressed file does not allow seeking.
class MemoryStream
  : private Held
  , public Assimp::MemoryIOStream
{
public:
  explicit MemoryStream(std::vector<char> all)
    : Held{ std::move(all) }
    , MemoryIOStream(reinterpret_cast<const std::uint8_t*>(this->bytes.data()), this->bytes.size())
  {
  }

  std::size_t Read(void* target, std::size_t size, std::size_t count) override
  {
    return size == 0 ? 0 : MemoryIOStream::Read(target, size, count);
  }
};

/// Reads the bytes of a file, and unpacks the bytes if gzip packed them. Returns the reason if the
/// file cannot be read, else an empty text.
std::string ReadAll(const std::string& file, std::vector<char>& bytes)
{
  gzFile handle = gzopen(file.c_str(), "rb");
  if (!handle)
  {
    return std::strerror(errno);
  }
  constexpr std::size_t chunk = 1u << 22;
  int got = 0;
  do
  {
    const std::size_t size = bytes.size();
    bytes.resize(size + chunk);
    got = gzread(handle, bytes.data() + size, chunk);
    bytes.resize(size + static_cast<std::size_t>(std::max(got, 0)));
  } while (got > 0);
  int error = Z_OK;
  const std::string reason = gzerror(handle, &error);
  // Only gzclose() finds some damaged archives.
  const int closed = gzclose(handle);
  return error == Z_OK && closed == Z_OK ? ""
    : !reason.empty()                    ? reason
                                         : "the compressed file ends too early";
}
}

AssimpFiles::AssimpFiles(const std::string& mesh)
  : Mesh(mesh)
  , MeshName(UncompressedName(mesh))
{
}

bool AssimpFiles::Exists(const char* file) const
{
  std::error_code ignored;
  return std::filesystem::is_regular_file(this->MeshName == file ? this->Mesh : file, ignored);
}

char AssimpFiles::getOsSeparator() const
{
  return '/';
}

Assimp::IOStream* AssimpFiles::Open(const char* file, const char* mode)
{
  // Reading a pipe may never begin, and reading a device may never end.
  if (!this->Exists(file) || std::strchr(mode, 'r') == nullptr)
  {
    return nullptr;
  }
  const bool isMesh = this->MeshName == file;
  std::vector<char> bytes;
  const std::string reason = ReadAll(isMesh ? this->Mesh : file, bytes);
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
  return new MemoryStream(std::move(bytes));
}

void AssimpFiles::Close(Assimp::IOStream* stream)
{
  delete stream;
}
}
