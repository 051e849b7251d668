// SPDX-License-Identifier: BSD-3-Clause
#include "MirrorRegions.h"

#include "BeamTracer.h"
#include "KeySort.h"
#include "Multiversion.h"
#include "Random.h"
#include "Throughput.h"
#include "TriangleOrder.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Largest number of regions of a surface for which each region has samples of its own.
constexpr std::size_t FewRegions = 32;

/// Area, half-beamwidths squared, up to which regions are left out.
constexpr double LeastRegion = 1e-12;

/// Step, modulo 1, by which consecutive samples are kept far apart.
constexpr double GoldenRatio = 0.6180339887498949;

/// Number of samples for each ray that would fall in a region.
constexpr double SamplesPerRay = 2.0;

/// Number of samples for each ray that falls on a mirror, for paths that may end anywhere.
constexpr double SpreadPerRay = 1.0;

/// Number of the first sample of such paths on a surface.
constexpr std::uint32_t FirstSpread = 0x80000000;

/// Region::two of such paths.
constexpr std::uint32_t Anywhere = 0xffffffff;

PlaneLine operator+(const PlaneLine& a, const PlaneLine& b)
{
  return { a.x + b.x, a.y + b.y, a.z + b.z };
}

PlaneLine operator*(double s, const PlaneLine& a)
{
  return { s * a.x, s * a.y, s * a.z };
}

/// 1 for a counterclockwise ring, -1 for a clockwise ring.
double signOf(const PlaneRing& ring)
{
  return ring.signedArea() < 0.0 ? -1.0 : 1.0;
}

/// Side of a ring from corner i to the next corner, positive inside. @param sign signOf() the ring
PlaneLine sideOf(const PlaneRing& ring, int i, double sign)
{
  const PlanePoint& a = ring.corners[i];
  const PlanePoint& b = ring.corners[i + 1 == ring.size ? 0 : i + 1];
  const double x = sign * (a.y - b.y);
  const double y = sign * (b.x - a.x);
  return { x, y, -(x * a.x + y * a.y) };
}

constexpr std::size_t BlockWidth = 8; ///< number of facets in a block

/// Greatest height of a box above a plane. @param box lanes of centre and half size
AVIANLIDAR_ALWAYS_INLINE double heightOf(
  const double* plane, const double* const* box, std::size_t i)
{
  return ((plane[0] * box[0][i] + plane[1] * box[1][i]) + plane[2] * box[2][i]) +
    ((std::fabs(plane[0]) * box[3][i] + std::fabs(plane[1]) * box[4][i]) +
      (std::fabs(plane[2]) * box[5][i] + plane[3]));
}

/// Find the facets to which a surface may reflect rays: the box of the facet has a part before the
/// plane of the surface and parts inside each of four sides, and the box of the surface has a part
/// before the plane of the facet. @param lanes, blocks set by fillLanes() @param centre, half box
/// of the surface @param planes coefficients of the surface's plane and of the sides @param facing
/// for each block, set to the bits of the facets that pass
AVIANLIDAR_MULTIVERSION void findFacing(const double* const* lanes, const double* const* blocks,
  std::size_t count, const Vec3& centre, const Vec3& half, const double (*planes)[4],
  std::uint32_t* facing)
{
#pragma omp simd
  for (std::size_t b = 0; b < count; ++b)
  {
    bool meets = true;
    for (int k = 0; k < 5; ++k)
    {
      meets = meets & (heightOf(planes[k], blocks, b) > 0.0);
    }
    facing[b] = meets ? 1u : 0u;
  }
  const double *ax = lanes[0], *ay = lanes[1], *az = lanes[2], *height = lanes[3];
  const double ox = centre.x, oy = centre.y, oz = centre.z;
  const double rx = half.x, ry = half.y, rz = half.z;
  for (std::size_t b = 0; b < count; ++b)
  {
    if (facing[b] == 0)
    {
      continue;
    }
    std::uint32_t bits = 0;
#pragma omp simd reduction(| : bits)
    for (std::size_t lane = 0; lane < BlockWidth; ++lane)
    {
      const std::size_t i = b * BlockWidth + lane;
      const double own = ((ax[i] * ox + ay[i] * oy) + az[i] * oz) +
        ((std::fabs(ax[i]) * rx + std::fabs(ay[i]) * ry) + (std::fabs(az[i]) * rz + height[i]));
      bool faces = own > 1e-9 * (height[i] + oz);
      for (int k = 0; k < 5; ++k)
      {
        faces = faces &
          (heightOf(planes[k], lanes + 4, i) >
            (k == 0 ? 1e-9 * (planes[k][3] + lanes[6][i]) : 0.0));
      }
      bits |= (faces ? 1u : 0u) << lane;
    }
    facing[b] = bits;
  }
}
}

