// SPDX-License-Identifier: BSD-3-Clause
#include "MeshStream.h"

#include <algorithm>
#include <new>
#include <type_traits>

namespace avianlidar::scene
{
namespace
{
constexpr char IsMesh = 'm';
constexpr char IsError = 'e';
constexpr char IsNoMemory = 'n';

/// Writes a value, or the number of values of a vector or a string and then the values.
struct Sender
{
  const WriteBytes& write;

  template <class T>
  void operator()(const T& value) const
  {
    if constexpr (std::is_trivially_copyable_v<T>)
    {
      this->write(&value, sizeof value);
    }
    else
    {
      (*this)(std::uint64_t{ value.size() });
      if constexpr (std::is_trivially_copyable_v<typename T::value_type>)
      {
        this->write(value.data(), value.size() * sizeof(typename T::value_type));
      }
      else
      {
        std::for_each(value.begin(), value.end(), *this);
      }
    }
  }
};

/// Reads the values that Sender writes. Memory grows only with received bytes, because the number
/// of values from a crashing program may be wrong.
struct Receiver
{
  const ReadBytes& read;

  template <class T>
  void operator()(T& value) const
  {
    if constexpr (std::is_trivially_copyable_v<T>)
    {
      this->read(&value, sizeof value);
    }
    else
    {
      using Element = typename T::value_type;
      constexpr bool isPlain = std::is_trivially_copyable_v<Element>;
      constexpr std::uint64_t piece = isPlain ? 1u << 20 : 1;
      std::uint64_t left = 0;
      for ((*this)(left); left > 0;)
      {
        const std::uint64_t count = std::min(left, piece);
        const std::size_t before = value.size();
        value.resize(before + count);
        if constexpr (isPlain)
        {
          this->read(&value[before], count * sizeof(Element));
        }
        else
        {
          (*this)(value.back());
        }
        left -= count;
      }
    }
  }
};

/// Passes all members of a mesh to or from a stream.
template <class Stream, class AnyMesh>
void Pass(const Stream& stream, AnyMesh& mesh)
{
  stream(mesh.points);
  stream(mesh.triangles);
  stream(mesh.materials);
  stream(mesh.materialNames);
  stream(mesh.skippedFaces);
  stream(mesh.rounding);
  stream(mesh.upAxis);
  stream(mesh.warnings);
}
}

void SendName(const std::string& file, const WriteBytes& write)
{
  Sender{ write }(file);
}

std::string ReceiveName(const ReadBytes& read)
{
  std::string file;
  Receiver{ read }(file);
  return file;
}

void SendMesh(const Mesh& mesh, const WriteBytes& write)
{
  Sender{ write }(IsMesh);
  Pass(Sender{ write }, mesh);
}

void SendError(const std::string& reason, const WriteBytes& write)
{
  Sender{ write }(IsError);
  Sender{ write }(reason);
}

void SendNoMemory(const WriteBytes& write)
{
  Sender{ write }(IsNoMemory);
}

Mesh ReceiveMesh(const ReadBytes& read)
{
  const Receiver receive{ read };
  char kind = 0;
  receive(kind);
  if (kind == IsError)
  {
    std::string reason;
    receive(reason);
    fail(reason);
  }
  if (kind == IsNoMemory)
  {
    throw std::bad_alloc();
  }
  Mesh mesh;
  Pass(receive, mesh);
  return mesh;
}
}
