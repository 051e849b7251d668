// SPDX-License-Identifier: BSD-3-Clause
#include "VisiblePatch.h"

#include "CollisionTree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Relative: planes and ranges that differ by less are the same, by more are different. In between
/// lies nothing: what is neither surely the same nor surely behind is not sure.
constexpr double SameRange = 1e-9;
constexpr double SameNormal = 1e-9; // rad

/// A triangle lies behind a plane for certain only if a corner lies behind it by more than this,
/// relative to the coordinates; other corners may lie on it.
constexpr double SurelyBehind = 1e-6;
constexpr double OnPlane = 1e-12;

/// A point is near a side when it is within that, in half-beamwidths.
constexpr double NearSide = 1e-6;

/// Cosine of incidence below which a plane is sampled.
constexpr double MostGrazing = 1e-6;

/// Starting points of the search, tried until one is not on an edge.
constexpr double Seeds[][2] = { { 0.2361, -0.1374 }, { -0.3119, 0.2713 }, { 0.0717, 0.4337 } };

/// Points that must be covered.
constexpr int NumberOfProbes = 6;
constexpr double Probes[NumberOfProbes][2] = { { 0.999, 0.0 }, { -0.999, 0.0 }, { 0.0, 0.999 },
  { 0.0, -0.999 }, { 0.2361, -0.1374 }, { -0.3119, 0.2713 } };

/// 1/r of a plane is this times the direction.
Vec3 inverseRange(const PatchPlane& plane)
{
  return plane.normal * (-1.0 / plane.height);
}

/// The most and the least of w . d over the unit directions d of the cone; where w lies in the
/// cone, or its opposite, they are attained inside and greater in magnitude.
double mostOnRim(const BeamFrame& frame, const Vec3& w)
{
  const Vec3 across = glm::cross(w, frame.axis);
  return glm::dot(w, frame.axis) * frame.cosHalf +
    std::sqrt(glm::dot(across, across)) * frame.sinHalf;
}
}

PatchPlane patchPlane(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& origin)
{
  const SeenTriangle seen = seeTriangle(mesh, triangle, origin);
  const Vec3 size = glm::max(
    glm::abs(seen.corners.a), glm::max(glm::abs(seen.corners.b), glm::abs(seen.corners.c)));
  return { seen.normal, -glm::dot(seen.normal, seen.corners.a),
    std::max(size.x, std::max(size.y, size.z)) };
}

double rimOf(const BeamFrame& frame)
{
  constexpr double rim = 1e-7;
  constexpr double roundings = 256.0;
  return std::max(rim, roundings * RoundOffDouble / frame.tanHalf);
}

void PatchFinder::begin(const BeamFrame& frame)
{
  this->Frame = frame;
  this->Map = BeamPlaneMap(frame);
  this->Across[0] = (1.0 / frame.tanHalf) * frame.e1;
  this->Across[1] = (1.0 / frame.tanHalf) * frame.e2;
  this->Radius = 1.0 - rimOf(frame);
  this->Hopeless = false;
  this->Covered = 0;
  this->Kept = 0;
  this->Candidates.clear();
  this->Patch.clear();
  this->Seams.clear();
  this->Planes.clear();
  this->Apart = 0.0;
}

bool PatchFinder::add(const std::uint32_t* triangles, std::uint32_t count)
{
  const std::size_t first = triangles - this->Tree.order.data();
  for (std::uint32_t i = 0; i < count && !this->Hopeless; ++i)
  {
    this->Hopeless = !this->take(first + i);
  }
  return !this->Hopeless;
}

/// True if one side of the square about the disc, or the plane of the apex, has all corners
/// outside.
bool PatchFinder::isBeside(const Vec3* p) const
{
  const auto all = [p](auto outside) { return outside(p[0]) & outside(p[1]) & outside(p[2]); };
  return all([](const Vec3& v) { return v.x >= v.z; }) |
    all([](const Vec3& v) { return -v.x >= v.z; }) | all([](const Vec3& v) { return v.y >= v.z; }) |
    all([](const Vec3& v) { return -v.y >= v.z; }) | all([](const Vec3& v) { return v.z <= 0.0; });
}

