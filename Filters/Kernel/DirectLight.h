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
  std::vector<double> air;        ///< transmission there and back
  std::vector<double> energy;     ///< J
  double sum = 0.0;               ///< J

  /// Materials and `reflected`.
  void reflect(const ScanSetup& setup, const PrimaryHits& hits);

  /// The rest, for rays of `rayEnergy` J each. After reflect().
  void attenuate(const ScanSetup& setup, const PrimaryHits& hits, double rayEnergy);
};
}

#endif
