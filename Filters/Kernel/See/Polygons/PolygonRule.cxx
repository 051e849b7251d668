// SPDX-License-Identifier: BSD-3-Clause
#include "PolygonRule.h"

#include "LaneMath.h"
#include "Multiversion.h"
#include "Reflectance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Largest relative change of the range within a part, and largest change of the lobe's exponent.
constexpr double MostStretch = 0.01;
constexpr double MostFall = 0.05;

/// Change of range and lobe below which a part takes one sample.
constexpr double Level = 1e-5;

/// Exponents above which a lobe counts as zero beside a diffuse component, and by itself.
constexpr double NoLobe = 42.0;
constexpr double NothingReturned = 100.0;

/// Rules are used in beams wider than WideBeam, rad. Rules are also used for lobes if the squared
/// half-beamwidth exceeds NarrowLobe times the lobe's squared width.
constexpr double WideBeam = 0.02;
constexpr double NarrowLobe = 0.03;

/// Gauss-Legendre rule of ten points on [-1, 1].
constexpr int Points = 10;
constexpr double Places[Points] = { -0.973906528517171720, -0.865063366688984511,
  -0.679409568299024406, -0.433395394129247191, -0.148874338981631211, 0.148874338981631211,
  0.433395394129247191, 0.679409568299024406, 0.865063366688984511, 0.973906528517171720 };
constexpr double Weights[Points] = { 0.066671344308688138, 0.149451349150580593,
  0.219086362515982044, 0.269266719309996355, 0.295524224714752870, 0.295524224714752870,
  0.269266719309996355, 0.219086362515982044, 0.149451349150580593, 0.066671344308688138 };

/// Share of a part that rules may put beyond a border: the mean range of a chord leaves out the
/// lobe.
constexpr double UncertainRules = 1e-4;

/// Largest relative change of the range over one rule.
constexpr double MostStretchOfRule = 0.5;

/// Largest length of one rule along which profile or lobe are exp(-x^2).
constexpr double LengthOfRule = 2.5;

/// Ratio of the distances to which successive rules reach from a lobe whose flanks are powers.
constexpr double GrowthOfRules = 4.0;

double fraction(double x)
{
  return x - std::floor(x);
}

/// Share of a part's energy that may lie beyond its borders. A chord at a border has the border's
/// range on average, so that curvature acts in second order. Rounding moves the whole part.
/// @param near, far 1/z at the ends, 1/m @param curved, rounded errors of the range, m @param pulse
/// length of the pulse, m
AVIANLIDAR_ALWAYS_INLINE double uncertainOf(
  double near, double far, double curved, double rounded, double pulse)
{
  const double length = (near - far) / (near * far);
  const double longest = lanes::larger(length, pulse);
  const double ofPart = length > curved ? curved / length : 1.0;
  const double ofLongest = longest > curved ? curved / longest : 1.0;
  return ofPart * ofLongest + (longest > rounded ? rounded / longest : 1.0);
}

/// Mean of q^2 over a chord, weighted by the beam's profile.
double meanSquare(const DiscPolygon::Chord& chord, const RadialProfile& profile)
{
  const double a = chord.low;
  const double b = chord.high;
  const double plain = (a * a + a * b + b * b) / 3.0;
  constexpr double narrow = 1e-3;
  if (profile.profile == BeamProfile::Uniform || !(b - a > narrow))
  {
    return plain;
  }
  // exp(-s^2 q^2)
  const double s = std::sqrt(2.0) * profile.truncation;
  const double all = std::sqrt(0.25 * Pi) / s * (std::erf(s * b) - std::erf(s * a));
  return 0.5 / (s * s) *
    (1.0 - (b * std::exp(-s * s * b * b) - a * std::exp(-s * s * a * a)) / all);
}

/// Length of the pulse in range, m.
double lengthOf(const Sensor& sensor)
{
  const ReceivedPulse pulse(sensor, sensor.samplingInterval);
  return pulse.isRectangle() ? 0.5 * SpeedOfLight * sensor.pulseWidth
                             : pulse.width() * sensor.rangeUnitLength();
}
}

