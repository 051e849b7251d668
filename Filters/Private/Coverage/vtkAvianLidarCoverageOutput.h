// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarCoverageOutput.h
 * @brief Converts coverage to VTK: arrays of places, echoes of the surfaces, and a table of shares
 * by region, species and height band. Not installed.
 */
#ifndef vtkAvianLidarCoverageOutput_h
#define vtkAvianLidarCoverageOutput_h

#include "CoverageShares.h"
#include "Scan.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBeams.h"
#include "vtkAvianLidarRanks.h"

#include "vtkFloatArray.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <string>
#include <vector>

class vtkPolyData;
class vtkTable;

/// The arrays of the places.
class vtkAvianLidarPlaceArrays
{
public:
  /// @param poses number of poses with probabilities; 0: no array
  vtkAvianLidarPlaceArrays(vtkIdType places, int poses)
    : Probability(
        vtkAvianLidarArrays::Make<vtkFloatArray>(vtkAvianLidarArrays::DetectionProbability, places))
    , Tracked(
        vtkAvianLidarArrays::Make<vtkFloatArray>(vtkAvianLidarArrays::TrackProbability, places))
    , Electrons(
        vtkAvianLidarArrays::Make<vtkFloatArray>(vtkAvianLidarArrays::Photoelectrons, places))
    , LeastArea(
        vtkAvianLidarArrays::Make<vtkFloatArray>(vtkAvianLidarArrays::MinimumEffectiveArea, places))
    , Held(vtkAvianLidarArrays::Make<vtkIntArray>(vtkAvianLidarArrays::BeamsPerScan, places))
    , Status(vtkAvianLidarArrays::Make<vtkUnsignedCharArray>(vtkAvianLidarArrays::Status, places))
  {
    if (poses > 0)
    {
      this->Poses = vtkAvianLidarArrays::Make<vtkFloatArray>(
        vtkAvianLidarArrays::PoseProbabilities, places, poses);
      this->Poses->Fill(0.0);
    }
  }

  /// Probabilities of the poses at a place.
  float* PosesOf(std::size_t place)
  {
    return this->Poses->GetPointer(
      static_cast<vtkIdType>(place) * this->Poses->GetNumberOfComponents());
  }

  void Set(vtkIdType place, const avianlidar::CoverageValue& value, double track)
  {
    this->Probability->SetValue(place, static_cast<float>(value.probability));
    this->Tracked->SetValue(place, static_cast<float>(track));
    this->Electrons->SetValue(place, static_cast<float>(value.photoelectrons));
    this->LeastArea->SetValue(place, static_cast<float>(value.leastArea));
    this->Held->SetValue(place, value.beams);
    this->Status->SetValue(place, static_cast<unsigned char>(value.status));
  }

  void AddTo(vtkPointData* points) const
  {
    points->SetScalars(this->Probability);
    points->AddArray(this->Tracked);
    points->AddArray(this->Electrons);
    points->AddArray(this->Held);
    points->AddArray(this->LeastArea);
    points->AddArray(this->Status);
    if (this->Poses)
    {
      points->AddArray(this->Poses);
    }
  }

private:
  vtkSmartPointer<vtkFloatArray> Probability, Tracked, Electrons, LeastArea, Poses;
  vtkSmartPointer<vtkIntArray> Held;
  vtkSmartPointer<vtkUnsignedCharArray> Status;
};

/// Fill `clutter` with the echoes of a scan without noise and, for each echo, the share of scans
/// with noise in which the echo is detected.
void vtkAvianLidarFillClutter(
  const avianlidar::ScanResult& still, const vtkAvianLidarBeams& beams, vtkPolyData* clutter);

struct vtkAvianLidarCoverageTable
{
  std::vector<std::string> species;
  std::vector<std::string> regions;
  std::vector<double> heightLimits; ///< heights between the bands, m, rising

  /// Sums by species, region and height band. The first band lies below all limits.
  std::vector<avianlidar::CoverageShares> sums;

  std::size_t Bands() const { return this->heightLimits.size() + 1; }
  std::size_t Cells() const { return this->regions.size() * this->Bands(); } ///< sums per species

  /// Replace the sums by the sums over all ranks, on every rank.
  void SumOverRanks(const vtkAvianLidarRanks& ranks);

  /// Fill in the rows that vtkAvianLidarCoverage describes. @param table an empty table
  void Fill(vtkTable* table) const;
};

/// Name of each CoverageStatus.
extern const char* const vtkAvianLidarCoverageStatusNames[avianlidar::CoverageShares::Statuses];

#endif
