// SPDX-License-Identifier: BSD-3-Clause
// Reflectance models: the paper's in three dimensions, its lobe at every glossiness, and the peers.
// Energies of planes in closed form are TestOracles'.
#include "GeometryTestScene.h"
#include "Reflectance.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace avianlidar;

namespace
{
constexpr ReflectanceModel models[] = { ReflectanceModel::LambertBlinnPhong,
  ReflectanceModel::Phong, ReflectanceModel::Microfacet, ReflectanceModel::OrenNayar };
constexpr ReflectanceModel paper = ReflectanceModel::LambertBlinnPhong;
const Material wall{ 0.146, 0.054, 112.0 };
const Material glass{ 0.020, 0.852, 8046.0 };
const Material metal{ 0.075, 0.634, 6803.0 };

/// Direction of travel that meets the plane z = 0 from above at an incidence angle.
Vec3 incidentAt(double angle)
{
  return { std::sin(angle), 0.0, -std::cos(angle) };
}

/// Direction away from the plane at an angle from its normal, in the plane of incidence; positive:
/// forward.
Vec3 outgoingAt(double angle, double azimuth = 0.0)
{
  return { std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
    std::cos(angle) };
}

const Vec3 up{ 0.0, 0.0, 1.0 };
}

TEST(Reflectance, LobeAtEveryGlossiness)
{
  for (const double k : { 0.5, 1.0, 2.0, 82.0, 112.0, 6803.0, 8046.0, 1e5, 1e6 })
  {
    for (const double delta : { 0.0, 1e-6, 1e-4, 1e-3, 5e-3, 0.02, 0.3, 0.79, 0.8, 1.2, 1.57 })
    {
      const long double exact =
        std::exp(static_cast<long double>(k) * std::log(std::cos(static_cast<long double>(delta))));
      const double s = std::sin(delta);
      const double value = lobe(std::cos(delta), s * s, k);
      EXPECT_NEAR(value, static_cast<double>(exact), 2e-12 * static_cast<double>(exact) + 1e-300)
        << k << ' ' << delta;
      // The same angle as a pair of vectors, incidence 40 degrees.
      const auto g = reflectionGeometry(incidentAt(0.7), outgoingAt(0.7 - delta), up);
      EXPECT_NEAR(specularReflectance(paper, { 0.0, 1.0, k }, g), static_cast<double>(exact),
        1e-9 * static_cast<double>(exact) + 1e-300)
        << k << ' ' << delta;
    }
  }
}

TEST(Reflectance, NoFalseGlintAtGrazingIncidence)
{
  // Taken literally, max{0, cos^112(178 deg)} would be 0.934: an even power of a negative cosine.
  EXPECT_NEAR(std::pow(std::cos(178.0 * Pi / 180.0), 112.0), 0.9340286530, 1e-10);
  for (const double k : { 0.0, 1.0, 2.0, 112.0, 8046.0, 1e6 })
  {
    for (const double degrees : { 45.0 + 1e-6, 60.0, 89.0, 89.9999, 90.0 })
    {
      const double angle = degrees * Pi / 180.0;
      const Material mirror{ 0.0, 1.0, k };
      EXPECT_EQ(specularReflectance(paper, mirror, monostaticGeometry(std::cos(angle))), 0.0);
      const Vec3 in = incidentAt(angle);
      EXPECT_EQ(specularReflectance(paper, mirror, reflectionGeometry(in, -in, up)), 0.0);
    }
  }
}

TEST(Reflectance, ZeroGlossinessIsAHalfSpace)
{
  const Material flat{ 0.0, 0.5, 0.0 };
  EXPECT_EQ(specularReflectance(paper, flat, monostaticGeometry(1.0)), 0.5);
  EXPECT_EQ(specularReflectance(paper, flat, monostaticGeometry(std::cos(0.7))), 0.5);
  EXPECT_EQ(specularReflectance(paper, flat, monostaticGeometry(std::cos(0.8))), 0.0);
}

TEST(Reflectance, DeltaIsThePlaneAngleOfThePaper)
{
  for (const double thetaI : { 0.0, 0.2, 0.9, 1.4 })
  {
    for (const double thetaR : { -1.5, -0.9, 0.0, 0.2, 0.9, 1.5 })
    {
      const auto g = reflectionGeometry(incidentAt(thetaI), outgoingAt(thetaR), up);
      EXPECT_NEAR(g.cosLobe, std::cos(thetaR - thetaI), 1e-15);
      EXPECT_NEAR(g.sin2Lobe, std::pow(std::sin(thetaR - thetaI), 2), 1e-15);
      EXPECT_NEAR(g.cosIncidence, std::cos(thetaI), 1e-15);
      EXPECT_NEAR(g.cosOutgoing, std::cos(thetaR), 1e-15);
      EXPECT_NEAR(g.sin2Half, std::pow(std::sin(0.5 * (thetaR - thetaI)), 2), 1e-15);
      EXPECT_NEAR(g.cosDifference, std::abs(std::cos(0.5 * (thetaI + thetaR))), 1e-15);
    }
  }
}