/// Add a triangle if it enters the disc. @return false if there is no patch
bool PatchFinder::take(std::size_t position)
{
  Candidate c;
  c.triangle = this->Tree.order[position];
  c.corners = leafCorners(this->Tree, position, this->Frame.origin);
  const Vec3* const v[3] = { &c.corners.a, &c.corners.b, &c.corners.c };
  for (int i = 0; i < 3; ++i)
  {
    c.places[i] = { glm::dot(*v[i], this->Across[0]), glm::dot(*v[i], this->Across[1]),
      glm::dot(*v[i], this->Frame.axis) };
  }
  if (this->isBeside(c.places))
  {
    return true;
  }
  c.number = NotInPatch;
  const EdgeVector first = edgeVector(c.corners.a, c.corners.b);
  const double determinant = glm::dot(c.corners.c, first.e);
  if (determinant == 0.0)
  {
    return true; // no ray hits it
  }
  const double sign = determinant > 0.0 ? 1.0 : -1.0;
  for (int i = 0; i < 3; ++i)
  {
    const EdgeVector side = i == 0 ? first : edgeVector(*v[i], *v[(i + 1) % 3]);
    const BeamEdge& e = c.edges[i] = this->Map.edge(side, sign);
    const double reach = std::sqrt(e.x * e.x + e.y * e.y);
    if (e.z <= -this->Radius * reach)
    {
      return true; // beside the disc
    }
    c.cut[i] = e.z < this->Radius * reach;
    if (c.cut[i] && !(e.tolerance < 0.125 * (1.0 - this->Radius) * reach))
    {
      return false; // where the side lies is not certain
    }
  }
  this->coverProbes(c.edges);
  this->Candidates.push_back(c);
  if (this->Candidates.size() > 2 * MostPatchTriangles)
  {
    this->cull();
  }
  return this->Candidates.size() <= 2 * MostPatchTriangles;
}

/// Test points near the rim, each of which must be covered if all of the disc is. This quick test
/// excludes most beams.
void PatchFinder::coverProbes(const BeamEdge* edges)
{
  for (int k = 0; k < NumberOfProbes; ++k)
  {
    const double x = Probes[k][0];
    const double y = Probes[k][1];
    const bool covers = ((edges[0].x * x + edges[0].y * y) + edges[0].z >= 0.0) &
      ((edges[1].x * x + edges[1].y * y) + edges[1].z >= 0.0) &
      ((edges[2].x * x + edges[2].y * y) + edges[2].z >= 0.0);
    this->Covered |= static_cast<unsigned>(covers) << k;
  }
}

/// Leave the candidates that do enter the disc.
void PatchFinder::cull()
{
  const auto begin = this->Candidates.begin() + static_cast<std::ptrdiff_t>(this->Kept);
  this->Candidates.erase(std::remove_if(begin, this->Candidates.end(),
                           [this](Candidate& c) { return !this->enters(c); }),
    this->Candidates.end());
  this->Kept = this->Candidates.size();
}

bool PatchFinder::enters(Candidate& c) const
{
  bool meets = c.edges[0].z > 0.0 && c.edges[1].z > 0.0 && c.edges[2].z > 0.0;
  for (int i = 0; i < 3; ++i)
  {
    c.enters[i] = c.cut[i] && this->sideEnters(c.places[i], c.places[(i + 1) % 3], c.edges[i]);
    meets = meets || c.enters[i];
  }
  return meets;
}

