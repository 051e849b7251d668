// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Main.cxx
 * @brief The program `mesh-reader BYTES` reads names of mesh files from standard input, and writes
 * each mesh to standard output (MeshStream.h), until the input ends. BYTES is the limit of memory
 * for data, bytes; 0 means no limit.
 *
 * The libraries that read meshes crash on some files, and never end on other files. In a separate
 * program they cannot crash or stop the process that reads the scene.
 */
#include "Imports.h"
#include "MeshImport.h"
#include "MeshStream.h"

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <new>
#include <string_view>
#include <unordered_map>

#include <malloc.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace avianlidar::scene
{
namespace
{
struct PointHash
{
  std::size_t operator()(const Point3& p) const
  {
    const Point3 sums{ p[0] + 0.0, p[1] + 0.0, p[2] + 0.0 }; // -0 becomes 0
    return std::hash<std::string_view>()({ reinterpret_cast<const char*>(&sums), sizeof sums });
  }
};

/// Merges points with identical coordinates. Triangles keep their number and order.
void MergePoints(Mesh& mesh)
{
  std::unordered_map<Point3, std::int64_t, PointHash> index;
  index.reserve(mesh.points.size());
  std::vector<Point3> points;
  std::vector<std::int64_t> target;
  for (const Point3& point : mesh.points)
  {
    const auto [known, isNew] = index.emplace(point, static_cast<std::int64_t>(points.size()));
    points.insert(points.end(), isNew ? 1 : 0, point);
    target.push_back(known->second);
  }
  for (auto& triangle : mesh.triangles)
  {
    triangle = { target[triangle[0]], target[triangle[1]], target[triangle[2]] };
  }
  mesh.points = std::move(points);
}

Mesh ReadMesh(const std::string& file)
{
  Mesh mesh = IsVtkFile(file) ? ReadVtkMesh(file) : ReadAssimpMesh(file);
  failIf(mesh.triangles.empty(), "holds no triangle");
  for (const Point3& p : mesh.points)
  {
    failIf(!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]),
      "has a vertex whose coordinates are not finite");
  }
  MergePoints(mesh);
  return mesh;
}

/// Returns a function that writes to a descriptor.
WriteBytes WriterTo(int output)
{
  return [output](const void* bytes, std::size_t size)
  {
    for (std::size_t written = 0; written < size;)
    {
      const ssize_t count =
        write(output, static_cast<const char*>(bytes) + written, size - written);
      if (count <= 0)
      {
        _exit(1); // the reader of the pipe has ended
      }
      written += static_cast<std::size_t>(count);
    }
  };
}

/// Reads from standard input, and ends the program at the end of the input.
void ReadInput(void* bytes, std::size_t size)
{
  for (std::size_t got = 0; got < size;)
  {
    const ssize_t count = read(STDIN_FILENO, static_cast<char*>(bytes) + got, size - got);
    if (count <= 0)
    {
      _exit(0); // without cleaning up, during which libraries may crash
    }
    got += static_cast<std::size_t>(count);
  }
}

/// Reads a file, and sends the mesh, or the reason why the file cannot be read.
void Answer(const std::string& file, const WriteBytes& write)
{
  try
  {
    SendMesh(ReadMesh(file), write);
  }
  catch (const Error& error)
  {
    SendError(error.what(), write);
  }
  catch (const std::bad_alloc&)
  {
    SendNoMemory(write);
  }
  catch (const std::exception& error)
  {
    SendError((IsVtkFile(file) ? "VTK cannot read it: " : "Assimp cannot read it: ") +
        std::string(error.what()),
      write);
  }
}

void Limit(rlim_t data)
{
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit none{ 0, 0 };
  setrlimit(RLIMIT_CORE, &none);
#ifndef AVIANLIDAR_SANITIZED
  if (data > 0)
  {
    const rlimit most{ data, data };
    setrlimit(RLIMIT_DATA, &most);
  }
#else
  (void)data; // unused, because the sanitizer's own tables count as data
#endif
}
}
}

int main(int argc, char* argv[])
{
  using namespace avianlidar::scene;
  if (argc != 2)
  {
    std::cerr << "mesh-reader BYTES: started by the avian-lidar library\n";
    return 2;
  }
  Limit(std::strtoull(argv[1], nullptr, 10));
  // Text that libraries print must not mix with the mesh.
  const WriteBytes write = WriterTo(dup(STDOUT_FILENO));
  dup2(STDERR_FILENO, STDOUT_FILENO);
  while (true)
  {
    Answer(ReceiveName(ReadInput), write);
    // A large mesh must not be kept beside its copy in the other process. Assimp takes 16 MB for
    // each file.
    malloc_trim(std::size_t(64) << 20);
  }
}