PolygonRule::PolygonRule(const ScanSetup& setup, double parts)
  : Setup(setup)
  , Shape(setup.sensor)
  , UnitLength(setup.sensor.rangeUnitLength() / parts)
  , PulseLength(lengthOf(setup.sensor))
  , LastBorder(setup.sensor.rangeGate)
{
  const ReceivedPulse pulse(setup.sensor, setup.sensor.samplingInterval / parts);
  this->Offsets[0] = fraction(pulse.before());
  this->Offsets[1] = fraction(-pulse.after());
  constexpr double same = 1e-9; // difference, in units
  const double apart = std::fabs(this->Offsets[0] - this->Offsets[1]);
  this->NumberOfOffsets = apart < same || apart > 1.0 - same || !pulse.isRectangle() ? 1 : 2;
  this->Tangent2 = this->Shape.width().tangent * this->Shape.width().tangent;
  this->ShareOfArea = this->Shape.shareOfArea();
}

double PolygonRule::Current::inverse(double p) const
{
  return std::max(this->leastInverse, this->base + this->slope * p);
}

double PolygonRule::rangeAt(double p, double radius2) const
{
  return std::sqrt(1.0 + this->Tangent2 * radius2) / this->Now.inverse(p);
}

/// Exponent of the lobe at a range of 1/inverse.
double PolygonRule::fallAt(double inverse) const
{
  const double cosine = std::min(1.0, this->Now.height * inverse);
  return (1.0 - cosine) * (1.0 + cosine) / this->Now.width2;
}

void PolygonRule::set(
  const PlaneSurface& surface, std::uint32_t triangle, const Extent& extent, bool faint)
{
  Current& now = this->Now;
  now.triangle = triangle;
  now.material = this->Setup.material(triangle);
  now.height = surface.height;
  now.leastInverse = surface.leastInverse;
  now.base = surface.inverse.z;
  now.slope = surface.inverse.slope();
  now.inverseSlope = 1.0 / now.slope;
  now.curved = this->curvatureOf(extent);
  now.rounded = this->roundingOf(now.height, extent);
  this->setLobe(extent.mostInverse);
  now.plain = this->UnitLength * extent.mostInverse <= MostStretch &&
    this->LastBorder * extent.leastInverse >= 1.0;
  now.byRules =
    this->takesRules() || (now.width2 > 0.0 && this->Tangent2 > NarrowLobe * now.width2);
  now.faint = faint && !now.byRules;
}

/// Difference between ranges on a straight line of equal z, m.
double PolygonRule::curvatureOf(const Extent& extent) const
{
  return 0.5 * this->Tangent2 *
    std::min(this->LastBorder, std::sqrt(1.0 + this->Tangent2) / extent.leastInverse);
}

/// Error of ranges by rounding, m.
double PolygonRule::roundingOf(double height, const Extent& extent) const
{
  const double farthest =
    std::min(this->LastBorder, std::sqrt(1.0 + this->Tangent2) / extent.leastInverse);
  return 32.0 * RoundOffDouble * farthest * farthest / height;
}

/// True if all polygons of the beam use rules, with a lobe or without.
bool PolygonRule::takesRules() const
{
  return this->Setup.sensor.beamProfile == BeamProfile::Gaussian ||
    this->Tangent2 > WideBeam * WideBeam;
}

/// Set the width of the lobe, 0 if the lobe does not matter. @param mostInverse largest 1/z, 1/m
void PolygonRule::setLobe(double mostInverse)
{
  Current& now = this->Now;
  now.width2 = lobeWidth2(now.material);
  if (now.width2 > 0.0 && now.material.isMatt() &&
    this->Setup.settings.reflectanceModel != ReflectanceModel::Microfacet &&
    this->fallAt(mostInverse) > NoLobe)
  {
    now.width2 = 0.0;
  }
}

/// p of the chord that has a range on average.
double PolygonRule::placeOf(double range) const
{
  const Current& now = this->Now;
  const double inverse = 1.0 / range;
  const auto placeAt = [&](double radius2)
  { return (std::sqrt(1.0 + this->Tangent2 * radius2) * inverse - now.base) * now.inverseSlope; };
  const double near = std::clamp(placeAt(0.5), this->Disc.least(), this->Disc.most());
  return placeAt(near * near + meanSquare(this->Disc.chordAt(near), this->Shape.profile()));
}

