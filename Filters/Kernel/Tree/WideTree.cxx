// SPDX-License-Identifier: BSD-3-Clause
#include "WideTree.h"

#include "BeamCone.h"
#include "LaneMath.h"
#include "Multiversion.h"
#include "TriangleTest.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
constexpr float Rounding = WideRounding;

float roundedUp(double v)
{
  return std::nextafter(static_cast<float>(v), std::numeric_limits<float>::infinity());
}

void meetAll(float* nearest)
{
  std::fill(nearest, nearest + WideNode::Width, 0.0f);
}

double largestOf(const Vec3& v)
{
  return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z)));
}

/// True if a rectangle lies left of a projection's left edge or right of its right edge.
AVIANLIDAR_ALWAYS_INLINE bool besideWedge(
  const WideCone& c, int plane, float x, float y, float halfX, float halfY, float error)
{
  const float left = c.leftX[plane] * y - c.leftY[plane] * x;
  const float right = c.rightX[plane] * y - c.rightY[plane] * x;
  const float leftReach = std::fabs(c.leftX[plane]) * halfY + std::fabs(c.leftY[plane]) * halfX;
  const float rightReach = std::fabs(c.rightX[plane]) * halfY + std::fabs(c.rightY[plane]) * halfX;
  return (left > leftReach + error) | (right < -rightReach - error);
}

AVIANLIDAR_MULTIVERSION void coneDistances(
  const WideCone& cone, const WideNode& node, float* nearest)
{
  const WideCone c = cone;
#pragma omp simd
  for (int i = 0; i < WideNode::Width; ++i)
  {
    const float x = node.x[i] - c.apexX;
    const float y = node.y[i] - c.apexY;
    const float z = node.z[i] - c.apexZ;
    const float hx = node.halfX[i] + c.widening;
    const float hy = node.halfY[i] + c.widening;
    const float hz = node.halfZ[i] + c.widening;
    const float error = Rounding * (std::fabs(x) + std::fabs(y) + std::fabs(z) + hx + hy + hz);
    // Tangent plane of the cone on the side of the centre (explained in BeamVolumeTest.cxx).
    const float along = x * c.axisX + y * c.axisY + z * c.axisZ;
    float rx = x - along * c.axisX;
    float ry = y - along * c.axisY;
    float rz = z - along * c.axisZ;
    const float rest = rx * c.axisX + ry * c.axisY + rz * c.axisZ;
    rx -= rest * c.axisX;
    ry -= rest * c.axisY;
    rz -= rest * c.axisZ;
    const float radius = std::sqrt(rx * rx + ry * ry + rz * rz);
    const float scale = c.cosine / radius;
    const float nx = scale * rx - c.sine * c.axisX;
    const float ny = scale * ry - c.sine * c.axisY;
    const float nz = scale * rz - c.sine * c.axisZ;
    const float beyond = nx * x + ny * y + nz * z;
    const float reach = std::fabs(nx) * hx + std::fabs(ny) * hy + std::fabs(nz) * hz;
    const bool outside = c.cosine * radius > along * c.sine;
    const bool separated = outside & (beyond > reach + error);
    const float depth = std::fabs(c.axisX) * hx + std::fabs(c.axisY) * hy + std::fabs(c.axisZ) * hz;
    const bool behind = along + depth + error < 0.0f;
    bool beside = besideWedge(c, 0, y, z, hy, hz, error);
    beside |= besideWedge(c, 1, z, x, hz, hx, error);
    beside |= besideWedge(c, 2, x, y, hx, hy, error);
    const float ex = lanes::larger(std::fabs(x) - hx, 0.0f);
    const float ey = lanes::larger(std::fabs(y) - hy, 0.0f);
    const float ez = lanes::larger(std::fabs(z) - hz, 0.0f);
    const float distance = std::sqrt(ex * ex + ey * ey + ez * ez) - error;
    nearest[i] = (separated | behind | beside) ? std::numeric_limits<float>::infinity()
                                               : lanes::larger(distance, 0.0f);
  }
}

AVIANLIDAR_MULTIVERSION void rayDistances(const WideRay& ray, const WideNode& node, float* nearest)
{
  const WideRay r = ray;
  const float absX = std::fabs(r.inverseX);
  const float absY = std::fabs(r.inverseY);
  const float absZ = std::fabs(r.inverseZ);
#pragma omp simd
  for (int i = 0; i < WideNode::Width; ++i)
  {
    const float x = node.x[i] - r.originX;
    const float y = node.y[i] - r.originY;
    const float z = node.z[i] - r.originZ;
    const float size =
      std::fabs(x) + std::fabs(y) + std::fabs(z) + node.halfX[i] + node.halfY[i] + node.halfZ[i];
    const float margin = r.widening + (Rounding + r.spread) * size;
    const float wx = (node.halfX[i] + margin) * absX;
    const float wy = (node.halfY[i] + margin) * absY;
    const float wz = (node.halfZ[i] + margin) * absZ;
    const float mx = x * r.inverseX;
    const float my = y * r.inverseY;
    const float mz = z * r.inverseZ;
    const float from = lanes::larger(lanes::larger(mx - wx, my - wy), mz - wz);
    const float to = lanes::smaller(lanes::smaller(mx + wx, my + wy), mz + wz);
    const float entry = lanes::larger(from, 0.0f);
    nearest[i] = entry <= to ? entry * (1.0f - Rounding) : std::numeric_limits<float>::infinity();
  }
}
}

