// SPDX-License-Identifier: BSD-3-Clause
#include "SecondaryReflection.h"

#include "Hash.h"
#include "LaneMath.h"
#include "SecondaryTracer.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace avianlidar
{
namespace
{
/// Part of the tolerance of the light-energy constraint that mirror paths by regions may lose on
/// surfaces that are not searched. Paths on searched surfaces may lose as much. Polygons may lose a
/// half, and connections less than the rest.
constexpr double MirrorPart = 0.125;

/// Largest number of paths that start with a mirror path.
double waysOf(const ScanSetup& setup)
{
  return setup.sensor.receiverAperture > 0.0 ? 1.0 + setup.settings.numberOfReflections : 1.0;
}

/// Hash of what the ends of a beam's mirror paths depend on besides the beam; 0 without an
/// aperture.
std::uint64_t lobesOf(const ScanSetup& setup, const SecondaryBeam& beam)
{
  std::uint64_t hash = 0;
  const auto add = [&](std::uint32_t triangle)
  {
    const double kp = triangle == NoTriangle ? 0.0 : setup.material(triangle).kp;
    hash = hashOf(&kp, sizeof(kp), hash);
  };
  if (setup.sensor.receiverAperture > 0.0)
  {
    hash = static_cast<std::uint64_t>(setup.settings.numberOfReflections);
    for (std::size_t i = 0; beam.surfaces && i < beam.surfaces->surfaces.size(); ++i)
    {
      add(beam.surfaces->surfaces[i].triangle);
      add(beam.surfaces->surfaces[i].other);
    }
    for (std::size_t i = 0; !beam.surfaces && i < beam.samples.surfaces.size(); ++i)
    {
      add(beam.samples.surfaces[i].triangle);
    }
  }
  return hash;
}

/// The matt end of a mirror path; one from which no light arrives if the path has none.
const MattEnd& mattEndOf(const SecondaryTrace& trace, const MirrorPath& path)
{
  static const MattEnd none{};
  return path.matt == NoSample ? none : trace.mattEnds[path.matt];
}

/// Order of the mirror paths of MirrorRegions.h: first those with ends that the apex sees.
bool isBefore(const MirrorPath& a, const MirrorPath& b)
{
  return a.seen == b.seen ? a.start < b.start : a.seen;
}

double sumOf(const std::vector<double>& values)
{
  return std::accumulate(values.begin(), values.end(), 0.0);
}
}

SecondaryReflection::SecondaryReflection(const ScanSetup& setup, const SceneTriangles& scene)
  : Setup(setup)
  , Shape(setup.sensor)
  , Finder(setup)
  , Regions(setup, scene)
{
}

//--- connections ----------------------------------------------------------------------------------

void SecondaryReflection::prepare(const SecondaryBeam& beam, bool byRegions)
{
  SecondaryTrace& trace = beam.trace;
  const std::uint32_t partners = connectionsOf(this->Setup.settings);
  const std::uint64_t lobes = lobesOf(this->Setup, beam);
  if (trace.lobes != lobes)
  {
    trace.mirror.clear();
    trace.searched.clear();
    trace.mirrorPaths.clear();
    trace.mattEnds.clear();
    trace.lobes = lobes;
  }
  if (trace.mirror.empty() && !byRegions)
  {
    trace.mirror.assign(beam.samples.size(), MirrorEnd::NotTraced);
  }
  if (trace.partners != partners)
  {
    trace.connections.clear();
    trace.shortPaths.clear();
    trace.shortTraced = partners == 0 || beam.samples.coplanar;
    trace.partners = partners;
    // Points of one plane do not face each other.
    if (partners > 0 && !beam.samples.coplanar)
    {
      this->Finder.find(beam, partners);
    }
  }
}

//--- throughputs ----------------------------------------------------------------------------------

double SecondaryReflection::bound(const BeamSamples& samples, const Throughput& direct) const
{
  double budget = 0.0;
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      const double albedo = this->Setup.material(triangle).albedo();
      for (std::uint32_t i = begin; i < end; ++i)
      {
        budget += samples.weight[i] * std::max(0.0, albedo - direct.reflected[i]);
      }
    });
  return budget;
}

double SecondaryReflection::bound(double albedo, double nearest) const
{
  const double ways = this->Setup.sensor.receiverAperture > 0.0 ? 2.0 : 1.0; // of connections
  const double returned = std::max(
    ways * returnBound(this->Setup, nearest), mirrorReturnBound(this->Setup, this->Shape, nearest));
  return albedo * std::min(1.0, returned * SurelyAbove);
}

