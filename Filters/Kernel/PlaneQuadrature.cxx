// SPDX-License-Identifier: BSD-3-Clause
#include "PlaneQuadrature.h"

#include "LaneMath.h"
#include "Multiversion.h"
#include "PathStrengths.h"
#include "Propagation.h"
#include "Reflectance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace avianlidar
{
namespace
{
/// In x, of which a whole beam has pi/2.
constexpr double WidestPanel = 0.9;

constexpr double TurnsPerRadian = 1.0 / (2.0 * Pi);

AVIANLIDAR_ALWAYS_INLINE double sineOf(double angle)
{
  double cosine = 0.0;
  double sine = 0.0;
  lanes::cosSinOfTurns(angle * TurnsPerRadian, cosine, sine);
  return sine;
}

/// Angle in [0, pi/2] of a positive multiple of (cosine, sine), both at least 0.
AVIANLIDAR_ALWAYS_INLINE double angleOf(double cosine, double sine)
{
  const double inverse = 1.0 / std::sqrt(cosine * cosine + sine * sine);
  const bool small = sine < cosine;
  const double x = inverse * (small ? sine : cosine);
  const double angle = lanes::asin(x);
  return small ? angle : 1.57079632679489661923 - angle;
}

/// Angles of incidence at which a plane has these ranges.
AVIANLIDAR_MULTIVERSION void incidenceOfAll(
  double height, const double* ranges, double* angles, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double beyond = ranges[i] - height;
    const double across = (beyond > 0.0 ? beyond : 0.0) * (ranges[i] + height);
    angles[i] = angleOf(height, std::sqrt(across));
  }
}

/// x of b = least + (most - least) sin^2 x.
AVIANLIDAR_MULTIVERSION void placesOfAll(
  double least, double most, const double* angles, double* places, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double below = angles[i] - least;
    const double above = most - angles[i];
    places[i] = angleOf(std::sqrt(above > 0.0 ? above : 0.0), std::sqrt(below > 0.0 ? below : 0.0));
  }
}

/// The numbers of a disc that every node needs.
struct DiscNumbers
{
  double height, tilt, half;
  double piece;  ///< min(a, t)
  double start;  ///< |a - t|
  double beyond; ///< 2 max(0, t - a)
  double short_; ///< 2 max(0, a - t)
  double sineTilt;
  double density; ///< of solid angle: 1/(4 pi sin^2(t/2))
  double inverse; ///< 1/sin^2(t/2)
};

/// Integral of the Gaussian profile over the half arc, relative to its mean over the cone. @param
/// first u at the middle of the arc @param rise so that u = first + rise sin^2(phi/2)
AVIANLIDAR_ALWAYS_INLINE double gaussianArc(double arc, double first, double rise)
{
  constexpr double norm = 2.0 / 0.86466471676338730811; // 2/(1 - e^-2)
  double sum = 0.0;
  for (int k = 0; k < GaussPoints; ++k)
  {
    const double s = sineOf(0.5 * arc * GaussPlace[k]);
    sum += GaussWeight[k] * lanes::exp(-2.0 * (first + rise * (s * s)));
  }
  return norm * arc * sum;
}

/// From x, or b on full circles, to range, cosine and share.
template <bool Circles, bool Gaussian>
AVIANLIDAR_ALWAYS_INLINE void nodesOf(const DiscNumbers& disc, const double* variable,
  const double* weight, double* range, double* cosine, double* share, std::size_t count)
{
  const DiscNumbers d = disc;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    double b = variable[i];
    double arc = Pi;
    double slope = 1.0; // db over the variable
    double ahead = b - d.tilt;
    if constexpr (!Circles)
    {
      double c = 0.0;
      double s = 0.0;
      lanes::cosSinOfTurns(variable[i] * TurnsPerRadian, c, s);
      const double low = 2.0 * d.piece * (s * s);
      const double high = 2.0 * d.piece * (c * c);
      b = d.start + low;
      slope = 4.0 * d.piece * (s * c);
      ahead = low + (0.5 * d.beyond - d.piece);
      const double inside = sineOf(0.5 * (low + d.beyond)) * sineOf(0.5 * high);
      const double outside = sineOf(0.5 * (low + d.short_)) * sineOf(d.tilt + d.half - 0.5 * high);
      arc = 2.0 *
        angleOf(std::sqrt(outside > 0.0 ? outside : 0.0), std::sqrt(inside > 0.0 ? inside : 0.0));
    }
    double cosB = 0.0;
    double sinB = 0.0;
    lanes::cosSinOfTurns(b * TurnsPerRadian, cosB, sinB);
    if constexpr (Gaussian)
    {
      const double off = sineOf(0.5 * ahead);
      arc = gaussianArc(arc, off * off * d.inverse, sinB * d.sineTilt * d.inverse);
    }
    range[i] = d.height / cosB;
    cosine[i] = cosB < 1.0 ? cosB : 1.0;
    share[i] = weight[i] * (2.0 * arc) * slope * sinB * d.density;
  }
}