void PolygonRule::findBorders()
{
  this->Borders.clear();
  this->OfUnits.clear();
  this->Borders.push_back(this->Disc.least());
  this->OfUnits.push_back(0.0);
  this->addUnitBorders();
  const std::size_t count = this->Borders.size();
  this->addSmoothBorders(this->Borders[count - 1], this->Disc.most());
}

/// Add borders of range units, and smooth borders between them.
void PolygonRule::addUnitBorders()
{
  const Current& now = this->Now;
  const double least = this->Disc.least();
  const double most = this->Disc.most();
  this->Ranges.clear();
  const double margin = now.curved + now.rounded;
  const double from = (this->rangeAt(most, 0.0) - margin) / this->UnitLength;
  const double to =
    std::min(this->LastBorder, this->rangeAt(least, 1.0) + margin) / this->UnitLength;
  for (int k = 0; k < this->NumberOfOffsets; ++k)
  {
    const double offset = this->Offsets[k];
    const double first = std::max(std::floor(from - offset), -std::ceil(offset)) + 1.0;
    for (double unit = first; unit + offset < to; unit += 1.0)
    {
      this->Ranges.push_back((unit + offset) * this->UnitLength);
    }
  }
  if (this->NumberOfOffsets > 1)
  {
    std::sort(this->Ranges.begin(), this->Ranges.end());
  }
  std::reverse(this->Ranges.begin(), this->Ranges.end());
  for (const double range : this->Ranges)
  {
    const double p =
      now.slope > 0.0 ? this->placeOf(range) : (range > this->rangeAt(0.0, 0.5) ? least : most);
    const double place = std::clamp(p, this->Borders.back(), most);
    this->addSmoothBorders(this->Borders.back(), place);
    this->OfUnits.back() = 1.0;
  }
}

/// Add the border `to`. Before `to`, add as many borders as the change of range and lobe needs.
void PolygonRule::addSmoothBorders(double from, double to)
{
  const Current& now = this->Now;
  if (now.width2 == 0.0 && now.plain)
  {
    this->Borders.push_back(to);
    this->OfUnits.push_back(0.0);
    return;
  }
  const double near = now.inverse(to);
  const double far = now.inverse(from);
  const double stretch = now.byRules ? MostStretchOfRule : MostStretch;
  double parts = near > (1.0 + stretch) * far ? std::log(near / far) / stretch : 1.0;
  if (now.width2 > 0.0 && !now.byRules)
  {
    const double least = this->fallAt(near);
    const double most = this->fallAt(far);
    const bool microfacet = this->Setup.settings.reflectanceModel == ReflectanceModel::Microfacet;
    const double fall = microfacet
      ? 2.0 * std::log((1.0 + most) / (1.0 + least))
      : std::min(most, NothingReturned) - std::min(least, NothingReturned);
    parts = std::max(parts, fall / MostFall);
  }
  const int count = static_cast<int>(std::clamp(std::ceil(parts), 1.0, 1e6));
  for (int k = 1; k <= count; ++k)
  {
    this->Borders.push_back(k == count ? to : from + (to - from) * k / count);
    this->OfUnits.push_back(0.0);
  }
}

/// uncertainOf() the part between two borders.
double PolygonRule::uncertainty(double from, double to) const
{
  const Current& now = this->Now;
  return uncertainOf(
    now.inverse(to), now.inverse(from), now.curved, now.rounded, this->PulseLength);
}

/// Share of the pulse on an area of the disc. @param radius2 squared distance of the area from the
/// axis
double PolygonRule::shareOf(double area, double radius2) const
{
  const double secant2 = 1.0 + this->Tangent2 * radius2;
  const double share = area * this->ShareOfArea / (secant2 * std::sqrt(secant2));
  return share * rayDensity(this->Shape.profile(), std::min(1.0, radius2));
}

/// @param range range at which the node's energy arrives, m @param inverse 1 over the node's own
/// range, 1/m
void PolygonRule::addNode(double range, double inverse, double weight, double uncertain)
{
  BeamSamples& samples = this->Nodes->samples;
  samples.range.push_back(range);
  samples.cosine.push_back(std::min(1.0, this->Now.height * inverse));
  samples.weight.push_back(weight);
  this->Nodes->uncertain.push_back(uncertain);
}