MirrorRegions::MirrorRegions(const ScanSetup& setup, const SceneTriangles& scene)
  : Setup(setup)
  , Scene(scene)
  , Shape(setup.sensor)
{
}

void MirrorRegions::Box::extend(const PlanePoint& p)
{
  this->low = { std::min(this->low.x, p.x), std::min(this->low.y, p.y) };
  this->high = { std::max(this->high.x, p.x), std::max(this->high.y, p.y) };
}

bool MirrorRegions::Box::meets(const Box& other) const
{
  return this->low.x < other.high.x && other.low.x < this->high.x && this->low.y < other.high.y &&
    other.low.y < this->high.y;
}

void MirrorRegions::begin(
  std::uint64_t beam, const BeamFrame& frame, const VisiblePolygons& seen, const BeamSamples* cells)
{
  this->Beam = beam;
  this->Frame = frame;
  this->Seen = &seen;
  this->ShareOfArea = this->Shape.shareOfArea();
  this->Surfaces.clear();
  this->Facets.clear();
  for (const PlaneSurface& s : seen.surfaces)
  {
    Surface surface{};
    surface.seen = &s;
    this->Surfaces.push_back(surface);
  }
  if (cells)
  {
    auto surface = this->Surfaces.begin();
    cells->forEachSurface(
      [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
      {
        const auto own = std::find_if(surface, this->Surfaces.end(),
          [=](const Surface& s)
          { return s.seen->triangle == triangle || s.seen->other == triangle; });
        for (std::uint32_t i = begin; i < end && own != this->Surfaces.end(); ++i)
        {
          own->share += cells->weight[i];
        }
        surface = own != this->Surfaces.end() ? own : surface;
      });
    return;
  }
  const double dense = this->Shape.mostDensity();
  std::size_t polygon = 0;
  seen.forEach(
    [&](const PlaneSurface&, const PlaneRing& ring)
    {
      this->Surfaces[seen.polygons[polygon++].surface].share +=
        dense * this->ShareOfArea * ring.area();
    });
}

double MirrorRegions::bound(std::size_t surface, double returned) const
{
  const Surface& s = this->Surfaces[surface];
  const auto most = [&](std::uint32_t triangle)
  { return specularBound(this->Setup, this->Setup.material(triangle), 1.0, returned); };
  const std::uint32_t one = s.seen->triangle;
  return s.share * std::max(most(one), most(s.seen->other == NoTriangle ? one : s.seen->other));
}

/// Set surfaces, facets (sorted by surface) and lanes from the visible polygons.
void MirrorRegions::addFacets()
{
  for (Surface& surface : this->Surfaces)
  {
    this->setSurface(surface);
  }
  std::uint32_t begin = 0;
  for (const VisiblePolygons::Polygon& polygon : this->Seen->polygons)
  {
    Surface& surface = this->Surfaces[polygon.surface];
    if (surface.height > 0.0)
    {
      Facet facet{ {}, {}, polygon.surface };
      for (std::uint32_t i = begin; i < polygon.end; ++i)
      {
        const PlanePoint& p = this->Seen->corners[i];
        facet.ring.add(p);
        facet.box.extend(p);
        surface.box.extend(p);
      }
      this->Facets.push_back(facet);
    }
    begin = polygon.end;
  }
  std::stable_sort(this->Facets.begin(), this->Facets.end(),
    [](const Facet& a, const Facet& b) { return a.surface < b.surface; });
  this->fillLanes();
}

/// Set the lanes of findFacing(), and the facets and boxes of surfaces.
void MirrorRegions::fillLanes()
{
  const std::size_t blocks = (this->Facets.size() + BlockWidth - 1) / BlockWidth;
  const std::size_t stride = blocks * BlockWidth;
  this->Lanes.assign(10 * stride, 0.0);
  std::fill_n(
    this->Lanes.begin() + 3 * stride, stride, -1.0); // no facet: no surface lies before it
  this->Blocks.resize(6 * blocks);
  this->Facing.resize(blocks);
  AABB all;
  this->Boxes.clear();
  for (std::uint32_t i = 0; i < this->Facets.size(); ++i)
  {
    const Facet& facet = this->Facets[i];
    Surface& s = this->Surfaces[facet.surface];
    s.first = s.end == 0 ? i : s.first;
    s.end = i + 1;
    AABB& box = this->Boxes.emplace_back();
    for (int k = 0; k < facet.ring.size; ++k)
    {
      const PlanePoint& p = facet.ring.corners[k];
      box.extend(Vec3(p.x, p.y, 1.0) / std::max(s.inverse.at(p), s.seen->leastInverse));
    }
    s.corners = merge(s.corners, box);
    all = merge(all, box);
  }
  // Facets of a block lie close together.
  this->Order.clear();
  for (std::uint32_t i = 0; i < this->Facets.size(); ++i)
  {
    const std::uint64_t place = placeOnCurve(this->Boxes[i].center(), all.lower, all.upper);
    this->Order.push_back(keyAbove(static_cast<std::uint32_t>(place >> 31), i));
  }
  sortKeys(this->Order);
  AABB ofBlock;
  for (std::size_t i = 0; i < this->Order.size(); ++i)
  {
    const std::uint32_t number = numberOf(this->Order[i]);
    const Surface& s = this->Surfaces[this->Facets[number].surface];
    const AABB& box = this->Boxes[number];
    const Vec3 centre = 0.5 * (box.lower + box.upper);
    const Vec3 half = 0.5 * (box.upper - box.lower);
    const double values[10] = { s.along.x, s.along.y, s.along.z, s.height, centre.x, centre.y,
      centre.z, half.x, half.y, half.z };
    for (std::size_t k = 0; k < 10; ++k)
    {
      this->Lanes[k * stride + i] = values[k];
    }
    ofBlock = i % BlockWidth == 0 ? box : merge(ofBlock, box);
    for (int k = 0; k < 3 && (i % BlockWidth == BlockWidth - 1 || i + 1 == this->Order.size()); ++k)
    {
      const double middle = 0.5 * (ofBlock.lower[k] + ofBlock.upper[k]);
      const double size = 0.5 * (ofBlock.upper[k] - ofBlock.lower[k]);
      this->Blocks[k * blocks + i / BlockWidth] = middle;
      this->Blocks[(k + 3) * blocks + i / BlockWidth] =
        size + 1e-9 * (size + std::fabs(middle)); // exceeds rounding
    }
  }
}

void MirrorRegions::setSurface(Surface& surface) const
{
  const SeenTriangle seen = seeTriangle(this->Scene, surface.seen->triangle, this->Frame.origin);
  surface.normal = seen.normal;
  surface.height = seen.height;
  surface.along = { this->Frame.tanHalf * glm::dot(surface.normal, this->Frame.e1),
    this->Frame.tanHalf * glm::dot(surface.normal, this->Frame.e2),
    glm::dot(surface.normal, this->Frame.axis) };
  surface.mirror = this->Frame.toPlane(surface.normal);
  if (surface.height > 0.0) // otherwise the surface is seen edge-on
  {
    surface.inverse = (-1.0 / surface.height) * surface.along;
  }
}

void MirrorRegions::begin(std::size_t surface)
{
  if (this->Facets.empty())
  {
    this->addFacets();
  }
  this->Start = static_cast<std::uint32_t>(surface);
  this->Sample = 0;
  this->Pair = 0;
  this->Drawn = 0;
  this->Regions.clear();
}

std::size_t MirrorRegions::spread(std::size_t surface, std::vector<MirrorPath>& starts)
{
  this->begin(surface);
  this->Sample = FirstSpread;
  const Surface& one = this->Surfaces[surface];
  for (std::uint32_t facet = one.first; facet < one.end; ++facet)
  {
    const PlaneRing& ring = this->Facets[facet].ring;
    this->Regions.push_back({ facet, Anywhere, ring, ring.area() });
  }
  if (!this->Regions.empty())
  {
    this->placeIn(0, this->Regions.size(), starts);
  }
  return this->Sample - FirstSpread;
}

std::size_t MirrorRegions::search(std::size_t surface, std::vector<MirrorPath>& paths)
{
  this->begin(surface);
  const Surface& one = this->Surfaces[surface];
  this->findNear(one);
  for (auto k = this->Near.begin(); k != this->Near.end();)
  {
    const std::uint32_t other = this->Facets[*k].surface;
    const auto end = std::upper_bound(k, this->Near.end(), this->Surfaces[other].end - 1);
    this->findRegions(one, this->Surfaces[other], &*k, &*k + (end - k));
    k = end;
  }
  // If there are many regions, all regions share samples.
  const std::size_t step = this->Regions.size() <= FewRegions ? 1 : this->Regions.size();
  for (std::size_t k = 0; k < this->Regions.size(); k += step)
  {
    this->placeIn(k, k + step, paths);
  }
  return this->Sample;
}

/// Find the facets to which a surface may reflect rays. If a point p lies before the plane of the
/// surface by H(p), its mirror image is p - 2 H(p) mirror. The apex sees the image in the surface's
/// box if the image is inside four planes through the apex.
void MirrorRegions::findNear(const Surface& one)
{
  this->Near.clear();
  const double plane[4] = { one.along.x, one.along.y, one.along.z, one.height };
  const double sides[5][4] = { {}, { 1.0, 0.0, -one.box.low.x }, { -1.0, 0.0, one.box.high.x },
    { 0.0, 1.0, -one.box.low.y }, { 0.0, -1.0, one.box.high.y } };
  double planes[5][4];
  for (int k = 0; k < 5; ++k)
  {
    const double* const s = sides[k];
    const double shift = s[0] * one.mirror.x + s[1] * one.mirror.y + s[2] * one.mirror.z;
    for (int i = 0; i < 4; ++i)
    {
      planes[k][i] = k == 0 ? plane[i] : s[i] - 2.0 * shift * plane[i];
    }
  }
  const std::size_t count = this->Facing.size();
  const double* lanes[10];
  const double* blocks[6];
  for (std::size_t k = 0; k < 10; ++k)
  {
    lanes[k] = this->Lanes.data() + k * count * BlockWidth;
    blocks[k % 6] = this->Blocks.data() + k % 6 * count;
  }
  findFacing(lanes, blocks, count, 0.5 * (one.corners.lower + one.corners.upper),
    0.5 * (one.corners.upper - one.corners.lower), planes, this->Facing.data());
  for (std::size_t b = 0; b < count; ++b)
  {
    for (std::uint32_t bits = this->Facing[b]; bits != 0; bits &= bits - 1)
    {
      const std::uint32_t facet = numberOf(this->Order[b * BlockWidth + __builtin_ctz(bits)]);
      if (facet < one.first || facet >= one.end)
      {
        this->Near.push_back(facet);
      }
    }
  }
  std::sort(this->Near.begin(), this->Near.end());
}

/// Find the regions of rays that go from a surface to facets [begin, end) of another surface.
void MirrorRegions::findRegions(
  const Surface& one, const Surface& two, const std::uint32_t* begin, const std::uint32_t* end)
{
  this->Mirrored.clear();
  bool before = false;
  for (const std::uint32_t* k = begin; k < end; ++k)
  {
    Box box;
    const PlaneRing& ring = this->Facets[*k].ring;
    for (int i = 0; i < ring.size; ++i)
    {
      const PlanePoint& p = ring.corners[i];
      const double near = one.height * std::max(two.inverse.at(p), two.seen->leastInverse);
      const double height = one.along.at(p) + near;
      before = before || height > 1e-9 * (1.0 + near);
      const Vec3 q = Vec3(p.x, p.y, 1.0) - 2.0 * height * one.mirror;
      box.extend(q.z > 0.0 ? PlanePoint{ q.x / q.z, q.y / q.z } : PlanePoint{ -1e300, -1e300 });
      box.extend(q.z > 0.0 ? box.low : PlanePoint{ 1e300, 1e300 });
    }
    this->Mirrored.push_back(box);
  }
  Image image;
  if (!before || !this->imageOf(one, two, image))
  {
    return;
  }
  for (std::uint32_t i = one.first; i < one.end; ++i)
  {
    for (const std::uint32_t* k = begin; k < end; ++k)
    {
      Region region{ i, *k, {}, 0.0 };
      if (this->Facets[i].box.meets(this->Mirrored[k - begin]) &&
        this->cutOut(this->Facets[i], this->Facets[*k], image, region.ring))
      {
        region.area = region.ring.area();
        if (region.area > LeastRegion)
        {
          this->Regions.push_back(region);
        }
      }
    }
  }
}

bool MirrorRegions::imageOf(const Surface& one, const Surface& two, Image& image) const
{
  // The plane of the first surface is n . P + h = 0. The plane of the second surface, mirrored on
  // it, is m . P + g = 0. The ray d meets the mirrored plane at d/w with w = -m . d/g.
  const double turn = glm::dot(one.normal, two.normal);
  const double g = two.height - 2.0 * one.height * turn;
  if (!(std::fabs(g) > 1e-12 * (one.height + two.height)))
  {
    return false;
  }
  image.w = (-1.0 / g) * (two.along + (-2.0 * turn) * one.along);
  // The end of the path, mirrored back, times w.
  const double tangent2 = this->Frame.tanHalf * this->Frame.tanHalf;
  const PlaneLine shift = -2.0 * (one.along + one.height * image.w);
  image.x = PlaneLine{ 1.0, 0.0, 0.0 } + (one.along.x / tangent2) * shift;
  image.y = PlaneLine{ 0.0, 1.0, 0.0 } + (one.along.y / (tangent2 * this->Frame.flatness2)) * shift;
  image.z = PlaneLine{ 0.0, 0.0, 1.0 } + one.along.z * shift;
  return true;
}

/// Find the rays that go from one facet to another. @return false if there is no such ray
bool MirrorRegions::cutOut(
  const Facet& one, const Facet& two, const Image& image, PlaneRing& ring) const
{
  const Surface& first = this->Surfaces[one.surface];
  const Surface& second = this->Surfaces[two.surface];
  ring = one.ring;
  const double sign = signOf(two.ring);
  for (int i = 0; i < two.ring.size; ++i)
  {
    const PlaneLine side = sideOf(two.ring, i, sign);
    if (!clipRing(ring, (side.x * image.x + side.y * image.y) + side.z * image.z))
    {
      return false;
    }
  }
  // The end must lie before the first plane, and the start before the second plane.
  return clipRing(ring, image.w) && clipRing(ring, image.z) &&
    clipRing(ring, first.inverse + -1.0 * image.w) &&
    clipRing(ring, second.along + second.height * first.inverse);
}

/// Fill regions [first, end) with samples, one sample in each of equal parts of the regions' area.
/// The parts follow each other around the first corner of a region, and go on in the next region.
void MirrorRegions::placeIn(std::size_t first, std::size_t end, std::vector<MirrorPath>& paths)
{
  double area = 0.0;
  for (std::size_t k = first; k < end; ++k)
  {
    area += this->Regions[k].area;
  }
  const bool anywhere = this->Regions[first].two == Anywhere;
  const double samples = (anywhere ? SpreadPerRay : SamplesPerRay) *
    this->Setup.settings.raysPerBeam * area * this->ShareOfArea;
  const double least = !anywhere && end - first > 1 ? static_cast<double>(FewRegions) : 1.0;
  const auto pairs = static_cast<std::uint32_t>(std::max(least, std::round(0.5 * samples)));
  const std::uint32_t count = 2 * pairs;
  const double tangent2 = this->Frame.tanHalf * this->Frame.tanHalf;
  std::size_t region = first;
  int part = 2;
  const auto areaOfPart = [&]()
  {
    const PlanePoint* const corners = this->Regions[region].ring.corners;
    const PlanePoint a{ corners[part - 1].x - corners[0].x, corners[part - 1].y - corners[0].y };
    const PlanePoint b{ corners[part].x - corners[0].x, corners[part].y - corners[0].y };
    return 0.5 * std::fabs(a.x * b.y - a.y * b.x);
  };
  double before = 0.0;
  double own = areaOfPart();
  // Random numbers depend on the pair of surfaces, so that different rounding does not change them.
  const std::uint64_t pair = std::uint64_t{ this->Start } << 32 |
    (anywhere ? 0 : this->Facets[this->Regions[first].two].surface + 1);
  this->Drawn = pair == this->Pair ? this->Drawn : 0;
  this->Pair = pair;
  const std::uint64_t draws = pair * 0x9e3779b97f4a7c15u + this->Drawn;
  for (std::uint32_t k = 0; k < count; ++k)
  {
    const auto u =
      uniformPair(this->Setup.settings.seed, this->Beam, draws + k, RandomPurpose::Mirrors);
    const double place = (k + u[0]) / count * area;
    while (place > before + own && (part + 1 < this->Regions[region].ring.size || region + 1 < end))
    {
      before += own;
      const bool isLast = ++part == this->Regions[region].ring.size;
      region += isLast ? 1 : 0;
      part = isLast ? 2 : part;
      own = areaOfPart();
    }
    const double across = own > 0.0 ? std::min(1.0, (place - before) / own) : 0.5;
    double out = k * GoldenRatio + u[1];
    out = std::sqrt(out - std::floor(out));
    const PlanePoint* const corners = this->Regions[region].ring.corners;
    const PlanePoint& a = corners[part - 1];
    const PlanePoint& b = corners[part];
    const PlanePoint side{ a.x + across * (b.x - a.x), a.y + across * (b.y - a.y) };
    const PlanePoint ray{ corners[0].x + out * (side.x - corners[0].x),
      corners[0].y + out * (side.y - corners[0].y) };
    const double secant2 = 1.0 + tangent2 * this->Frame.radius2(ray.x, ray.y);
    MirrorPath path;
    path.start = this->Start;
    path.one = this->Sample + k;
    const Region& here = this->Regions[region];
    if (!this->Shape.holds(ray.x, ray.y))
    {
      continue;
    }
    this->findStart(this->Facets[here.one], ray, path);
    if (anywhere || this->findEnd(this->Facets[here.two], path))
    {
      path.weight = area / count * this->ShareOfArea * this->Shape.density(ray.x, ray.y) /
        (this->Shape.isRound() ? secant2 * std::sqrt(secant2) : 1.0);
      paths.push_back(path);
    }
  }
  this->Sample += count;
  this->Drawn += count;
}

/// Where a ray meets its mirror. `end` is the direction of the reflected ray.
void MirrorRegions::findStart(const Facet& facet, const PlanePoint& p, MirrorPath& path) const
{
  const Surface& one = this->Surfaces[facet.surface];
  const Vec3 direction = unitVector(this->Frame.direction(p.x, p.y));
  path.cosine = std::min(1.0, -glm::dot(one.normal, direction));
  path.rangeOne = one.height / path.cosine;
  path.first = one.seen->triangleAt(p);
  path.from = path.rangeOne * direction;
  path.end = mirrorDirection(direction, one.normal);
  path.visibility = Visibility::Unknown;
}

/// Follow a ray from its mirror. @return false if the ray does not arrive
bool MirrorRegions::findEnd(const Facet& facet, MirrorPath& path) const
{
  const Surface& two = this->Surfaces[facet.surface];
  const Vec3 from = path.from;
  const Vec3 out = path.end;
  const double fall = -glm::dot(two.normal, out);
  const double step = (glm::dot(two.normal, from) + two.height) / fall;
  const Vec3 end = from + step * out;
  path.range = safeLength(end);
  const double margin = surfaceMargin(std::max(path.rangeOne, path.range));
  const Vec3 q = this->Frame.toPlane(end);
  if (!(fall > 0.0) || !(step > 2.0 * margin) || !(q.z > 0.0))
  {
    return false;
  }
  const PlanePoint place{ q.x / q.z, q.y / q.z };
  if (!this->Shape.holds(place.x, place.y))
  {
    return false;
  }
  const double sign = signOf(facet.ring);
  for (int i = 0; i < facet.ring.size; ++i)
  {
    if (sideOf(facet.ring, i, sign).at(place) < -1e-9)
    {
      return false;
    }
  }
  path.triangle = two.seen->triangleAt(place);
  path.length = path.rangeOne + step + path.range;
  path.second = reflectionGeometry(out, -end / path.range, two.normal);
  path.end = end;
  return true;
}
}