SecondaryReflection::MirrorThroughput SecondaryReflection::mirrorThroughput(
  const SecondaryBeam& beam, const MirrorPath& path) const
{
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const Sensor& sensor = this->Setup.sensor;
  const double aperture = sensor.receiverAperture;
  const Material& first = this->Setup.material(path.first);
  const double f1 = specularReflectance(model, first, mirrorGeometry(path.cosine));
  const double direct = !beam.trace.searched.empty()
    ? throughAperture(
        reflectance(model, first, monostaticGeometry(path.cosine)), first, aperture, path.rangeOne)
        .total() *
      sensor.nearRangeShare(path.rangeOne)
    : beam.direct.reflected[path.one];
  const auto scaleAt = [&](std::uint32_t triangle) {
    return secondaryScale(this->Setup, first, this->Setup.material(triangle), path.cosine, direct);
  };
  MirrorThroughput part;
  if (path.seen)
  {
    Material second = this->Setup.material(path.triangle);
    ReflectionGeometry back = path.second;
    if (aperture > 0.0)
    {
      back.cosIncidence = back.cosOutgoing;
      // The lobes of both mirrors spread the light that arrives.
      const double reach = (path.length - path.rangeOne) / path.range;
      second.kp = 1.0 / (1.0 / second.kp + reach * reach / first.kp);
    }
    const Reflectance f2 =
      throughAperture(reflectance(model, second, back), second, aperture, path.range);
    part.exact = f1 * (aperture > 0.0 ? f2.specular : f2.total()) *
      sensor.nearRangeShare(path.range) * scaleAt(path.triangle) * path.weight;
  }
  const MattEnd& matt = mattEndOf(beam.trace, path);
  const auto returned = [&](ReflectionGeometry geometry, double range)
  {
    geometry.cosIncidence = geometry.cosOutgoing;
    const Material& material = this->Setup.material(matt.triangle);
    return f1 * path.weight * scaleAt(matt.triangle) *
      throughAperture(reflectance(model, material, geometry), material, aperture, range).diffuse;
  };
  if (aperture > 0.0 && path.visibility == Visibility::Unknown)
  {
    part.most = f1 * path.weight * this->OfMatt;
  }
  if (matt.seen)
  {
    const double light = returned(matt.second, matt.range);
    part.there = light * sensor.nearRangeShare(matt.range);
    part.back = light * matt.back * sensor.nearRangeShare(path.rangeOne);
  }
  if (matt.shown)
  {
    const Material& mirror = this->Setup.material(matt.mirror);
    part.again = returned(matt.third, matt.image) * matt.again *
      specularReflectance(model, mirror, mirrorGeometry(matt.cosine)) *
      sensor.nearRangeShare(safeLength(matt.through));
  }
  // If an aperture gathers nearly all light, the bound of one way limits the sum of all ways.
  const double all = part.exact + part.there + part.back + part.again;
  if (aperture > 0.0 && all > f1 * path.weight)
  {
    const double within = f1 * path.weight / all;
    part = { within * part.exact, within * part.there, within * part.back, within * part.again,
      part.most };
  }
  return part;
}

/// Share of a mirror path's light that the width of the mirror's lobe moves across the cone's rim,
/// if such paths fill the cone at the second point: circumference times mean excursion over area.
double SecondaryReflection::unsureShare(const MirrorPath& path) const
{
  const Sensor& sensor = this->Setup.sensor;
  if (!(sensor.receiverAperture > 0.0))
  {
    return 0.0; // with the paper's receiver it does not matter where light arrives
  }
  const double step = path.length - path.rangeOne - path.range;
  const double deviation = step / std::sqrt(this->Setup.material(path.first).kp);
  const double across = sensor.halfBeamwidthAcross;
  const double narrower =
    across > 0.0 ? std::min(across, sensor.halfBeamwidth) : sensor.halfBeamwidth;
  return std::min(1.0, std::sqrt(2.0 / Pi) * deviation / (path.range * std::tan(narrower)));
}

