// SPDX-License-Identifier: BSD-3-Clause
#include "Air.h"

#include "ValueError.h"
#include "Vector.h"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/bessel.hpp>

#include <algorithm>
#include <cmath>

namespace avianlidar
{
double attenuationOfVisibility(double visibility, double wavelength)
{
  const double km = 1e-3 * visibility;
  const double exponent = km > 50.0 ? 1.6
    : km > 6.0                      ? 1.3
    : km > 1.0                      ? 0.16 * km + 0.34
    : km > 0.5                      ? km - 0.5
                                    : 0.0;
  return 3.912 / visibility * std::pow(wavelength / 550e-9, -exponent);
}

double attenuationOf(double clear, const std::vector<PlacedMedium>& media)
{
  double sum = clear;
  for (const PlacedMedium& one : media)
  {
    sum += one.fillsScene() ? one.medium.extinction : 0.0;
  }
  return sum;
}

bool haveVolumes(const std::vector<PlacedMedium>& media)
{
  return std::any_of(
    media.begin(), media.end(), [](const PlacedMedium& one) { return !one.fillsScene(); });
}

LidarView viewOf(const Sensor& sensor)
{
  return { SpeedOfLight / sensor.frequency,
    2.0 * std::asin(std::min(1.0, std::sqrt(sensor.solidAngle() / (4.0 * Pi)))) };
}

double keptInView(const LidarView& view, double slope)
{
  using boost::math::cyl_bessel_j;
  using boost::math::quadrature::gauss;
  constexpr double largest = 30.0; // largest diameter, in units of 1/slope
  const double scale = Pi * view.halfAngle / (view.wavelength * slope);
  const auto within = [](double x)
  { return 1.0 - std::pow(cyl_bessel_j(0, x), 2) - std::pow(cyl_bessel_j(1, x), 2); };
  const auto ofDrops = [&](double u)
  {
    return gauss<double, 30>::integrate(
      [&](double t) { return 0.5 * t * t * std::exp(-t) * within(scale * t / u); }, 0.0, largest);
  };
  return gauss<double, 20>::integrate(ofDrops, 0.0, 1.0);
}

Medium rainOf(
  double rate, double backscatterRatio, const LidarView& view, double perVolume, double fall)
{
  const double lambda = fall * std::pow(rate, -0.21);                  // slope, 1/mm
  const double squares = perVolume * 2.0 / (lambda * lambda * lambda); // sum of D^2, mm^2/m^3
  const double areas = 0.25 * Pi * squares * 1e-6;                     // area of the drops, 1/m
  // A drop removes the light of twice its area from the beam. The lidar loses less, as diffracted
  // light is kept in the field of view. The backscatter ratio refers to twice the area.
  const double lost = 2.0 - keptInView(view, 1e3 * lambda);
  return { lost * areas, 0.5 * lost * backscatterRatio, perVolume / lambda };
}

std::string checkMedium(const Medium& medium)
{
  if (!(medium.extinction >= 0.0 && medium.extinction <= 1e30))
  {
    return valueError("extinction", medium.extinction, "0 to 1e30 1/m");
  }
  if (!(medium.backscatterRatio >= 1e-3 && medium.backscatterRatio <= 1e9))
  {
    return valueError("backscatter_ratio", medium.backscatterRatio, "1e-3 to 1e9 sr");
  }
  if (!(medium.drops >= 0.0 && medium.drops <= 1e12))
  {
    return valueError("drops", medium.drops, "0 to 1e12 1/m3");
  }
  if (!(medium.renewed >= 0.0 && medium.renewed <= 1.0))
  {
    return valueError("renewed", medium.renewed, "0 to 1");
  }
  return {};
}
}
