// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MeshReaderProcess.h
 * @brief Starts the program that reads one mesh file, and watches it.
 *
 * VTK and Assimp crash on some files, so they run in a process of their own: the program
 * `avianlidar/mesh-reader` beside the library that contains this code. These environment variables
 * set its limits:
 *
 * | variable                  | meaning             | default                         |
 * |---------------------------|---------------------|---------------------------------|
 * | AVIANLIDAR_MESH_SECONDS   | most time, s        | 3600                            |
 * | AVIANLIDAR_MESH_GIGABYTES | most memory, GB     | nine tenths of available memory |
 * | AVIANLIDAR_MESH_READER    | path of the program | the one beside the library      |
 *
 * The program is started by posix_spawn, not by fork: other threads may hold locks.
 *
 * Test: Testing/Python/TestMeshFiles.py, TestInputFiles.py.
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
  /// Starts the program on a file. Throws Error if it cannot be started or if a limit is not a
  /// number above 0. @param keepGoing called about ten times a second while Read() waits
  MeshReaderProcess(const std::string& file, const std::function<bool()>& keepGoing);

  /// Kills the program if it is still running.
  ~MeshReaderProcess();
  MeshReaderProcess(const MeshReaderProcess&) = delete;
  MeshReaderProcess& operator=(const MeshReaderProcess&) = delete;

  /// Reads the next bytes that the program sends. Throws Error if it ends before that or if its
  /// time is over, and WorkStopped if keepGoing returns false.
  void Read(void* bytes, std::size_t size);

private:
  void Wait();
  std::string HowItEnded();

  const std::string Library; // "VTK" or "Assimp", for messages
  const std::function<bool()>& KeepGoing;
  double Seconds = 0.0;
  std::chrono::steady_clock::time_point Begin;
  pid_t Pid = -1;
  int Pipe = -1;
};
}

#endif
