// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Propagation.h
 * @brief Attenuation of light in air.
 *
 * Coefficients are in 1/m everywhere (the paper's 0.088 and 0.035 have no unit; here they are read
 * as 1/km).
 *
 * Source: paper, Sec. 2.3, Eq. 9; of a visibility: P. W. Kruse et al., Elements of Infrared
 * Technology (1962), with the exponents of I. I. Kim et al., Proc. SPIE 4214 (2001).
 * Differs: coefficients are per metre.
 * Valid: homogeneous air. Where the transmission underflows it is 0.
 * Test: TestPropagation.cxx.
 */
#ifndef avianlidar_Propagation_h
#define avianlidar_Propagation_h

#include <cmath>

namespace avianlidar
{
/// Share of the energy that is left after `length` metres of air: exp(-mu l) (paper, Eq. 9).
/// @param attenuation 1/m, >= 0 @param length m, >= 0, the whole way (a direct echo travels 2 r). 0
/// where it underflows.
inline double transmission(double attenuation, double length)
{
  // 0 * infinity is no length of air at all.
  return attenuation > 0.0 ? std::exp(-attenuation * length) : 1.0;
}

/// Visibility of clear air, m, for which makers' ranges are taken to hold (assumed).
constexpr double ClearVisibility = 23e3;

/// Attenuation coefficient of haze, 1/m. @param visibility at 550 nm, m, above 0
/// @param wavelength m
inline double attenuationOfVisibility(double visibility, double wavelength)
{
  const double km = 1e-3 * visibility;
  const double exponent = km > 50.0 ? 1.6
    : km > 6.0                      ? 1.3
    : km > 1.0                      ? 0.16 * km + 0.34
    : km > 0.5                      ? km - 0.5
                                    : 0.0;
  return 3.912 / visibility * std::pow(wavelength / 550e-9, -exponent);
}
}

#endif
