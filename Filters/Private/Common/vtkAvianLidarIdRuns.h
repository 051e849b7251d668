// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarIdRuns.h
 * @brief Ids of beams as runs of consecutive numbers, to find one that is there twice. Not
 * installed.
 */
#ifndef vtkAvianLidarIdRuns_h
#define vtkAvianLidarIdRuns_h

#include <cstdint>
#include <string>
#include <vector>

/// Ids from `first` on, `count` of them: a sensor numbers its beams so, and columns dealt to ranks
/// are a few such runs.
struct vtkAvianLidarIdRun
{
  std::uint64_t first;
  std::uint64_t count;
};

/// The ids in any order as runs, ascending. One that is there twice begins a run of its own.
std::vector<vtkAvianLidarIdRun> vtkAvianLidarRunsOf(std::vector<std::uint64_t> ids);

/// What is wrong if any id is in two of the runs, or nothing.
std::string vtkAvianLidarRepeatedIdError(std::vector<vtkAvianLidarIdRun> runs);

#endif
