// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LabelSums.h
 * @brief Energies of a return by object and material: a beam meets few, and neighbouring rays the
 * same, so that a list is faster than a map.
 */
#ifndef avianlidar_LabelSums_h
#define avianlidar_LabelSums_h

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <vector>

namespace avianlidar
{
/// Reusable without allocation; one per thread.
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

  /// Ties go to the lowest object, then material.
  const Sum& largest() const
  {
    return *std::min_element(this->Sums.begin(), this->Sums.end(),
      [](const Sum& a, const Sum& b)
      {
        return std::make_tuple(-a.energy, a.object, a.material) <
          std::make_tuple(-b.energy, b.object, b.material);
      });
  }

  /// J, of all.
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
}

#endif
