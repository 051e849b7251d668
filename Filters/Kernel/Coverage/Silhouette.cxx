// SPDX-License-Identifier: BSD-3-Clause
#include "Silhouette.h"

#include "BeamFrame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace avianlidar
{
namespace
{
/// Pixels along the longer side of the finest image, and samples along a pixel.
constexpr int LongerSide = 96;
constexpr int SamplesOfPixel = 3;
/// Number of images, each half as fine as the image before.
constexpr int MostImages = 5;
/// Least radius of a beam in the image that it uses, in pixels.
constexpr double RadiusInPixels = 3.5;
/// Least radius of a beam in the finest image, in pixels.
constexpr double LeastRadiusInPixels = 1.0;
/// Samples along the longer side for an effective area.
constexpr int SamplesOfArea = 512;

struct Sample
{
  float depth = std::numeric_limits<float>::infinity();
  float cosine = 0.0F;
};

/// Depth buffer: samples of the nearest surface on a rectangle.
struct Canvas
{
  double left, below, step; ///< left and lower border, and distance between samples, m
  int columns, rows;
  std::vector<Sample> samples;

  /// Draws a triangle. @param p right, up and depth of its corners, m @param cosine of incidence
  void draw(const std::array<Vec3, 3>& p, double cosine)
  {
    // Depth is linear over the triangle.
    const double x1 = p[1].x - p[0].x, y1 = p[1].y - p[0].y;
    const double x2 = p[2].x - p[0].x, y2 = p[2].y - p[0].y;
    const double twice = x1 * y2 - x2 * y1;
    if (!(std::fabs(twice) > 0.0))
    {
      return;
    }
    const double z1 = p[1].z - p[0].z, z2 = p[2].z - p[0].z;
    const double zx = (z1 * y2 - z2 * y1) / twice;
    const double zy = (x1 * z2 - x2 * z1) / twice;
    const auto [low, high] = std::minmax({ p[0].y, p[1].y, p[2].y });
    const int first = std::max(0, static_cast<int>(std::ceil((low - this->below) / this->step)));
    const int last =
      std::min(this->rows - 1, static_cast<int>(std::floor((high - this->below) / this->step)));
    for (int row = first; row <= last; ++row)
    {
      const double y = this->below + row * this->step;
      double from = std::numeric_limits<double>::infinity();
      double to = -from;
      for (int i = 0; i < 3; ++i)
      {
        const Vec3& a = p[i];
        const Vec3& b = p[(i + 1) % 3];
        if (std::min(a.y, b.y) <= y && y <= std::max(a.y, b.y))
        {
          const double x = a.y == b.y ? b.x : a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
          from = std::min({ from, x, a.y == b.y ? a.x : x });
          to = std::max({ to, x, a.y == b.y ? a.x : x });
        }
      }
      const int begin = std::max(0, static_cast<int>(std::ceil((from - this->left) / this->step)));
      const int end =
        std::min(this->columns - 1, static_cast<int>(std::floor((to - this->left) / this->step)));
      for (int column = begin; column <= end; ++column)
      {
        const double x = this->left + column * this->step;
        const auto depth = static_cast<float>(p[0].z + zx * (x - p[0].x) + zy * (y - p[0].y));
        Sample& sample = this->samples[static_cast<std::size_t>(row) * this->columns + column];
        if (depth < sample.depth)
        {
          sample = { depth, static_cast<float>(cosine) };
        }
      }
    }
  }
};

/// Points of a mesh in the coordinates right, up and depth, and their bounds.
struct Projected
{
  Projected(const TriangleMesh& mesh, const Vec3& right, const Vec3& view)
  {
    const Vec3 up = glm::cross(right, view);
    this->Points.reserve(mesh.points.size());
    for (const Vec3& p : mesh.points)
    {
      this->Points.emplace_back(glm::dot(p, right), glm::dot(p, up), glm::dot(p, view));
      this->Low = glm::min(this->Low, this->Points.back());
      this->High = glm::max(this->High, this->Points.back());
    }
  }

  double longerSide() const
  {
    return std::max(this->High.x - this->Low.x, this->High.y - this->Low.y);
  }

  std::vector<Vec3> Points;
  Vec3 Low = Vec3(std::numeric_limits<double>::infinity());
  Vec3 High = -Low;
};

/// Draws a mesh. @param points its points by right, up and depth, m
void drawMesh(const TriangleMesh& mesh, const std::vector<Vec3>& points, Canvas& canvas)
{
  for (const auto& t : mesh.triangles)
  {
    const std::array<Vec3, 3> p = { points[t[0]], points[t[1]], points[t[2]] };
    const Vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double length = safeLength(normal);
    if (length > 0.0)
    {
      canvas.draw(p, std::fabs(normal.z) / length);
    }
  }
}

LitPart partOf(double area, double depth, double square)
{
  const double mean = depth / area;
  return { area, mean, std::sqrt(std::max(0.0, square / area - mean * mean)) };
}

/// exp(-2u) for u from 0 to 2, with a relative error below 1e-3.
float gaussian(float u)
{
  const float x = 0.125F * u; // exp(-2u) is exp(-x) to the 16th
  float e = 1.0F - x * (1.0F - x * (0.5F - x * (1.0F / 6.0F)));
  for (int k = 0; k < 4; ++k)
  {
    e *= e;
  }
  return e;
}
}

Silhouette::Silhouette()
  : Silhouette(1.0)
{
}

Silhouette::Silhouette(double area)
  : All{ area, 0.0, 0.0 }
{
}

Silhouette::Silhouette(const TriangleMesh& mesh, const Vec3& view, double unit)
{
  const Projected shown(mesh, unitVector(glm::cross(view, Vec3(0.0, 0.0, 1.0))), view);
  const Vec3& low = shown.Low;
  const Vec3& high = shown.High;
  for (const Vec3& p : shown.Points)
  {
    this->Reach = std::max(this->Reach, std::hypot(p.x, p.y));
  }
  Image fine;
  fine.pixel = shown.longerSide() / LongerSide;
  if (!(fine.pixel > 0.0) || !std::isfinite(fine.pixel))
  {
    const bool isEmpty = shown.Points.empty() || std::isfinite(fine.pixel);
    this->All.area = isEmpty ? 0.0 : std::numeric_limits<double>::quiet_NaN();
    return;
  }
  // Each side is a whole number of pixels of the coarsest image.
  constexpr int whole = 1 << (MostImages - 1);
  const auto pixelsOf = [&](double length) {
    return whole * std::max(1, static_cast<int>(std::ceil(length / (whole * fine.pixel) - 1e-9)));
  };
  fine.columns = pixelsOf(high.x - low.x);
  fine.rows = pixelsOf(high.y - low.y);
  fine.left = 0.5 * (low.x + high.x - (fine.columns - 1) * fine.pixel);
  fine.below = 0.5 * (low.y + high.y - (fine.rows - 1) * fine.pixel);
  Canvas canvas{ 0.0, 0.0, fine.pixel / SamplesOfPixel, SamplesOfPixel * fine.columns,
    SamplesOfPixel * fine.rows, {} };
  canvas.left = fine.left - 0.5 * fine.pixel + 0.5 * canvas.step;
  canvas.below = fine.below - 0.5 * fine.pixel + 0.5 * canvas.step;
  canvas.samples.resize(static_cast<std::size_t>(canvas.columns) * canvas.rows);
  drawMesh(mesh, shown.Points, canvas);
  fine.pixels.resize(static_cast<std::size_t>(fine.columns) * fine.rows);
  const double each = canvas.step * canvas.step / unit;
  double area = 0.0, depth = 0.0, square = 0.0;
  for (int row = 0; row < canvas.rows; ++row)
  {
    for (int column = 0; column < canvas.columns; ++column)
    {
      const Sample& s = canvas.samples[static_cast<std::size_t>(row) * canvas.columns + column];
      if (s.cosine > 0.0F)
      {
        Sums& pixel = fine.pixels[static_cast<std::size_t>(row / SamplesOfPixel) * fine.columns +
          column / SamplesOfPixel];
        const double part = each * s.cosine;
        pixel.area += static_cast<float>(part);
        pixel.depth += static_cast<float>(part * s.depth);
        pixel.square += static_cast<float>(part * s.depth * s.depth);
        area += part;
        depth += part * s.depth;
        square += part * s.depth * s.depth;
      }
    }
  }
  this->All = area > 0.0 ? partOf(area, depth, square) : LitPart();
  this->Images.push_back(std::move(fine));
  while (this->Images.size() < MostImages)
  {
    this->Images.push_back(halved(this->Images.back()));
  }
}

Silhouette::Image Silhouette::halved(const Image& fine)
{
  Image coarse{ 2.0 * fine.pixel, fine.left + 0.5 * fine.pixel, fine.below + 0.5 * fine.pixel,
    fine.columns / 2, fine.rows / 2, {} };
  coarse.pixels.resize(static_cast<std::size_t>(coarse.columns) * coarse.rows);
  for (int row = 0; row < 2 * coarse.rows; ++row)
  {
    for (int column = 0; column < 2 * coarse.columns; ++column)
    {
      const Sums& from = fine.pixels[static_cast<std::size_t>(row) * fine.columns + column];
      Sums& to = coarse.pixels[static_cast<std::size_t>(row / 2) * coarse.columns + column / 2];
      to.area += from.area;
      to.depth += from.depth;
      to.square += from.square;
    }
  }
  return coarse;
}

/// The coarsest image that is fine enough for a beam.
const Silhouette::Image& Silhouette::imageFor(const BeamAtTarget& beam) const
{
  auto image = this->Images.rbegin();
  while (image + 1 != this->Images.rend() && RadiusInPixels * image->pixel > beam.across)
  {
    ++image;
  }
  return *image;
}

/// Finds the pixels [begin, end) of a row or column within a reach of a place.
void Silhouette::rangeOf(
  double place, double reach, double first, double pixel, int count, int& begin, int& end)
{
  const auto indexOf = [&](double at)
  { return static_cast<int>(std::clamp<double>((at - first) / pixel, -1.0, count)); };
  begin = std::max(0, indexOf(place - reach));
  end = std::min(count, indexOf(place + reach) + 1);
}

/// litBy() for beams that are not usual (BeamAtTarget::isUsual()).
LitPart Silhouette::litByOther(const BeamAtTarget& beam) const
{
  const Image& image = this->imageFor(beam);
  BeamAtTarget wide = beam;
  wide.radius = std::max(beam.radius, LeastRadiusInPixels * image.pixel);
  wide.across = std::max(beam.across, LeastRadiusInPixels * image.pixel);
  const auto reachOf = [&](double along, double beside)
  {
    const double a = std::fabs(along * wide.radius);
    const double b = std::fabs(beside * wide.across);
    return image.pixel + (beam.isRectangle ? a + b : std::hypot(a, b));
  };
  int left, right, below, above;
  rangeOf(
    beam.x, reachOf(beam.cosine, beam.sine), image.left, image.pixel, image.columns, left, right);
  rangeOf(
    beam.y, reachOf(beam.sine, beam.cosine), image.below, image.pixel, image.rows, below, above);
  // The share of a pixel falls linearly, from half a pixel inside the border to half outside.
  const auto within = [&](double length, double square)
  { return std::clamp(0.5 + length / image.pixel * (1.0 - std::sqrt(square)), 0.0, 1.0); };
  const auto shareOf = [&](const Squares& at)
  {
    if (beam.isRectangle)
    {
      return within(wide.radius, at.along) * within(wide.across, at.beside);
    }
    const double slope = 2.0 *
      std::sqrt(at.along / (wide.radius * wide.radius) + at.beside / (wide.across * wide.across));
    return slope > 0.0 ? std::clamp(0.5 + (1.0 - at.sum()) / (slope * image.pixel), 0.0, 1.0) : 1.0;
  };
  double area = 0.0, depth = 0.0, square = 0.0;
  for (int row = below; row < above; ++row)
  {
    for (int column = left; column < right; ++column)
    {
      const Squares at = wide.squaresOf(
        image.left + column * image.pixel - beam.x, image.below + row * image.pixel - beam.y);
      const double share = shareOf(at) * wide.irradiance(at.sum());
      const Sums& pixel = image.pixels[static_cast<std::size_t>(row) * image.columns + column];
      area += share * pixel.area;
      depth += share * pixel.depth;
      square += share * pixel.square;
    }
  }
  if (!(area > 0.0))
  {
    return {};
  }
  LitPart lit = partOf(area, depth, square);
  lit.area *= beam.radius * beam.across / (wide.radius * wide.across);
  return lit;
}

std::size_t Silhouette::bytes() const
{
  return std::accumulate(this->Images.begin(), this->Images.end(), std::size_t(0),
    [](std::size_t sum, const Image& image) { return sum + image.pixels.size() * sizeof(Sums); });
}

LitPart Silhouette::litBy(const BeamAtTarget& beam) const
{
  const double away2 = beam.x * beam.x + beam.y * beam.y;
  if (this->Images.empty())
  {
    const bool isHeld = beam.isRound() ? away2 <= beam.radius * beam.radius : beam.beyond() <= 0.0;
    return isHeld ? LitPart{ this->All.area * beam.irradiance(), 0.0, 0.0 } : LitPart();
  }
  if (!beam.isUsual())
  {
    return this->litByOther(beam);
  }
  const Image* const image = &this->imageFor(beam);
  const double radius = std::max(beam.radius, LeastRadiusInPixels * image->pixel);
  // The share of a pixel is linear in its squared distance. The share is 1 half a pixel inside the
  // border and 0 half a pixel outside, so that the disc keeps its area.
  const double radius2 = radius * radius;
  const double edge = radius * image->pixel;
  const double reach = std::sqrt(radius2 + edge);
  int left, right, below, above;
  rangeOf(beam.x, reach, image->left, image->pixel, image->columns, left, right);
  rangeOf(beam.y, reach, image->below, image->pixel, image->rows, below, above);
  const bool isGaussian = beam.profile == BeamProfile::Gaussian;
  const auto perEdge = static_cast<float>(0.5 / edge);
  const auto perRadius2 = static_cast<float>(1.0 / radius2);
  const auto limit = static_cast<float>(radius2);
  Sums sum;
  for (int row = below; row < above; ++row)
  {
    const auto y = static_cast<float>(image->below + row * image->pixel - beam.y);
    // The pointer lies past the last pixel if the beam lies beside the image.
    const Sums* pixel =
      image->pixels.data() + static_cast<std::size_t>(row) * image->columns + left;
    auto x = static_cast<float>(image->left + left * image->pixel - beam.x);
    for (int column = left; column < right; ++column, ++pixel)
    {
      const float away = x * x + y * y;
      float share = std::clamp(0.5F + (limit - away) * perEdge, 0.0F, 1.0F);
      share *= isGaussian ? gaussian(away * perRadius2) : 1.0F;
      sum.area += share * pixel->area;
      sum.depth += share * pixel->depth;
      sum.square += share * pixel->square;
      x += static_cast<float>(image->pixel);
    }
  }
  if (!(sum.area > 0.0F))
  {
    return {};
  }
  LitPart lit = partOf(sum.area, sum.depth, sum.square);
  lit.area *= beam.radius * beam.radius / radius2 * beam.irradiance(0.0);
  return lit;
}

double effectiveArea(const TriangleMesh& mesh, const Vec3& view)
{
  // The image is turned about the line of sight, so that level and upright edges cross the rows.
  constexpr double turn = 0.4;
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), view, turn);
  const Projected shown(mesh, std::cos(turn) * frame.e1 + std::sin(turn) * frame.e2, view);
  const double side = shown.longerSide();
  if (!(side > 0.0) || !std::isfinite(side))
  {
    return mesh.points.empty() || std::isfinite(side) ? 0.0
                                                      : std::numeric_limits<double>::quiet_NaN();
  }
  const double step = side / SamplesOfArea;
  const auto samplesOf = [&](double length) { return 1 + static_cast<int>(length / step); };
  Canvas canvas{ shown.Low.x + 0.5 * step, shown.Low.y + 0.5 * step, step,
    samplesOf(shown.High.x - shown.Low.x), samplesOf(shown.High.y - shown.Low.y), {} };
  canvas.samples.resize(static_cast<std::size_t>(canvas.columns) * canvas.rows);
  drawMesh(mesh, shown.Points, canvas);
  double sum = 0.0;
  for (const Sample& sample : canvas.samples)
  {
    sum += sample.cosine;
  }
  return sum * step * step;
}
}
