// SPDX-License-Identifier: BSD-3-Clause
#include "HiddenGlint.h"

#include "DirectLight.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// So many rays show a lobe as it is.
constexpr double EnoughRays = 8.0;

/// No direction of the cone is farther than this from all rays, but rarely: multiple of t/sqrt(N).
constexpr double WidestGap = 2.0;
}

double hiddenGlintOf(const ScanSetup& setup, const PrimaryHits& hits, const DirectLight& light)
{
  const double rays = static_cast<double>(hits.rays);
  const double t = setup.sensor.halfBeamwidth;
  // Rays in the lobe: half of this over k.
  const double scale = rays / (t * t);
  const double narrow = 0.5 * scale / EnoughRays;
  double most = 0.0;
  double seen = 0.0;
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    if (light.kp[i] <= narrow || light.ks[i] <= 0.0)
    {
      continue;
    }
    const Material material{ light.kd[i], light.ks[i], light.kp[i] };
    const double angle = std::acos(std::min(1.0, hits.cosine[i]));
    const double root = std::sqrt(std::min(1.0, 0.25 * scale / material.kp));
    const auto returned = [&](double incidence)
    {
      Reflectance f;
      f.specular = specularReflectance(
        setup.settings.reflectanceModel, material, monostaticGeometry(std::cos(incidence)));
      return root *
        throughAperture(f, material.kp, setup.sensor.receiverAperture, hits.range[i]).specular;
    };
    seen = std::max(seen, returned(angle));
    most = std::max(most, returned(std::max(0.0, angle - WidestGap * t / std::sqrt(rays))));
  }
  return most - seen;
}
}
