// SPDX-License-Identifier: BSD-3-Clause
#include "LinkLight.h"

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

double secondaryBudget(const SecondaryBeam& beam, std::uint32_t hit)
{
  return std::max(0.0, beam.light.kd[hit] + beam.light.ks[hit] - beam.strengths.direct[hit]);
}

double secondaryScale(
  const ScanSetup& setup, const SecondaryBeam& beam, std::uint32_t hit, const Material& second)
{
  const Material first{ beam.light.kd[hit], beam.light.ks[hit], beam.light.kp[hit] };
  const double passedOn = setup.sensor.receiverAperture > 0.0
    ? first.kd + first.ks
    : reflectanceBound(setup.settings.reflectanceModel, first, beam.hits.cosine[hit]).total();
  const double budget = secondaryBudget(beam, hit);
  const double passed = passedOn * (second.kd + second.ks);
  return passed > budget ? budget / passed : 1.0;
}

namespace
{
/// What the strengths of links are made from: links, hits, materials of hits.
struct LinkLanes
{
  const std::uint32_t* one;
  const std::uint32_t* two;
  const double* weight;
  const double* cosIn;
  const double* cosLobe;
  const double* sin2Lobe;
  const double* cosine;
  const double* kd;
  const double* ks;
  const double* kp;
  const double* reflected;
};

/// LambertBlinnPhong (see Reflectance.h): f_d at P1, the whole f_sur at P2, and the scale that
/// keeps P1 from passing on more than its direct echo leaves.
AVIANLIDAR_MULTIVERSION void strengthsOfAll(
  const LinkLanes& links, double* strengths, std::size_t count)
{
  const LinkLanes h = links;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::uint32_t a = h.one[i];
    const std::uint32_t b = h.two[i];
    const double diffuse = h.kd[a] * h.cosine[a];
    const double second = h.kd[b] + h.ks[b];
    const double left = h.kd[a] + h.ks[a] - h.reflected[a];
    const double budget = left > 0.0 ? left : 0.0;
    const double passed = (diffuse + h.ks[a]) * second;
    const double scale = passed > budget ? budget / passed : 1.0;
    const double c = h.cosIn[i] < 1.0 ? h.cosIn[i] : 1.0;
    const double f2 = h.kd[b] * c + h.ks[b] * lanes::lobe(h.cosLobe[i], h.sin2Lobe[i], h.kp[b]);
    strengths[i] = (h.weight[i] * diffuse) * f2 * scale;
  }
}

void strengthsOneByOne(
  const ScanSetup& setup, const SecondaryBeam& beam, std::vector<double>& strengths)
{
  const ReflectanceModel model = setup.settings.reflectanceModel;
  const double aperture = setup.sensor.receiverAperture;
  const SecondaryLinks& links = beam.trace.links;
  const DirectLight& light = beam.light;
  for (std::size_t i = 0; i < links.size(); ++i)
  {
    const std::uint32_t one = links.one[i];
    const std::uint32_t two = links.two[i];
    const Material first{ light.kd[one], light.ks[one], light.kp[one] };
    const Material second{ light.kd[two], light.ks[two], light.kp[two] };
    const double range = beam.hits.range[two];
    const double cosBack = beam.hits.cosine[two];
    double f1 = 0.0;
    if (aperture > 0.0)
    {
      // The solid angle under which P1 sees the part of the surface that fills the cone around P2,
      // over pi.
      const double lit =
        range * range * coneSolidAngle(setup.sensor.halfBeamwidth) / std::max(cosBack, 1e-300);
      const double form =
        links.cosOut[i] * links.cosIn[i] * lit / (Pi * links.length[i] * links.length[i]);
      f1 = first.kd * std::min(1.0, links.weight[i] * form);
    }
    else
    {
      ReflectionGeometry out;
      out.cosIncidence = beam.hits.cosine[one];
      out.cosOutgoing = links.cosOut[i];
      out.cosDifference = links.differenceOne[i];
      f1 = links.weight[i] * diffuseReflectance(model, first, out);
    }
    const ReflectionGeometry back{ aperture > 0.0 ? cosBack : links.cosIn[i], cosBack,
      links.cosLobe[i], links.sin2Lobe[i], links.sin2Half[i], links.differenceTwo[i] };
    const double f2 =
      throughAperture(reflectance(model, second, back), second.kp, aperture, range).total();
    strengths[i] = f1 * f2 * secondaryScale(setup, beam, one, second);
  }
}
}

void linkStrengths(
  const ScanSetup& setup, const SecondaryBeam& beam, std::vector<double>& strengths)
{
  const SecondaryLinks& links = beam.trace.links;
  const std::size_t count = links.size();
  strengths.resize(count);
  if (setup.settings.reflectanceModel != ReflectanceModel::LambertBlinnPhong ||
    setup.sensor.receiverAperture > 0.0)
  {
    strengthsOneByOne(setup, beam, strengths);
    return;
  }
  const DirectLight& light = beam.light;
  const LinkLanes lanes{ links.one.data(), links.two.data(), links.weight.data(),
    links.cosIn.data(), links.cosLobe.data(), links.sin2Lobe.data(), beam.hits.cosine.data(),
    light.kd.data(), light.ks.data(), light.kp.data(), beam.strengths.direct.data() };
  strengthsOfAll(lanes, strengths.data(), count);
}
}
