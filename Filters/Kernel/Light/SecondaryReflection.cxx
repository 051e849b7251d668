// SPDX-License-Identifier: BSD-3-Clause
#include "SecondaryReflection.h"

#include "LaneMath.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
PathNumbers numbersOf(const SecondaryReflection::Beam& beam)
{
  return { beam.hits.allRays(), beam.trace.connections };
}

/// What the paths that go on from a hit may bring back: more if they stand for those of others.
double budgetOf(const SecondaryBeam& beam, std::uint32_t hit)
{
  const bool alone = beam.hits.pathStep == 1;
  return secondaryBudget(beam, hit) * (alone ? 1.0 : std::max(1.0, beam.hits.pathWeight(hit)));
}
}

std::uint32_t connectionsOf(const EchoSettings& settings, std::uint32_t rays)
{
  if (settings.numberOfReflections < 2 || rays < 2)
  {
    return 0;
  }
  return std::min(static_cast<std::uint32_t>(settings.numberOfConnections), rays - 1);
}

SecondaryReflection::SecondaryReflection(const ScanSetup& setup)
  : Setup(setup)
  , Finder(setup)
  , Tracer(setup)
{
}

//--- what may be connected ------------------------------------------------------------------------

void SecondaryReflection::prepare(const Beam& beam)
{
  SecondaryTrace& trace = beam.trace;
  const std::uint32_t connections = connectionsOf(this->Setup.settings, beam.hits.rays);
  if (trace.mirror.empty())
  {
    trace.mirror.assign(beam.hits.size(), MirrorEnd::NotTraced);
    trace.unknown = beam.hits.size();
  }
  if (!trace.linksKnown || trace.connections != connections)
  {
    trace.links.clear();
    trace.connections = connections;
    // Points of one plane do not look at each other.
    if (connections > 0 && !beam.hits.coplanar)
    {
      this->Finder.find(beam, connections);
    }
    trace.linksKnown = true;
    trace.unseen = trace.links.size();
  }
}

//--- what it is worth -----------------------------------------------------------------------------

bool SecondaryReflection::isKnown(const Beam& beam) const
{
  const KnownPaths& known = beam.strengths.paths;
  return known.found && known.connections == connectionsOf(this->Setup.settings, beam.hits.rays);
}

double SecondaryReflection::bound(const Beam& beam) const
{
  const PathStrengths& strengths = beam.strengths;
  // A ray returns kd + ks at most; from one plane there are mirror paths alone.
  const bool mirrorsOnly = beam.hits.coplanar && this->Setup.sensor.receiverAperture <= 0.0;
  const double most = this->isKnown(beam) ? strengths.paths.mostSum
    : mirrorsOnly                         ? strengths.glossSum
                                          : strengths.budgetSum;
  return std::min(most, strengths.budgetSum);
}

double SecondaryReflection::mirrorStrength(const Beam& beam, const MirrorPath& path) const
{
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const double aperture = this->Setup.sensor.receiverAperture;
  const Material first{ beam.light.kd[path.one], beam.light.ks[path.one], beam.light.kp[path.one] };
  const Material& second = this->Setup.materials[path.triangle];
  ReflectionGeometry back = path.second;
  if (aperture > 0.0)
  {
    back.cosIncidence = back.cosOutgoing;
  }
  const double f1 = specularReflectance(model, first, mirrorGeometry(beam.hits.cosine[path.one]));
  const double f2 =
    throughAperture(reflectance(model, second, back), second.kp, aperture, path.range).total();
  return f1 * f2 * secondaryScale(this->Setup, beam, path.one, second) *
    beam.hits.pathWeight(path.one);
}

/// What each path could bring back.
void SecondaryReflection::measure(const Beam& beam)
{
  if (this->Measured)
  {
    return;
  }
  beam.light.reflect(this->Setup, beam.hits);
  linkStrengths(this->Setup, beam, this->LinkStrengths);
  glossesOf(this->Setup, beam.hits, beam.light, this->Glosses);
  this->Measured = true;
}

/// List the paths that are known to arrive, and sum up the others.
void SecondaryReflection::know(const Beam& beam)
{
  this->measure(beam);
  const SecondaryTrace& trace = beam.trace;
  KnownPaths known;
  known.found = true;
  known.connections = trace.connections;
  for (std::uint32_t hit = 0; trace.unknown > 0 && hit < beam.hits.size(); ++hit)
  {
    if (trace.mirror[hit] == MirrorEnd::NotTraced)
    {
      known.unknownSum += this->Glosses[hit];
      known.unknownMirror = std::max(known.unknownMirror, this->Glosses[hit]);
    }
  }
  // Before anything is traced, and on one plane ever after, that is all.
  if (!trace.mirrorPaths.empty() || trace.links.size() > 0)
  {
    this->listPaths(beam, known);
  }
  known.mostSum += known.unknownSum;
  beam.strengths.paths = std::move(known);
}

