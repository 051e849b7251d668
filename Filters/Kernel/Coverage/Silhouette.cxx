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

enum class Outline
{
  Circle,
  Ellipse,
  Rectangle
};

/// Pixels of a rectangle of an image, in a beam.
struct LitPixels
{
  const float* pixels; ///< areas; the depths and the squares follow, `plane` numbers later each
  std::size_t plane, stride;
  int columns, rows;
  float along, beside;   ///< first pixel's coordinates along the beam's sides, in half sides
  float alongX, besideX; ///< change of the coordinates to the next column
  float alongY, besideY; ///< change of the coordinates to the next row
  float pixelAlong, pixelBeside; ///< side of a pixel, in half sides
  float fall;                    ///< see BeamAtTarget
};

/// Sums over pixels by lane.
struct LitSums
{
  float area[Lanes] = {}, depth[Lanes] = {}, square[Lanes] = {};
};

template <Outline outline, bool isGaussian>
AVIANLIDAR_ALWAYS_INLINE void addPixels(const LitPixels& of, LitSums& sums)
{
  for (int row = 0; row < of.rows; ++row)
  {
    const float alongRow = of.along + static_cast<float>(row) * of.alongY;
    const float besideRow = of.beside + static_cast<float>(row) * of.besideY;
    for (int column = 0; column < of.columns; column += Lanes)
    {
      const float* const area = of.pixels + row * of.stride + column;
#pragma omp simd
      for (int lane = 0; lane < Lanes; ++lane)
      {
        const float along = alongRow + static_cast<float>(column + lane) * of.alongX;
        const float beside = besideRow + static_cast<float>(column + lane) * of.besideX;
        const float square = along * along + beside * beside;
        // The share falls linearly from 1 half a pixel inside the border to 0 half a pixel outside.
        const auto within = [](float pixels) AVIANLIDAR_INLINE_LAMBDA
        { return lanes::larger(0.0F, lanes::smaller(0.5F + pixels, 1.0F)); };
        float share;
        if constexpr (outline == Outline::Rectangle)
        {
          share = within((1.0F - std::fabs(along)) / of.pixelAlong) *
            within((1.0F - std::fabs(beside)) / of.pixelBeside);
        }
        else if constexpr (outline == Outline::Ellipse)
        {
          const float a = along * of.pixelAlong;
          const float b = beside * of.pixelBeside;
          share = within(0.5F * (1.0F - square) / std::sqrt(a * a + b * b));
        }
        else
        {
          share = within(0.5F * (1.0F - square) / of.pixelAlong); // a disc keeps its area
        }
        share *= isGaussian ? exponential(of.fall * square) : 1.0F;
        sums.area[lane] += share * area[lane];
        sums.depth[lane] += share * area[lane + of.plane];
        sums.square[lane] += share * area[lane + 2 * of.plane];
      }
    }
  }
}

AVIANLIDAR_MULTIVERSION void addUniform(Outline outline, const LitPixels& of, LitSums& sums)
{
  outline == Outline::Circle      ? addPixels<Outline::Circle, false>(of, sums)
    : outline == Outline::Ellipse ? addPixels<Outline::Ellipse, false>(of, sums)
                                  : addPixels<Outline::Rectangle, false>(of, sums);
}

AVIANLIDAR_MULTIVERSION void addGaussian(Outline outline, const LitPixels& of, LitSums& sums)
{
  outline == Outline::Circle      ? addPixels<Outline::Circle, true>(of, sums)
    : outline == Outline::Ellipse ? addPixels<Outline::Ellipse, true>(of, sums)
                                  : addPixels<Outline::Rectangle, true>(of, sums);
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
    this->Images.push_back(halved(this->Images.back()));
  }
}

void Silhouette::Image::allocate()
{
  // Lanes may lie beyond the last column.
  this->stride = static_cast<std::size_t>(this->columns) + Lanes - 1;
  this->plane = this->stride * this->rows;
  this->pixels.resize(3 * this->plane);
}

Silhouette::Image Silhouette::halved(const Image& fine)
{
  Image coarse{ 2.0 * fine.pixel, fine.left + 0.5 * fine.pixel, fine.below + 0.5 * fine.pixel,
    fine.columns / 2, fine.rows / 2, 0, 0, {} };
  coarse.allocate();
  for (int plane = 0; plane < 3; ++plane)
  {
    for (int row = 0; row < fine.rows; ++row)
    {
      for (int column = 0; column < fine.columns; ++column)
      {
        coarse.at(plane, row / 2, column / 2) += fine.at(plane, row, column);
      }
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

std::size_t Silhouette::bytes() const
{
  return std::accumulate(this->Images.begin(), this->Images.end(), std::size_t(0),
    [](std::size_t sum, const Image& image) { return sum + image.pixels.size() * sizeof(float); });
}

LitPart Silhouette::litBy(const BeamAtTarget& beam) const
{
  const double away2 = beam.x * beam.x + beam.y * beam.y;
  if (this->Images.empty())
  {
    const bool isHeld = beam.isRound() ? away2 <= beam.radius * beam.radius : beam.beyond() <= 0.0;
    return isHeld ? LitPart{ this->All.area * beam.irradiance(), 0.0, 0.0 } : LitPart();
  }
  const Image& image = this->imageFor(beam);
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
  int left, right, below, above;
  rangeOf(beam.x, reachOf(beam.cosine, beam.sine), image.left, pixel, image.columns, left, right);
  rangeOf(beam.y, reachOf(beam.sine, beam.cosine), image.below, pixel, image.rows, below, above);
  if (left >= right || below >= above)
  {
    return {};
  }
  const double x = image.left + left * pixel - beam.x;
  const double y = image.below + below * pixel - beam.y;
  const double alongX = wide.cosine / wide.radius, alongY = wide.sine / wide.radius;
  const double besideX = -wide.sine / wide.across, besideY = wide.cosine / wide.across;
  const auto single = [](double value) { return static_cast<float>(value); };
  const LitPixels lit = { &image.pixels[below * image.stride + left], image.plane, image.stride,
    right - left, above - below, single(alongX * x + alongY * y), single(besideX * x + besideY * y),
    single(alongX * pixel), single(besideX * pixel), single(alongY * pixel),
    single(besideY * pixel), single(pixel / wide.radius), single(pixel / wide.across),
    single(beam.fall) };
  const Outline outline = beam.isRound() ? Outline::Circle
    : beam.isRectangle                   ? Outline::Rectangle
                                         : Outline::Ellipse;
  LitSums sums;
  (beam.profile == BeamProfile::Gaussian ? addGaussian : addUniform)(outline, lit, sums);
  const auto total = [](const float(&lanes)[Lanes])
  { return std::accumulate(lanes, lanes + Lanes, 0.0); };
  const double area = total(sums.area);
  if (!(area > 0.0))
  {
    return {};
  }
  LitPart part = partOf(area, total(sums.depth), total(sums.square));
  part.area *= beam.radius * beam.across / (wide.radius * wide.across) * beam.irradiance(0.0);
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