/// Place one sample of a part, two samples along the part, or two more across the part if the lobe
/// needs them.
void PolygonRule::placeNodes(std::size_t part, double uncertain)
{
  const Current& now = this->Now;
  const double from = this->Borders[part];
  const double to = this->Borders[part + 1];
  const double area = this->Parts.area[part];
  if (!(area > 0.0))
  {
    return;
  }
  const double inverseArea = 1.0 / area;
  const double mean = std::clamp(this->Parts.p[part] * inverseArea, from, to);
  const double variance = std::max(0.0, this->Parts.pp[part] * inverseArea - mean * mean);
  const double across = std::clamp(this->Parts.qq[part] * inverseArea, 0.0, 1.0);
  const double radius2 = mean * mean + variance + across;
  const double share = this->shareOf(area, radius2);
  const double near = now.inverse(to);
  const double far = now.inverse(from);
  const double stretch = now.faint ? MostFaintStretch : Level;
  const bool single = this->Tangent2 <= stretch * now.width2; // one sample across suffices
  if (single && near - far <= stretch * far && this->fallAt(far) - this->fallAt(near) <= stretch)
  {
    const double range = this->rangeAt(mean, radius2);
    const double spread = now.slope * range; // slope of the logarithm of the range
    this->addNode(range * (1.0 + spread * spread * variance), 1.0 / range, share, uncertain);
    return;
  }
  const double off = std::sqrt(variance);
  const double places[] = { std::max(from, mean - off), std::min(to, mean + off) };
  if (single)
  {
    for (const double p : places)
    {
      const double range = this->rangeAt(p, p * p + across);
      this->addNode(range, 1.0 / range, 0.5 * share, uncertain);
    }
    return;
  }
  // Two values of q^2 with the mean and variance of the part. Both values are at least 0.
  const double beside2 = std::max(0.0, this->Parts.qqqq[part] * inverseArea - across * across);
  const double near2 = std::max(0.0, across - std::sqrt(beside2));
  const double far2 = across > near2 ? across + beside2 / (across - near2) : across;
  const double farther = far2 > near2 ? (across - near2) / (far2 - near2) : 0.0;
  for (const double p : places)
  {
    const double range = this->rangeAt(p, p * p + across);
    const double nearRange = this->rangeAt(p, p * p + near2);
    const double farRange = this->rangeAt(p, p * p + far2);
    this->addNode(uncertain == 0.0 ? nearRange : range, 1.0 / nearRange,
      0.5 * share * (1.0 - farther), uncertain);
    this->addNode(
      uncertain == 0.0 ? farRange : range, 1.0 / farRange, 0.5 * share * farther, uncertain);
  }
}

/// Exponent by which the profile and, if `lobe`, the lobe fall from the axis to the rim.
double PolygonRule::fallOfDisc(bool lobe) const
{
  const double width2 = lobe ? this->Now.width2 : 0.0;
  const RadialProfile& profile = this->Shape.profile();
  const double density =
    profile.profile == BeamProfile::Gaussian ? 2.0 * profile.truncation * profile.truncation : 0.0;
  return density + (width2 > 0.0 ? this->Tangent2 / width2 : 0.0) + this->Tangent2;
}

/// Divide a line into pieces within a lobe and beyond the lobe. @param centre of the lobe on that
/// line
void PolygonRule::divideAtLobe(
  double from, double to, double centre, std::vector<Piece>& pieces) const
{
  pieces.clear();
  const double radius =
    (1.0 + this->Tangent2) * std::sqrt(NoLobe * this->Now.width2 / this->Tangent2);
  if (this->Now.width2 == 0.0 || radius >= 1.0)
  {
    pieces.push_back({ from, to, true });
    return;
  }
  const bool far = this->Setup.settings.reflectanceModel == ReflectanceModel::Microfacet;
  const auto add = [&](double begin, double end, bool lobe)
  {
    begin = std::max(begin, from);
    end = std::min(end, to);
    if (begin < end)
    {
      pieces.push_back({ begin, end, lobe });
    }
  };
  add(centre - radius, centre + radius, true);
  for (double inner = radius; inner < std::max(centre - from, to - centre);)
  {
    const double outer = far ? GrowthOfRules * inner : std::numeric_limits<double>::infinity();
    add(centre - outer, centre - inner, false);
    add(centre + inner, centre + outer, false);
    inner = outer;
  }
  std::sort(pieces.begin(), pieces.end(),
    [](const Piece& one, const Piece& two) { return one.from < two.from; });
}

