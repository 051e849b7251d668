// SPDX-License-Identifier: BSD-3-Clause
#include "PathSpace.h"

#include "Multiversion.h"
#include "Reflectance.h"
#include "SecondaryBeam.h"
#include "TriangleTest.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace avianlidar
{
namespace
{
/// With fewer paths of a kind, a descent for each is as cheap.
constexpr std::size_t FewPaths = 3;

/// A search that looks at more triangles is given up: so many descents for single paths are
/// cheaper. A triangle costs about a thirtieth of a descent, and as much to cull for a hundred
/// paths; what is not culled is tested besides.
constexpr std::size_t LookedAtPerPath = 4;
constexpr std::size_t MostLookedAt = 1024;
}

double distanceInCone(
  const BeamFrame& frame, const Vec3& point, double range, const Vec3& direction)
{
  // p . p cos^2 - (p . axis)^2 = 0 on the cone, a quadratic in the length s.
  const double cos2 = frame.cosHalf * frame.cosHalf;
  const double along = glm::dot(point, frame.axis);
  const double turn = glm::dot(direction, frame.axis);
  const double a = cos2 - turn * turn;
  const double b = cos2 * glm::dot(point, direction) - along * turn;
  const double c = std::min(0.0, cos2 * range * range - along * along);
  if (!(a > 1e-9))
  {
    return std::numeric_limits<double>::infinity(); // within the cone of directions, or nearly
  }
  const double reach = (std::sqrt(std::max(0.0, b * b - a * c)) - b) / a;
  return reach * (1.0 + 1e-6) + 1e-6 * range;
}

//--- candidates -----------------------------------------------------------------------------------

void PathSpace::beginLook(
  const BeamSamples& hits, const SampleGeometry& geometry, const BeamFrame& frame)
{
  this->Hits = &hits;
  this->Geometry = &geometry;
  this->Frame = &frame;
  this->Known = false;
  this->Reaches.assign(
    geometry.surfaces.size(), { std::numeric_limits<double>::infinity(), AABB{} });
}

/// Fill Near, unless it is known already, and close what is out of reach. @param box around all
/// paths
void PathSpace::look(const CollisionTree& tree, const AABB& box, std::size_t paths)
{
  if (paths < FewPaths || !isFinite(box.lower) || !isFinite(box.upper))
  {
    return;
  }
  const bool inside = this->Gathered &&
    glm::all(glm::greaterThanEqual(box.lower, this->GatheredBox.lower)) &&
    glm::all(glm::lessThanEqual(box.upper, this->GatheredBox.upper));
  if (!inside)
  {
    const std::size_t most = std::min(MostLookedAt, LookedAtPerPath * paths);
    this->Gathered =
      this->Near.find(tree, *this->Frame, this->Hits->farthest, box, most, this->Stack);
    this->GatheredBox = box;
    this->Culled = false;
  }
  this->Known = this->Gathered;
  if (this->Known)
  {
    this->Stride = this->Near.stride();
    this->closeOutOfReach();
  }
}

/// For each surface, which candidates its paths cannot meet.
void PathSpace::closeOutOfReach()
{
  const std::size_t surfaces = this->Reaches.size();
  this->Closed.resize(std::max(this->Closed.size(), surfaces * this->Stride));
  this->Open.assign(surfaces, 0);
  for (std::size_t s = 0; s < surfaces; ++s)
  {
    const SampleGeometry::Surface& surface = this->Geometry->surfaces[s];
    const Reach& reach = this->Reaches[s];
    if (!(reach.least < std::numeric_limits<double>::infinity()))
    {
      continue; // no path
    }
    std::uint8_t* const closed = this->Closed.data() + s * this->Stride;
    this->Near.close(
      surface.triangle, surface.normal, reach.least - surface.height, reach.box, closed);
    for (std::size_t i = 0; i < this->Stride && !this->Open[s]; i += 8)
    {
      this->Open[s] = anyZero(eightOf(closed + i));
    }
  }
}

void PathSpace::beginCodes(std::size_t points)
{
  this->Codes.resize(std::max(this->Codes.size(), points * this->Stride));
  this->Points.resize(std::max(this->Points.size(), points));
  this->Missed.resize(std::max(this->Missed.size(), this->Stride));
  this->Coded.assign(points, 0);
}

/// Codes of a hit or of the end of a mirror path. @param closed of its surface
const std::uint8_t* PathSpace::codeOf(std::size_t point, const std::uint8_t* closed)
{
  if (!this->Culled)
  {
    this->Culling.set(*this->Frame, this->Hits->farthest, this->Near.lanes(), this->Near.size());
    this->Culled = true;
  }
  std::uint8_t* const codes = this->Codes.data() + point * this->Stride;
  if (!this->Coded[point])
  {
    const std::size_t hits = this->Hits->size();
    this->Coded[point] = 1;
    this->Points[point] = this->Culling.project(point < hits
        ? this->Hits->range[point] * this->Geometry->direction(point)
        : Vec3(this->EndX[point - hits], this->EndY[point - hits], this->EndZ[point - hits]));
    this->Culling.code(this->Points[point], closed, codes);
  }
  return codes;
}

/// Candidates that a segment between two points may meet, as far as they are not closed.
const PathSpace::Candidates& PathSpace::meeting(
  std::size_t point1, std::size_t point2, const std::uint8_t* closed1, const std::uint8_t* closed2)
{
  const std::uint8_t* const code1 = this->codeOf(point1, closed1);
  const std::uint8_t* const code2 = this->codeOf(point2, closed2);
  std::uint8_t* const missed = this->Missed.data();
  bool any = false;
  for (std::size_t i = 0; i < this->Stride; i += 8)
  {
    const std::uint64_t eight =
      (eightOf(code1 + i) & eightOf(code2 + i)) | eightOf(closed1 + i) | eightOf(closed2 + i);
    std::memcpy(missed + i, &eight, sizeof eight);
    any = any || anyZero(eight);
  }
  if (any)
  {
    this->Culling.cull(this->Points[point1], this->Points[point2], missed);
    for (std::size_t i = 0; i < this->Stride; i += 8)
    {
      for (std::size_t k = i; k < i + 8 && anyZero(eightOf(missed + i)); ++k)
      {
        if (missed[k] == 0)
        {
          missed[k] = 0xff;
          this->Found.push_back(this->Near.triangle(k));
        }
      }
    }
  }
  return this->Found;
}

//--- mirror paths ---------------------------------------------------------------------------------

namespace
{
/// distanceInCone() along mirrorDirection(), and where that leads to.
AVIANLIDAR_MULTIVERSION void mirrorEnds(const SampleLanes& lanes, const Vec3& axis, double cos2,
  double* endX, double* endY, double* endZ, std::size_t count)
{
  const SampleLanes h = lanes;
  const Vec3 w = axis;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double range = h.range[i];
    const double twice = 2.0 * ((h.dx[i] * h.nx[i] + h.dy[i] * h.ny[i]) + h.dz[i] * h.nz[i]);
    const double mx = h.dx[i] - twice * h.nx[i];
    const double my = h.dy[i] - twice * h.ny[i];
    const double mz = h.dz[i] - twice * h.nz[i];
    const double px = range * h.dx[i];
    const double py = range * h.dy[i];
    const double pz = range * h.dz[i];
    const double along = (px * w.x + py * w.y) + pz * w.z;
    const double turn = (mx * w.x + my * w.y) + mz * w.z;
    const double a = cos2 - turn * turn;
    const double b = cos2 * ((px * mx + py * my) + pz * mz) - along * turn;
    const double outside = cos2 * range * range - along * along;
    const double c = outside < 0.0 ? outside : 0.0;
    const double square = b * b - a * c;
    const double reach = (std::sqrt(square > 0.0 ? square : 0.0) - b) / a;
    const double s =
      a > 1e-9 ? reach * (1.0 + 1e-6) + 1e-6 * range : std::numeric_limits<double>::infinity();
    endX[i] = px + s * mx;
    endY[i] = py + s * my;
    endZ[i] = pz + s * mz;
  }
}
}

