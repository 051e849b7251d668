// SPDX-License-Identifier: BSD-3-Clause
#include "MeshImport.h"

#include "AvailableMemory.h"
#include "MeshStream.h"

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
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

/// Starts a program whose input and output are the descriptor. Returns 0, or the error number.
int Start(const std::vector<std::string>& words, int input, pid_t& pid)
{
  std::vector<char*> arguments;
  for (const std::string& word : words)
  {
    arguments.push_back(const_cast<char*>(word.c_str()));
  }
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, input, STDOUT_FILENO);
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

// The end of the program, other than after an answer.
struct ProgramEnded : Error
{
  using Error::Error;
};

// Returns the axis that points up after reading. Assimp turns Collada, 3DS, IFC and DXF to y. The
// specifications of glTF, AC3D and FBX require y. Other formats do not give the axis, and z is
// taken, as is usual in surveying.
char UpAxis(const std::string& file)
{
  const bool isY = EndsWithAny(UncompressedName(file),
    { ".dae", ".zae", ".3ds", ".ifc", ".stp", ".step", ".dxf", ".gltf", ".glb", ".ac", ".acc",
      ".ac3d", ".fbx" });
  return isY ? 'y' : 'z';
}
}

/// Process of the program that reads meshes.
class MeshReader::Process
{
public:
  /// Starts the program. Throws Error if the program cannot be started or if the limit of memory is
  /// not a number above 0.
  Process()
  {
    const std::vector<std::string> words = { Program(), MostData() };
    int ends[2];
    int error = socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0 ? 0 : errno;
    if (error == 0)
    {
      this->Socket = ends[0];
      error = Start(words, ends[1], this->Pid);
      close(ends[1]);
    }
    if (error != 0)
    {
      this->Pid = -1;
      if (this->Socket >= 0)
      {
        close(this->Socket);
      }
      fail("the program that reads meshes, ", words.front(),
        ", cannot be started: ", std::strerror(error),
        "; expected it there, or where AVIANLIDAR_MESH_READER says");
    }
  }

  /// Kills the program if it is still running.
  ~Process()
  {
    close(this->Socket);
    if (this->Pid > 0)
    {
      kill(this->Pid, SIGKILL);
      this->HowItEnded();
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Reads a file. Throws ProgramEnded if the program ends early, Error if it exceeds its time or
  /// says why it cannot read the file, and WorkStopped if keepGoing returns false.
  Mesh Read(const std::string& file, const std::function<bool()>& keepGoing)
  {
    this->Library = IsVtkFile(file) ? "VTK" : "Assimp";
    this->Seconds = Limit("AVIANLIDAR_MESH_SECONDS", 3600.0);
    this->Begin = std::chrono::steady_clock::now();
    // If the program has ended, the answer will be missing.
    SendName(file,
      [this](const void* bytes, std::size_t size)
      { static_cast<void>(send(this->Socket, bytes, size, MSG_NOSIGNAL)); });
    return ReceiveMesh(
      [&](void* bytes, std::size_t size) { this->Receive(bytes, size, keepGoing); });
  }

private:
  void Receive(void* bytes, std::size_t size, const std::function<bool()>& keepGoing)
  {
    for (std::size_t got = 0; got < size;)
    {
      this->Wait(keepGoing);
      const ssize_t count = read(this->Socket, static_cast<char*>(bytes) + got, size - got);
      if (count > 0)
      {
        got += static_cast<std::size_t>(count);
      }
      else if (count == 0 || (errno != EINTR && errno != EAGAIN))
      {
        throw ProgramEnded(joined(this->Library, " cannot read it: ", this->HowItEnded()));
      }
    }
  }

  /// Waits until bytes can be read or the program has ended.
  void Wait(const std::function<bool()>& keepGoing) const
  {
    constexpr int pause = 100; // time between calls of keepGoing, ms
    pollfd wanted{ this->Socket, POLLIN, 0 };
    while (poll(&wanted, 1, pause) <= 0)
    {
      if (!keepGoing())
      {
        throw WorkStopped();
      }
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - this->Begin;
      if (passed.count() > this->Seconds)
      {
        fail(this->Library, " cannot read it in ", this->Seconds,
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

  const char* Library = ""; // "VTK" or "Assimp", for messages
  double Seconds = 0.0;
  std::chrono::steady_clock::time_point Begin;
  pid_t Pid = -1;
  int Socket = -1;
};

MeshReader::MeshReader() = default;
MeshReader::~MeshReader() = default;

Mesh MeshReader::Read(const std::string& file, const std::function<bool()>& keepGoing)
{
  const bool isUsed = this->Running != nullptr;
  std::unique_ptr<Process> process =
    isUsed ? std::move(this->Running) : std::make_unique<Process>();
  try
  {
    Mesh mesh = process->Read(file, keepGoing);
    this->Running = std::move(process);
    return mesh;
  }
  catch (const ProgramEnded&)
  {
    if (!isUsed)
    {
      throw;
    }
  }
  catch (const std::bad_alloc&)
  {
    if (!isUsed)
    {
      throw;
    }
  }
  // Earlier files may be the reason, so a new process reads this file again.
  process.reset();
  return this->Read(file, keepGoing);
}

void TurnUp(const std::string& file, char upAxis, Mesh& mesh)
{
  const char said = mesh.upAxis ? mesh.upAxis : UpAxis(file);
  if ((upAxis ? upAxis : said) == 'y')
  {
    for (Point3& p : mesh.points)
    {
      p = { p[0], -p[2], p[1] };
    }
  }
}
}