double SecondaryReflection::shortThroughput(const SecondaryBeam& beam, const ShortPath& path) const
{
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const Material first = this->Materials[path.one];
  const Material& second = this->Setup.material(path.triangle);
  ReflectionGeometry back = path.second;
  back.cosIncidence = back.cosOutgoing;
  const double unlike =
    withModel(model, [&](auto m) { return decltype(m)::unlikeLambert(first, path.first); });
  const double f2 = throughAperture(
    reflectance(model, second, back), second, this->Setup.sensor.receiverAperture, path.range)
                      .diffuse;
  return path.weight * first.kd * unlike * f2 * this->Setup.sensor.nearRangeShare(path.range) *
    secondaryScale(
      this->Setup, first, second, beam.samples.cosine[path.one], beam.direct.reflected[path.one]);
}

/// Upper bound of the sum of the throughputs of all short paths.
double SecondaryReflection::mostOfShortPaths(const SecondaryBeam& beam) const
{
  const double aperture = this->Setup.sensor.receiverAperture;
  if (!(aperture > 0.0) || beam.trace.partners == 0 || beam.samples.coplanar)
  {
    return 0.0;
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < beam.samples.size(); ++i)
  {
    const double cosine = beam.samples.cosine[i];
    const double most =
      reflectanceBound(this->Setup.settings.reflectanceModel, this->Materials[i], cosine).diffuse;
    sum += most > 0.0 ? beam.samples.weight[i] * most / cosine : 0.0;
  }
  const double gathered = aperture / (Pi * beam.nearest * beam.nearest);
  return sum * std::min(1.0, this->Setup.largestReflectance * gathered) * SurelyAbove;
}

/// Find the bounds of mirror paths and the throughputs of connections.
void SecondaryReflection::measure(const SecondaryBeam& beam)
{
  const BeamSamples& samples = beam.samples;
  this->Triangles.resize(samples.size());
  this->Materials.resize(samples.size());
  this->SpecularBounds.resize(samples.size());
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      const Material& material = this->Setup.material(triangle);
      this->Materials.fill(begin, end, material);
      for (std::uint32_t i = begin; i < end; ++i)
      {
        this->Triangles[i] = triangle;
        this->SpecularBounds[i] = samples.weight[i] *
          specularBound(this->Setup, material, samples.cosine[i], this->OverMirror);
      }
    });
  connectionThroughputs(this->Setup, beam, this->Materials, this->ConnectionThroughputs);
}

/// Upper bound of the sum of the throughputs of all mirror paths.
double SecondaryReflection::mostOfMirrors(bool byRegions) const
{
  double sum = byRegions ? 0.0 : sumOf(this->SpecularBounds);
  for (std::size_t k = 0; byRegions && k < this->Regions.surfaces(); ++k)
  {
    sum += this->Regions.bound(k, this->OverMirror);
  }
  return sum;
}

/// Place mirror paths on surfaces whose bound is at least `least`, and find the throughputs. Paths
/// on other surfaces count as lost even if they were found. The search begins with the largest
/// bound. It ends, without any throughput, once all mirror paths together have less than `needed`.
/// @return bound of the lost throughputs
double SecondaryReflection::placeMirrors(const SecondaryBeam& beam, double least, double needed)
{
  SecondaryTrace& trace = beam.trace;
  const std::size_t count = this->Regions.surfaces();
  trace.searched.resize(count, 0);
  this->Wanted.assign(count, 0);
  this->Order.clear();
  double albedo = 0.0;
  for (const PlaneSurface& s : beam.surfaces->surfaces)
  {
    const std::uint32_t other = s.other == NoTriangle ? s.triangle : s.other;
    albedo = std::max(
      { albedo, this->Setup.material(s.triangle).albedo(), this->Setup.material(other).albedo() });
  }
  // Without an aperture, no surface returns more than its albedo.
  const bool gathers = this->Setup.sensor.receiverAperture > 0.0;
  const double scale = gathers ? 1.0 : std::min(1.0, albedo / this->OverMirror);
  double left = 0.0;
  double rest = 0.0; // bound of the surfaces that are still to be searched
  for (std::uint32_t k = 0; k < count; ++k)
  {
    const double most = this->Regions.bound(k, this->OverMirror);
    this->Wanted[k] = most > 0.0 && most >= least;
    left += this->Wanted[k] ? 0.0 : most;
    if (this->Wanted[k] && !trace.searched[k])
    {
      this->Order.emplace_back(-scale * most, k);
      rest += scale * most;
    }
  }
  if (needed > 0.0)
  {
    std::sort(this->Order.begin(), this->Order.end());
  }
  double found = this->measureMirrors(beam, 0);
  std::size_t drawn = 0;
  for (const auto& [bound, k] : this->Order)
  {
    const double all = left + (found + rest) * SurelyAbove;
    if (all < needed)
    {
      this->MirrorThroughputs.clear();
      this->MirrorParts.clear();
      return all;
    }
    drawn += this->Regions.search(k, trace.mirrorPaths);
    trace.searched[k] = 1;
    if (drawn >= SecondaryBeam::StepsBetweenChecks)
    {
      beam.throwIfStopped(SecondaryBeam::StepsBetweenChecks - 1);
      drawn = 0;
    }
    found += this->measureMirrors(beam, this->MirrorThroughputs.size());
    rest += bound;
  }
  if (!std::is_sorted(trace.mirrorPaths.begin(), trace.mirrorPaths.end(), isBefore))
  {
    std::stable_sort(trace.mirrorPaths.begin(), trace.mirrorPaths.end(), isBefore);
    this->measureMirrors(beam, 0);
  }
  return left;
}

