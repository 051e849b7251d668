// SPDX-License-Identifier: BSD-3-Clause
#include "Silhouette.h"

#include "BeamFrame.h"
#include "LaneMath.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <type_traits>

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
/// Pixels that are added at once.
constexpr int Lanes = 8;
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

/// exp(-x) for x from 0 to 80, with a relative error below 1e-4.
AVIANLIDAR_ALWAYS_INLINE float exponential(float x)
{
  constexpr float rounder = 12582912.0F; // 1.5 * 2^23, see lanes::Rounder
  const float y = -1.44269504F * lanes::smaller(x, 80.0F);
  const float whole = y + rounder;
  std::uint32_t bits;
  std::memcpy(&bits, &whole, sizeof bits);
  bits = (bits + 127u) << 23;
  float power;
  std::memcpy(&power, &bits, sizeof power);
  const float u = 0.693147181F * (y - (whole - rounder));
  return power * (1.0F + u * (1.0F + u * (0.5F + u * (1.0F / 6.0F + u * (1.0F / 24.0F)))));
}

/// Rows and columns [begin, end) of an image.
struct Window
{
  int left, right, below, above;
};

/// Sums over pixels by lane.
struct LitSums
{
  float area[Lanes] = {}, depth[Lanes] = {}, square[Lanes] = {};
};

enum class Outline
{
  Circle,
  Ellipse,
  Rectangle
};

template <Outline outline, bool isGaussian>
AVIANLIDAR_ALWAYS_INLINE void addPixels(
  const Silhouette::Image& image, const BeamAtTarget& beam, const Window& window, LitSums& sums)
{
  const auto single = [](double value) { return static_cast<float>(value); };
  // Coordinates along the beam's sides, in half sides, at the first pixel and from pixel to pixel.
  const double px = image.pixel, cosine = beam.cosine, sine = beam.sine;
  const double x = image.left + window.left * px - beam.x;
  const float alongX = single(cosine * px / beam.radius),
              besideX = single(-sine * px / beam.across);
  const float pixelAlong = single(px / beam.radius), pixelBeside = single(px / beam.across);
  const float fall = single(beam.fall);
  for (int row = window.below; row < window.above; ++row)
  {
    const double y = image.below + row * px - beam.y;
    const float alongRow = single((cosine * x + sine * y) / beam.radius);
    const float besideRow = single((cosine * y - sine * x) / beam.across);
    for (int column = window.left; column < window.right; column += Lanes)
    {
      const float* const area = &image.pixels[row * image.stride + column];
#pragma omp simd
      for (int lane = 0; lane < Lanes; ++lane)
      {
        const auto step = static_cast<float>(column - window.left + lane);
        const float along = alongRow + step * alongX;
        const float beside = besideRow + step * besideX;
        const float square = along * along + beside * beside;
        // The share falls linearly from 1 half a pixel inside the border to 0 half a pixel outside.
        const auto within = [](float pixels) AVIANLIDAR_INLINE_LAMBDA
        { return lanes::larger(0.0F, lanes::smaller(0.5F + pixels, 1.0F)); };
        const float a = along * pixelAlong;
        const float b = beside * pixelBeside;
        // With the constant slope, a disc keeps its area.
        const float slope = outline == Outline::Ellipse ? std::sqrt(a * a + b * b) : pixelAlong;
        float share = outline == Outline::Rectangle
          ? within((1.0F - std::fabs(along)) / pixelAlong) *
            within((1.0F - std::fabs(beside)) / pixelBeside)
          : within(0.5F * (1.0F - square) / slope);
        share *= isGaussian ? exponential(fall * square) : 1.0F;
        sums.area[lane] += share * area[lane];
        sums.depth[lane] += share * area[lane + image.plane];
        sums.square[lane] += share * area[lane + 2 * image.plane];
      }
    }
  }
}

