// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target: bytes are a scene file and, after lines "=== name", the files that it may name.
// Reading them ends with a scene or with an error that says something; what a scene holds is sound.
#include "SceneBuilder.h"

#include "vtkObject.h"

#include <cpl_conv.h>
#include <cpl_error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <unistd.h>

namespace
{
namespace fs = std::filesystem;
using namespace avianlidar::scene;

/// Names that an input may give its files: nothing else is written.
const char* const Names[] = { "scene.lidarscene.json", "houses.geojson", "mesh.obj", "mesh.mtl",
  "mesh.stl", "mesh.vtk" };

/// A folder of this process, gone with it.
class Folder
{
public:
  Folder()
    : Path(fs::temp_directory_path() / ("avianlidar-fuzz-" + std::to_string(getpid())))
  {
    fs::create_directories(this->Path);
  }
  ~Folder()
  {
    std::error_code ignored;
    fs::remove_all(this->Path, ignored);
  }
  std::string fill(const std::string& text)
  {
    for (const char* name : Names)
    {
      std::error_code ignored;
      fs::remove(this->Path / name, ignored);
    }
    std::string name = Names[0];
    std::size_t begin = 0;
    while (begin <= text.size())
    {
      const std::size_t mark = std::min(text.find("\n=== ", begin), text.size());
      std::ofstream(this->Path / name, std::ios::binary) << text.substr(begin, mark - begin);
      if (mark == text.size())
      {
        break;
      }
      const std::size_t line = std::min(text.find('\n', mark + 1), text.size());
      const std::string asked = text.substr(mark + 5, line - mark - 5);
      const auto known = std::find(std::begin(Names) + 1, std::end(Names), asked);
      name = known == std::end(Names) ? Names[1] : *known;
      begin = line + 1;
    }
    return (this->Path / Names[0]).string();
  }

private:
  fs::path Path;
};

[[noreturn]] void fail(const char* what)
{
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

void check(const BuiltScene& built)
{
  const std::size_t materials = built.description.materials.size();
  for (const Part& part : built.parts)
  {
    const Mesh& mesh = part.mesh;
    for (const auto& p : mesh.points)
    {
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      {
        fail("a point that is not finite");
      }
    }
    for (const auto& t : mesh.triangles)
    {
      for (const auto corner : t)
      {
        if (static_cast<std::size_t>(corner) >= mesh.points.size())
        {
          fail("a triangle without a corner");
        }
      }
    }
    if (mesh.materials.size() != mesh.triangles.size())
    {
      fail("triangles without a material each");
    }
    for (const auto id : mesh.materials)
    {
      if (static_cast<std::size_t>(id) >= materials)
      {
        fail("a material that is none");
      }
    }
  }
}
}

extern "C" int LLVMFuzzerInitialize(int*, char***)
{
  vtkObject::GlobalWarningDisplayOff();
  CPLSetErrorHandler(CPLQuietErrorHandler);
  CPLSetConfigOption("GDAL_HTTP_TIMEOUT", "1");
  CPLSetConfigOption("CPL_VSIL_CURL_ALLOWED_FILENAME", "none");
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  static Folder folder;
  const std::string file = folder.fill(std::string(reinterpret_cast<const char*>(data), size));
  try
  {
    check(BuildScene(file, [](double) { return true; }));
  }
  catch (const std::exception& error)
  {
    if (std::string(error.what()).empty())
    {
      fail("an error that says nothing");
    }
  }
  return 0;
}
