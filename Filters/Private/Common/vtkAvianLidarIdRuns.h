// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarIdRuns.h
 * @brief Stores ids of beams as runs of consecutive numbers, to find an id that occurs twice. Not
 * installed.
 */
#ifndef vtkAvianLidarIdRuns_h
#define vtkAvianLidarIdRuns_h

#include <cstdint>
#include <string>
#include <vector>

/// Consecutive ids, `count` of them, from `first` on. The beams of a sensor are one run, and the
/// columns of one rank are a few runs.
struct vtkAvianLidarIdRun
{
  std::uint64_t first;
  std::uint64_t count;
};

/// Ascending runs of ids that come in any order. An id that occurs twice begins a new run.
std::vector<vtkAvianLidarIdRun> vtkAvianLidarRunsOf(std::vector<std::uint64_t> ids);

/// An error text if an id is in two of the runs, else an empty string.
std::string vtkAvianLidarRepeatedIdError(std::vector<vtkAvianLidarIdRun> runs);

#endif