/// True if the side between two corners, whose line crosses the disc, does so itself.
bool PatchFinder::sideEnters(const Vec3& pa, const Vec3& pb, const BeamEdge& edge) const
{
  const double reach = std::sqrt(edge.x * edge.x + edge.y * edge.y);
  const double ux = -edge.y / reach;
  const double uy = edge.x / reach;
  const double distance = std::fabs(edge.z) / reach;
  const double half = std::sqrt((this->Radius - distance) * (this->Radius + distance));
  // Along the line, in homogeneous coordinates: n/z from its point nearest to the axis.
  const double na = pa.x * ux + pa.y * uy;
  const double nb = pb.x * ux + pb.y * uy;
  if (pa.z <= 0.0 && pb.z <= 0.0)
  {
    return false;
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double fromA = pa.z > 0.0 ? na / pa.z : std::copysign(infinity, pb.z * na - pa.z * nb);
  const double fromB = pb.z > 0.0 ? nb / pb.z : std::copysign(infinity, pa.z * nb - pb.z * na);
  return std::min(fromA, fromB) < half && std::max(fromA, fromB) > -half;
}

std::unique_ptr<VisiblePatch> PatchFinder::find()
{
  constexpr unsigned all = (1u << NumberOfProbes) - 1u;
  if (this->Hopeless || this->Covered != all)
  {
    return nullptr;
  }
  this->cull();
  if (this->Candidates.size() > MostPatchTriangles)
  {
    return nullptr;
  }
  const auto* const seed = std::find_if(std::begin(Seeds), std::end(Seeds),
    [this](const auto& place) { return this->firstSeen(place[0], place[1]) != nullptr; });
  if (seed == std::end(Seeds) || !this->fillsFrom((*seed)[0], (*seed)[1]))
  {
    return nullptr;
  }
  auto patch = std::make_unique<VisiblePatch>();
  patch->planes.assign(this->Planes.begin(), this->Planes.end());
  patch->apart = this->Apart;
  patch->seams.assign(this->Seams.begin(), this->Seams.end());
  patch->triangles.reserve(this->Patch.size());
  patch->planeOf.reserve(this->Patch.size());
  for (const Candidate* c : this->Patch)
  {
    patch->triangles.push_back(c->triangle);
    patch->planeOf.push_back(c->plane);
  }
  for (std::size_t one = 0; one < this->Planes.size(); ++one)
  {
    for (std::size_t two = 0; two < one && !patch->facing; ++two)
    {
      patch->facing = this->isFacing(one, two);
    }
  }
  return patch;
}

/// Distance of a point from the nearest side, inside a triangle, in half-beamwidths.
double PatchFinder::slackOf(const Candidate& candidate, double x, double y)
{
  double slack = std::numeric_limits<double>::infinity();
  for (const BeamEdge& e : candidate.edges)
  {
    const double reach = std::sqrt(e.x * e.x + e.y * e.y);
    const double value = (e.x * x + e.y * y) + e.z;
    slack = std::min(slack, reach > 0.0 ? value / reach : value);
  }
  return slack;
}

/// The triangle that the point sees first; null if none, or if that is not sure.
PatchFinder::Candidate* PatchFinder::firstSeen(double x, double y)
{
  Candidate* nearest = nullptr;
  double best = 0.0;
  double second = 0.0;
  const Vec3 d = this->Frame.direction(x, y);
  for (Candidate& c : this->Candidates)
  {
    const double slack = slackOf(c, x, y);
    if (slack < -NearSide)
    {
      continue;
    }
    const PatchPlane plane = patchPlane(this->Mesh, c.triangle, this->Frame.origin);
    const double inverse = plane.height > 0.0 ? glm::dot(inverseRange(plane), d) : 0.0;
    if (slack < NearSide || !(inverse > 0.0))
    {
      return nullptr;
    }
    if (inverse > best)
    {
      second = best;
      best = inverse;
      nearest = &c;
    }
    else
    {
      second = std::max(second, inverse);
    }
  }
  return second < (1.0 - SameRange) * best ? nearest : nullptr;
}

/// True if the triangle that a point sees first, with all connected to it, fills the disc.
bool PatchFinder::fillsFrom(double x, double y)
{
  Candidate& first = *this->firstSeen(x, y);
  if (!this->findPlane(first) || !this->flood(first) || !this->coversOnce(x, y) ||
    !std::all_of(
      this->Patch.begin(), this->Patch.end(), [this](Candidate* c) { return this->findPlane(*c); }))
  {
    return false;
  }
  return std::all_of(this->Candidates.begin(), this->Candidates.end(),
    [this](const Candidate& c)
    {
      return c.number != NotInPatch ||
        std::all_of(this->Planes.begin(), this->Planes.end(),
          [&](const PatchPlane& plane) { return this->liesBehind(plane, c); });
    });
}

/// True if exactly one triangle of the patch covers the point.
bool PatchFinder::coversOnce(double x, double y) const
{
  return std::count_if(this->Patch.begin(), this->Patch.end(),
           [&](const Candidate* c) { return slackOf(*c, x, y) > -NearSide; }) == 1;
}

/// Set the plane of a triangle: a known one or a new one. @return false if it is seen edge-on, or
/// there are too many
bool PatchFinder::findPlane(Candidate& candidate)
{
  const PatchPlane own = patchPlane(this->Mesh, candidate.triangle, this->Frame.origin);
  if (!(own.height > 0.0))
  {
    return false;
  }
  const auto known = std::find_if(this->Planes.begin(), this->Planes.end(),
    [&](const PatchPlane& plane) { return this->liesIn(plane, own); });
  candidate.plane = static_cast<std::uint8_t>(known - this->Planes.begin());
  if (known != this->Planes.end())
  {
    return true;
  }
  const Vec3 across = glm::cross(own.normal, this->Frame.axis);
  const double leastCosine = -glm::dot(own.normal, this->Frame.axis) * this->Frame.cosHalf -
    std::sqrt(glm::dot(across, across)) * this->Frame.sinHalf;
  this->Planes.push_back(own);
  return leastCosine > MostGrazing && this->Planes.size() <= MostPatchPlanes;
}

/// Follow the sides that enter the disc. @return false if one of them has no other side
bool PatchFinder::flood(Candidate& first)
{
  first.number = 0;
  this->Patch.push_back(&first);
  for (std::size_t k = 0; k < this->Patch.size(); ++k)
  {
    for (int side = 0; side < 3; ++side)
    {
      if (!this->Patch[k]->enters[side])
      {
        continue;
      }
      Candidate* const next = this->across(*this->Patch[k], side);
      if (!next)
      {
        return false;
      }
      this->join(*this->Patch[k], side, *next);
    }
  }
  return true;
}

/// Add the triangle beyond a side to the patch.
void PatchFinder::join(Candidate& one, int side, Candidate& two)
{
  if (two.number == NotInPatch)
  {
    two.number = static_cast<int>(this->Patch.size());
    this->Patch.push_back(&two);
  }
  // A side is met from both its triangles.
  const auto known = [&](const PatchSeam& seam)
  { return seam.one == two.number && seam.two == one.number; };
  if (std::none_of(this->Seams.begin(), this->Seams.end(), known))
  {
    this->Seams.push_back({ static_cast<std::uint8_t>(one.number),
      static_cast<std::uint8_t>(two.number), static_cast<std::uint8_t>(side) });
  }
}

/// The one triangle that shares the side and lies on its other side; null if there is none, or more
/// than one.
PatchFinder::Candidate* PatchFinder::across(const Candidate& from, int side)
{
  const auto cornerOf = [](const Candidate& c, int i) -> const Vec3&
  { return i % 3 == 0 ? c.corners.a : (i % 3 == 1 ? c.corners.b : c.corners.c); };
  const Vec3& a = cornerOf(from, side);
  const Vec3& b = cornerOf(from, side + 1);
  const BeamEdge& edge = from.edges[side];
  Candidate* found = nullptr;
  for (Candidate& c : this->Candidates)
  {
    for (int i = 0; i < 3 && &c != &from; ++i)
    {
      const Vec3& p = cornerOf(c, i);
      const Vec3& q = cornerOf(c, i + 1);
      if (!((p == a && q == b) || (p == b && q == a)))
      {
        continue;
      }
      const BeamEdge& e = c.edges[i];
      if (e.x * edge.x + e.y * edge.y + e.z * edge.z < 0.0)
      {
        if (found)
        {
          return nullptr;
        }
        found = &c;
      }
    }
  }
  return found;
}

/// True if a triangle's own plane is the same for all directions of the cone.
bool PatchFinder::liesIn(const PatchPlane& plane, const PatchPlane& own)
{
  const Vec3 tilt = glm::cross(own.normal, plane.normal);
  if (!(glm::dot(own.normal, plane.normal) > 0.0) ||
    !(glm::dot(tilt, tilt) <= SameNormal * SameNormal))
  {
    return false;
  }
  const Vec3 q = inverseRange(plane);
  const Vec3 w = inverseRange(own) - q;
  const double least = -mostOnRim(this->Frame, -q);
  const double apart = std::sqrt(glm::dot(w, w)) / least;
  if (!(apart <= SameRange))
  {
    return false;
  }
  this->Apart = std::max(this->Apart, apart);
  return true;
}

/// True if triangles of two planes may lie before each other.
bool PatchFinder::isFacing(std::size_t one, std::size_t two) const
{
  return !this->liesBehind(this->Planes[one], two) && !this->liesBehind(this->Planes[two], one);
}

/// True if no triangle of another plane of the patch has a corner before a plane.
bool PatchFinder::liesBehind(const PatchPlane& plane, std::size_t other) const
{
  return std::all_of(this->Patch.begin(), this->Patch.end(),
    [&](const Candidate* c)
    {
      const Vec3* const corners[] = { &c->corners.a, &c->corners.b, &c->corners.c };
      return c->plane != other ||
        std::all_of(std::begin(corners), std::end(corners),
          [&](const Vec3* v)
          {
            const double size = plane.height + glm::dot(glm::abs(*v), Vec3(1.0));
            return -glm::dot(plane.normal, *v) - plane.height >= -OnPlane * size;
          });
    });
}

/// True if no direction of the cone meets the triangle before the plane.
bool PatchFinder::liesBehind(const PatchPlane& plane, const Candidate& candidate) const
{
  double nearest = std::numeric_limits<double>::infinity(); // depth behind the plane, m
  double farthest = 0.0;
  double size = plane.height;
  for (const Vec3* v : { &candidate.corners.a, &candidate.corners.b, &candidate.corners.c })
  {
    const double depth = -glm::dot(plane.normal, *v) - plane.height;
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
    size = std::max(size, std::fabs(v->x) + std::fabs(v->y) + std::fabs(v->z));
  }
  if (nearest >= -OnPlane * size && farthest >= SurelyBehind * size)
  {
    return true;
  }
  const PatchPlane own = patchPlane(this->Mesh, candidate.triangle, this->Frame.origin);
  if (!(own.height > 0.0))
  {
    return false;
  }
  const Vec3 q = inverseRange(plane);
  const double most = mostOnRim(this->Frame, inverseRange(own) - q);
  return most < -SurelyBehind * mostOnRim(this->Frame, q);
}
}