AVIANLIDAR_MULTIVERSION void nodesOfAll(bool circles, bool gaussian, const DiscNumbers& disc,
  const double* variable, const double* weight, double* range, double* cosine, double* share,
  std::size_t count)
{
  if (circles)
  {
    gaussian ? nodesOf<true, true>(disc, variable, weight, range, cosine, share, count)
             : nodesOf<true, false>(disc, variable, weight, range, cosine, share, count);
  }
  else
  {
    gaussian ? nodesOf<false, true>(disc, variable, weight, range, cosine, share, count)
             : nodesOf<false, false>(disc, variable, weight, range, cosine, share, count);
  }
}

double fraction(double x)
{
  return x - std::floor(x);
}

bool sameMaterial(const Material& one, const Material& two)
{
  return one.kd == two.kd && one.ks == two.ks && one.kp == two.kp;
}
}

PlaneQuadrature::PlaneQuadrature(const ScanSetup& setup)
  : Setup(setup)
  , UnitLength(setup.sensor.rangeUnitLength())
{
  const double half = 0.5 * setup.sensor.pulseWidth / setup.sensor.samplingInterval;
  this->Offsets[0] = fraction(half);
  this->Offsets[1] = fraction(-half);
  constexpr double same = 1e-9; // of a unit
  const double apart = std::fabs(this->Offsets[0] - this->Offsets[1]);
  this->NumberOfOffsets = apart < same || apart > 1.0 - same ? 1 : 2;
}

PlaneQuadrature::Disc PlaneQuadrature::discOf(const BeamFrame& frame, const PatchPlane& plane)
{
  Disc disc;
  const Vec3 across = glm::cross(plane.normal, frame.axis);
  disc.height = plane.height;
  disc.tilt = angleOf(
    std::max(0.0, -glm::dot(plane.normal, frame.axis)), std::sqrt(glm::dot(across, across)));
  disc.half = frame.halfBeamwidth;
  const double sine = sineOf(0.5 * disc.half);
  disc.sine2 = sine * sine;
  disc.least = std::max(0.0, disc.tilt - disc.half);
  disc.most = disc.tilt + disc.half;
  double none = 0.0;
  lanes::cosSinOfTurns(disc.least * TurnsPerRadian, disc.cosLeast, none);
  lanes::cosSinOfTurns(disc.most * TurnsPerRadian, disc.cosMost, none);
  return disc;
}

double PlaneQuadrature::footprintOf(const BeamFrame& frame, const PatchPlane& plane)
{
  const Disc disc = discOf(frame, plane);
  return disc.cosMost > 0.0 ? disc.farthest() - disc.nearest()
                            : std::numeric_limits<double>::infinity();
}

/// True if two triangles are of one object and one material.
bool PlaneQuadrature::isAlike(std::uint32_t one, std::uint32_t two) const
{
  return one == two ||
    (sameMaterial(this->Setup.materials[one], this->Setup.materials[two]) &&
      this->Setup.objectIds[one] == this->Setup.objectIds[two] &&
      this->Setup.materialIds[one] == this->Setup.materialIds[two]);
}

bool PlaneQuadrature::mayFit(
  double footprint, const std::uint32_t* triangles, std::size_t count) const
{
  const std::size_t mostOff = mostRaysOff(count);
  for (const std::uint32_t first : { triangles[0], triangles[count - 1] })
  {
    std::size_t off = first == NoTriangle ? count : 0;
    for (std::size_t i = 0; i < count && off <= mostOff; ++i)
    {
      off += triangles[i] == NoTriangle || !this->isAlike(first, triangles[i]) ? 1 : 0;
    }
    if (off <= mostOff)
    {
      return this->mayFit(footprint);
    }
  }
  return false;
}

bool PlaneQuadrature::mayFit(double footprint) const
{
  // Another triangle of the plane may tell it a little shorter.
  constexpr double surely = 1.0 - 1e-3;
  return this->bordersOf(surely * footprint) < static_cast<double>(MostPanels);
}