/// Bound of the throughputs of matt light of the mirror paths that start on a surface and do not
/// end where the apex sees the end.
double SecondaryReflection::boundBeyond(std::size_t surface) const
{
  return this->Wanted[surface] ? this->Regions.bound(surface, this->OfMatt) : 0.0;
}

/// Sum of boundBeyond() over all surfaces.
double SecondaryReflection::mostBeyond() const
{
  double sum = 0.0;
  for (std::size_t k = 0; this->Setup.sensor.receiverAperture > 0.0 && k < this->Wanted.size(); ++k)
  {
    sum += this->boundBeyond(k);
  }
  return sum;
}

/// Follow the mirror paths of such surfaces whose bound is at least `least`.
/// @return bound of the lost throughputs
double SecondaryReflection::traceBeyondMirrors(const SecondaryBeam& beam, double least)
{
  SecondaryTrace& trace = beam.trace;
  double left = 0.0;
  for (std::uint32_t k = 0; k < this->Wanted.size(); ++k)
  {
    const double most = this->boundBeyond(k);
    const bool follows = most > 0.0 && most >= least;
    left += follows ? 0.0 : most;
    if (follows && trace.searched[k] < 2)
    {
      const std::size_t known = trace.mirrorPaths.size();
      beam.throwIfStopped(SecondaryBeam::StepsBetweenChecks - 1);
      this->Regions.spread(k, trace.mirrorPaths);
      traceBeyond(this->Setup, beam, trace.mirrorPaths, known);
      trace.searched[k] = 2;
    }
  }
  const auto first = std::partition_point(trace.mirrorPaths.begin(), trace.mirrorPaths.end(),
    [](const MirrorPath& path) { return path.seen; });
  std::stable_sort(first, trace.mirrorPaths.end(), isBefore);
  this->measureMirrors(beam, static_cast<std::size_t>(first - trace.mirrorPaths.begin()));
  return left;
}

/// Add paths to the range units of the beam, as if nothing blocks them: connections before mirror
/// paths are placed, then mirror paths. Set the throughputs of mirror paths to 0 if their units
/// have too little energy for an echo. @param most largest energy of a path of throughput 1, J
/// @param further energy that is not in the units, J @return bound of the energy of a unit, J
double SecondaryReflection::addPaths(
  const SecondaryBeam& beam, double most, double further, bool mirrors)
{
  const SecondaryConnections& connections = beam.trace.connections;
  for (std::size_t i = 0; i < connections.size() && !mirrors; ++i)
  {
    const double ends =
      beam.samples.range[connections.one[i]] + beam.samples.range[connections.two[i]];
    beam.units->add({ ends + connections.length[i], most * this->ConnectionThroughputs[i] });
  }
  const bool gathers = this->Setup.sensor.receiverAperture > 0.0;
  const std::size_t first = beam.units->pathLengths().size();
  for (std::size_t p = 0; p < this->MirrorParts.size() && mirrors; ++p)
  {
    const MirrorPath& path = beam.trace.mirrorPaths[p];
    const MirrorThroughput& part = this->MirrorParts[p];
    beam.units->add({ path.length, most * part.exact });
    if (gathers)
    {
      const MattEnd& matt = mattEndOf(beam.trace, path);
      beam.units->add({ matt.length, most * (part.there + part.back) });
      beam.units->add({ matt.lengthAgain, most * part.again });
    }
  }
  beam.units->accumulate();
  const auto isFaint = [&](std::size_t number)
  { return beam.units->mostAround(first + number) + further < beam.faintBelow; };
  for (std::size_t p = 0; p < this->MirrorParts.size() && mirrors; ++p)
  {
    MirrorThroughput& part = this->MirrorParts[p];
    part.exact = isFaint(gathers ? 3 * p : p) ? 0.0 : part.exact;
    part.there = gathers && isFaint(3 * p + 1) ? 0.0 : part.there;
    part.back = gathers && isFaint(3 * p + 1) ? 0.0 : part.back;
    part.again = gathers && isFaint(3 * p + 2) ? 0.0 : part.again;
    this->MirrorThroughputs[p] = part.total();
  }
  double strongest = 0.0;
  for (const RangeUnit& unit : beam.units->units())
  {
    strongest = std::max(strongest, unit.energy);
  }
  return strongest + further;
}

