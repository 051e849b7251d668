// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file DirectLight.h
 * @brief Energies of the direct echoes of a beam (paper, Eq. 4-9): Q f_sur exp(-2 mu r) of every
 * hit, in a loop over lanes for the paper's own reflectance without an aperture (about 5 ns a hit),
 * one by one for the other models.
 */
#ifndef avianlidar_DirectLight_h
#define avianlidar_DirectLight_h

#include "PrimaryHits.h"
#include "ScanSetup.h"

#include <vector>

namespace avianlidar
{
/// One value per hit. Reusable without allocation; one per thread.
struct DirectLight
{
  std::vector<double> kd, ks, kp; ///< of the surfaces hit
  std::vector<double> reflected;  ///< f_direct, share of the ray's energy that its direct echo
                                  ///< returns (without air)
  bool materialsKnown = false;    ///< all of the above are those of the beam
  std::vector<double> energy;     ///< J
  double sum = 0.0;               ///< J
  double least = 0.0;             ///< J

  /// Begin a beam.
  void clear() { this->materialsKnown = false; }

  /// Materials and `reflected`, if they are not known yet.
  void reflect(const ScanSetup& setup, const PrimaryHits& hits);

  /// Energies, for N equal rays of `rayEnergy` J each; hits with shares have theirs. @param
  /// strengths f_direct of each hit
  void attenuate(const ScanSetup& setup, const PrimaryHits& hits,
    const std::vector<double>& strengths, double rayEnergy);
};
}

#endif
