// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MeshReaderProcess.h
 * @brief The program that reads one mesh file, started and watched.
 *
 * It is `avianlidar/mesh-reader` beside the library that contains this code, where the build and
 * the packages put it. Its limits are environment variables of the process that starts it:
 *
 * | variable                    | limits    | default                            |
 * |-----------------------------|-----------|------------------------------------|
 * | AVIANLIDAR_MESH_SECONDS     | its time  | 3600                               |
 * | AVIANLIDAR_MESH_GIGABYTES   | its data  | nine tenths of the memory there is |
 * | AVIANLIDAR_MESH_READER      | which program it is | the one beside the library |
 *
 * The program is started by posix_spawn: threads of this process may hold any lock meanwhile.
 */
#ifndef AvianLidarMeshReaderProcess_h
#define AvianLidarMeshReaderProcess_h

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

#include <sys/types.h>

namespace avianlidar::scene
{
class MeshReaderProcess
{
public:
  /// Starts the program on a file. Throws Error where it cannot be started or a limit is not a
  /// number. @param keepGoing is asked about ten times in a second while Read() waits
  MeshReaderProcess(const std::string& file, const std::function<bool()>& keepGoing);

  /// Ends the program if it still runs.
  ~MeshReaderProcess();
  MeshReaderProcess(const MeshReaderProcess&) = delete;
  MeshReaderProcess& operator=(const MeshReaderProcess&) = delete;

  /// The next bytes that it sends. Throws Error where it ended before, or its time is over;
  /// WorkStopped where keepGoing returns false.
  void Read(void* bytes, std::size_t size);

private:
  void Wait();
  std::string HowItEnded();

  const std::string Library; // which reads: "VTK" or "Assimp"
  const std::function<bool()>& KeepGoing;
  double Seconds = 0.0;
  std::chrono::steady_clock::time_point Begin;
  pid_t Pid = -1;
  int Pipe = -1;
};
}

#endif