/// Find the throughputs of mirror paths from number `from` on. @return their sum
double SecondaryReflection::measureMirrors(const SecondaryBeam& beam, std::size_t from)
{
  const std::vector<MirrorPath>& paths = beam.trace.mirrorPaths;
  this->MirrorThroughputs.resize(from);
  this->MirrorParts.resize(from);
  double sum = 0.0;
  for (std::size_t p = from; p < paths.size(); ++p)
  {
    const bool wanted = beam.trace.searched.empty() || this->Wanted[paths[p].start];
    this->MirrorParts.push_back(
      wanted ? this->mirrorThroughput(beam, paths[p]) : MirrorThroughput());
    this->MirrorThroughputs.push_back(this->MirrorParts.back().total());
    sum += this->MirrorThroughputs.back();
  }
  return sum;
}

/// Sum of the bounds of the mirror paths by regions that are not traced.
double SecondaryReflection::untracedMirrors(const SecondaryTrace& trace) const
{
  double sum = 0.0;
  for (std::size_t p = 0; p < trace.mirrorPaths.size(); ++p)
  {
    sum +=
      trace.mirrorPaths[p].visibility == Visibility::Unknown ? this->MirrorThroughputs[p] : 0.0;
  }
  return sum;
}

/// Sum of the bounds of the paths that are not traced.
double SecondaryReflection::untracedBound(const SecondaryTrace& trace) const
{
  double sum = this->untracedMirrors(trace);
  for (std::size_t hit = 0; hit < trace.mirror.size(); ++hit)
  {
    sum += trace.mirror[hit] == MirrorEnd::NotTraced ? this->SpecularBounds[hit] : 0.0;
  }
  const std::vector<Visibility>& visibility = trace.connections.visibility;
  for (std::size_t i = 0; i < visibility.size(); ++i)
  {
    sum += visibility[i] == Visibility::Unknown ? this->ConnectionThroughputs[i] : 0.0;
  }
  return sum;
}

//--- paths ----------------------------------------------------------------------------------------

