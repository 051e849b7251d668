// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EchoLabels.h
 * @brief Finds object, material, angle of incidence and share of secondary paths of an echo.
 *
 * The labels of a return are computed from all paths with a share in the return. The labels are the
 * object and material with the most energy, the mean angle of incidence, and the share of the
 * energy from paths with two reflections.
 *
 * Source: none.
 * Valid: a false alarm has no object, no material and no angle.
 * Test: TestScanReport.cxx, TestScan.cxx.
 */
#ifndef avianlidar_EchoLabels_h
#define avianlidar_EchoLabels_h

#include "BeamLight.h"
#include "Echo.h"
#include "RangeShares.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <vector>

namespace avianlidar
{
/// Energies of a return by object and material. A list is faster than a map, because a beam meets
/// few pairs of object and material. Most rays meet the same pair as the ray before. A LabelSums is
/// reused without allocation. Each thread needs its own object.
class LabelSums
{
public:
  void clear()
  {
    this->Sums.clear();
    this->Last = 0;
  }

  void add(int object, int material, double energy)
  {
    if (this->Sums.empty() || !this->Sums[this->Last].is(object, material))
    {
      this->Last = std::find_if(this->Sums.begin(), this->Sums.end(),
                     [=](const Sum& sum) { return sum.is(object, material); }) -
        this->Sums.begin();
      if (this->Last == this->Sums.size())
      {
        this->Sums.push_back({ object, material, 0.0 });
      }
    }
    this->Sums[this->Last].energy += energy;
  }

  struct Sum
  {
    int object;
    int material;
    double energy;
    bool is(int o, int m) const { return this->object == o && this->material == m; }
  };

  /// The largest sum. If sums are equal, the lowest object id is taken, then the lowest material
  /// id.
  const Sum& largest() const
  {
    return *std::min_element(this->Sums.begin(), this->Sums.end(),
      [](const Sum& a, const Sum& b)
      {
        return std::make_tuple(-a.energy, a.object, a.material) <
          std::make_tuple(-b.energy, b.object, b.material);
      });
  }

  /// Sum of all energies, J.
  double total() const
  {
    double sum = 0.0;
    for (const Sum& s : this->Sums)
    {
      sum += s.energy;
    }
    return sum;
  }

private:
  std::vector<Sum> Sums;
  std::size_t Last = 0;
};

/// Finds the labels of echoes. An EchoLabels is reused without allocation. Each thread needs its
/// own object.
class EchoLabels
{
public:
  /// The setup must outlive the object.
  explicit EchoLabels(const ScanSetup& setup)
    : Setup(setup)
  {
  }

  /// Set the labels of an echo. @param shares shares of the light's contributions in the return
  void label(const BeamLight& light, const RangeShares& shares, Echo& echo);

private:
  void findAngles(const BeamLight& light, const RangeShares& shares);
  bool meetsOneThing(const BeamLight& light) const;
  void findLargest(const BeamLight& light, const RangeShares& shares);

  const ScanSetup& Setup;
  LabelSums Sums;
  std::vector<double> Angles; ///< angles of incidence of the shares, rad
};
}

#endif
