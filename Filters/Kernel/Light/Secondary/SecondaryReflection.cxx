// SPDX-License-Identifier: BSD-3-Clause
#include "SecondaryReflection.h"

#include "LaneMath.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
SecondaryReflection::SecondaryReflection(const ScanSetup& setup)
  : Setup(setup)
  , Finder(setup)
{
}

//--- what may be connected ------------------------------------------------------------------------

void SecondaryReflection::prepare(const Beam& beam)
{
  SecondaryTrace& trace = beam.trace;
  const std::uint32_t partners = connectionsOf(this->Setup.settings);
  if (trace.mirror.empty())
  {
    trace.mirror.assign(beam.samples.size(), MirrorEnd::NotTraced);
    trace.unknown = beam.samples.size();
  }
  if (!trace.connectionsKnown || trace.partners != partners)
  {
    trace.connections.clear();
    trace.partners = partners;
    // Points of one plane do not look at each other.
    if (partners > 0 && !beam.samples.coplanar)
    {
      this->Finder.find(beam, partners);
    }
    trace.connectionsKnown = true;
    trace.unseen = trace.connections.size();
  }
}

//--- what it is worth -----------------------------------------------------------------------------

bool SecondaryReflection::isKnown(const KnownPaths& known) const
{
  return known.found && known.partners == connectionsOf(this->Setup.settings);
}

double SecondaryReflection::bound(const BeamSamples& samples, const Throughput& known) const
{
  // No ray returns more than the albedo; from one plane there are mirror paths alone.
  const bool mirrorsOnly = samples.coplanar && this->Setup.sensor.receiverAperture <= 0.0;
  const double most = this->isKnown(known.paths) ? known.paths.mostSum
    : mirrorsOnly                                ? known.specularSum
                                                 : known.budgetSum;
  return std::min(most, known.budgetSum);
}

double SecondaryReflection::mirrorThroughput(const Beam& beam, const MirrorPath& path) const
{
  const ReflectanceModel model = this->Setup.settings.reflectanceModel;
  const double aperture = this->Setup.sensor.receiverAperture;
  const Material first = this->Materials[path.one];
  const Material& second = this->Setup.materials[path.triangle];
  ReflectionGeometry back = path.second;
  if (aperture > 0.0)
  {
    back.cosIncidence = back.cosOutgoing;
  }
  const double f1 =
    specularReflectance(model, first, mirrorGeometry(beam.samples.cosine[path.one]));
  const double f2 =
    throughAperture(reflectance(model, second, back), second, aperture, path.range).total();
  return f1 * f2 * secondaryScale(this->Setup, beam, path.one, first, second) *
    beam.samples.weight[path.one];
}

/// Share of the pulse that the paths on from a sample may bring back: what its direct echo leaves.
double SecondaryReflection::budgetOf(const Beam& beam, std::uint32_t sample) const
{
  return beam.samples.weight[sample] *
    std::max(0.0, this->Materials[sample].albedo() - beam.throughput.reflected[sample]);
}

/// What each path could bring back.
void SecondaryReflection::measure(const Beam& beam)
{
  if (this->Measured)
  {
    return;
  }
  const BeamSamples& samples = beam.samples;
  this->Triangles.resize(samples.size());
  this->Materials.resize(samples.size());
  this->SpecularBounds.resize(samples.size());
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      const Material& material = this->Setup.materials[triangle];
      this->Materials.fill(begin, end, material);
      for (std::uint32_t i = begin; i < end; ++i)
      {
        this->Triangles[i] = triangle;
        this->SpecularBounds[i] =
          samples.weight[i] * specularBound(this->Setup, material, samples.cosine[i]);
      }
    });
  connectionThroughputs(this->Setup, beam, this->Materials, this->ConnectionThroughputs);
  this->Measured = true;
}

/// List the paths that are known to arrive, and sum up the others.
void SecondaryReflection::know(const Beam& beam)
{
  this->measure(beam);
  const SecondaryTrace& trace = beam.trace;
  KnownPaths known;
  known.found = true;
  known.partners = trace.partners;
  for (std::uint32_t hit = 0; trace.unknown > 0 && hit < beam.samples.size(); ++hit)
  {
    if (trace.mirror[hit] == MirrorEnd::NotTraced)
    {
      known.unknownSum += this->SpecularBounds[hit];
      known.unknownMirror = std::max(known.unknownMirror, this->SpecularBounds[hit]);
    }
  }
  // Before anything is traced, and on one plane ever after, that is all.
  if (!trace.mirrorPaths.empty() || trace.connections.size() > 0)
  {
    this->listPaths(beam, known);
  }
  known.mostSum += known.unknownSum;
  beam.throughput.paths = std::move(known);
}

