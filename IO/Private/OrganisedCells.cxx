// SPDX-License-Identifier: BSD-3-Clause
#include "OrganisedCells.h"

#include <algorithm>
#include <numeric>

namespace avianlidar::formats
{
std::string organise(const ScanPattern& pattern, std::int64_t size,
  const std::function<std::int64_t(std::int64_t)>& beam,
  const std::function<int(std::int64_t)>& channel,
  const std::function<double(std::int64_t)>& strength, OrganisedCells& cells)
{
  constexpr std::int64_t mostCells = 100000000;
  const int channels = numberOfChannels(pattern);
  cells.width = numberOfColumns(pattern);
  if (cells.width > mostCells / channels)
  {
    return "its scan has " + std::to_string(cells.width) + " columns of " +
      std::to_string(channels) + " channels, more than 100 million cells";
  }
  cells.height = channels;
  cells.channelOfRow.resize(channels);
  std::iota(cells.channelOfRow.begin(), cells.channelOfRow.end(), 0);
  std::stable_sort(cells.channelOfRow.begin(), cells.channelOfRow.end(),
    [&](int a, int b) { return channelElevation(pattern, a) > channelElevation(pattern, b); });
  std::vector<int> rowOfChannel(channels);
  for (int row = 0; row < channels; ++row)
  {
    rowOfChannel[cells.channelOfRow[row]] = row;
  }
  cells.points.assign(static_cast<std::size_t>(cells.width * cells.height), -1);
  for (std::int64_t i = 0; i < size; ++i)
  {
    const std::int64_t id = beam(i);
    if (id < 0 || id >= cells.width * cells.height || channel(i) != id % channels)
    {
      return "point " + std::to_string(i) + " has the beam_id " + std::to_string(id) +
        " and the laser_id " + std::to_string(channel(i)) + ", which is no beam of a scan of " +
        std::to_string(cells.width) + " columns and " + std::to_string(channels) + " channels";
    }
    std::int64_t& at = cells.points[rowOfChannel[id % channels] * cells.width + id / channels];
    cells.several = cells.several || at >= 0;
    if (at < 0 || strength(i) > strength(at))
    {
      at = i;
    }
  }
  return std::string();
}
}
