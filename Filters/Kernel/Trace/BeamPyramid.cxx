// SPDX-License-Identifier: BSD-3-Clause
#include "BeamPyramid.h"

#include "LaneMath.h"
#include "Multiversion.h"
#include "TriangleTest.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
/// Least cosine between a beam of a pyramid and the middle of its group.
constexpr double LeastCosine = 0.5;

/// Largest sine of the half-angle of a cone in a pyramid.
constexpr float WidestSine = 0.99f;

/// True if a box lies beside the directions of these slopes: at depths [near, far] along the
/// dominant axis they reach from low to high along the two others.
AVIANLIDAR_ALWAYS_INLINE bool besideSlopes(float lowU, float highU, float lowV, float highV,
  float near, float far, float cu, float hu, float cv, float hv)
{
  const float mostU = highU * (highU > 0.0f ? far : near);
  const float leastU = lowU * (lowU > 0.0f ? near : far);
  const float mostV = highV * (highV > 0.0f ? far : near);
  const float leastV = lowV * (lowV > 0.0f ? near : far);
  return (cu - hu > mostU) | (cu + hu < leastU) | (cv - hv > mostV) | (cv + hv < leastV);
}

/// True if a box lies outside a side of the pyramid.
AVIANLIDAR_ALWAYS_INLINE bool beyondSide(
  const Pyramid& p, int side, float x, float y, float z, float hx, float hy, float hz, float error)
{
  const float nx = p.normalX[side];
  const float ny = p.normalY[side];
  const float nz = p.normalZ[side];
  return nx * x + ny * y + nz * z >
    std::fabs(nx) * hx + std::fabs(ny) * hy + std::fabs(nz) * hz + error;
}

AVIANLIDAR_MULTIVERSION void meetSides(
  const Pyramid& pyramid, const WideNode& node, NearBoxes& boxes)
{
  const Pyramid p = pyramid;
#pragma omp simd
  for (int i = 0; i < WideNode::Width; ++i)
  {
    const float x = node.x[i] - p.apexX;
    const float y = node.y[i] - p.apexY;
    const float z = node.z[i] - p.apexZ;
    const float hx = node.halfX[i] + p.widening;
    const float hy = node.halfY[i] + p.widening;
    const float hz = node.halfZ[i] + p.widening;
    const float error = WideRounding * (std::fabs(x) + std::fabs(y) + std::fabs(z) + hx + hy + hz);
    const float along = x * p.axisX + y * p.axisY + z * p.axisZ;
    const float depth = std::fabs(p.axisX) * hx + std::fabs(p.axisY) * hy + std::fabs(p.axisZ) * hz;
    const bool behind = along + depth + error < 0.0f;
    bool beside = beyondSide(p, 0, x, y, z, hx, hy, hz, error);
    beside |= beyondSide(p, 1, x, y, z, hx, hy, hz, error);
    beside |= beyondSide(p, 2, x, y, z, hx, hy, hz, error);
    beside |= beyondSide(p, 3, x, y, z, hx, hy, hz, error);
    const float ex = lanes::larger(std::fabs(x) - hx, 0.0f);
    const float ey = lanes::larger(std::fabs(y) - hy, 0.0f);
    const float ez = lanes::larger(std::fabs(z) - hz, 0.0f);
    const float distance = lanes::larger(std::sqrt(ex * ex + ey * ey + ez * ez) - error, 0.0f);
    boxes.center[0][i] = x;
    boxes.center[1][i] = y;
    boxes.center[2][i] = z;
    boxes.half[0][i] = hx;
    boxes.half[1][i] = hy;
    boxes.half[2][i] = hz;
    boxes.error[i] = error;
    boxes.nearest[i] = (behind | beside) ? FloatInfinity : distance;
    boxes.size[i] = std::sqrt(hx * hx + hy * hy + hz * hz) / distance;
  }
}