/// List the paths that arrive, with throughputs in place of energies.
void SecondaryReflection::listPaths(
  const SecondaryBeam& beam, std::vector<SecondaryPath>& paths) const
{
  const SecondaryConnections& connections = beam.trace.connections;
  paths.clear();
  const bool bySample = beam.trace.searched.empty();
  // Transmission of the media that do not fill the scene.
  const Vec3 apex(0.0);
  MediumCrosser crosser;
  std::vector<MediumCrossing> found;
  const auto passed = [&](const Vec3& one, const Vec3& two)
  { return beam.air ? beam.air->transmissionBetween(one, two, crosser, found) : 1.0; };
  const auto leftOf = [&](const Vec3& one, const Vec3& two)
  { return passed(apex, one) * passed(one, two) * passed(two, apex); };
  const auto pointOf = [&](std::uint32_t sample)
  { return beam.samples.range[sample] * beam.geometry.direction(sample); };
  const MirrorPath* before = nullptr;
  std::uint32_t number = 0;
  for (std::size_t p = 0; p < beam.trace.mirrorPaths.size(); ++p)
  {
    const MirrorPath& path = beam.trace.mirrorPaths[p];
    if (path.visibility == Visibility::Clear)
    {
      number = numberAfter(before, number, path);
      before = &path;
      const MirrorThroughput& part = this->MirrorParts[p];
      const MattEnd& matt = mattEndOf(beam.trace, path);
      const std::uint32_t one = bySample ? path.one : NoSample;
      const std::uint32_t two = bySample ? NoSample : number;
      if (part.exact > 0.0)
      {
        paths.push_back({ path.length, part.exact * leftOf(path.from, path.end), path.triangle,
          path.second.cosIncidence, one, two, this->unsureShare(path) });
      }
      const double left = matt.seen ? leftOf(path.from, matt.end) : 0.0;
      if (part.there > 0.0)
      {
        paths.push_back(
          { matt.length, part.there * left, matt.triangle, matt.second.cosIncidence, one, two });
      }
      if (part.back > 0.0)
      {
        paths.push_back({ matt.length, part.back * left, path.first, path.cosine, one, two });
      }
      if (part.again > 0.0)
      {
        const double there = passed(apex, path.from) * passed(path.from, matt.end);
        const double back = passed(matt.end, matt.through) * passed(matt.through, apex);
        paths.push_back(
          { matt.lengthAgain, part.again * there * back, matt.mirror, matt.cosine, one, two });
      }
    }
  }
  for (std::size_t i = 0; i < connections.size(); ++i)
  {
    if (connections.visibility[i] == Visibility::Clear)
    {
      const std::uint32_t one = connections.one[i];
      const std::uint32_t two = connections.two[i];
      paths.push_back({ beam.samples.range[one] + connections.length[i] + beam.samples.range[two],
        this->ConnectionThroughputs[i] * leftOf(pointOf(one), pointOf(two)), this->Triangles[two],
        connections.cosIn[i], one, two });
    }
  }
  const bool gathers = this->Setup.sensor.receiverAperture > 0.0;
  for (std::size_t i = 0; gathers && i < beam.trace.shortPaths.size(); ++i)
  {
    const ShortPath& path = beam.trace.shortPaths[i];
    paths.push_back({ path.length, this->shortThroughput(beam, path) * leftOf(path.from, path.end),
      path.triangle, path.second.cosIncidence, path.one, NoSample });
  }
}

namespace
{
/// Set energies from the throughputs that stand in their place.
AVIANLIDAR_MULTIVERSION void energiesOfAll(
  double pulseEnergy, double attenuation, SecondaryPath* paths, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    paths[i].energy = pulseEnergy * paths[i].energy * lanes::exp(-attenuation * paths[i].length);
  }
}
}