TEST(Reflectance, MonostaticGeometryIsTheGeneralOne)
{
  for (const double angle : { 0.0, 1e-4, 1e-3, 0.01, 0.5, 1.0, 1.5 })
  {
    for (const ReflectanceModel model : models)
    {
      for (const double k : { 1.0, 112.0, 1e6 })
      {
        const Material material{ 0.3, 0.6, k, 0.4 };
        const Vec3 in = incidentAt(angle);
        const double general =
          reflectance(model, material, reflectionGeometry(in, -in, up)).total();
        const double cosine =
          reflectance(model, material, monostaticGeometry(std::cos(angle))).total();
        EXPECT_NEAR(cosine, general, 2e-9 * general) << angle << ' ' << k;
      }
    }
  }
}

TEST(Reflectance, MirrorGeometryIsThePeak)
{
  for (const double angle : { 0.0, 0.5, 1.5 })
  {
    const Vec3 in = incidentAt(angle);
    const auto exact = mirrorGeometry(std::cos(angle));
    const auto general = reflectionGeometry(in, mirrorDirection(in, up), up);
    for (const ReflectanceModel model : models)
    {
      EXPECT_NEAR(specularReflectance(model, glass, exact),
        specularReflectance(model, glass, general), 1e-12);
    }
    EXPECT_EQ(specularReflectance(paper, glass, exact), glass.ks);
  }
}

TEST(Reflectance, EveryModelIsBoundedByItsCoefficients)
{
  geometrytest::Numbers random(2);
  for (int n = 0; n < 100000; ++n)
  {
    const double albedo = random();
    const double kd = albedo * random();
    const double kp = random() < 0.05 ? 0.0 : random.logUniform(1.0, 1e6);
    const Material material{ kd, albedo - kd, kp, random(0.0, 0.5 * Pi) };
    Vec3 normal = random.direction();
    const Vec3 in = random.direction();
    normal = glm::dot(normal, in) > 0.0 ? -normal : normal;
    const Vec3 out = random() < 0.3 ? mirrorDirection(in, normal) : random.direction();
    const auto g = reflectionGeometry(in, out, normal);
    for (const ReflectanceModel model : models)
    {
      const Reflectance f = reflectance(model, material, g);
      const Reflectance bound = reflectanceBound(model, material, g.cosIncidence);
      ASSERT_GE(f.diffuse, 0.0);
      ASSERT_GE(f.specular, 0.0);
      ASSERT_LE(f.total(), (material.kd + material.ks) * (1.0 + 1e-14));
      ASSERT_LE(f.diffuse, bound.diffuse * (1.0 + 1e-14));
      ASSERT_LE(f.specular, bound.specular * (1.0 + 1e-14));
      ASSERT_EQ(f.specular, specularReflectance(model, material, g));
    }
  }
}

TEST(Reflectance, PhongIsThePaperTimesTheCosine)
{
  const auto g = reflectionGeometry(incidentAt(0.4), outgoingAt(0.5, 0.1), up);
  const auto a = reflectance(paper, wall, g);
  const auto b = reflectance(ReflectanceModel::Phong, wall, g);
  EXPECT_EQ(a.diffuse, b.diffuse);
  EXPECT_NEAR(b.specular, a.specular * std::cos(0.4), 1e-15);
}

TEST(Reflectance, MicrofacetByItsFormula)
{
  const double k = 112.0;
  for (const double ti : { 0.1, 0.5, 1.2 })
  {
    for (const double to : { 0.0, 0.3, 1.1 })
    {
      for (const double azimuth : { 0.0, 0.2, 2.0, Pi })
      {
        const Vec3 in = incidentAt(ti);
        const Vec3 out = outgoingAt(to, azimuth);
        const Vec3 half = glm::normalize(out - in);
        const double s = std::pow(1.0 - glm::dot(half, out), 5);
        const double a2 = 1.0 / (2.0 * k + 1.0);
        const double ch2 = half.z * half.z;
        const double d = std::pow(a2 / (ch2 * (a2 - 1.0) + 1.0), 2);
        // Heitz' masking by its Lambda functions.
        const auto lambda = [a2](double t)
        { return 0.5 * (std::sqrt(1.0 + a2 * std::pow(std::tan(t), 2)) - 1.0); };
        const double mask = 1.0 / (1.0 + lambda(ti) + lambda(to));
        const auto f =
          reflectance(ReflectanceModel::Microfacet, wall, reflectionGeometry(in, out, up));
        EXPECT_NEAR(f.specular, (wall.ks + wall.kd * s) * d * mask, 1e-12);
        EXPECT_NEAR(f.diffuse, wall.kd * (1.0 - s) * std::cos(ti), 1e-15);
      }
    }
  }
}