AVIANLIDAR_MULTIVERSION LitSums lit(
  const Silhouette::Image& image, const BeamAtTarget& beam, const Window& window)
{
  LitSums sums;
  const auto add = [&](auto outline) AVIANLIDAR_INLINE_LAMBDA
  {
    beam.profile == BeamProfile::Gaussian ? addPixels<outline(), true>(image, beam, window, sums)
                                          : addPixels<outline(), false>(image, beam, window, sums);
  };
  beam.isRound()       ? add(std::integral_constant<Outline, Outline::Circle>())
    : beam.isRectangle ? add(std::integral_constant<Outline, Outline::Rectangle>())
                       : add(std::integral_constant<Outline, Outline::Ellipse>());
  return sums;
}
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
  fine.allocate();
  const double each = canvas.step * canvas.step / unit;
  double area = 0.0, depth = 0.0, square = 0.0;
  for (int row = 0; row < canvas.rows; ++row)
  {
    for (int column = 0; column < canvas.columns; ++column)
    {
      const Sample& s = canvas.samples[static_cast<std::size_t>(row) * canvas.columns + column];
      if (s.cosine > 0.0F)
      {
        const double part = each * s.cosine;
        const double sums[] = { part, part * s.depth, part * s.depth * s.depth };
        for (int plane = 0; plane < 3; ++plane)
        {
          fine.at(plane, row / SamplesOfPixel, column / SamplesOfPixel) +=
            static_cast<float>(sums[plane]);
        }
        area += sums[0];
        depth += sums[1];
        square += sums[2];
      }
    }
  }
  this->All = area > 0.0 ? partOf(area, depth, square) : LitPart();
  this->Images.push_back(std::move(fine));
  while (this->Images.size() < MostImages)
  {
    const Image& last = this->Images.back();
    Image coarse{ 2.0 * last.pixel, last.left + 0.5 * last.pixel, last.below + 0.5 * last.pixel,
      last.columns / 2, last.rows / 2, 0, 0, {} };
    coarse.allocate();
    for (int plane = 0; plane < 3; ++plane)
    {
      for (int row = 0; row < last.rows; ++row)
      {
        for (int column = 0; column < last.columns; ++column)
        {
          coarse.at(plane, row / 2, column / 2) += last.at(plane, row, column);
        }
      }
    }
    this->Images.push_back(std::move(coarse));
  }
}

void Silhouette::Image::allocate()
{
  // Lanes may lie beyond the last column.
  this->stride = static_cast<std::size_t>(this->columns) + Lanes - 1;
  this->plane = this->stride * this->rows;
  this->pixels.resize(3 * this->plane);
}

std::size_t Silhouette::bytes() const
{
  return std::accumulate(this->Images.begin(), this->Images.end(), std::size_t(0),
    [](std::size_t sum, const Image& image) { return sum + image.pixels.size() * sizeof(float); });
}

LitPart Silhouette::litBy(const BeamAtTarget& beam) const
{
  if (this->Images.empty())
  {
    return beam.beyond() <= 0.0 ? LitPart{ this->All.area * beam.irradiance(), 0.0, 0.0 }
                                : LitPart();
  }
  // The coarsest image that is fine enough
  const Image& image = *std::find_if(this->Images.rbegin(), this->Images.rend() - 1,
    [&](const Image& coarse) { return RadiusInPixels * coarse.pixel <= beam.across; });
  const double pixel = image.pixel;
  BeamAtTarget wide = beam;
  wide.radius = std::max(beam.radius, LeastRadiusInPixels * pixel);
  wide.across = std::max(beam.across, LeastRadiusInPixels * pixel);
  const auto reachOf = [&](double along, double beside)
  {
    const double a = std::fabs(along * wide.radius);
    const double b = std::fabs(beside * wide.across);
    return beam.isRound() ? wide.radius + 0.5 * pixel
                          : pixel + (beam.isRectangle ? a + b : std::hypot(a, b));
  };
  const auto rangeOf = [&](double from, double to, double first, int count, int& begin, int& end)
  {
    begin = static_cast<int>(std::clamp<double>((from - first) / pixel, 0.0, count));
    end = static_cast<int>(std::clamp<double>((to - first) / pixel + 1.0, 0.0, count));
  };
  const double wideX = reachOf(beam.cosine, beam.sine);
  const double wideY = reachOf(beam.sine, beam.cosine);
  Window window;
  rangeOf(beam.x - wideX, beam.x + wideX, image.left, image.columns, window.left, window.right);
  rangeOf(beam.y - wideY, beam.y + wideY, image.below, image.rows, window.below, window.above);
  const LitSums sums = lit(image, wide, window);
  const auto total = [](const float(&lanes)[Lanes])
  { return std::accumulate(lanes, lanes + Lanes, 0.0); };
  const double area = total(sums.area);
  if (!(area > 0.0))
  {
    return {};
  }
  LitPart part = partOf(area, total(sums.depth), total(sums.square));
  part.area *= beam.radius * beam.across / (wide.radius * wide.across);
  part.area *= beam.profile == BeamProfile::Gaussian ? beam.most : 1.0;
  return part;
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