bool SecondaryReflection::collect(
  const SecondaryBeam& beam, std::vector<SecondaryPath>& paths, double& lost)
{
  const EchoSettings& settings = this->Setup.settings;
  const double pulseEnergy = this->Setup.sensor.pulseEnergy;
  const bool byRegions = beam.surfaces != nullptr;
  if (byRegions)
  {
    this->Regions.begin(beam.id, beam.frame, *beam.surfaces, beam.cells);
  }
  this->OverMirror = mirrorReturnBound(this->Setup, this->Shape, beam.nearest);
  this->OfMatt = mattReturnBound(this->Setup, this->Shape, beam.nearest);
  this->prepare(beam, byRegions);
  this->measure(beam);
  // Largest energy of a path whose throughput is 1.
  const double most = pulseEnergy * transmissionBound(beam.nearest, this->Setup.attenuation());
  const bool gathers = this->Setup.sensor.receiverAperture > 0.0;
  const double ofShort = this->mostOfShortPaths(beam);
  const double others = sumOf(this->ConnectionThroughputs) + ofShort;
  // Largest energy of a range unit without mirror paths, and throughput that an echo needs besides.
  const double sure = most * SurelyAbove;
  const double before = beam.units ? this->addPaths(beam, sure, lost + most * ofShort, false) : 0.0;
  const double needed = beam.units && most > 0.0 ? (beam.faintBelow - before) / most : 0.0;
  const auto isSilent = [&](double ofMirrors)
  {
    lost = ofMirrors < needed ? before + most * ofMirrors : lost;
    return ofMirrors < needed;
  };
  // The paths share a tolerance, or each path is compared with a limit.
  const bool drops = dropsFaintPaths(settings);
  const bool shares = drops && settings.lightEnergyThreshold == LightEnergyThreshold::ShareOfLimit;
  double threshold = drops ? limitOfPath(this->Setup) : 0.0;
  if (shares)
  {
    const double budget = lightEnergyTolerance(this->Setup);
    const double all = most * (this->mostOfMirrors(byRegions) + others);
    if (all + lost < budget)
    {
      lost += all;
      return true;
    }
    // With an aperture, more paths start in each hit: by mirrors, and short paths.
    threshold = budget / (pathsOfABeam(settings) * waysOf(this->Setup));
  }
  const auto throughputOf = [=](double energy)
  { return most > 0.0 ? energy / most : std::numeric_limits<double>::infinity(); };
  double ofMirrors = threshold;
  if (byRegions)
  {
    const double part = MirrorPart * lightEnergyTolerance(this->Setup);
    const double ofSurface = part / static_cast<double>(this->Regions.surfaces());
    const double left =
      this->placeMirrors(beam, throughputOf(shares ? ofSurface : threshold), needed);
    const double beyond = this->mostBeyond();
    if (isSilent(left + sumOf(this->MirrorThroughputs) + beyond))
    {
      return false;
    }
    lost += most * left;
    // Adds the paths to the range units. False if no unit may have enough energy.
    const auto mayMatter = [&](double further)
    {
      const double strongest = beam.units && !this->MirrorThroughputs.empty()
        ? this->addPaths(beam, sure, lost + most * (ofShort + further), true)
        : beam.faintBelow;
      lost = strongest < beam.faintBelow ? strongest : lost;
      return !(strongest < beam.faintBelow);
    };
    if (!gathers && !mayMatter(0.0))
    {
      return false;
    }
    if (gathers)
    {
      lost += most * this->traceBeyondMirrors(beam, throughputOf(shares ? ofSurface : threshold));
    }
    const auto wanted = std::count_if(beam.trace.mirrorPaths.begin(), beam.trace.mirrorPaths.end(),
      [&](const MirrorPath& path) { return this->Wanted[path.start] != 0; });
    ofMirrors =
      shares ? part / std::max(1.0, waysOf(this->Setup) * static_cast<double>(wanted)) : threshold;
    traceMirrorPaths(this->Setup, beam, this->MirrorThroughputs, throughputOf(ofMirrors));
    if (gathers)
    {
      // Now the ends are known.
      this->measureMirrors(beam, 0);
      if (!mayMatter(this->untracedMirrors(beam.trace)))
      {
        return false;
      }
    }
  }
  else
  {
    if (isSilent(this->mostOfMirrors(false)))
    {
      return false;
    }
    traceMirrors(this->Setup, beam, this->SpecularBounds, throughputOf(threshold), this->Pairs);
    this->measureMirrors(beam, 0);
  }
  const double least = throughputOf(threshold);
  traceConnections(beam, this->ConnectionThroughputs, least);
  if (gathers)
  {
    traceShortPaths(this->Setup, beam, this->Finder);
  }
  lost += most * this->untracedBound(beam.trace);
  this->listPaths(beam, paths);
  energiesOfAll(pulseEnergy, this->Setup.attenuation(), paths.data(), paths.size());
  for (SecondaryPath& path : paths)
  {
    if (path.energy < (path.one == NoSample ? ofMirrors : threshold))
    {
      lost += path.energy;
      path.energy = 0.0;
    }
  }
  this->cutToBudget(beam, paths);
  paths.erase(std::remove_if(paths.begin(), paths.end(),
                [](const SecondaryPath& path) { return !(path.energy > 0.0); }),
    paths.end());
  return true;
}

/// Scale the paths of a ray down to its budget, the part of the albedo that the direct echo leaves.
/// The random weights of the ray's connections may exceed 1 together.
void SecondaryReflection::cutToBudget(const SecondaryBeam& beam, std::vector<SecondaryPath>& paths)
{
  this->Returned.assign(beam.samples.size(), 0.0);
  for (const SecondaryPath& path : paths)
  {
    if (path.one != NoSample)
    {
      this->Returned[path.one] += path.energy;
    }
  }
  for (SecondaryPath& path : paths)
  {
    if (path.one == NoSample)
    {
      continue;
    }
    const double left = this->Materials[path.one].albedo() - beam.direct.reflected[path.one];
    const double budget =
      beam.samples.weight[path.one] * std::max(0.0, left) * this->Setup.sensor.pulseEnergy;
    if (this->Returned[path.one] > budget)
    {
      path.energy *= budget / this->Returned[path.one];
    }
  }
}
}