TEST(Reflectance, OrenNayarByItsFormula)
{
  for (const double roughness : { 0.0, 0.1, 0.35, 0.7, 1.5 })
  {
    Material rough = wall;
    rough.roughness = roughness;
    const double s2 = roughness * roughness;
    const double even = 1.0 - 0.5 * s2 / (s2 + 0.33);
    const double facets = 0.45 * s2 / (s2 + 0.09);
    for (const double ti : { 0.0, 0.1, 0.5, 1.2, 1.55 })
    {
      for (const double to : { 0.0, 0.3, 1.1, 1.55 })
      {
        for (const double azimuth : { 0.0, 0.2, 2.0, Pi })
        {
          const auto f = reflectance(ReflectanceModel::OrenNayar, rough,
            reflectionGeometry(incidentAt(ti), outgoingAt(to, azimuth), up));
          // The mirror direction has the azimuth 0: around the normal the two lie pi - azimuth
          // apart.
          const double expected = wall.kd * std::cos(ti) *
            (even +
              facets * std::max(0.0, std::cos(Pi - azimuth)) * std::sin(std::max(ti, to)) *
                std::tan(std::min(ti, to)));
          EXPECT_NEAR(f.diffuse, expected, 1e-13) << ti << ' ' << to << ' ' << azimuth;
          EXPECT_EQ(f.specular,
            reflectance(
              paper, rough, reflectionGeometry(incidentAt(ti), outgoingAt(to, azimuth), up))
              .specular);
        }
      }
    }
    // Grazing, straight back: kd B is left.
    EXPECT_NEAR(reflectance(ReflectanceModel::OrenNayar, rough, monostaticGeometry(1e-9)).diffuse,
      wall.kd * facets, 1e-9);
  }
}

TEST(Reflectance, NoIncidenceIsBrighterThanWhatIsSaid)
{
  geometrytest::Numbers random(7);
  for (int n = 0; n < 20000; ++n)
  {
    const Material material{ 0.4, 0.3, random.logUniform(1.0, 1e6), random(0.0, 0.5 * Pi) };
    const double mostCosine = random();
    const double cosine = mostCosine * random();
    for (const ReflectanceModel model : models)
    {
      const Reflectance most = mostStraightBack(model, material, mostCosine);
      const Reflectance f = reflectance(model, material, monostaticGeometry(cosine));
      ASSERT_LE(f.diffuse, most.diffuse * (1.0 + 1e-12));
      ASSERT_LE(f.specular, most.specular * (1.0 + 1e-12));
    }
  }
}

TEST(ReflectanceAperture, FactorsAndCap)
{
  const Reflectance f{ 0.1, 0.5 };
  const auto paperRadiometry = throughAperture(f, wall, 0.0, 100.0);
  EXPECT_EQ(paperRadiometry.diffuse, 0.1);
  EXPECT_EQ(paperRadiometry.specular, 0.5);
  EXPECT_NEAR(
    throughAperture({ 1.0, 0.0 }, { 1.0, 0.0, 0.0 }, 0.01, 100.0).diffuse, 3.183098862e-7, 1e-16);
  const auto far = throughAperture(f, wall, 0.01, 100.0);
  EXPECT_NEAR(far.diffuse, 0.1 * 3.183098862e-7, 1e-17);
  EXPECT_NEAR(far.specular, 0.5 * 3.183098862e-7 * 113.0 / 2.0, 1e-14);
  const auto near = throughAperture(f, wall, 0.01, 1e-3);
  EXPECT_NEAR(near.total(), 1.0, 1e-15);
  EXPECT_NEAR(near.diffuse / near.specular, far.diffuse / far.specular, 1e-15);
  EXPECT_EQ(throughAperture(f, wall, 0.01, 0.0).total(), 1.0);
  EXPECT_EQ(throughAperture({ 0.0, 0.0 }, wall, 0.01, 0.0).total(), 0.0);
}

TEST(ReflectanceMaterial, BadValuesAreNamed)
{
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  const struct
  {
    Material material;
    const char* name;
  } bad[] = { { { -0.1, 0.1, 1.0 }, "kd is -0.1" }, { { nan, 0.1, 1.0 }, "kd is nan" },
    { { 0.1, -0.1, 1.0 }, "ks is -0.1" }, { { 0.1, infinity, 1.0 }, "ks is inf" },
    { { 0.6, 0.5, 1.0 }, "kd + ks is 1.1" }, { { 0.1, 0.1, -1.0 }, "kp is -1" },
    { { 0.1, 0.1, 1.1e6 }, "kp is 1100000" }, { { 0.1, 0.1, nan }, "kp is nan" } };
  for (const auto& item : bad)
  {
    statistics::expectSays(checkMaterial(item.material), item.name);
  }
  for (const Material& good :
    { wall, glass, metal, Material{ 0.0, 0.0, 0.0 }, Material{ 0.7, 0.3, 1e6 } })
  {
    EXPECT_EQ(checkMaterial(good), "");
  }
}
