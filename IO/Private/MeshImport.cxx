// SPDX-License-Identifier: BSD-3-Clause
#include "MeshImport.h"

#include "AvailableMemory.h"
#include "MeshFormats.h"
#include "MeshStream.h"

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace avianlidar::scene
{
namespace
{
std::string Program()
{
  if (const char* given = std::getenv("AVIANLIDAR_MESH_READER"))
  {
    return given;
  }
  Dl_info library{};
  const bool found = dladdr(reinterpret_cast<void*>(&Program), &library) && library.dli_fname;
  return vtksys::SystemTools::GetFilenamePath(
           vtksys::SystemTools::CollapseFullPath(found ? library.dli_fname : "")) +
    "/avianlidar/mesh-reader";
}

/// Returns the number that an environment variable gives, or `otherwise` if the variable is not
/// set.
double Limit(const char* variable, double otherwise)
{
  const char* text = std::getenv(variable);
  if (!text)
  {
    return otherwise;
  }
  char* end = nullptr;
  const double number = std::strtod(text, &end);
  failIf(end == text || *end != '\0' || !(number > 0.0), "the environment variable ", variable,
    " is '", text, "', expected a number above 0");
  return number;
}

/// Returns the limit of memory as the program's argument, bytes, or 0 for no limit.
std::string MostData()
{
  constexpr double share = 0.9; // share of the program, leaving memory for this process
  constexpr double gigabyte = 1e9;
  const double bytes =
    Limit("AVIANLIDAR_MESH_GIGABYTES", share * availableMemory() / gigabyte) * gigabyte;
  return std::to_string(bytes < 1e18 ? static_cast<std::uint64_t>(bytes) : 0);
}

/// Starts a program whose output is written to the descriptor. Returns 0, or the error number.
int Start(const std::vector<std::string>& words, int output, pid_t& pid)
{
  std::vector<char*> arguments;
  for (const std::string& word : words)
  {
    arguments.push_back(const_cast<char*>(word.c_str()));
  }
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  // The program must not inherit signals that this thread blocks or ignores.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&attributes, &signals);
  sigfillset(&signals);
  posix_spawnattr_setsigdefault(&attributes, &signals);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  const int error =
    posix_spawn(&pid, words.front().c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

/// Process of the program that reads a mesh.
class MeshReaderProcess
{
public:
  /// Starts the program on a file. Throws Error if the program cannot be started or if a limit is
  /// not a number above 0. @param keepGoing called about ten times a second while Read() waits
  MeshReaderProcess(const std::string& file, const std::function<bool()>& keepGoing)
    : Library(IsVtkFile(file) ? "VTK" : "Assimp")
    , KeepGoing(keepGoing)
    , Seconds(Limit("AVIANLIDAR_MESH_SECONDS", 3600.0))
    , Begin(std::chrono::steady_clock::now())
  {
    const std::vector<std::string> words = { Program(), file, MostData() };
    int ends[2];
    int error = pipe2(ends, O_CLOEXEC) == 0 ? 0 : errno;
    if (error == 0)
    {
      this->Pipe = ends[0];
      error = Start(words, ends[1], this->Pid);
      close(ends[1]);
    }
    if (error != 0)
    {
      this->Pid = -1;
      if (this->Pipe >= 0)
      {
        close(this->Pipe);
      }
      fail("the program that reads meshes, ", words.front(),
        ", cannot be started: ", std::strerror(error),
        "; expected it there, or where AVIANLIDAR_MESH_READER says");
    }
  }

  /// Kills the program if it is still running.
  ~MeshReaderProcess()
  {
    close(this->Pipe);
    if (this->Pid > 0)
    {
      kill(this->Pid, SIGKILL);
      this->HowItEnded();
    }
  }
  MeshReaderProcess(const MeshReaderProcess&) = delete;
  MeshReaderProcess& operator=(const MeshReaderProcess&) = delete;

  /// Reads the next bytes that the program sends. Throws Error if the program ends early or exceeds
  /// its time. Throws WorkStopped if keepGoing returns false.
  void Read(void* bytes, std::size_t size)
  {
    for (std::size_t got = 0; got < size;)
    {
      this->Wait();
      const ssize_t count = read(this->Pipe, static_cast<char*>(bytes) + got, size - got);
      if (count > 0)
      {
        got += static_cast<std::size_t>(count);
      }
      else if (count == 0 || (errno != EINTR && errno != EAGAIN))
      {
        fail(this->Library, " cannot read it: ", this->HowItEnded());
      }
    }
  }

private:
  /// Waits until bytes can be read or the pipe is closed.
  void Wait()
  {
    constexpr int pause = 100; // time between calls of KeepGoing, ms
    pollfd wanted{ this->Pipe, POLLIN, 0 };
    while (poll(&wanted, 1, pause) <= 0)
    {
      if (!this->KeepGoing())
      {
        throw WorkStopped();
      }
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - this->Begin;
      if (passed.count() > this->Seconds)
      {
        fail(this->Library, " cannot read it in ", std::llround(this->Seconds),
          " s: set the environment variable AVIANLIDAR_MESH_SECONDS to allow more");
      }
    }
  }

  std::string HowItEnded()
  {
    int status = 0;
    const pid_t ended = TEMP_FAILURE_RETRY(waitpid(this->Pid, &status, 0));
    this->Pid = -1;
    // The program's status is unknown if this process ignores SIGCHLD.
    if (ended <= 0 || !WIFSIGNALED(status))
    {
      return "the program that reads meshes ended early";
    }
    // The program has the limits of this process, and libraries may crash if memory runs out.
    rlimit addresses{};
    const bool isLimited =
      getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY;
    return std::string("it crashes on the file (") + strsignal(WTERMSIG(status)) + ")" +
      (isLimited ? ", or the memory that this process may have (ulimit -v) is too little" : "");
  }

  const std::string Library; // "VTK" or "Assimp", for messages
  const std::function<bool()>& KeepGoing;
  double Seconds = 0.0;
  std::chrono::steady_clock::time_point Begin;
  pid_t Pid = -1;
  int Pipe = -1;
};

// Returns the axis that points up after reading. Assimp turns Collada, 3DS, IFC and DXF to y. The
// specifications of glTF, AC3D, FBX and X3D require y. Other formats do not give the axis, and z is
// taken, as is usual in surveying.
char UpAxis(const std::string& file)
{
  const bool isY = EndsWithAny(UncompressedName(file),
    { ".dae", ".zae", ".3ds", ".ifc", ".stp", ".step", ".dxf", ".gltf", ".glb", ".ac", ".acc",
      ".ac3d", ".fbx", ".x3d" });
  return isY ? 'y' : 'z';
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
