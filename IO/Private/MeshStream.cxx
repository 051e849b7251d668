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

template <class T>
void Send(const T& value, const WriteBytes& write)
{
  static_assert(std::is_trivially_copyable_v<T>);
  write(&value, sizeof value);
}

/// A vector or a string: how many values, then these.
template <class Values>
void SendAll(const Values& values, const WriteBytes& write)
{
  static_assert(std::is_trivially_copyable_v<typename Values::value_type>);
  Send<std::uint64_t>(values.size(), write);
  write(values.data(), values.size() * sizeof(typename Values::value_type));
}

void SendTexts(const std::vector<std::string>& texts, const WriteBytes& write)
{
  Send<std::uint64_t>(texts.size(), write);
  for (const std::string& text : texts)
  {
    SendAll(text, write);
  }
}

template <class T>
T Receive(const ReadBytes& read)
{
  T value;
  read(&value, sizeof value);
  return value;
}

/// Memory grows with what arrives: a count from a damaged process asks for none.
template <class Values>
Values ReceiveAll(const ReadBytes& read)
{
  constexpr std::uint64_t piece = 1u << 20;
  Values values;
  for (auto left = Receive<std::uint64_t>(read); left > 0;)
  {
    const std::uint64_t count = std::min(left, piece);
    const std::size_t before = values.size();
    values.resize(before + count);
    read(&values[before], count * sizeof(typename Values::value_type));
    left -= count;
  }
  return values;
}

std::vector<std::string> ReceiveTexts(const ReadBytes& read)
{
  std::vector<std::string> texts;
  for (auto left = Receive<std::uint64_t>(read); left > 0; --left)
  {
    texts.push_back(ReceiveAll<std::string>(read));
  }
  return texts;
}
}

void SendMesh(const Mesh& mesh, const WriteBytes& write)
{
  Send(IsMesh, write);
  SendAll(mesh.points, write);
  SendAll(mesh.triangles, write);
  SendAll(mesh.materials, write);
  SendTexts(mesh.materialNames, write);
  Send(mesh.skippedFaces, write);
  Send(mesh.rounding, write);
  Send(mesh.upAxis, write);
  SendTexts(mesh.warnings, write);
}

void SendError(const std::string& reason, const WriteBytes& write)
{
  Send(IsError, write);
  SendAll(reason, write);
}

void SendNoMemory(const WriteBytes& write)
{
  Send(IsNoMemory, write);
}

Mesh ReceiveMesh(const ReadBytes& read)
{
  const char kind = Receive<char>(read);
  if (kind == IsError)
  {
    throw Error(ReceiveAll<std::string>(read));
  }
  if (kind == IsNoMemory)
  {
    throw std::bad_alloc();
  }
  Mesh mesh;
  mesh.points = ReceiveAll<std::vector<Vec3>>(read);
  mesh.triangles = ReceiveAll<std::vector<std::array<std::int64_t, 3>>>(read);
  mesh.materials = ReceiveAll<std::vector<int>>(read);
  mesh.materialNames = ReceiveTexts(read);
  mesh.skippedFaces = Receive<std::int64_t>(read);
  mesh.rounding = Receive<double>(read);
  mesh.upAxis = Receive<char>(read);
  mesh.warnings = ReceiveTexts(read);
  return mesh;
}
}