/// Place the samples of a part by rules along and across it.
void PolygonRule::placeRules(double from, double to, double uncertain)
{
  const Current& now = this->Now;
  const double scales[] = { std::sqrt(this->fallOfDisc(false)) / LengthOfRule,
    std::sqrt(this->fallOfDisc(true)) / LengthOfRule };
  const auto rulesOf = [&](const Piece& piece, double length)
  { return 1 + static_cast<int>(scales[piece.lobe] * length); };
  // The centre of the lobe, where the plane is met at right angles.
  constexpr double far = 1e3;
  const double centre =
    now.base * this->Tangent2 * far > now.slope ? now.slope / (now.base * this->Tangent2) : far;
  const bool isWide = this->Tangent2 > WideBeam * WideBeam;
  const bool apart = isWide || (now.width2 > 0.0 && this->Tangent2 > Level * now.width2);
  for (int k = 0; k < this->Disc.count(); ++k)
  {
    const DiscPolygon::Strip& strip = this->Disc.strip(k);
    const double begin = std::max(from, strip.from);
    const double end = std::min(to, strip.to);
    if (!(begin < end))
    {
      continue;
    }
    const double sides = std::max(
      strip.upper.at(begin) - strip.lower.at(begin), strip.upper.at(end) - strip.lower.at(end));
    const double chord =
      std::max(sides, strip.upper.at(0.5 * (begin + end)) - strip.lower.at(0.5 * (begin + end)));
    this->divideAtLobe(begin, end, centre, this->Along);
    for (const Piece& piece : this->Along)
    {
      // With p = sin(phi) the integrand has no square roots at the ends of arcs.
      const double phi0 = std::asin(std::clamp(piece.from, -1.0, 1.0));
      const double phi1 = std::asin(std::clamp(piece.to, -1.0, 1.0));
      const int along = rulesOf(piece, piece.to - piece.from);
      const double step = (phi1 - phi0) / along;
      for (int i = 0; i < along * Points; ++i)
      {
        const double phi = phi0 + step * (i / Points + 0.5 * (1.0 + Places[i % Points]));
        const double p = std::sin(phi);
        const double wide = 0.5 * step * Weights[i % Points] * std::cos(phi);
        const double low = strip.lower.at(p);
        const double high = strip.upper.at(p);
        // At borders of units the whole chord arrives at its mean range, as placeOf() assumes.
        const double range =
          this->rangeAt(p, p * p + meanSquare({ low, high }, this->Shape.profile()));
        double together = 0.0;
        this->divideAtLobe(low, high, 0.0, this->Across);
        for (const Piece& part : this->Across)
        {
          const int across = rulesOf(part, this->Across.size() == 1 ? chord : part.to - part.from);
          const double rows = (part.to - part.from) / across;
          for (int j = 0; j < across * Points && rows > 0.0; ++j)
          {
            const double q = part.from + rows * (j / Points + 0.5 * (1.0 + Places[j % Points]));
            const double radius2 = p * p + q * q;
            const double share = this->shareOf(wide * 0.5 * rows * Weights[j % Points], radius2);
            together += share;
            if (apart)
            {
              const double own = this->rangeAt(p, radius2);
              this->addNode(uncertain == 0.0 ? own : range, 1.0 / own, share, uncertain);
            }
          }
        }
        if (!apart && together > 0.0)
        {
          this->addNode(range, 1.0 / range, together, uncertain);
        }
      }
    }
  }
}

namespace
{
/// A polygon without a lobe, in lanes.
struct PlainPolygon
{
  double base, slope, leastInverse, height; ///< see PolygonRule::Current
  double tangent2, shareOfArea;
  double curved, rounded, pulse; ///< errors of the range by curvature and rounding, pulse length, m
  const double *borders, *ofUnits;
  const double *area, *p, *pp, *qq;
  double *range, *cosine, *weight, *uncertain; ///< results, by node