/// Borders of range units in a footprint, m, at most.
double PlaneQuadrature::bordersOf(double footprint) const
{
  return this->NumberOfOffsets * (footprint / this->UnitLength + 1.0);
}

bool PlaneQuadrature::fits(const BeamFrame& frame, const VisiblePatch& patch) const
{
  const std::uint32_t first = patch.triangles[0];
  const Material& material = this->Setup.materials[first];
  for (const std::uint32_t t : patch.triangles)
  {
    if (!this->isAlike(first, t))
    {
      return false;
    }
  }
  const Disc disc = discOf(frame, patch.plane);
  if (!(disc.cosMost > 0.0) ||
    !(this->bordersOf(disc.farthest() - disc.nearest()) < static_cast<double>(MostPanels)))
  {
    return false;
  }
  const double aperture = this->Setup.sensor.receiverAperture;
  if (aperture <= 0.0)
  {
    return true;
  }
  // At the nearest point the most is gathered: the cap of throughAperture() must be out of reach.
  const Reflectance f =
    reflectance(this->Setup.settings.reflectanceModel, material, monostaticGeometry(disc.cosLeast));
  return throughAperture(f, material.kp, aperture, disc.nearest()).total() < 1.0 - 1e-9;
}

PlaneQuadrature::Extent PlaneQuadrature::extentOf(
  const BeamFrame& frame, const VisiblePatch& patch) const
{
  // All models fall with the angle of incidence, and so do aperture and air with the range.
  const Disc disc = discOf(frame, patch.plane);
  const Material& material = this->Setup.materials[patch.triangles[0]];
  const Reflectance f =
    reflectance(this->Setup.settings.reflectanceModel, material, monostaticGeometry(disc.cosLeast));
  const double gathered =
    throughAperture(f, material.kp, this->Setup.sensor.receiverAperture, disc.nearest()).total();
  constexpr double surely = 1.0 + 1e-6; // the shares of the nodes are rounded
  const double nearest = disc.nearest() * (1.0 - 1e-9);
  return { nearest, disc.farthest() * surely,
    gathered * surely * transmission(this->Setup.settings.attenuationCoefficient, 2.0 * nearest) };
}

/// Square of the angle at which the specular lobe has fallen to e^-1; 0 if it does not count.
double PlaneQuadrature::lobeWidth2(const Material& material) const
{
  // cos^kp(2 b) is about exp(-2 kp b^2); a^2 of Microfacet is 1/(2 kp + 1).
  return material.ks > 0.0 ? 1.0 / (2.0 * material.kp + 1.0) : 0.0;
}

//--- borders --------------------------------------------------------------------------------------

void PlaneQuadrature::findBorders(const Disc& disc, const Material& material)
{
  this->Borders.clear();
  this->addUnitBorders(disc);
  this->addLobeBorders(disc, material);
  this->addPoleBorders(disc);
  std::sort(this->Borders.begin(), this->Borders.end());
}

void PlaneQuadrature::addUnitBorders(const Disc& disc)
{
  this->Ranges.clear();
  const double from = disc.nearest() / this->UnitLength;
  const double to = disc.farthest() / this->UnitLength;
  for (int k = 0; k < this->NumberOfOffsets; ++k)
  {
    const double offset = this->Offsets[k];
    for (double unit = std::floor(from - offset) + 1.0; unit + offset < to; unit += 1.0)
    {
      this->Ranges.push_back((unit + offset) * this->UnitLength);
    }
  }
  this->Borders.resize(this->Ranges.size());
  incidenceOfAll(disc.height, this->Ranges.data(), this->Borders.data(), this->Ranges.size());
}

/// So that the lobe falls by at most e^6 in a panel (Microfacet: so that panels are not wider than
/// their distance from the lobe's poles).
void PlaneQuadrature::addLobeBorders(const Disc& disc, const Material& material)
{
  const double width2 = this->lobeWidth2(material);
  if (width2 == 0.0)
  {
    return;
  }
  if (this->Setup.settings.reflectanceModel == ReflectanceModel::Microfacet)
  {
    for (double b = std::sqrt(width2); b < disc.most; b *= 2.0)
    {
      this->Borders.push_back(b);
    }
    return;
  }
  constexpr double step = 6.0;
  constexpr double nothing = 42.0; // e^-42
  const double first = disc.least * disc.least / width2;
  const double last = disc.most * disc.most / width2;
  if (first > nothing && material.kd > 0.0)
  {
    return;
  }
  for (double e = first + step; e < std::min(last, first + nothing); e += step)
  {
    this->Borders.push_back(std::sqrt(e * width2));
  }
}

