// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Propagation.h
 * @brief Attenuation of light in air.
 *
 * Coefficients are in 1/m everywhere (the paper's 0.088 and 0.035 are per kilometre).
 *
 * Source: paper, Sec. 2.3, Eq. 9; for haze, Kruse's law with the exponents of Kim, McArthur and
 * Korevaar (Proc. SPIE 4214, 2001).
 * Differs: coefficients are per metre; the law of haze is added.
 * Valid: homogeneous air; the law of haze for the visible and near infrared up to about 1.6 um.
 * Where the transmission underflows it is 0.
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

/**
 * Attenuation coefficient, 1/m, of haze at a visibility by Kruse's law with the exponents of Kim,
 * McArthur and Korevaar (Proc. SPIE 4214, 2001): 3.912/V (lambda/550 nm)^-q, q = 1.6 above 50
 * km, 1.3 from 6 km, 0.16 V + 0.34 from 1 km, V - 0.5 from 0.5 km (V in km), else 0. For the
 * visible and near infrared up to about 1.6 um.
 * @param visibility m, > 0 @param wavelength m, > 0; NaN for anything else
 */
inline double hazeAttenuation(double visibility, double wavelength)
{
  if (!(visibility > 0.0) || !(wavelength > 0.0))
  {
    return std::nan("");
  }
  const double v = visibility * 1e-3;
  double q = 0.0;
  if (v > 50.0)
  {
    q = 1.6;
  }
  else if (v >= 6.0)
  {
    q = 1.3;
  }
  else if (v >= 1.0)
  {
    q = 0.16 * v + 0.34;
  }
  else if (v >= 0.5)
  {
    q = v - 0.5;
  }
  return 3.912 / visibility * std::pow(wavelength / 550e-9, -q);
}
}

#endif
