// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarCoverageTable.h
 * @brief Sums over places as a table: shares by region, species and height band. Not installed.
 */
#ifndef vtkAvianLidarCoverageTable_h
#define vtkAvianLidarCoverageTable_h

#include "CoverageShares.h"
#include "vtkAvianLidarRanks.h"

#include <string>
#include <vector>

class vtkTable;

struct vtkAvianLidarCoverageTable
{
  std::vector<std::string> species;
  std::vector<std::string> regions;
  std::vector<double> heightLimits; ///< m, rising

  /// By species, region, height band; the first band lies below all limits.
  std::vector<avianlidar::CoverageShares> sums;

  std::size_t Bands() const { return this->heightLimits.size() + 1; }
  std::size_t Cells() const { return this->regions.size() * this->Bands(); } ///< of a species

  /// Add the sums of all ranks up, on each of them.
  void SumOverRanks(const vtkAvianLidarRanks& ranks);

  /// Its rows, see vtkAvianLidarCoverage. @param table empty
  void Fill(vtkTable* table) const;
};

/// Words for each CoverageStatus.
extern const char* const vtkAvianLidarCoverageStatusNames[avianlidar::CoverageShares::Statuses];

#endif