void PathSpace::lookBefore(const CollisionTree& tree, const BeamFrame& frame,
  const BeamSamples& hits, const SampleGeometry& geometry)
{
  this->beginLook(hits, geometry, frame);
  const std::size_t count = hits.size();
  for (std::vector<double>* v : { &this->EndX, &this->EndY, &this->EndZ })
  {
    v->resize(std::max(v->size(), count));
  }
  const SampleLanes lanes(hits, geometry);
  mirrorEnds(lanes, frame.axis, frame.cosHalf * frame.cosHalf, this->EndX.data(), this->EndY.data(),
    this->EndZ.data(), count);
  std::size_t paths = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    const Vec3 end(this->EndX[i], this->EndY[i], this->EndZ[i]);
    if (!isFinite(end))
    {
      continue;
    }
    ++paths;
    Reach& reach = this->Reaches[geometry.surface[i]];
    reach.box.extend(hits.range[i] * geometry.direction(i));
    reach.box.extend(end);
    // Half the height at which a path of this hit is first looked at.
    reach.least = std::min(reach.least, 0.5 * surfaceMargin(hits.range[i]) * hits.cosine[i]);
  }
  AABB all;
  for (const Reach& reach : this->Reaches)
  {
    all = merge(all, reach.box);
  }
  this->look(tree, all, paths);
  this->Mirrors.assign(count, this->Known ? Knowledge::Free : Knowledge::Nothing);
  if (!this->Known)
  {
    return;
  }
  this->beginCodes(2 * count);
  for (std::size_t i = 0; i < count; ++i)
  {
    const Vec3 end(this->EndX[i], this->EndY[i], this->EndZ[i]);
    this->Mirrors[i] = !isFinite(end)   ? Knowledge::Nothing
      : this->Open[geometry.surface[i]] ? Knowledge::Candidates
                                        : Knowledge::Free;
  }
}

