// SPDX-License-Identifier: BSD-3-Clause
#include "DirectLight.h"

#include "LaneMath.h"
#include "Reflectance.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// Eq. 5-8 for light that goes back where it came from: delta = 2 theta_i (see Reflectance.h).
AVIANLIDAR_MULTIVERSION void lambertBlinnPhong(const double* cosines, const double* kd,
  const double* ks, const double* kp, double* reflected, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double c = cosines[i];
    const double sine2 = (1.0 - c) * (1.0 + c);
    const double cosLobe = c * c - sine2;
    const double sin2Lobe = 4.0 * sine2 * c * c;
    reflected[i] = kd[i] * c + ks[i] * lanes::lobe(cosLobe, sin2Lobe, kp[i]);
  }
}

AVIANLIDAR_MULTIVERSION void lambert(
  const double* cosines, const double* kd, double* reflected, std::size_t count)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    reflected[i] = kd[i] * cosines[i];
  }
}

/// transmission() of the way there and back acts on what is reflected. @return the least energy
AVIANLIDAR_MULTIVERSION double energiesOfAll(const double* strengths, const double* ranges,
  double attenuation, double rayEnergy, double* energies, std::size_t count)
{
  const double factor = -2.0 * attenuation;
  double least = std::numeric_limits<double>::infinity();
#pragma omp simd reduction(min : least)
  for (std::size_t i = 0; i < count; ++i)
  {
    const double energy = rayEnergy * strengths[i] * lanes::exp(factor * ranges[i]);
    energies[i] = energy;
    least = energy < least ? energy : least;
  }
  return least;
}
}

void DirectLight::reflect(const ScanSetup& setup, const PrimaryHits& hits)
{
  if (this->materialsKnown)
  {
    return;
  }
  this->materialsKnown = true;
  const std::size_t count = hits.size();
  for (std::vector<double>* v : { &this->kd, &this->ks, &this->kp, &this->reflected })
  {
    v->resize(count);
  }
  bool glossy = false;
  Material material; // neighbouring rays mostly meet the same triangle
  for (std::size_t i = 0; i < count; ++i)
  {
    if (i == 0 || hits.triangle[i] != hits.triangle[i - 1])
    {
      material = setup.materials[hits.triangle[i]];
    }
    this->kd[i] = material.kd;
    this->ks[i] = material.ks;
    this->kp[i] = material.kp;
    glossy = glossy || material.ks > 0.0;
  }
  const ReflectanceModel model = setup.settings.reflectanceModel;
  const double aperture = setup.sensor.receiverAperture;
  if (model == ReflectanceModel::LambertBlinnPhong && aperture <= 0.0)
  {
    if (glossy)
    {
      lambertBlinnPhong(hits.cosine.data(), this->kd.data(), this->ks.data(), this->kp.data(),
        this->reflected.data(), count);
    }
    else
    {
      lambert(hits.cosine.data(), this->kd.data(), this->reflected.data(), count);
    }
    return;
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    const Material& material = setup.materials[hits.triangle[i]];
    const Reflectance f = reflectance(model, material, monostaticGeometry(hits.cosine[i]));
    this->reflected[i] = throughAperture(f, material.kp, aperture, hits.range[i]).total();
  }
}

void DirectLight::attenuate(const ScanSetup& setup, const PrimaryHits& hits,
  const std::vector<double>& strengths, double rayEnergy)
{
  const std::size_t count = hits.size();
  this->energy.resize(count);
  this->least = energiesOfAll(strengths.data(), hits.range.data(),
    setup.settings.attenuationCoefficient, rayEnergy, this->energy.data(), count);
  if (!hits.share.empty())
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      this->energy[i] *= hits.weight(i);
      this->least = std::min(this->least, this->energy[i]);
    }
  }
  this->sum = 0.0;
  for (const double e : this->energy)
  {
    this->sum += e;
  }
}
}