/// Where the cone just misses the normal, and near the grazing direction, panels shrink towards the
/// pole.
void PlaneQuadrature::addPoleBorders(const Disc& disc)
{
  const double length = disc.most - disc.least;
  const double gap = std::fabs(disc.tilt - disc.half);
  constexpr double ratio = 4.0;
  constexpr double near = 0.25;
  constexpr double least = 1e-7;
  for (double b = ratio * std::max(gap, least * length); b < near * length && gap < near * length;
       b *= ratio)
  {
    this->Borders.push_back(b);
  }
  const double rest = 0.5 * Pi - disc.most;
  for (double c = ratio * rest; c < 0.5 * Pi - disc.least && rest < near * length; c *= ratio)
  {
    this->Borders.push_back(0.5 * Pi - c);
  }
}

//--- nodes ----------------------------------------------------------------------------------------

/// @param width of the panel in x @param from, to its borders, b, rad
const GaussKronrodRule& PlaneQuadrature::ruleFor(
  const Material& material, double width, double from, double to, bool end) const
{
  int need = end ? 2 : 0;
  const auto atLeast = [&need](double value, double second, double third)
  { need = std::max(need, value > third ? 2 : (value > second ? 1 : 0)); };
  atLeast(width, 0.1, 0.6);
  // How far the lobe falls, and how range and cosine change, in the panel.
  if (const double width2 = this->lobeWidth2(material))
  {
    const double fall = this->Setup.settings.reflectanceModel == ReflectanceModel::Microfacet
      ? (to * to - from * from) / (width2 + from * from)
      : (to * to - from * from) / width2;
    atLeast(fall, 0.1, 1.0);
  }
  atLeast((to - from) / (0.5 * Pi - to), 0.1, 0.4);
  return need == 2 ? gaussKronrod15() : (need == 1 ? gaussKronrod7() : gaussKronrod5());
}

/// Panels between the borders inside [from, to]: circles about the normal, or arcs.
void PlaneQuadrature::addPiece(const Material& material, bool circles, double from, double to)
{
  const auto begin = std::upper_bound(this->Borders.begin(), this->Borders.end(), from);
  const auto end = std::lower_bound(begin, this->Borders.end(), to);
  const std::size_t inner = end - begin;
  this->Places.resize(inner);
  if (circles)
  {
    std::copy(begin, end, this->Places.begin());
  }
  else
  {
    placesOfAll(
      from, to, this->Borders.data() + (begin - this->Borders.begin()), this->Places.data(), inner);
  }
  const double unit = circles ? 0.5 * Pi / (to - from) : 1.0; // circles: as wide as arcs
  double lower = circles ? from : 0.0;
  double angle = from;
  const auto add = [&](double upper, double next)
  {
    // At the ends of the arcs the energy rises from 0.
    const bool end = !circles && (angle == from || next == to);
    this->addPanel(this->ruleFor(material, unit * (upper - lower), angle, next, end), lower, upper);
    lower = upper;
    angle = next;
  };
  for (std::size_t k = 0; k <= inner; ++k)
  {
    const double upper = k < inner ? this->Places[k] : (circles ? to : 0.5 * Pi);
    const double next = k < inner ? begin[k] : to;
    constexpr double nothing = 1e-15;
    if (upper - lower <= nothing * upper)
    {
      continue;
    }
    if (unit * (upper - lower) > WidestPanel)
    {
      const double middle = 0.5 * (lower + upper);
      const double sine = circles ? 0.0 : sineOf(middle);
      add(middle, circles ? middle : from + (to - from) * (sine * sine));
    }
    add(upper, next);
  }
}

void PlaneQuadrature::addPanel(const GaussKronrodRule& rule, double lower, double upper)
{
  const double half = 0.5 * (upper - lower);
  for (int i = 0; i < rule.points; ++i)
  {
    this->Variable.push_back(lower + half * (1.0 + rule.place[i]));
    this->Weight.push_back(half * rule.weight[i]);
    this->Nodes.doubt.push_back(1.0 - rule.gauss[i] / rule.weight[i]);
  }
  this->Nodes.panels.push_back(static_cast<std::uint32_t>(this->Variable.size()));
}

