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
  LidarView view{ SpeedOfLight / sensor.frequency, sensor.halfBeamwidth };
  if (!sensor.hasRoundBeam())
  {
    const double across = sensor.halfBeamwidthAcross;
    view.across = across > 0.0 ? across : sensor.halfBeamwidth;
    view.isRectangle = sensor.beamOutline == BeamOutline::Rectangle;
  }
  return view;
}

namespace
{
/// keptInView() of a round field of view.
double keptWithin(double halfAngle, double wavelength, double slope)
{
  using boost::math::cyl_bessel_j;
  using boost::math::quadrature::gauss;
  constexpr double largest = 30.0; // largest diameter, in units of 1/slope
  const double scale = Pi * halfAngle / (wavelength * slope);
  const auto within = [](double x)
  { return 1.0 - std::pow(cyl_bessel_j(0, x), 2) - std::pow(cyl_bessel_j(1, x), 2); };
  const auto ofDrops = [&](double u)
  {
    return gauss<double, 30>::integrate(
      [&](double t) { return 0.5 * t * t * std::exp(-t) * within(scale * t / u); }, 0.0, largest);
  };
  return gauss<double, 20>::integrate(ofDrops, 0.0, 1.0);
}
}

double keptInView(const LidarView& view, double slope)
{
  if (!(view.across > 0.0))
  {
    return keptWithin(view.halfAngle, view.wavelength, slope);
  }
  // Airy's pattern is round: the mean over directions about the axis of round fields of view.
  const auto towards = [&](double angle)
  {
    const double x = std::cos(angle) / view.halfAngle;
    const double y = std::sin(angle) / view.across;
    const double edge = view.isRectangle ? std::max(x, y) : std::hypot(x, y);
    return keptWithin(1.0 / edge, view.wavelength, slope);
  };
  using boost::math::quadrature::gauss;
  const double corner = std::atan2(view.across, view.halfAngle);
  return (gauss<double, 10>::integrate(towards, 0.0, corner) +
           gauss<double, 10>::integrate(towards, corner, 0.5 * Pi)) /
    (0.5 * Pi);
}

DropLight::DropLight(double index, double absorption, const std::array<Term, 2>& rear)
  : terms{ { { std::pow((index - 1.0) / (index + 1.0), 2), 0.0 }, rear[0], rear[1] } }
{
  this->terms[1].loss *= absorption;
  this->terms[2].loss *= absorption;
}

Medium rainOf(
  double rate, const DropLight& light, const LidarView& view, double perVolume, double fall)
{
  const double lambda = fall * std::pow(rate, -0.21);                  // slope, 1/mm
  const double squares = perVolume * 2.0 / (lambda * lambda * lambda); // sum of D^2, mm^2/m^3
  const double areas = 0.25 * Pi * squares * 1e-6;                     // area of the drops, 1/m
  // A drop removes the light of twice its area from the beam. The lidar loses less, as diffracted
  // light is kept in the field of view. The backscatter does not depend on the field of view.
  const double lost = 2.0 - keptInView(view, 1e3 * lambda);
  Medium rain{ lost * areas, 1.0, perVolume / lambda };
  rain.light = light;
  double mean = 0.0; // efficiency weighted with the areas
  for (DropLight::Term& term : rain.light.terms)
  {
    term.loss /= 1e3 * lambda;
    mean += term.efficiency / std::pow(1.0 + term.loss, 3);
  }
  double square = 0.0; // mean square of a drop's energy, over the same without absorption
  for (DropLight::Term& one : rain.light.terms)
  {
    one.efficiency /= mean;
  }
  for (const DropLight::Term& one : rain.light.terms)
  {
    for (const DropLight::Term& two : rain.light.terms)
    {
      square += one.efficiency * two.efficiency / std::pow(1.0 + one.loss + two.loss, 5);
    }
  }
  rain.squareOfDrops = SquareOfDrops * square;
  rain.backscatterRatio = lost * 4.0 * Pi / mean;
  return rain;
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