  AVIANLIDAR_ALWAYS_INLINE double inverse(double place) const
  {
    return lanes::larger(this->leastInverse, this->base + this->slope * place);
  }
  AVIANLIDAR_ALWAYS_INLINE double secant(double radius2) const
  {
    return std::sqrt(1.0 + this->tangent2 * radius2);
  }
};

/// Values that the nodes of a part share.
struct PlainPart
{
  double mean, variance, across, share, uncertain;
};

AVIANLIDAR_ALWAYS_INLINE PlainPart partOf(const PlainPolygon& c, std::size_t k)
{
  const double from = c.borders[k];
  const double to = c.borders[k + 1];
  const double uncertain =
    uncertainOf(c.inverse(to), c.inverse(from), c.curved, c.rounded, c.pulse);
  const bool any = c.area[k] > 0.0;
  const double area = any ? c.area[k] : 0.0;
  const double inverse = any ? 1.0 / c.area[k] : 0.0;
  const double mean = lanes::smaller(lanes::larger(c.p[k] * inverse, from), to);
  const double variance = lanes::larger(c.pp[k] * inverse - mean * mean, 0.0);
  const double across = lanes::unit(c.qq[k] * inverse);
  const double secant = c.secant(mean * mean + variance + across);
  return { mean, variance, across, area * c.shareOfArea / (secant * secant * secant),
    c.ofUnits[k] + c.ofUnits[k + 1] > 0.0 ? uncertain : 0.0 };
}

AVIANLIDAR_MULTIVERSION void placeOne(const PlainPolygon& polygon, std::size_t parts, double more)
{
  const PlainPolygon c = polygon;
#pragma omp simd
  for (std::size_t k = 0; k < parts; ++k)
  {
    const PlainPart part = partOf(c, k);
    const double own =
      c.secant(part.mean * part.mean + part.variance + part.across) / c.inverse(part.mean);
    const double spread = c.slope * own; // slope of the logarithm of the range
    c.range[k] = own * (1.0 + spread * spread * part.variance);
    c.cosine[k] = lanes::smaller(c.height / own, 1.0);
    c.weight[k] = part.share;
    c.uncertain[k] = part.uncertain + more;
  }
}

AVIANLIDAR_MULTIVERSION void placeTwo(const PlainPolygon& polygon, std::size_t parts)
{
  const PlainPolygon c = polygon;
#pragma omp simd
  for (std::size_t k = 0; k < parts; ++k)
  {
    const PlainPart part = partOf(c, k);
    const double off = std::sqrt(part.variance);
    const double one = lanes::larger(c.borders[k], part.mean - off);
    const double two = lanes::smaller(c.borders[k + 1], part.mean + off);
    const double nearer = c.secant(two * two + part.across) / c.inverse(two);
    const double farther = c.secant(one * one + part.across) / c.inverse(one);
    c.range[2 * k] = farther;
    c.range[2 * k + 1] = nearer;
    c.cosine[2 * k] = lanes::smaller(c.height / farther, 1.0);
    c.cosine[2 * k + 1] = lanes::smaller(c.height / nearer, 1.0);
    c.weight[2 * k] = c.weight[2 * k + 1] = 0.5 * part.share;
    c.uncertain[2 * k] = c.uncertain[2 * k + 1] = part.uncertain;
  }
}
}

/// Place one or two samples of each part of a polygon without a lobe.
void PolygonRule::placePlain()
{
  const Current& now = this->Now;
  const bool one =
    now.faint && this->UnitLength * now.inverse(this->Disc.most()) <= MostFaintStretch;
  BeamSamples& samples = this->Nodes->samples;
  const std::size_t parts = this->Borders.size() - 1;
  const std::size_t first = samples.range.size();
  const std::size_t all = first + (one ? parts : 2 * parts);
  samples.range.resize(all);
  samples.cosine.resize(all);
  samples.weight.resize(all);
  this->Nodes->uncertain.resize(all);
  const PlainPolygon polygon{ now.base, now.slope, now.leastInverse, now.height, this->Tangent2,
    this->ShareOfArea, now.curved, now.rounded, this->PulseLength, this->Borders.data(),
    this->OfUnits.data(), this->Parts.area.data(), this->Parts.p.data(), this->Parts.pp.data(),
    this->Parts.qq.data(), samples.range.data() + first, samples.cosine.data() + first,
    samples.weight.data() + first, this->Nodes->uncertain.data() + first };
  one ? placeOne(polygon, parts, MostFaintStretch / 12.0) : placeTwo(polygon, parts);
}

