// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file OrganisedCells.h
 * @brief Echoes in the rows and columns of their scan, as organised point clouds have them.
 *
 * Rows are channels, the highest elevation first; columns are the scan's, in the order of firing.
 */
#ifndef AvianLidarOrganisedCells_h
#define AvianLidarOrganisedCells_h

#include "ScanPattern.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace avianlidar::formats
{
struct OrganisedCells
{
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::vector<std::int64_t> points; ///< index of the point of a cell (row * width + column), or -1
  std::vector<int> channelOfRow;
  bool several = false; ///< a beam had more than one echo: the strongest is in its cell

  /// Beam of a cell, as the beam source numbers them.
  std::int64_t beamOf(std::int64_t cell) const
  {
    return cell % this->width * this->height + this->channelOfRow[cell / this->width];
  }
};

/// Sorts echoes into cells. Returns what is in the way, or an empty string: too many cells, a beam
/// outside the pattern, a channel that is not its beam's.
std::string organise(const ScanPattern& pattern, std::int64_t size,
  const std::function<std::int64_t(std::int64_t)>& beam,
  const std::function<int(std::int64_t)>& channel,
  const std::function<double(std::int64_t)>& strength, OrganisedCells& cells);
}

#endif