void SecondaryReflection::listPaths(const Beam& beam, KnownPaths& known)
{
  const SecondaryTrace& trace = beam.trace;
  const SecondaryLinks& links = trace.links;
  const PathNumbers numbers = numbersOf(beam);
  const std::size_t arriving = trace.mirrorPaths.size() +
    (trace.unseen < links.size()
        ? std::count(links.visibility.begin(), links.visibility.end(), Visibility::Clear)
        : 0);
  known.length.reserve(arriving);
  known.strength.reserve(arriving);
  known.ends.reserve(arriving);
  const auto add = [&known](double length, double strength, const KnownPaths::End& end)
  {
    known.length.push_back(length);
    known.strength.push_back(strength);
    known.ends.push_back(end);
    known.mostSum += strength;
  };
  this->Returned.assign(beam.hits.size(), 0.0);
  for (const MirrorPath& path : trace.mirrorPaths)
  {
    const double strength = this->mirrorStrength(beam, path);
    this->Returned[path.one] += strength;
    if (strength > 0.0)
    {
      add(path.length, strength,
        { numbers.mirror(beam.hits.ray[path.one]), path.triangle, path.one, NoHit,
          path.second.cosIncidence });
    }
  }
  for (std::size_t i = 0; i < links.size(); ++i)
  {
    const double strength = this->LinkStrengths[i];
    const std::uint32_t one = links.one[i];
    known.linkSum += strength;
    this->Returned[one] += strength;
    if (links.visibility[i] == Visibility::Unknown)
    {
      known.unknownSum += strength;
      known.unknownLink = std::max(known.unknownLink, strength);
    }
    else if (links.visibility[i] == Visibility::Clear && strength > 0.0)
    {
      const std::uint32_t two = links.two[i];
      add(beam.hits.range[one] + links.length[i] + beam.hits.range[two], strength,
        { numbers.connection(beam.hits.ray[one], links.connection[i]), beam.hits.triangle[two], one,
          two, links.cosIn[i] });
    }
  }
  for (std::uint32_t hit = 0; hit < beam.hits.size(); ++hit)
  {
    known.mayPassBudget =
      known.mayPassBudget || this->Returned[hit] * SurelyAbove > budgetOf(beam, hit);
  }
}

//--- paths ----------------------------------------------------------------------------------------

bool SecondaryReflection::collect(const Beam& beam, std::vector<SecondaryPath>& paths, double& lost)
{
  const EchoSettings& settings = this->Setup.settings;
  this->Measured = false;
  this->Tracer.beginBeam();
  bool more = !this->isKnown(beam);
  if (more)
  {
    this->prepare(beam);
    this->know(beam);
  }
  const KnownPaths& known = beam.strengths.paths;
  // What the strongest path can carry.
  const double most = this->Setup.sensor.pulseEnergy / beam.hits.rays *
    beam.strengths.mostAir(settings.attenuationCoefficient);
  double threshold = 0.0;
  if (dropsFaintPaths(settings))
  {
    const double budget = LightEnergyTolerance * this->Setup.sensor.lowerEnergyLimit;
    const double all = most * (beam.strengths.glossSum + known.linkSum);
    if (all + lost < budget)
    {
      lost += all;
      return more;
    }
    threshold = budget / static_cast<double>(numbersOf(beam).total());
  }
  const double least = most > 0.0 ? threshold / most : std::numeric_limits<double>::infinity();
  const auto matters = [least](double strength) { return strength > 0.0 && strength >= least; };
  const bool mirrors = matters(known.unknownMirror);
  const bool links = matters(known.unknownLink);
  if (mirrors || links)
  {
    this->measure(beam);
    if (mirrors)
    {
      this->Tracer.traceMirrors(beam, this->Glosses, least);
    }
    if (links)
    {
      this->Tracer.traceLinks(beam, this->LinkStrengths, least);
    }
    this->know(beam);
    more = true;
  }
  lost += most * known.unknownSum;
  this->takePaths(beam, threshold, paths, lost);
  return more;
}

namespace
{
AVIANLIDAR_MULTIVERSION void energiesOfAll(const double* lengths, const double* strengths,
  double rayEnergy, double attenuation, double* energies, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    energies[i] = rayEnergy * strengths[i] * lanes::exp(-attenuation * lengths[i]);
  }
}
}

/// Paths that carry enough, in the order of their numbers.
void SecondaryReflection::takePaths(
  const Beam& beam, double threshold, std::vector<SecondaryPath>& paths, double& lost)
{
  const KnownPaths& known = beam.strengths.paths;
  const double rayEnergy = this->Setup.sensor.pulseEnergy / beam.hits.rays;
  this->Energies.resize(known.size());
  energiesOfAll(known.length.data(), known.strength.data(), rayEnergy,
    this->Setup.settings.attenuationCoefficient, this->Energies.data(), known.size());
  for (double& energy : this->Energies)
  {
    if (energy < threshold)
    {
      lost += energy;
      energy = 0.0;
    }
  }
  if (known.mayPassBudget)
  {
    this->cutToBudget(beam, rayEnergy);
  }
  paths.reserve(paths.size() + known.size());
  for (std::size_t i = 0; i < known.size(); ++i)
  {
    if (this->Energies[i] > 0.0)
    {
      const KnownPaths::End& end = known.ends[i];
      SecondaryPath& path = paths.emplace_back();
      path.contribution.pathLength = known.length[i];
      path.contribution.energy = this->Energies[i];
      path.contribution.path = end.path;
      path.triangle = end.triangle;
      path.cosIncidence = end.cosIncidence;
      path.one = end.one;
      path.two = end.two;
    }
  }
}

/// The random weights of the connections may together exceed 1: cut what passes the ray's budget.
void SecondaryReflection::cutToBudget(const Beam& beam, double rayEnergy)
{
  const KnownPaths& known = beam.strengths.paths;
  beam.light.reflect(this->Setup, beam.hits);
  this->Returned.assign(beam.hits.size(), 0.0);
  for (std::size_t i = 0; i < known.size(); ++i)
  {
    this->Returned[known.ends[i].one] += this->Energies[i];
  }
  for (std::size_t i = 0; i < known.size(); ++i)
  {
    const std::uint32_t one = known.ends[i].one;
    const double budget = budgetOf(beam, one) * rayEnergy;
    if (this->Returned[one] > budget)
    {
      this->Energies[i] *= budget / this->Returned[one];
    }
  }
}
}
