// SPDX-License-Identifier: BSD-3-Clause
// Birds and plates, and the oracle of their effective areas: an image of the nearest surfaces.
#ifndef BirdTestScene_h
#define BirdTestScene_h

#include "BirdTables.h"
#include "Silhouette.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace birdtest
{
using namespace avianlidar;

const BirdShape HerringGull({ "gull", 0.95, 0.60, 1.35, 0.20, false, 12.5 });

inline std::vector<BirdSpecies> shippedSpecies()
{
  const std::string file = AVIANLIDAR_SOURCE_DIR "/Filters/Birds/species.csv";
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return readSpecies(text.str(), file);
}

/// A plate about the origin, along x and z, that recedes along y by `slope` times x.
inline TriangleMesh plateOfSlope(double width, double height, double slope)
{
  const double w = 0.5 * width;
  const double h = 0.5 * height;
  TriangleMesh mesh;
  mesh.points = { { -w, -w * slope, -h }, { w, w * slope, -h }, { w, w * slope, h },
    { -w, -w * slope, h } };
  mesh.triangles = { { 0, 1, 2 }, { 0, 2, 3 } };
  return mesh;
}

/// The nearest surface at a place across the view.
struct Pixel
{
  double x = 0.0, y = 0.0;                                ///< to the right and up, m
  double depth = std::numeric_limits<double>::infinity(); ///< along the view, m
  double cosine = 0.0;                                    ///< cosine of the angle of incidence
};

/// Square pixels of a closed mesh that is seen along a unit direction. @param size of a pixel, m
inline std::vector<Pixel> imageOf(const TriangleMesh& mesh, const Vec3& view, double size)
{
  const Vec3 right =
    unitVector(glm::cross(view, std::fabs(view.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
  const Vec3 up = glm::cross(right, view);
  std::map<std::pair<int, int>, Pixel> image;
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    double x[3], y[3], z[3];
    for (int c = 0; c < 3; ++c)
    {
      x[c] = glm::dot(mesh.corner(t, c), right) / size;
      y[c] = glm::dot(mesh.corner(t, c), up) / size;
      z[c] = glm::dot(mesh.corner(t, c), view);
    }
    const double twice = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    const Vec3 normal =
      glm::cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    if (!(twice > 0.0))
    {
      continue; // seen from behind
    }
    const double cosine = -glm::dot(normal, view) / glm::length(normal);
    for (int i = static_cast<int>(std::floor(*std::min_element(x, x + 3)));
         i <= *std::max_element(x, x + 3); ++i)
    {
      for (int k = static_cast<int>(std::floor(*std::min_element(y, y + 3)));
           k <= *std::max_element(y, y + 3); ++k)
      {
        const double px = i + 0.5;
        const double py = k + 0.5;
        double w[3];
        for (int c = 0; c < 3; ++c)
        {
          const int d = (c + 1) % 3;
          const int e = (c + 2) % 3;
          w[c] = ((x[d] - px) * (y[e] - py) - (x[e] - px) * (y[d] - py)) / twice;
        }
        if (w[0] < 0.0 || w[1] < 0.0 || w[2] < 0.0)
        {
          continue;
        }
        Pixel& nearest = image[{ i, k }];
        const double depth = w[0] * z[0] + w[1] * z[1] + w[2] * z[2];
        if (depth < nearest.depth)
        {
          nearest = { px * size, py * size, depth, cosine };
        }
      }
    }
  }
  std::vector<Pixel> pixels;
  for (const auto& entry : image)
  {
    pixels.push_back(entry.second);
  }
  return pixels;
}
}

#endif