const PathSpace::Candidates* PathSpace::ofMirror(std::size_t hit)
{
  if (this->Mirrors[hit] == Knowledge::Nothing)
  {
    return nullptr;
  }
  this->Found.clear();
  if (this->Mirrors[hit] == Knowledge::Free)
  {
    return &this->Found;
  }
  const std::uint8_t* const closed = this->closedOf(this->Geometry->surface[hit]);
  return &this->meeting(hit, this->Hits->size() + hit, closed, closed);
}

//--- connections
//----------------------------------------------------------------------------------------

void PathSpace::lookBetween(const CollisionTree& tree, const BeamFrame& frame,
  const BeamSamples& hits, const SampleGeometry& geometry, const SecondaryConnections& connections)
{
  this->beginLook(hits, geometry, frame);
  this->Connections = &connections;
  for (std::size_t i = 0; i < connections.size(); ++i)
  {
    const std::uint32_t one = connections.one[i];
    const std::uint32_t two = connections.two[i];
    // Half the heights at which the segment is first and last looked at.
    const double margin = 0.5 * surfaceMargin(std::max(hits.range[one], hits.range[two]));
    double& atOne = this->Reaches[geometry.surface[one]].least;
    double& atTwo = this->Reaches[geometry.surface[two]].least;
    atOne = std::min(atOne, margin * connections.cosOut[i]);
    atTwo = std::min(atTwo, margin * connections.cosIn[i]);
  }
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    Reach& reach = this->Reaches[geometry.surface[i]];
    if (reach.least < std::numeric_limits<double>::infinity())
    {
      reach.box.extend(hits.range[i] * geometry.direction(i));
    }
  }
  AABB all;
  for (const Reach& reach : this->Reaches)
  {
    all = merge(all, reach.box);
  }
  for (Reach& reach : this->Reaches)
  {
    reach.box = all;
  }
  this->look(tree, all, connections.size());
  if (this->Known)
  {
    this->beginCodes(hits.size());
  }
}

const PathSpace::Candidates* PathSpace::ofConnection(std::size_t connection)
{
  if (!this->Known)
  {
    return nullptr;
  }
  this->Found.clear();
  const std::uint32_t one = this->Connections->one[connection];
  const std::uint32_t two = this->Connections->two[connection];
  const std::uint32_t surface1 = this->Geometry->surface[one];
  const std::uint32_t surface2 = this->Geometry->surface[two];
  if (!this->Open[surface1] || !this->Open[surface2])
  {
    return &this->Found;
  }
  return &this->meeting(one, two, this->closedOf(surface1), this->closedOf(surface2));
}
}