const BeamNodes& PlaneQuadrature::place(const BeamFrame& frame, const VisiblePatch& patch)
{
  const Disc disc = discOf(frame, patch.plane);
  const Material& material = this->Setup.materials[patch.triangles[0]];
  this->findBorders(disc, material);
  this->Variable.clear();
  this->Weight.clear();
  this->Nodes.doubt.clear();
  this->Nodes.panels.clear();
  if (disc.tilt < disc.half)
  {
    this->addPiece(material, true, 0.0, disc.half - disc.tilt);
  }
  const std::size_t circles = this->Variable.size();
  if (disc.tilt > 0.0)
  {
    this->addPiece(material, false, std::fabs(disc.tilt - disc.half), disc.most);
  }
  this->evaluate(disc, circles);
  PrimaryHits& hits = this->Nodes.hits;
  const std::size_t count = this->Variable.size();
  hits.triangle.assign(count, patch.triangles[0]);
  for (std::size_t i = hits.ray.size(); i < count; ++i)
  {
    hits.ray.push_back(static_cast<std::uint32_t>(i));
  }
  hits.ray.resize(count);
  hits.rays = static_cast<std::uint32_t>(count);
  hits.coplanar = true;
  hits.farthest = disc.farthest();
  this->Nodes.misplaced = this->misplacedOf(frame, disc, patch);
  return this->Nodes;
}

/// Corners and ranges are rounded, and the ranges of the patch's triangles may differ a little: so
/// much energy may pass a border of range units. What lies in the rim may not be there at all.
double PlaneQuadrature::misplacedOf(
  const BeamFrame& frame, const Disc& disc, const VisiblePatch& patch) const
{
  const double corners = 8.0 * RoundOffDouble * patch.plane.size / disc.cosMost;
  const double ranges = 16.0 * RoundOffDouble * disc.farthest() / disc.cosMost;
  const double planes = patch.triangles.size() > 1 ? 1e-9 * disc.farthest() : 0.0;
  const double length =
    std::max(disc.farthest() - disc.nearest(), 0.5 * SpeedOfLight * this->Setup.sensor.pulseWidth);
  const double shift = corners + ranges + planes;
  bool border = false;
  for (int k = 0; k < this->NumberOfOffsets; ++k)
  {
    border = border ||
      std::floor((disc.nearest() - shift) / this->UnitLength - this->Offsets[k]) !=
        std::floor((disc.farthest() + shift) / this->UnitLength - this->Offsets[k]);
  }
  const double rim = std::pow(rimOf(frame), 1.5) * MostPatchTriangles;
  return rim + (border ? (shift < length ? 2.0 * shift / length : 1.0) : 0.0);
}

void PlaneQuadrature::evaluate(const Disc& disc, std::size_t circles)
{
  const std::size_t count = this->Variable.size();
  PrimaryHits& hits = this->Nodes.hits;
  hits.range.resize(count);
  hits.cosine.resize(count);
  hits.share.resize(count);
  DiscNumbers d;
  d.height = disc.height;
  d.tilt = disc.tilt;
  d.half = disc.half;
  d.piece = std::min(disc.tilt, disc.half);
  d.start = std::fabs(disc.tilt - disc.half);
  d.beyond = 2.0 * std::max(0.0, disc.half - disc.tilt);
  d.short_ = 2.0 * std::max(0.0, disc.tilt - disc.half);
  d.sineTilt = sineOf(disc.tilt);
  d.inverse = 1.0 / disc.sine2;
  d.density = d.inverse / (4.0 * Pi);
  const bool gaussian = this->Setup.sensor.beamProfile == BeamProfile::Gaussian;
  nodesOfAll(true, gaussian, d, this->Variable.data(), this->Weight.data(), hits.range.data(),
    hits.cosine.data(), hits.share.data(), circles);
  nodesOfAll(false, gaussian, d, this->Variable.data() + circles, this->Weight.data() + circles,
    hits.range.data() + circles, hits.cosine.data() + circles, hits.share.data() + circles,
    count - circles);
}

double PlaneQuadrature::boundOf(const RangeShares& shares, double total) const
{
  double bound = 0.0;
  double energy = 0.0;
  std::size_t panel = 0;
  double difference = 0.0;
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t node = shares.contribution(s);
    while (node >= this->Nodes.panels[panel])
    {
      bound += std::fabs(difference);
      difference = 0.0;
      ++panel;
    }
    difference += shares.energies[s] * this->Nodes.doubt[node];
    energy += shares.energies[s];
  }
  constexpr double ofShares = 1e-9;
  return bound + std::fabs(difference) + ofShares * energy + this->Nodes.misplaced * total;
}
}
