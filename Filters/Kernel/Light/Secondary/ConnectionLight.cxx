// SPDX-License-Identifier: BSD-3-Clause
#include "ConnectionLight.h"

#include "LaneMath.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
double coneSolidAngle(double halfBeamwidth)
{
  const double s = std::sin(0.5 * halfBeamwidth);
  return 4.0 * Pi * s * s;
}

namespace
{
/// min(1, B/(g R2)), see SecondaryReflection.h. @param passedOn g @param direct what P1 returns
template <class Model>
AVIANLIDAR_ALWAYS_INLINE double scaleOf(
  Material first, Material second, double cosine, double direct, double aperture)
{
  const double bound = Model::bound(first, cosine).total();
  const double passed = (aperture > 0.0 ? first.albedo() : bound) * second.albedo();
  const double budget = lanes::larger(first.albedo() - direct, 0.0);
  return passed > budget ? budget / passed : 1.0;
}

/// What the throughputs of connections are made from: connections, samples, their materials.
struct ConnectionLanes
{
  const std::uint32_t *one, *two;
  const double *weight, *length, *cosOut, *differenceOne;
  const double *cosIn, *cosLobe, *sin2Lobe, *sin2Half, *differenceTwo;
  const double *cosine, *range, *direct;
  MaterialLanes::View material;
  double share; ///< of the pulse, of each ray
  double aperture;
  double solidAngle; ///< of the cone
};

template <class Model>
AVIANLIDAR_ALWAYS_INLINE double throughputOf(const ConnectionLanes& h, std::size_t i)
{
  const std::uint32_t a = h.one[i];
  const std::uint32_t b = h.two[i];
  const Material first = h.material[a];
  const Material second = h.material[b];
  const double cosBack = h.cosine[b];
  const bool gathers = h.aperture > 0.0;
  const ReflectionGeometry out{ h.cosine[a], h.cosOut[i], 1.0, 0.0, 0.0, h.differenceOne[i] };
  const double diffuse = h.weight[i] * Model::of(first, out).diffuse;
  // Through an aperture: the solid angle under which P1 sees the part of the surface that fills
  // the cone around P2, over pi.
  const double lit = h.range[b] * h.range[b] * h.solidAngle / lanes::larger(cosBack, 1e-300);
  const double form = h.cosOut[i] * h.cosIn[i] * lit / (Pi * h.length[i] * h.length[i]);
  const double received = first.diffuseAlbedo() * lanes::smaller(h.weight[i] * form, 1.0);
  const ReflectionGeometry back{ gathers ? cosBack : h.cosIn[i], cosBack, h.cosLobe[i],
    h.sin2Lobe[i], h.sin2Half[i], h.differenceTwo[i] };
  const double returned =
    throughAperture(Model::of(second, back), second, h.aperture, h.range[b]).total();
  return h.share * (gathers ? received : diffuse) * returned *
    scaleOf<Model>(first, second, h.cosine[a], h.direct[a], h.aperture);
}

template <class Model>
AVIANLIDAR_ALWAYS_INLINE void throughputsOf(
  const ConnectionLanes& lanes, double* throughputs, std::size_t count)
{
  const ConnectionLanes h = lanes;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    throughputs[i] = throughputOf<Model>(h, i);
  }
}

AVIANLIDAR_MULTIVERSION void throughputsOfAll(
  ReflectanceModel model, const ConnectionLanes& lanes, double* throughputs, std::size_t count)
{
  withModel(model,
    [=, &lanes](auto m) AVIANLIDAR_INLINE_LAMBDA
    { throughputsOf<decltype(m)>(lanes, throughputs, count); });
}
}

double secondaryScale(const ScanSetup& setup, const SecondaryBeam& beam, std::uint32_t sample,
  const Material& first, const Material& second)
{
  return withModel(setup.settings.reflectanceModel,
    [&](auto m)
    {
      return scaleOf<decltype(m)>(first, second, beam.samples.cosine[sample],
        beam.throughput.reflected[sample], setup.sensor.receiverAperture);
    });
}

void connectionThroughputs(const ScanSetup& setup, const SecondaryBeam& beam,
  const MaterialLanes& materials, std::vector<double>& throughputs)
{
  const SecondaryConnections& connections = beam.trace.connections;
  throughputs.resize(connections.size());
  throughputsOfAll(setup.settings.reflectanceModel,
    { connections.one.data(), connections.two.data(), connections.weight.data(),
      connections.length.data(), connections.cosOut.data(), connections.differenceOne.data(),
      connections.cosIn.data(), connections.cosLobe.data(), connections.sin2Lobe.data(),
      connections.sin2Half.data(), connections.differenceTwo.data(), beam.samples.cosine.data(),
      beam.samples.range.data(), beam.throughput.reflected.data(), materials.view(),
      1.0 / beam.samples.rays, setup.sensor.receiverAperture,
      coneSolidAngle(setup.sensor.halfBeamwidth) },
    throughputs.data(), connections.size());
}
}
