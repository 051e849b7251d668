// SPDX-License-Identifier: BSD-3-Clause
// Air that weakens light (paper, Eq. 9) and sends it back: a table calculated by hand, closed
// forms, and scans of air against counts by std::poisson_distribution.
#include "BeamReceiver.h"
#include "Drops.h"
#include "FollowedAir.h"
#include "Search905.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace avianlidar;
using namespace echotest;
using statistics::byMidpoints;

namespace
{
/// Of the table: mu = 3.912/V without the law of wavelengths.
Medium airOf(double visibility, double ratio)
{
  return { 3.912 / visibility, ratio, 0.0 };
}

/// The law of backscatter.
double lightOf(const Sensor& sensor, const Medium& air, double from, double to)
{
  const auto law = [&](double r)
  {
    return sensor.nearRangeShare(r) * std::min(sensor.receiverAperture / (r * r), 2.0 * Pi) *
      std::exp(-2.0 * air.extinction * r);
  };
  return sensor.pulseEnergy * air.backscatter() * byMidpoints(from, to, 20000, law);
}

double tail(double z)
{
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

/// Air of one medium that fills the scene.
FollowedAir filledBy(const Sensor& sensor, const Medium& medium)
{
  return { sensor, { 0.0, { { medium, {} } } } };
}

/// Variance by the drops of a unit, J^2.
double varianceOf(FollowedAir& air, std::int64_t unit)
{
  double sum = 0.0;
  for (const AirLight::Share& share : air.sharesOf(unit))
  {
    sum += share.mean * share.mean * air.scan.mediumAt(share.medium).squareOfDrops / share.drops;
  }
  return sum;
}

/// Points of so many beams through nothing but air, by unit.
std::vector<double> pointsOf(
  const Sensor& sensor, const ScanAir& air, int beams, std::vector<double>* runs = nullptr)
{
  BeamReceiver receiver(sensor, planNoise(sensor, true), 7, ReturnMode::RangeUnits, air);
  std::vector<double> counts;
  for (int beam = 0; beam < beams; ++beam)
  {
    const Received received = receiver.receive(static_cast<std::uint64_t>(beam),
      { {}, {}, sensor.backgroundRadiance }, BeamAir(air), DrawnLeaves());
    for (const Return& one : received.returns)
    {
      const auto unit = static_cast<std::size_t>(received.units[one.strongestUnit].index);
      counts.resize(std::max(counts.size(), unit + 1), 0.0);
      counts[unit] += 1.0;
      if (runs)
      {
        runs->push_back(one.air / one.returnEnergy);
      }
    }
  }
  return counts;
}

}

TEST(Medium, RainIsThatOfMarshallAndPalmer)
{
  const double rows[][3] = { { 1.0, 1951.0, 3.647e-4 }, { 5.0, 2736.0, 1.005e-3 },
    { 10.0, 3165.0, 1.556e-3 }, { 25.0, 3836.0, 2.771e-3 }, { 50.0, 4437.0, 4.288e-3 } };
  for (const auto& [rate, drops, extinction] : rows)
  {
    const Medium rain = rainOf(rate, 20.0, {});
    EXPECT_NEAR(rain.drops, drops, 0.5);
    EXPECT_NEAR(rain.extinction / extinction, 1.0, 3e-4);
    // Twice the cross-sections of the drops, and their mean square, by midpoints over diameters.
    const double fall = 4.1 * std::pow(rate, -0.21);
    double areas = 0.0, squares = 0.0, number = 0.0;
    for (double d = 0.0005; d < 20.0; d += 0.001)
    {
      const double count = 8000.0 * std::exp(-fall * d) * 0.001;
      const double area = 0.25 * Pi * d * d * 1e-6;
      number += count;
      areas += 2.0 * count * area;
      squares += count * area * area;
    }
    EXPECT_NEAR(areas / rain.extinction, 1.0, 1e-4);
    EXPECT_NEAR(squares / number * 4.0 * number * number / (areas * areas), SquareOfDrops, 1e-2);
  }
}

TEST(Medium, LightThatDropsDiffractIntoTheViewIsNotLost)
{
  // Airy's pattern 2 J1(x)^2/x, summed over angles; over drops, places on the way, and turns about
  // the axis by midpoints.
  constexpr double step = 0.01;
  std::vector<double> within = { 0.0 };
  for (double x = 0.5 * step; x < 500.0; x += step)
  {
    const double j = ::j1(x);
    within.push_back(within.back() + 2.0 * j * j / x * step);
  }
  const auto airy = [&](double x)
  {
    const double at = x / step;
    return at < static_cast<double>(within.size()) ? within[static_cast<std::size_t>(at)]
                                                   : 1.0 - 2.0 / (Pi * x);
  };
  struct Row
  {
    double wavelength, along, across; ///< m, half-angles in rad
    BeamOutline outline;
    double kept; ///< in rain of 10 mm/h; NaN: not known
  };
  const BeamOutline ellipse = BeamOutline::Ellipse;
  for (const Row& row :
    { Row{ 903e-9, 0.95e-3, 0.95e-3, ellipse, 0.87 }, Row{ 905e-9, 1.5e-3, 1.5e-3, ellipse, 0.92 },
      Row{ 1550e-9, 3e-3, 3e-3, ellipse, 0.93 }, Row{ 905e-9, 5.6e-3, 5.6e-3, ellipse, 0.98 },
      Row{ 905e-9, 1e-5, 1e-5, ellipse, 0.034 }, Row{ 905e-9, 2.443e-3, 2.618e-4, ellipse, NAN },
      Row{ 905e-9, 2.443e-3, 2.618e-4, BeamOutline::Rectangle, NAN } }) // the Avia's view
  {
    Sensor sensor = sensorOf(Search905);
    sensor.frequency = SpeedOfLight / row.wavelength;
    sensor.halfBeamwidth = row.along;
    sensor.halfBeamwidthAcross = row.across;
    sensor.beamOutline = row.outline;
    std::vector<double> edges; // half-angles of the view, over a quarter of a turn
    const int turns = row.along == row.across ? 1 : 50;
    for (int k = 0; k < turns; ++k)
    {
      const double turn = 0.5 * Pi * (k + 0.5) / turns;
      const double u = std::cos(turn) / row.along;
      const double v = std::sin(turn) / row.across;
      edges.push_back(1.0 / (row.outline == ellipse ? std::hypot(u, v) : std::max(u, v)));
    }
    for (const double rate : { 1.0, 10.0, 50.0 })
    {
      const double slope = 4.1e3 * std::pow(rate, -0.21); // 1/m
      double kept = 0.0, weight = 0.0;
      for (double d = 5e-6; d < 8e-3; d += 1e-5)
      {
        const double area = d * d * std::exp(-slope * d);
        for (double u = 0.0025; u < 1.0; u += 0.005)
        {
          for (const double edge : edges)
          {
            kept += area * airy(Pi * d * edge / (row.wavelength * u));
            weight += area;
          }
        }
      }
      kept /= weight;
      const LidarView view = viewOf(sensor);
      EXPECT_NEAR(keptInView(view, slope), kept, 1e-3) << row.along << " " << rate;
      EXPECT_TRUE(rate != 10.0 || std::isnan(row.kept) || std::fabs(kept - row.kept) < 0.005);
      const Medium all = rainOf(rate, 20.0, {});
      const Medium seen = rainOf(rate, 20.0, view);
      EXPECT_NEAR(seen.extinction / all.extinction, 1.0 - 0.5 * kept, 1e-3);
      EXPECT_NEAR(seen.backscatter() / all.backscatter(), 1.0, 1e-12);
      EXPECT_EQ(seen.drops, all.drops);
    }
  }
}

TEST(Medium, AbsorbingDropsReturnLittleLight)
{
  // Over diameters by midpoints: mean light and its mean square, with losses as at 1550 nm.
  const DropLight light(1.3109, 1.083e3, { { { 0.154, 2.2 }, { 1.18, 11.2 } } });
  for (const double rate : { 1.0, 10.0 })
  {
    const double slope = 4.1e3 * std::pow(rate, -0.21);
    double areas = 0.0, back = 0.0, squares = 0.0, number = 0.0;
    for (double d = 5e-7; d < 2e-2; d += 1e-6)
    {
      const double count = std::exp(-slope * d);
      const double q =
        0.018122 + 0.154 * std::exp(-2.2 * 1083.0 * d) + 1.18 * std::exp(-11.2 * 1083.0 * d);
      number += count;
      areas += count * d * d;
      back += count * d * d * q;
      squares += count * std::pow(d * d * q, 2);
    }
    const Medium rain = rainOf(rate, light, {});
    EXPECT_NEAR(rain.backscatterRatio / (8.0 * Pi * areas / back), 1.0, 1e-3);
    EXPECT_NEAR(rain.squareOfDrops / (squares * number / (back * back)), 1.0, 1e-3);
    // Drops drawn one by one have this mean and this mean square.
    double mean = 0.0, square = 0.0;
    constexpr int draws = 400000;
    for (int k = 0; k < draws; ++k)
    {
      double energy = 1.0; // of few drops, beyond the mean of 1
      addDropsBeyondMean(
        1, static_cast<std::uint64_t>(k), 1, 0, 1.0, 0.5, rain, PulseShares(), &energy);
      mean += energy / draws;
      square += (energy - 1.0) * (energy - 1.0) / draws;
    }
    EXPECT_NEAR(mean, 1.0, 0.015);
    EXPECT_NEAR(square / (rain.squareOfDrops / 0.5), 1.0, 0.04);
  }
}

TEST(Medium, BadOnesAreNamed)
{
  EXPECT_EQ(checkMedium({ 0.5, 20.0, 0.0 }), "");
  EXPECT_EQ(checkMedium({ -1.0, 20.0, 0.0 }), "extinction is -1, expected 0 to 1e30 1/m");
  EXPECT_EQ(checkMedium({ 1.0, 0.0, 0.0 }), "backscatter_ratio is 0, expected 1e-3 to 1e9 sr");
}

TEST(Attenuation, EndsOfTheRange)
{
  EXPECT_EQ(transmission(0.0, 1e9), 1.0);
  EXPECT_EQ(transmission(0.0, std::numeric_limits<double>::infinity()), 1.0);
  EXPECT_EQ(transmission(1.0, 0.0), 1.0);
  EXPECT_EQ(transmission(1.0, 1e9), 0.0);
}

TEST(Attenuation, OfHaze)
{
  EXPECT_NEAR(attenuationOfVisibility(23e3, 905e-9), 8.9e-5, 0.02e-5);
  EXPECT_NEAR(attenuationOfVisibility(23e3, 550e-9), 3.912 / 23e3, 1e-12);
  EXPECT_NEAR(attenuationOfVisibility(200.0, 1550e-9), 3.912 / 200.0, 1e-12); // fog: all colours
  double before = 1.0;
  for (double visibility = 100.0; visibility < 1e5; visibility *= 1.01)
  {
    const double now = attenuationOfVisibility(visibility, 1550e-9);
    EXPECT_LT(now, before) << visibility;
    before = now;
  }
}

TEST(Air, TheTableHolds)
{
  struct Row
  {
    Instrument of;
    double visibility, ratio, electrons[4], airTo, gullTo;
  };
  const Row rows[] = {
    { Search905, 23000.0, 50.0, { 5166.4, 1269.8, 306.8, 131.8 }, 136.8, 650.9 },
    { Search905, 5000.0, 50.0, { 22353.7, 5167.6, 1104.8, 419.9 }, 247.7, 553.5 },
    { Search905, 1000.0, 18.8, { 217380.9, 36748.9, 4201.3, 853.9 }, 317.4, 345.9 },
    { Search905, 200.0, 18.8, { 227325.3, 8036.6, 40.2, 0.4 }, 144.3, 152.5 },
    { Search1550, 23000.0, 50.0, { 41477.1, 10194.0, 2463.2, 1058.2 }, 461.3, 1551.1 },
    { Search1550, 1000.0, 18.8, { 1745202.0, 295031.0, 33729.5, 6855.4 }, 516.8, 570.7 },
    { Automotive16, 1000.0, 18.8, { 15.1, 2.6, 0.3, 0.1 }, 12.4, 115.0 },
  };
  for (const Row& row : rows)
  {
    const Sensor sensor = sensorOf(row.of);
    const PhotonReceiver receiver(sensor);
    const Medium air = airOf(row.visibility, row.ratio);
    FollowedAir echo = filledBy(sensor, air);
    const double length = sensor.rangeUnitLength();
    for (int k = 0; k < 4; ++k)
    {
      const double r = k == 0 ? 50.0 : 100.0 * k;
      const double n =
        receiver.electronsPerJoule * lightOf(sensor, air, r - 0.5 * length, r + 0.5 * length);
      EXPECT_NEAR(n, row.electrons[k], std::max(0.051, 1e-3 * row.electrons[k])) << r;
    }
    const double threshold = receiver.electronsPerJoule * sensor.lowerEnergyLimit;
    double airTo = 0.0;
    double gullTo = 0.0;
    for (std::int64_t unit = 0; unit < unitsInsideGate(5e-9, sensor.rangeGate); ++unit)
    {
      const double middle = length * (static_cast<double>(unit) + 0.5);
      const double n = receiver.electronsPerJoule * echo.followed(unit);
      airTo = n > threshold ? middle : airTo;
      const double gull =
        receiver.electronsPerJoule * energyFromTarget(sensor, middle, 0.03, 0.3, air.extinction);
      gullTo = gull > threshold * receiver.growthInAir(n) ? middle : gullTo;
    }
    EXPECT_NEAR(airTo, row.airTo, length + 0.05);
    EXPECT_NEAR(gullTo, row.gullTo, length + 0.05);
  }
}

TEST(Air, UnitsAreIntegralsOfTheLaw)
{
  Sensor sensor = sensorOf(Search905);
  for (const double overlap : { 0.0, 6.0 })
  {
    sensor.overlapRange = overlap;
    for (const double extinction : { 1e-5, 4e-3, 0.3, 20.0 })
    {
      const Medium air{ extinction, 30.0, 0.0 };
      FollowedAir echo = filledBy(sensor, air);
      for (const std::int64_t unit : { 1, 2, 10, 300 })
      {
        const double from = sensor.rangeUnitLength() * static_cast<double>(unit);
        const double truth = lightOf(sensor, air, from, from + sensor.rangeUnitLength());
        EXPECT_NEAR(echo.followed(unit), truth, 2e-6 * truth + 1e-300) << unit << " " << extinction;
      }
      // Nearest, an aperture gathers no more than half of all.
      const double first = lightOf(sensor, air, 0.0, sensor.rangeUnitLength());
      EXPECT_NEAR(echo.followed(0), first, 1e-4 * first);
      EXPECT_LT(echo.followed(0), sensor.pulseEnergy * 2.0 * Pi / 30.0);
    }
  }
  // Nothing arrives before the gate; the unit in which it begins is recorded in part.
  sensor.minimumRange = 1.7;
  const Medium air{ 1e-4, 30.0, 2.0 };
  FollowedAir gated = filledBy(sensor, air);
  const double length = sensor.rangeUnitLength();
  EXPECT_EQ(gated.followed(0), 0.0);
  EXPECT_EQ(gated.followed(1), 0.0);
  const double part = lightOf(sensor, air, 1.7, 3.0 * length);
  EXPECT_NEAR(gated.followed(2), part, 2e-6 * part);
  const double drops =
    2.0 * sensor.solidAngle() * (std::pow(3.0 * length, 3) - std::pow(1.7, 3)) / 3.0;
  EXPECT_NEAR(
    varianceOf(gated, 2), SquareOfDrops * part * part / drops, 1e-5 * varianceOf(gated, 2));
  EXPECT_FALSE(ScanAir(sensor, { 0.1, {} }).fillsScene());
  sensor.receiverAperture = 0.0;
  EXPECT_FALSE(filledBy(sensor, { 0.1, 20.0, 0.0 }).scan.fillsScene());
}

TEST(Air, FalseAlarmsInFogAreThoseOfItsNoise)
{
  Sensor sensor = sensorOf(Search905);
  EXPECT_EQ(setPhotonLimits(sensor, 3000.0, 40.0, 15360.0), "");
  const PhotonReceiver receiver(sensor);
  const Medium air = airOf(1000.0, 18.8);
  FollowedAir echo = filledBy(sensor, air);
  const double k = sensor.lowerEnergyLimit * receiver.electronsPerJoule / receiver.deviation(0.0);
  constexpr int beams = 3000;
  const auto units = static_cast<double>(unitsInsideGate(5e-9, sensor.rangeGate));
  // A threshold that follows leaves all units alike.
  const std::vector<double> follows = pointsOf(sensor, echo.scan, beams);
  const double expected = beams * units * tail(k);
  EXPECT_NEAR(statistics::sumOf(follows), expected, 3.0 * std::sqrt(expected));
  sensor.thresholdLaw = ThresholdLaw::Fixed;
  std::vector<double> ofAir;
  const std::vector<double> fixed = pointsOf(sensor, echo.scan, beams, &ofAir);
  double truth = 0.0;
  double variance = 0.0;
  std::size_t last = 0; // where the air is as likely perceived as not
  for (std::int64_t unit = 0; unit < static_cast<std::int64_t>(units); ++unit)
  {
    const double n = receiver.electronsPerJoule * echo.followed(unit);
    const double p =
      tail((receiver.electronsPerJoule * sensor.lowerEnergyLimit - n) / receiver.deviation(n));
    truth += beams * p;
    variance += beams * p * (1.0 - p);
    last = p > 0.5 ? static_cast<std::size_t>(unit) : last;
  }
  EXPECT_NEAR(statistics::sumOf(fixed), truth, 3.0 * std::sqrt(variance));
  EXPECT_NEAR(fixed[last], 0.5 * beams, 0.2 * beams);
  EXPECT_GT(std::count_if(ofAir.begin(), ofAir.end(), [](double share) { return share > 0.5; }),
    0.95 * static_cast<double>(ofAir.size()));
}

TEST(Air, DropsAreACompoundPoissonLaw)
{
  Sensor sensor = sensorOf(Search905);
  sensor.pulseWidth = 0.0;
  const Medium rain = rainOf(10.0, 20.0, {});
  FollowedAir echo = filledBy(sensor, rain);
  std::mt19937_64 random(3);
  for (const std::int64_t unit : { 2, 8, 14, 40, 200 })
  {
    const double length = sensor.rangeUnitLength();
    const double near = length * static_cast<double>(unit);
    const double far = near + length;
    const double number =
      rain.drops * sensor.solidAngle() * (far * far * far - near * near * near) / 3.0;
    constexpr int draws = 20000;
    double mean = 0.0, square = 0.0, high = 0.0, theirs = 0.0;
    const double mean0 = echo.followed(unit);
    const double limit = 1.5 * std::sqrt(SquareOfDrops / number); // over the mean, relative
    std::poisson_distribution<int> poisson(number);
    std::exponential_distribution<double> diameter(1.0);
    for (int beam = 0; beam < draws; ++beam)
    {
      double whole = 0.0;
      for (const AirLight::Share& share : echo.sharesOf(unit))
      {
        addDropsBeyondMean(1, static_cast<std::uint64_t>(beam), static_cast<std::uint64_t>(unit), 0,
          share.mean, share.drops, rain, PulseShares(), &whole);
      }
      const double beyond = whole / mean0;
      mean += beyond / draws;
      square += beyond * beyond / draws;
      high += beyond > limit ? 1.0 / draws : 0.0;
      double all = 0.0;
      for (int drop = poisson(random); drop > 0; --drop)
      {
        const double d = diameter(random);
        all += 0.5 * d * d;
      }
      theirs += all / number - 1.0 > limit ? 1.0 / draws : 0.0;
    }
    const double variance = SquareOfDrops / number;
    EXPECT_NEAR(mean, 0.0, 4.0 * std::sqrt(variance / draws)) << unit;
    EXPECT_NEAR(square / variance, 1.0, 0.15) << unit;
    EXPECT_NEAR(varianceOf(echo, unit) / (variance * mean0 * mean0), 1.0, 1e-9);
    EXPECT_NEAR(high, theirs, 0.01) << unit; // of a gamma distribution, in part
  }
}

TEST(Air, DropsShareTheirPulsesBetweenUnits)
{
  // Drops anywhere: a unit has 1 - w/3 of the variance that it has of short pulses, w/6 in common
  // with the next, and third moments fall to 1 - w/2.
  constexpr int cells = 200000;
  const Medium rain = rainOf(10.0, 20.0, {});
  for (const double width : { 0.3, 1.0, 2.0 })
  {
    const PulseShares pulse(width);
    for (const double number : { 30.0, 60.0 })
    {
      SharedDrops drops(pulse);
      double mean = 0.0, square = 0.0, cube = 0.0, next = 0.0, before = 0.0;
      for (std::int64_t unit = 0; unit < cells; ++unit)
      {
        const double here = drops.in(unit,
          [&](std::int64_t of, double* units) {
            addDropsBeyondMean(
              3, 1, static_cast<std::uint64_t>(of), 0, 1.0, number, rain, pulse, units);
          });
        mean += here / cells;
        square += here * here / cells;
        cube += here * here * here / cells;
        next += here * before / cells;
        before = here;
      }
      const double variance = SquareOfDrops / number;
      // Of many drops the third moment is that of the gamma distribution; E[D^6]/E[D^2]^3 = 90.
      const double third = number > FewDrops ? 2.0 * variance * variance : 90.0 / (number * number);
      const bool narrow = width <= 1.0;
      EXPECT_NEAR(mean, 0.0, 0.005);
      EXPECT_NEAR(square / variance,
        narrow ? 1.0 - width / 3.0 : (width - 1.0 / 3.0) / (width * width), 0.02);
      EXPECT_NEAR(next / variance, narrow ? width / 6.0 : 0.25, 0.015);
      EXPECT_NEAR(cube / third, narrow ? 1.0 - width / 2.0 : 0.1875, 0.06) << width << number;
    }
  }
}

TEST(Air, PointsOfRainAreThoseOfDropsOneByOne)
{
  const Sensor sensor = sensorOf(Search905);
  const PhotonReceiver receiver(sensor);
  const Medium rain = rainOf(10.0, 20.0, viewOf(sensor));
  FollowedAir echo = filledBy(sensor, rain);
  const double length = sensor.rangeUnitLength();
  const double far = 160.0; // m
  const auto units = static_cast<std::size_t>(far / length) - 2;
  std::mt19937_64 random(5);
  constexpr int beams = 40;
  const double slope = 4.1e3 * std::pow(10.0, -0.21); // 1/m
  std::poisson_distribution<int> count(rain.drops * sensor.solidAngle() * far * far * far / 3.0);
  std::exponential_distribution<double> diameter(slope);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  std::vector<double> theirs(units, 0.0);
  for (int beam = 0; beam < beams; ++beam)
  {
    std::vector<double> light(units + 4, 0.0);
    for (int drop = count(random); drop > 0; --drop)
    {
      // Anywhere in the cone; twice its area over S per steradian, of the light that meets it.
      const double r = far * std::cbrt(uniform(random));
      const double d = diameter(random);
      const double energy = sensor.pulseEnergy * 2.0 * 0.25 * Pi * d * d / 20.0 *
        std::min(sensor.receiverAperture / (r * r), 2.0 * Pi) / (sensor.solidAngle() * r * r) *
        std::exp(-2.0 * rain.extinction * r);
      const double begin = r / length - 0.5; // of the pulse, as long as a unit
      if (begin > 0.0)
      {
        const auto unit = static_cast<std::size_t>(begin);
        light[unit] += energy * (1.0 - begin + static_cast<double>(unit));
        light[unit + 1] += energy * (begin - static_cast<double>(unit));
      }
    }
    for (std::size_t unit = 0; unit < units; ++unit)
    {
      const double mean = echo.followed(static_cast<std::int64_t>(unit));
      const double noise = normal(random) *
        receiver.deviation(receiver.electronsPerJoule * light[unit]) / receiver.electronsPerJoule;
      const double lower =
        sensor.lowerEnergyLimit * receiver.growthInAir(receiver.electronsPerJoule * mean);
      theirs[unit] += light[unit] + noise - mean > lower ? 1.0 / beams : 0.0;
    }
  }
  const auto between = [&](const std::vector<double>& points, double from, double to)
  {
    double all = 0.0;
    for (auto unit = static_cast<std::size_t>(from / length); unit < to / length; ++unit)
    {
      all += unit < points.size() ? points[unit] : 0.0;
    }
    return all;
  };
  // Nearer than 8 m the mean of the rain blinds the receiver.
  constexpr int ours = 400;
  std::vector<double> points = pointsOf(sensor, echo.scan, ours);
  for (const auto& [from, to] :
    { std::pair(8.0, 50.0), std::pair(50.0, 100.0), std::pair(100.0, 150.0) })
  {
    const double truth = between(theirs, from, to);
    const double error = std::sqrt(truth / beams + truth / ours); // at most
    EXPECT_NEAR(between(points, from, to) / ours, truth, 3.0 * error) << from;
  }
}

TEST(Air, DropsAreDrawnWithoutNoisePhotons)
{
  // A rate of 1e-9/s gives no photon in these beams. A unit holds 0.3 drops, and the limit lies at
  // twice the mean energy of a drop.
  Sensor sensor = sensorOf(Search905);
  sensor.receiverModel = ReceiverModel::EnergyLimits;
  sensor.halfBeamwidth = 1.5e-4;
  sensor.pulseWidth = 0.0;
  const Medium rain = rainOf(10.0, 20.0, viewOf(sensor));
  const std::size_t unit = 60;
  FollowedAir echo = filledBy(sensor, rain);
  const AirLight::Share share = echo.sharesOf(unit).front();
  sensor.lowerEnergyLimit = 2.0 * share.mean / share.drops;
  std::mt19937_64 random(7);
  std::poisson_distribution<int> poisson(share.drops);
  std::exponential_distribution<double> diameter(1.0);
  constexpr int beams = 4000;
  double theirs = 0.0;
  for (int beam = 0; beam < beams; ++beam)
  {
    double light = 0.0;
    for (int drop = poisson(random); drop > 0; --drop)
    {
      light += 0.5 * std::pow(diameter(random), 2);
    }
    theirs += light > 2.0 ? 1.0 : 0.0;
  }
  std::vector<std::vector<double>> points;
  for (const double rate : { 0.0, 1e-9 })
  {
    sensor.noisePhotonRate = rate;
    points.push_back(pointsOf(sensor, filledBy(sensor, rain).scan, beams));
    ASSERT_GT(points.back().size(), unit);
    EXPECT_NEAR(points.back()[unit], theirs, 3.0 * std::sqrt(2.0 * theirs));
  }
  EXPECT_EQ(points[0], points[1]);
}

TEST(Air, NearAirBlinds)
{
  // Where the air alone is above the upper limit nothing is perceived.
  Sensor sensor = sensorOf(Search905);
  const Medium air = airOf(200.0, 18.8);
  FollowedAir echo = filledBy(sensor, air);
  BeamReceiver receiver(sensor, planNoise(sensor, false), 7, ReturnMode::All, echo.scan);
  std::int64_t blind = 0;
  while (echo.followed(blind) > sensor.upperEnergyLimit)
  {
    ++blind;
  }
  EXPECT_GT(blind, 5);
  const double wall = 0.5 * sensor.upperEnergyLimit;
  const auto returnsAt = [&](std::int64_t unit)
  {
    const std::vector<RangeUnit> units = { { unit, wall, 1 } };
    return receiver.receive(1, { units, {}, sensor.backgroundRadiance }, echo.along, DrawnLeaves())
      .returns;
  };
  EXPECT_TRUE(returnsAt(blind - 3).empty());
  const std::vector<Return> returns = returnsAt(blind + 20);
  ASSERT_EQ(returns.size(), 1u);
  EXPECT_NEAR(returns[0].energyReceived, wall, 1e-12 * wall);
  EXPECT_LE(returns[0].energy, sensor.upperEnergyLimit - echo.followed(blind + 20));
}