/// Tests the boxes that the sides let through against the pyramid's slopes.
AVIANLIDAR_MULTIVERSION void meetSlopes(const Pyramid& pyramid, NearBoxes& boxes)
{
  const Pyramid p = pyramid;
  const float* const kc = boxes.center[p.axes[0]];
  const float* const kh = boxes.half[p.axes[0]];
  const float* const uc = boxes.center[p.axes[1]];
  const float* const uh = boxes.half[p.axes[1]];
  const float* const vc = boxes.center[p.axes[2]];
  const float* const vh = boxes.half[p.axes[2]];
#pragma omp simd
  for (int i = 0; i < WideNode::Width; ++i)
  {
    const float e = boxes.error[i];
    const float far = p.sign * kc[i] + kh[i] + e;
    const float near = lanes::larger(p.sign * kc[i] - kh[i] - e, 0.0f);
    const bool beside = besideSlopes(p.slopes.lowU, p.slopes.highU, p.slopes.lowV, p.slopes.highV,
      near, far, uc[i], uh[i] + e, vc[i], vh[i] + e);
    boxes.nearest[i] = (beside | (far < 0.0f)) ? FloatInfinity : boxes.nearest[i];
  }
}
}

/// False if the cones do not all lie along one coordinate axis.
bool Pyramid::setSlopes(const Vec3& middle, ConeLanes& cones)
{
  const Vec3 size = glm::abs(middle);
  const int k = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  this->axes[0] = k;
  this->axes[1] = (k + 1) % 3;
  this->axes[2] = (k + 2) % 3;
  this->sign = middle[k] < 0.0 ? -1.0f : 1.0f;
  this->slopes = { FloatInfinity, -FloatInfinity, FloatInfinity, -FloatInfinity };
  const float* const lanes[3] = { cones.x, cones.y, cones.z };
  for (int i = 0; i < ConeLanes::Width; ++i)
  {
    const float depth = this->sign * lanes[k][i];
    if (!(depth > 0.25f))
    {
      return false;
    }
    const float u = lanes[this->axes[1]][i] / depth;
    const float v = lanes[this->axes[2]][i] / depth;
    // On the plane at depth 1 the cone's trace reaches no farther than tan(a + b) - tan(a) from its
    // axis, a between axis and normal, b the half-angle.
    const float a = std::sqrt(u * u + v * v);
    const float b = cones.sine[i] / cones.cosine[i];
    if (!(a * b < 0.5f))
    {
      return false;
    }
    const float reach = (1.0f + 1e-5f) * b * (1.0f + a * a) / (1.0f - a * b) + 1e-6f;
    cones.lowU[i] = u - reach;
    cones.highU[i] = u + reach;
    cones.lowV[i] = v - reach;
    cones.highV[i] = v + reach;
    this->slopes.lowU = std::min(this->slopes.lowU, cones.lowU[i]);
    this->slopes.highU = std::max(this->slopes.highU, cones.highU[i]);
    this->slopes.lowV = std::min(this->slopes.lowV, cones.lowV[i]);
    this->slopes.highV = std::max(this->slopes.highV, cones.highV[i]);
  }
  return true;
}