void WideNode::clear()
{
  *this = {};
  std::fill(this->first, this->first + Width, NoChild);
}

void EntryPoints::clear()
{
  this->nodes.clear();
  this->nearest.clear();
  this->Filled = WideNode::Width;
}

int EntryPoints::nextLane(float distance)
{
  if (this->Filled == WideNode::Width)
  {
    this->Filled = 0;
    this->nodes.emplace_back().clear();
    this->nearest.push_back(distance);
  }
  this->nearest.back() = std::min(this->nearest.back(), distance);
  return this->Filled++;
}

void EntryPoints::add(const WideNode& node, int lane, float distance)
{
  const int i = this->nextLane(distance);
  WideNode& target = this->nodes.back();
  target.x[i] = node.x[lane];
  target.y[i] = node.y[lane];
  target.z[i] = node.z[lane];
  target.halfX[i] = node.halfX[lane];
  target.halfY[i] = node.halfY[lane];
  target.halfZ[i] = node.halfZ[lane];
  target.first[i] = node.first[lane];
  target.count[i] = node.count[lane];
}

void EntryPoints::addLeaf(std::uint32_t first, std::uint32_t count)
{
  constexpr float Everywhere = 1e30f;
  WideNode node;
  node.clear();
  node.halfX[0] = node.halfY[0] = node.halfZ[0] = Everywhere;
  node.first[0] = first;
  node.count[0] = count;
  this->add(node, 0, 0.0f);
}

bool wideningFor(const WideTree& tree, const Vec3& offset, float& widening)
{
  widening = roundedUp(4e-7 * (tree.extent + largestOf(offset)));
  // Leaves without a box of their own (see EntryPoints::addLeaf()) need no squares.
  const bool square = tree.nodes.empty() || tree.extent + largestOf(offset) > LeastWideExtent;
  return square && tree.extent < LargestWideExtent && largestOf(offset) < LargestWideExtent;
}

WideCone::WideCone(const WideTree& tree, const BeamFrame& frame)
{
  const BeamCone cone(frame);
  const Vec3 offset = cone.apex - tree.reference;
  this->apexX = static_cast<float>(offset.x);
  this->apexY = static_cast<float>(offset.y);
  this->apexZ = static_cast<float>(offset.z);
  this->axisX = static_cast<float>(cone.axis.x);
  this->axisY = static_cast<float>(cone.axis.y);
  this->axisZ = static_cast<float>(cone.axis.z);
  this->sine = static_cast<float>(cone.sine);
  this->cosine = static_cast<float>(cone.cosine);
  for (int plane = 0; plane < 3; ++plane)
  {
    const ConeWedge& wedge = cone.wedges[plane];
    this->leftX[plane] = static_cast<float>(wedge.leftX);
    this->leftY[plane] = static_cast<float>(wedge.leftY);
    this->rightX[plane] = static_cast<float>(wedge.rightX);
    this->rightY[plane] = static_cast<float>(wedge.rightY);
  }
  this->everywhere = !wideningFor(tree, offset, this->widening);
}

void WideCone::distances(const WideNode& node, float* nearest) const
{
  this->everywhere ? meetAll(nearest) : coneDistances(*this, node, nearest);
}

WideRay::WideRay(const WideTree& tree, const Vec3& apex, const Vec3& origin, const Vec3& direction,
  double angularMargin)
{
  const Vec3 offset = (apex - tree.reference) + origin;
  const auto inverse = [](double d)
  {
    constexpr double Smallest = 1e-20;
    return static_cast<float>(1.0 / (std::fabs(d) < Smallest ? std::copysign(Smallest, d) : d));
  };
  this->originX = static_cast<float>(offset.x);
  this->originY = static_cast<float>(offset.y);
  this->originZ = static_cast<float>(offset.z);
  this->inverseX = inverse(direction.x);
  this->inverseY = inverse(direction.y);
  this->inverseZ = inverse(direction.z);
  this->spread = static_cast<float>(angularMargin);
  this->everywhere = !wideningFor(tree, offset, this->widening);
}

void WideRay::distances(const WideNode& node, float* nearest) const
{
  this->everywhere ? meetAll(nearest) : rayDistances(*this, node, nearest);
}
}