void PolygonRule::place(const PlaneSurface& surface, const PlaneRing& ring, PolygonNodes& nodes)
{
  const Current& now = this->Now;
  this->Nodes = &nodes;
  this->Disc.set(ring, { surface.inverse.x, surface.inverse.y });
  if (this->Disc.isEmpty())
  {
    return;
  }
  this->findBorders();
  if (!now.byRules)
  {
    this->Disc.measure(this->Borders, this->Parts);
  }
  if (!now.byRules && now.width2 == 0.0)
  {
    this->placePlain();
  }
  else
  {
    for (std::size_t k = 0; k + 1 < this->Borders.size(); ++k)
    {
      const double from = this->Borders[k];
      const double to = this->Borders[k + 1];
      if (from < to)
      {
        const bool borders = this->OfUnits[k] + this->OfUnits[k + 1] > 0.0;
        const double more = now.byRules ? UncertainRules : MostFaintStretch / 12.0;
        const double uncertain = (borders ? this->uncertainty(from, to) : 0.0) +
          ((now.byRules && borders) || now.faint ? more : 0.0);
        now.byRules ? this->placeRules(from, to, uncertain) : this->placeNodes(k, uncertain);
      }
    }
  }
  BeamSamples& samples = nodes.samples;
  const auto end = static_cast<std::uint32_t>(samples.range.size());
  if (samples.surfaces.empty() ? end > 0 : end > samples.surfaces.back().end)
  {
    samples.surfaces.push_back({ now.triangle, end });
  }
}

PolygonRule::Extent PolygonRule::extentOf(const PlaneSurface& surface, const PlaneRing& ring)
{
  const PlaneLine& w = surface.inverse;
  Extent extent{ w.at(ring.corners[0]), w.at(ring.corners[0]) };
  for (int i = 1; i < ring.size; ++i)
  {
    extent.leastInverse = std::min(extent.leastInverse, w.at(ring.corners[i]));
    extent.mostInverse = std::max(extent.mostInverse, w.at(ring.corners[i]));
  }
  const double nearest = 1.0 / surface.height;
  const double farthest = std::min(nearest, surface.leastInverse);
  return { std::clamp(extent.leastInverse, farthest, nearest),
    std::clamp(extent.mostInverse, farthest, nearest) };
}

bool PolygonRule::fits(const VisiblePolygons& seen, double most) const
{
  double nodes = 0.0;
  seen.forEach([&](const PlaneSurface& surface, const PlaneRing& ring)
    { nodes += this->count(surface.height, extentOf(surface, ring)); });
  return nodes <= most;
}

double PolygonRule::count(double height, const Extent& extent) const
{
  // Counted by whole range units, so that parts of units do not turn polygons into cells.
  const double nearest = 1.0 / extent.mostInverse;
  const double farthest = std::sqrt(1.0 + this->Tangent2) / extent.leastInverse;
  const double received = std::max(0.0, std::min(farthest, this->LastBorder) - nearest);
  if (!(this->curvatureOf(extent) + this->roundingOf(height, extent) <=
        MostCurved * this->unitLength()) ||
    !(farthest < MaximumGateUnits * this->unitLength()))
  {
    return std::numeric_limits<double>::infinity();
  }
  const bool rules = this->takesRules();
  const double parts = 1.0 + this->NumberOfOffsets * received / this->unitLength() +
    std::log(farthest / nearest) / (rules ? MostStretchOfRule : MostStretch);
  if (!rules)
  {
    return 2.0 * parts;
  }
  // See placeRules(). The strips of a polygon add a few parts.
  const double aside = 1.0 + std::floor(2.0 / LengthOfRule * std::sqrt(this->fallOfDisc(false)));
  return (parts + 2.0) * Points * Points * aside * aside;
}

}