void SecondaryReflection::listPaths(const Beam& beam, KnownPaths& known)
{
  const SecondaryTrace& trace = beam.trace;
  const SecondaryConnections& connections = trace.connections;
  const std::size_t arriving = trace.mirrorPaths.size() +
    (trace.unseen < connections.size() ? std::count(connections.visibility.begin(),
                                           connections.visibility.end(), Visibility::Clear)
                                       : 0);
  known.length.reserve(arriving);
  known.throughput.reserve(arriving);
  known.ends.reserve(arriving);
  const auto add = [&known](double length, double throughput, const KnownPaths::End& end)
  {
    known.length.push_back(length);
    known.throughput.push_back(throughput);
    known.ends.push_back(end);
    known.mostSum += throughput;
  };
  this->Returned.assign(beam.samples.size(), 0.0);
  for (const MirrorPath& path : trace.mirrorPaths)
  {
    const double throughput = this->mirrorThroughput(beam, path);
    this->Returned[path.one] += throughput;
    if (throughput > 0.0)
    {
      add(path.length, throughput, { path.triangle, path.one, NoSample, path.second.cosIncidence });
    }
  }
  for (std::size_t i = 0; i < connections.size(); ++i)
  {
    const double throughput = this->ConnectionThroughputs[i];
    const std::uint32_t one = connections.one[i];
    known.connectionSum += throughput;
    this->Returned[one] += throughput;
    if (connections.visibility[i] == Visibility::Unknown)
    {
      known.unknownSum += throughput;
      known.unknownConnection = std::max(known.unknownConnection, throughput);
    }
    else if (connections.visibility[i] == Visibility::Clear && throughput > 0.0)
    {
      const std::uint32_t two = connections.two[i];
      add(beam.samples.range[one] + connections.length[i] + beam.samples.range[two], throughput,
        { this->Triangles[two], one, two, connections.cosIn[i] });
    }
  }
  for (std::uint32_t hit = 0; hit < beam.samples.size(); ++hit)
  {
    known.mayPassBudget =
      known.mayPassBudget || this->Returned[hit] * SurelyAbove > this->budgetOf(beam, hit);
  }
}

//--- paths ----------------------------------------------------------------------------------------

bool SecondaryReflection::collect(const Beam& beam, std::vector<SecondaryPath>& paths, double& lost)
{
  const EchoSettings& settings = this->Setup.settings;
  this->Measured = false;
  bool more = !this->isKnown(beam.throughput.paths);
  if (more)
  {
    this->prepare(beam);
    this->know(beam);
  }
  const KnownPaths& known = beam.throughput.paths;
  // What the strongest path can carry.
  const double most =
    this->Setup.sensor.pulseEnergy * mostAir(beam.samples, settings.attenuationCoefficient);
  double threshold = 0.0;
  if (dropsFaintPaths(settings) && settings.lightEnergyThreshold == LightEnergyThreshold::Limit)
  {
    threshold = this->Setup.sensor.lowerEnergyLimit;
  }
  else if (dropsFaintPaths(settings))
  {
    const double budget = lightEnergyTolerance(this->Setup);
    const double all = most * (beam.throughput.specularSum + known.connectionSum);
    if (all + lost < budget)
    {
      lost += all;
      return more;
    }
    threshold = budget / pathsOfABeam(settings);
  }
  const double least = most > 0.0 ? threshold / most : std::numeric_limits<double>::infinity();
  const auto matters = [least](double throughput)
  { return throughput > 0.0 && throughput >= least; };
  const bool mirrors = matters(known.unknownMirror);
  const bool connections = matters(known.unknownConnection);
  if (mirrors || connections)
  {
    this->measure(beam);
    if (mirrors)
    {
      traceMirrors(this->Setup, beam, this->SpecularBounds, least, this->Pairs);
    }
    if (connections)
    {
      traceConnections(beam, this->ConnectionThroughputs, least);
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
AVIANLIDAR_MULTIVERSION void energiesOfAll(const double* lengths, const double* throughputs,
  double pulseEnergy, double attenuation, double* energies, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    energies[i] = pulseEnergy * throughputs[i] * lanes::exp(-attenuation * lengths[i]);
  }
}
}

/// Paths that carry enough, in the order of their numbers.
void SecondaryReflection::takePaths(
  const Beam& beam, double threshold, std::vector<SecondaryPath>& paths, double& lost)
{
  const KnownPaths& known = beam.throughput.paths;
  this->Energies.resize(known.size());
  energiesOfAll(known.length.data(), known.throughput.data(), this->Setup.sensor.pulseEnergy,
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
    this->cutToBudget(beam);
  }
  paths.reserve(paths.size() + known.size());
  for (std::size_t i = 0; i < known.size(); ++i)
  {
    if (this->Energies[i] > 0.0)
    {
      const KnownPaths::End& end = known.ends[i];
      paths.push_back(
        { known.length[i], this->Energies[i], end.triangle, end.cosIncidence, end.one, end.two });
    }
  }
}

/// The random weights of the connections may together exceed 1: cut what passes the ray's budget.
void SecondaryReflection::cutToBudget(const Beam& beam)
{
  const KnownPaths& known = beam.throughput.paths;
  this->measure(beam);
  this->Returned.assign(beam.samples.size(), 0.0);
  for (std::size_t i = 0; i < known.size(); ++i)
  {
    this->Returned[known.ends[i].one] += this->Energies[i];
  }
  for (std::size_t i = 0; i < known.size(); ++i)
  {
    const std::uint32_t one = known.ends[i].one;
    const double budget = this->budgetOf(beam, one) * this->Setup.sensor.pulseEnergy;
    if (this->Returned[one] > budget)
    {
      this->Energies[i] *= budget / this->Returned[one];
    }
  }
}
}
