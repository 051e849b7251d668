// SPDX-License-Identifier: BSD-3-Clause
#include "AssimpFiles.h"

#include "VirtualFiles.h"

#include <assimp/IOStream.hpp>

#include <cpl_vsi.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <vector>

namespace avianlidar::scene
{
namespace
{
// The whole file in memory: a compressed one cannot be sought in, and Assimp seeks.
class MemoryStream : public Assimp::IOStream
{
public:
  explicit MemoryStream(std::vector<char> bytes)
    : Bytes(std::move(bytes))
  {
  }

  std::size_t Read(void* buffer, std::size_t size, std::size_t count) override
  {
    if (size == 0)
    {
      return 0;
    }
    const std::size_t items = std::min(count, (this->Bytes.size() - this->Position) / size);
    if (items > 0)
    {
      std::memcpy(buffer, this->Bytes.data() + this->Position, items * size);
      this->Position += items * size;
    }
    return items;
  }

  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }

  aiReturn Seek(std::size_t offset, aiOrigin origin) override
  {
    const std::size_t start =
      origin == aiOrigin_SET ? 0 : (origin == aiOrigin_CUR ? this->Position : this->Bytes.size());
    if (start + offset > this->Bytes.size())
    {
      return aiReturn_FAILURE;
    }
    this->Position = start + offset;
    return aiReturn_SUCCESS;
  }

  std::size_t Tell() const override { return this->Position; }
  std::size_t FileSize() const override { return this->Bytes.size(); }
  void Flush() override {}

private:
  std::vector<char> Bytes;
  std::size_t Position = 0;
};

bool ReadAll(const std::string& file, std::vector<char>& bytes)
{
  VSILFILE* handle = VSIFOpenL(file.c_str(), "rb");
  if (!handle)
  {
    return false;
  }
  const std::size_t chunk = 1u << 22;
  std::size_t got = 0;
  do
  {
    const std::size_t size = bytes.size();
    bytes.resize(size + chunk);
    got = VSIFReadL(bytes.data() + size, 1, chunk, handle);
    bytes.resize(size + got);
  } while (got == chunk);
  VSIFCloseL(handle);
  return true;
}
}

AssimpFiles::AssimpFiles(const std::string& mesh)
  : Mesh(mesh)
  , MeshName(UncompressedName(mesh))
{
}

std::string AssimpFiles::RealName(const char* file) const
{
  return this->MeshName == file ? VirtualName(this->Mesh) : std::string(file);
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
  // A pipe would wait for ever, a device never end; and GDAL takes names like /vsicurl/ for other
  // places than the file system.
  if (!this->Exists(file))
  {
    return nullptr;
  }
  const QuietGdal quiet;
  std::vector<char> bytes;
  // A damaged archive ends like a whole one, but not without an error.
  if (std::strchr(mode, 'r') == nullptr || !ReadAll(this->RealName(file), bytes) || quiet.Failed())
  {
    this->Reason = quiet.Reason();
    return nullptr;
  }
  return new MemoryStream(std::move(bytes));
}

void AssimpFiles::Close(Assimp::IOStream* stream)
{
  delete stream;
}
}
