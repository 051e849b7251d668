// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarIdRuns.h"

#include <algorithm>

//------------------------------------------------------------------------------
std::vector<vtkAvianLidarIdRun> vtkAvianLidarRunsOf(std::vector<std::uint64_t> ids)
{
  std::sort(ids.begin(), ids.end());
  std::vector<vtkAvianLidarIdRun> runs;
  for (const std::uint64_t id : ids)
  {
    if (runs.empty() || id != runs.back().first + runs.back().count)
    {
      runs.push_back({ id, 0 });
    }
    ++runs.back().count;
  }
  return runs;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarRepeatedIdError(std::vector<vtkAvianLidarIdRun> runs)
{
  std::sort(runs.begin(), runs.end(),
    [](const vtkAvianLidarIdRun& a, const vtkAvianLidarIdRun& b) { return a.first < b.first; });
  const auto twice = std::adjacent_find(runs.begin(), runs.end(),
    [](const vtkAvianLidarIdRun& a, const vtkAvianLidarIdRun& b)
    { return b.first < a.first + a.count; });
  if (twice == runs.end())
  {
    return {};
  }
  return "point array 'beam_id' holds " + std::to_string((twice + 1)->first) +
    " twice; expected the beams of one sensor (use one echo filter for each sensor instead of "
    "appending beams)";
}