bool Pyramid::set(const WideTree& tree, const Vec3& apex, ConeLanes& cones)
{
  const auto axisOf = [&cones](int i) { return Vec3(cones.x[i], cones.y[i], cones.z[i]); };
  Vec3 middle(0.0);
  for (int i = 0; i < cones.count; ++i)
  {
    if (!(cones.sine[i] < WidestSine))
    {
      return false;
    }
    middle += axisOf(i);
  }
  const double length = std::sqrt(glm::dot(middle, middle));
  if (!(length > 0.1))
  {
    return false;
  }
  const Vec3 axis = middle / length;
  // Sides along the horizon, as scans have them.
  const Vec3 level =
    std::fabs(axis.z) < 0.99 ? Vec3(axis.y, -axis.x, 0.0) : Vec3(0.0, -axis.z, axis.y);
  const Vec3 right = level / std::sqrt(glm::dot(level, level));
  const Vec3 up = glm::cross(right, axis);
  double low[2] = { 1e9, 1e9 };
  double high[2] = { -1e9, -1e9 };
  this->widest = 0.0;
  for (int i = 0; i < cones.count; ++i)
  {
    const Vec3 d = axisOf(i);
    const double along = glm::dot(d, axis);
    const double u = glm::dot(d, right) / along;
    const double v = glm::dot(d, up) / along;
    // The cone's trace on the plane at distance 1 reaches no farther than tan(a + b) - tan(a) from
    // its axis, a between the axes and b the half-angle.
    const double a = std::sqrt(u * u + v * v);
    const double b = static_cast<double>(cones.sine[i]) / cones.cosine[i];
    if (!(along > LeastCosine && a * b < 0.5))
    {
      return false;
    }
    const double reach = (1.0 + 1e-6) * b * (1.0 + a * a) / (1.0 - a * b);
    low[0] = std::min(low[0], u - reach);
    high[0] = std::max(high[0], u + reach);
    low[1] = std::min(low[1], v - reach);
    high[1] = std::max(high[1], v + reach);
    this->widest = std::max(this->widest, b);
  }
  const Vec3 sides[4] = { right - high[0] * axis, low[0] * axis - right, up - high[1] * axis,
    low[1] * axis - up };
  for (int side = 0; side < 4; ++side)
  {
    const Vec3 normal = sides[side] / std::sqrt(glm::dot(sides[side], sides[side]));
    this->normalX[side] = static_cast<float>(normal.x);
    this->normalY[side] = static_cast<float>(normal.y);
    this->normalZ[side] = static_cast<float>(normal.z);
  }
  this->axisX = static_cast<float>(axis.x);
  this->axisY = static_cast<float>(axis.y);
  this->axisZ = static_cast<float>(axis.z);
  const Vec3 offset = apex - tree.reference;
  this->apexX = static_cast<float>(offset.x);
  this->apexY = static_cast<float>(offset.y);
  this->apexZ = static_cast<float>(offset.z);
  return wideningFor(tree, offset, this->widening) && this->setSlopes(axis, cones);
}

void ConeLanes::add(const BeamFrame* frames, const std::uint32_t* beams, std::size_t number)
{
  Vec3 axis = frames[beams[0]].axis;
  double apart = 0.0;
  if (number > 1)
  {
    for (std::size_t k = 1; k < number; ++k)
    {
      axis += frames[beams[k]].axis;
    }
    const double length = std::sqrt(glm::dot(axis, axis));
    axis = length > 0.0 ? axis / length : frames[beams[0]].axis;
    for (std::size_t k = 0; k < number; ++k)
    {
      const Vec3 off = frames[beams[k]].axis - axis;
      apart = std::max(apart, glm::dot(off, off));
    }
  }
  const int i = this->count++;
  this->x[i] = static_cast<float>(axis.x);
  this->y[i] = static_cast<float>(axis.y);
  this->z[i] = static_cast<float>(axis.z);
  // The sine of a sum is at most the sum of the sines, and a chord is longer than the sine of its
  // angle; 1e-6 for the rounding of the axis.
  const double wide = std::sqrt(apart) + frames[beams[0]].sinHalf * (1.0 + 2.0 * HitMarginBeam) +
    2.0 * HitMargin + 1e-6;
  const double widened = std::min(wide, 0.999);
  this->sine[i] = static_cast<float>(widened);
  this->cosine[i] = static_cast<float>(std::sqrt((1.0 - widened) * (1.0 + widened)));
}

void ConeLanes::close()
{
  const int last = this->count - 1;
  for (float* lanes : { this->x, this->y, this->z, this->sine, this->cosine })
  {
    std::fill(lanes + this->count, lanes + Width, lanes[last]);
  }
}

void meetPyramid(const Pyramid& pyramid, const WideNode& node, NearBoxes& boxes)
{
  meetSides(pyramid, node, boxes);
  meetSlopes(pyramid, boxes);
}
}
