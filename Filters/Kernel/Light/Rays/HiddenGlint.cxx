// SPDX-License-Identifier: BSD-3-Clause
#include "HiddenGlint.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

namespace avianlidar
{
namespace
{
/// Number of rays in a lobe from which on the sample shows it as it is.
constexpr double EnoughRays = 8.0;

/// Distance from the nearest ray that few directions of the cone exceed, as a multiple of
/// t/sqrt(N).
constexpr double WidestGap = 2.0;

/// Triangles lie on one plane if their normals and heights agree to so much, relative.
constexpr double SamePlane = 1e-6;

/// Planes of one height that are compared with a triangle: more would take quadratic time on a
/// sphere about the lidar, where no triangle shows anything of another.
constexpr std::size_t MostCompared = 16;

/// Part of a triangle's lobe that the rays show, and the most that may be there.
struct Lobe
{
  std::uint32_t triangle;
  double height; ///< m, distance of its plane from the apex
  Material material;
  double seen;
  double most;
  Vec3 normal{ 0.0 }; ///< unit, either way
  void add(const Lobe& other)
  {
    this->seen = std::max(this->seen, other.seen);
    this->most = std::max(this->most, other.most);
  }
};

/// Keep one of each triangle.
void uniteTriangles(std::vector<Lobe>& lobes)
{
  std::sort(lobes.begin(), lobes.end(),
    [](const Lobe& a, const Lobe& b) { return a.triangle < b.triangle; });
  std::size_t count = 0;
  for (const Lobe& lobe : lobes)
  {
    if (count > 0 && lobes[count - 1].triangle == lobe.triangle)
    {
      lobes[count - 1].add(lobe);
    }
    else
    {
      lobes[count++] = lobe;
    }
  }
  lobes.erase(lobes.begin() + static_cast<std::ptrdiff_t>(count), lobes.end());
}

bool shareALobe(const Lobe& a, const Lobe& b)
{
  const Vec3 across = glm::cross(a.normal, b.normal);
  return hasSameSpecular(a.material, b.material) &&
    glm::dot(across, across) <= SamePlane * SamePlane;
}

/// Keep one of each plane.
void unitePlanes(const TriangleMesh& mesh, std::vector<Lobe>& lobes)
{
  if (lobes.size() < 2)
  {
    return;
  }
  for (Lobe& lobe : lobes)
  {
    const Vec3& corner = mesh.corner(lobe.triangle, 0);
    lobe.normal = unitVector(
      glm::cross(mesh.corner(lobe.triangle, 1) - corner, mesh.corner(lobe.triangle, 2) - corner));
  }
  std::sort(lobes.begin(), lobes.end(),
    [](const Lobe& a, const Lobe& b)
    { return std::tie(a.height, a.triangle) < std::tie(b.height, b.triangle); });
  std::size_t count = 0;
  for (const Lobe& lobe : lobes)
  {
    std::size_t k = count;
    bool found = false;
    while (!found && k > 0 && count - k < MostCompared &&
      lobe.height - lobes[k - 1].height <= SamePlane * lobe.height)
    {
      found = shareALobe(lobes[--k], lobe);
    }
    if (found)
    {
      lobes[k].add(lobe);
    }
    else
    {
      lobes[count++] = lobe;
    }
  }
  lobes.erase(lobes.begin() + static_cast<std::ptrdiff_t>(count), lobes.end());
}
}

double hiddenGlintOf(const ScanSetup& setup, const BeamSamples& samples)
{
  const double rays = static_cast<double>(samples.rays);
  const double t = setup.sensor.halfBeamwidth;
  // Rays in the lobe: half of this over k.
  const double scale = rays / (t * t);
  const double narrow = 0.5 * scale / EnoughRays;
  std::vector<Lobe> lobes;
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      const Material& material = setup.materials[triangle];
      if (lobeExponent(material) <= narrow)
      {
        return;
      }
      const double root = std::sqrt(0.25 * scale / lobeExponent(material));
      for (std::uint32_t i = begin; i < end; ++i)
      {
        const double angle = std::acos(std::min(1.0, samples.cosine[i]));
        const auto returned = [&](double incidence)
        {
          Reflectance f;
          f.specular = specularReflectance(
            setup.settings.reflectanceModel, material, monostaticGeometry(std::cos(incidence)));
          return root *
            throughAperture(f, material, setup.sensor.receiverAperture, samples.range[i]).specular;
        };
        const double most = returned(std::max(0.0, angle - WidestGap * t / std::sqrt(rays)));
        if (most > 0.0)
        {
          lobes.push_back(
            { triangle, samples.range[i] * samples.cosine[i], material, returned(angle), most });
        }
      }
    });
  uniteTriangles(lobes);
  unitePlanes(*setup.tree->mesh, lobes);
  double hidden = 0.0;
  for (const Lobe& lobe : lobes)
  {
    hidden = std::max(hidden, lobe.most - lobe.seen);
  }
  return hidden;
}
}
