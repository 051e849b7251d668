// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarCoverageOutput.h"

#include "CoverageSurvey.h"
#include "vtkAvianLidarEchoOutput.h"
#include "vtkAvianLidarText.h"

#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using avianlidar::CoverageShares;

constexpr double Infinity = std::numeric_limits<double>::infinity();

/// Columns of a table, to which rows are added.
class Columns
{
public:
  Columns()
  {
    for (const Arrays::Name& name :
      { Arrays::HeightFrom, Arrays::HeightTo, Arrays::Places, Arrays::DetectionProbability,
        Arrays::DetectionStdError, Arrays::TrackProbability, Arrays::TrackStdError })
    {
      this->Numbers.push_back(Arrays::Make<vtkDoubleArray>(name));
    }
    for (std::string status : vtkAvianLidarCoverageStatusNames)
    {
      std::replace(status.begin(), status.end(), ' ', '_');
      const std::string name = "share_" + status;
      this->Numbers.push_back(Arrays::Make<vtkDoubleArray>({ name.c_str(), "1" }));
    }
  }

  /// Add a row, unless the sum contains no places.
  void Add(const std::string& region, const std::string& species, double from, double to,
    const CoverageShares& sum)
  {
    if (!(sum.detected.weight[0] > 0.0))
    {
      return;
    }
    std::vector<double> row = { from, to, sum.detected.weight[0], sum.detected.mean(),
      sum.detected.stdError(), sum.tracked.mean(), sum.tracked.stdError() };
    for (const double weight : sum.byStatus)
    {
      row.push_back(weight / sum.detected.weight[1]);
    }
    this->Region->InsertNextValue(vtkAvianLidarText(region));
    this->Species->InsertNextValue(vtkAvianLidarText(species));
    for (std::size_t c = 0; c < row.size(); ++c)
    {
      this->Numbers[c]->InsertNextValue(row[c]);
    }
  }

  void MoveTo(vtkTable* table) const
  {
    table->AddColumn(this->Region);
    table->AddColumn(this->Species);
    for (const auto& column : this->Numbers)
    {
      table->AddColumn(column);
    }
  }

private:
  vtkSmartPointer<vtkStringArray> Region = Arrays::Make<vtkStringArray>(Arrays::Region);
  vtkSmartPointer<vtkStringArray> Species = Arrays::Make<vtkStringArray>(Arrays::Species);
  std::vector<vtkSmartPointer<vtkDoubleArray>> Numbers;
};
}

const char* const vtkAvianLidarCoverageStatusNames[CoverageShares::Statuses] = { "outside the gate",
  "above the band", "below the band", "between beams", "shadowed", "in clutter", "too weak",
  "seen" };

//------------------------------------------------------------------------------
void vtkAvianLidarFillClutter(
  const avianlidar::ScanResult& still, const vtkAvianLidarBeams& beams, vtkPolyData* clutter)
{
  vtkAvianLidarEchoOutput::FillEchoes(still, beams, {}, clutter);
  clutter->GetPointData()->AddArray(Arrays::MakeOf<vtkDoubleArray>(
    Arrays::DetectionProbability, avianlidar::shareOfScans(beams.sensor, still.echoes)));
}

//------------------------------------------------------------------------------
void vtkAvianLidarCoverageTable::SumOverRanks(const vtkAvianLidarRanks& ranks)
{
  static_assert(
    std::is_trivially_copyable_v<CoverageShares> && sizeof(CoverageShares) % sizeof(double) == 0,
    "sums hold doubles alone");
  const std::size_t values = this->sums.size() * (sizeof(CoverageShares) / sizeof(double));
  auto mine = Arrays::Make<vtkDoubleArray>({ "sums", "" }, static_cast<vtkIdType>(values));
  std::memcpy(mine->GetPointer(0), this->sums.data(), values * sizeof(double));
  vtkNew<vtkDoubleArray> all;
  ranks.Gather(mine, all);
  this->sums.assign(this->sums.size(), CoverageShares());
  for (int rank = 0; rank < ranks.Size(); ++rank)
  {
    std::vector<CoverageShares> others(this->sums.size());
    std::memcpy(static_cast<void*>(others.data()),
      all->GetPointer(static_cast<vtkIdType>(rank * values)), values * sizeof(double));
    for (std::size_t i = 0; i < this->sums.size(); ++i)
    {
      this->sums[i].add(others[i]);
    }
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarCoverageTable::Fill(vtkTable* table) const
{
  Columns columns;
  const std::size_t limits = this->heightLimits.size();
  const auto addRows = [&](const std::string& region, const std::string& name,
                         const std::vector<CoverageShares>& bands)
  {
    for (std::size_t b = 0; b < limits; ++b)
    {
      columns.Add(region, name, this->heightLimits[b],
        b + 1 < limits ? this->heightLimits[b + 1] : Infinity, bands[b + 1]);
    }
    CoverageShares all;
    for (const CoverageShares& band : bands)
    {
      all.add(band);
    }
    columns.Add(region, name, -Infinity, Infinity, all);
  };
  for (std::size_t t = 0; t < this->species.size(); ++t)
  {
    std::vector<CoverageShares> everywhere(this->Bands());
    for (std::size_t r = 0; r < this->regions.size(); ++r)
    {
      const auto first =
        this->sums.begin() + static_cast<std::ptrdiff_t>(t * this->Cells() + r * this->Bands());
      const std::vector<CoverageShares> here(
        first, first + static_cast<std::ptrdiff_t>(this->Bands()));
      addRows(this->regions[r], this->species[t], here);
      for (std::size_t b = 0; b < here.size(); ++b)
      {
        everywhere[b].add(here[b]);
      }
    }
    if (this->regions.size() > 1)
    {
      addRows("all", this->species[t], everywhere);
    }
  }
  columns.MoveTo(table);
}
