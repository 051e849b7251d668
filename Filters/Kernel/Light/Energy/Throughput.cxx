// SPDX-License-Identifier: BSD-3-Clause
#include "Throughput.h"

#include "Multiversion.h"

#include <algorithm>

namespace avianlidar
{
double mattReturnBound(const ScanSetup& setup, const BeamShape& shape, double nearest)
{
  // The reverse path and the path back by the mirror have weights of their own.
  const double more = MostGrazing *
    (shape.mostDensity() / shape.density(1.0, 0.0) +
      (setup.settings.numberOfReflections > 2 ? 1.0 : 0.0));
  const double gathered = setup.sensor.receiverAperture / (Pi * nearest * nearest);
  return std::min(1.0, setup.largestReflectance * gathered * (1.0 + more) * SurelyAbove);
}

double mirrorReturnBound(const ScanSetup& setup, const BeamShape& shape, double nearest)
{
  const double once = returnBound(setup, nearest);
  return setup.sensor.receiverAperture > 0.0
    ? std::min(1.0, once + mattReturnBound(setup, shape, nearest))
    : once;
}

double specularBound(
  const ScanSetup& setup, const Material& material, double cosIncidence, double returned)
{
  return reflectanceBound(setup.settings.reflectanceModel, material, cosIncidence).specular *
    returned * SurelyAbove;
}

double transmissionBound(double nearest, double attenuation)
{
  return transmission(attenuation, 2.0 * nearest) * SurelyAbove;
}

namespace
{
/// Some samples of one surface.
struct SurfaceLanes
{
  const double* cosine;
  const double* range;
  double* reflected;
  std::size_t count;
};

/// Eq. 5-8 for light that returns along its own path: delta = 2 theta_i (Reflectance.h). Without ks
/// no model has a specular component in this direction.
template <class Model, bool Glossy>
AVIANLIDAR_ALWAYS_INLINE double returned(
  Material material, double aperture, double cosine, double range)
{
  const Reflectance f = Model::of(material, monostaticGeometry(cosine));
  const Reflectance all{ f.diffuse, Glossy ? f.specular : 0.0 };
  return throughAperture(all, material, aperture, range).total();
}

template <class Model, bool Glossy>
AVIANLIDAR_ALWAYS_INLINE void reflect(
  const Material& of, double aperture, const SurfaceLanes& lanes)
{
  const Material material = of;
  const SurfaceLanes s = lanes;
#pragma omp simd
  for (std::size_t i = 0; i < s.count; ++i)
  {
    s.reflected[i] = returned<Model, Glossy>(material, aperture, s.cosine[i], s.range[i]);
  }
}

AVIANLIDAR_MULTIVERSION void reflectAll(
  ReflectanceModel model, const Material& material, double aperture, const SurfaceLanes& lanes)
{
  withModel(model,
    [&](auto m) AVIANLIDAR_INLINE_LAMBDA
    {
      using Model = decltype(m);
      return material.isGlossy() ? reflect<Model, true>(material, aperture, lanes)
                                 : reflect<Model, false>(material, aperture, lanes);
    });
}
}

void Throughput::measure(const ScanSetup& setup, const BeamSamples& samples)
{
  this->directSum = 0.0;
  this->reflected.resize(samples.size());
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      reflectAll(setup.settings.reflectanceModel, setup.material(triangle),
        setup.sensor.receiverAperture,
        { samples.cosine.data() + begin, samples.range.data() + begin,
          this->reflected.data() + begin, end - begin });
      for (std::uint32_t i = begin; setup.sensor.losesNearRange() && i < end; ++i)
      {
        this->reflected[i] *= setup.sensor.nearRangeShare(samples.range[i]);
      }
      for (std::uint32_t i = begin; i < end; ++i)
      {
        this->directSum += samples.weight[i] * this->reflected[i];
      }
    });
}

namespace
{
/// Multiply throughputs by the transmission() of the way to the sample and back.
AVIANLIDAR_MULTIVERSION void energiesOfAll(const double* weights, const double* reflected,
  const double* ranges, double attenuation, double pulseEnergy, double* energies, std::size_t count)
{
  const double factor = -2.0 * attenuation;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    energies[i] = pulseEnergy * weights[i] * reflected[i] * lanes::exp(factor * ranges[i]);
  }
}
}

double directEnergies(const ScanSetup& setup, const BeamSamples& samples,
  const Throughput& throughput, std::vector<double>& energies)
{
  energies.resize(samples.size());
  energiesOfAll(samples.weight.data(), throughput.reflected.data(), samples.range.data(),
    setup.attenuation(), setup.sensor.pulseEnergy, energies.data(), samples.size());
  double sum = 0.0;
  for (const double energy : energies)
  {
    sum += energy;
  }
  return sum;
}
}
