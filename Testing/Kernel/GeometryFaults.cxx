// SPDX-License-Identifier: BSD-3-Clause
#include "GeometryCase.h"

#include "Descents.h"
#include "EchoTestScene.h"
#include "GeometryTestScene.h"
#include "SameEchoes.h"
#include "VolumeTree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace geometrycase
{
using namespace avianlidar;
using geometrytest::sameBits;

namespace
{
/// Hits by a loop over all triangles with the kernel's own test of a pair.
std::vector<Hit> loopOverTriangles(
  const GeometryCase& one, const BeamFrame& frame, const CollisionTree& tree)
{
  const BeamRays& rays = one.rays;
  std::vector<std::uint32_t> all(one.mesh.size());
  for (std::uint32_t t = 0; t < all.size(); ++t)
  {
    all[t] = t;
  }
  const BeamPlaneMap map(frame);
  const SceneTriangles scene(tree);
  BeamRayVisitor visitor(scene, frame, map);
  std::vector<Hit> hits(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    visitor.setRay(
      rays.x[i], rays.y[i], unitDirection(frame.direction(rays.x[i], rays.y[i])), hits[i]);
    visitor.leaf(all.data(), static_cast<std::uint32_t>(all.size()));
  }
  return hits;
}

std::string unlike(const char* what, int number, std::size_t ray, const Hit& hit, const Hit& right)
{
  std::ostringstream text;
  text.precision(17);
  text << what << ' ' << number << ", ray " << ray << ": triangle "
       << static_cast<std::int64_t>(static_cast<std::int32_t>(hit.triangle)) << " at " << hit.range
       << ", but " << static_cast<std::int64_t>(static_cast<std::int32_t>(right.triangle)) << " at "
       << right.range;
  return text.str();
}

std::string faultOfWays(const GeometryCase& one, const BeamFrame& frame,
  const std::vector<Hit>& right, const CollisionTree& tree)
{
  OneBeamTracer tracer(tree);
  tracer.setBeam(frame);
  std::vector<Hit> hits;
  for (const TraceMode mode : { TraceMode::Automatic, TraceMode::Beams, TraceMode::SingleRays })
  {
    tracer.trace(one.rays, mode, hits);
    for (std::size_t i = 0; i < right.size(); ++i)
    {
      if (!sameBits(hits[i], right[i]))
      {
        return unlike("mode", static_cast<int>(mode), i, hits[i], right[i]);
      }
    }
  }
  return {};
}

/// Neighbours that go down the tree together.
std::string faultOfBlock(const GeometryCase& one, const BeamFrame& frame, const CollisionTree& tree)
{
  constexpr std::size_t Beams = 5;
  std::vector<BeamFrame> frames;
  for (std::size_t b = 0; b < Beams; ++b)
  {
    const double aside = 0.7 * (static_cast<double>(b) - 2.0);
    frames.push_back(
      makeBeamFrame(one.apex, frame.direction(aside, 0.3 * aside), one.halfBeamwidth));
  }
  const std::vector<BeamRays> rays(Beams, one.rays);
  DrawnRays given(rays.data());
  const TracedBeams block{ frames.data(), Beams, static_cast<std::uint32_t>(one.rays.size()),
    &given };
  OneBeamTracer tracer(tree);
  const TracedHits& found = tracer.traceBeams(block, TraceMode::Automatic);
  for (std::size_t b = 0; b < Beams; ++b)
  {
    const std::vector<Hit> right = loopOverTriangles(one, frames[b], tree);
    for (std::size_t i = 0; i < right.size(); ++i)
    {
      const std::uint32_t triangle = found.triangles[b] ? found.triangles[b][i] : NoTriangle;
      if (triangle != right[i].triangle)
      {
        return unlike("beam of a block", static_cast<int>(b), i, { triangle, 0.0 }, right[i]);
      }
    }
  }
  return {};
}

/// Nearest hit in long double, and whether rounding may decide otherwise.
struct SureHit
{
  Hit hit;
  long double bound = 0.0L; ///< bound of the error of the range, m
  bool sure = true;
};

/// From a point to the triangle's boundary, m.
long double boundaryDistance(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& point)
{
  using namespace geometrytest;
  long double nearest = std::numeric_limits<long double>::infinity();
  for (int c = 0; c < 3; ++c)
  {
    const Vec3L p = wide(mesh.corner(triangle, c)) - wide(point);
    const Vec3L side = wide(mesh.corner(triangle, (c + 1) % 3)) - wide(point) - p;
    const long double squared = dot(side, side);
    const long double along = squared > 0.0L ? -dot(p, side) / squared : 0.0L;
    const Vec3L closest = p + std::fmin(1.0L, std::fmax(0.0L, along)) * side;
    nearest = std::fmin(nearest, std::sqrt(dot(closest, closest)));
  }
  return nearest;
}

/// What TriangleTest.h guarantees of every accepted pair is that the ray passes the triangle within
/// HitMargin times its farthest corner, and for a beam within HitMarginBeam tan(theta0.5) times the
/// distance.
SureHit hitInLongDouble(
  const GeometryCase& one, const BeamFrame& frame, std::size_t ray, std::uint32_t found)
{
  using namespace geometrytest;
  const Vec3L d = rayDirection(frame, one.rays.x[ray], one.rays.y[ray]);
  SureHit best;
  for (std::uint32_t t = 0; t < one.mesh.size(); ++t)
  {
    const PairResult pair = testPair(one.mesh, t, one.apex, d);
    const long double nearest = std::fmin(pair.edgeRange, std::fabs(pair.range));
    const long double margin =
      HitMargin * pair.size / nearest + HitMarginBeam * frame.tanHalf + 32.0L * 0x1p-53L;
    const bool nearEdge = pair.edgeRange > 0.0L && !(pair.edgeAngle > margin);
    // Its plane passes the lidar so near that rounding decides on which side.
    const bool coplanar = !(std::fabs(pair.range) * pair.cosine > 0x1p-45L * pair.size);
    // So large beside its range that long double says little of it, or beside its distance that a
    // hit may lie off it by as much.
    const bool huge = 0x1p-25L * pair.size > std::fabs(pair.range) ||
      (pair.hit && !(pair.range > 0.0L)) ||
      HitMargin * pair.size > boundaryDistance(one.mesh, t, one.apex);
    // What lies behind could still be told; not worth a distinction.
    best.sure = best.sure && !nearEdge && !((coplanar || huge) && (pair.hit || t == found));
    if (pair.hit && pair.range < best.hit.range)
    {
      best.hit = { t, static_cast<double>(pair.range) };
      best.bound = 64.0L * 0x1p-53L * pair.size / pair.cosine;
    }
  }
  return best;
}

std::string faultOfHits(
  const GeometryCase& one, const BeamFrame& frame, const std::vector<Hit>& hits)
{
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    const SureHit right = hitInLongDouble(one, frame, i, hits[i].triangle);
    if (!right.sure)
    {
      continue;
    }
    const bool same = hits[i].valid() == right.hit.valid() &&
      (!hits[i].valid() || std::fabs(hits[i].range - right.hit.range) <= right.bound);
    if (!same)
    {
      return unlike("long double", 0, i, hits[i], right.hit);
    }
  }
  return {};
}

std::string faultOfEchoes(const ScanResult& result, const ScanSetup& setup, double farthest)
{
  double sum = 0.0;
  double direct = 0.0;
  double before = 0.0;
  for (const Echo& echo : result.echoes)
  {
    const bool finite = std::isfinite(echo.range) && std::isfinite(echo.energy) &&
      std::isfinite(echo.returnEnergy) && std::isfinite(echo.energyStdError) &&
      std::isfinite(echo.incidenceAngle) && std::isfinite(echo.secondaryShare);
    if (!finite || echo.energyReceived > echo.returnEnergy * (1.0 + 1e-12))
    {
      return "an echo of no number, or with more energy in a unit than in all";
    }
    // A path with two reflections is three legs at most of the farthest, and the first and last.
    if (echo.range < before || echo.range > 2.0 * farthest * (1.0 + 1e-9))
    {
      std::ostringstream text;
      text << "echoes out of order or out of the scene: " << echo.range << " after " << before
           << ", secondary share " << echo.secondaryShare << ", farthest corner " << farthest;
      return text.str();
    }
    before = echo.range;
    sum += echo.returnEnergy;
    direct += echo.returnEnergy * (1.0 - echo.secondaryShare);
  }
  const double most = 0.9 * setup.sensor.pulseEnergy * (1.0 + 1e-9);
  // In cells the rays from which paths start are others than those of the direct echo: each alone
  // returns no more.
  const double all = setup.settings.beamSamples == BeamSampleSource::Rays ? most : 2.0 * most;
  if (direct > most || sum > all)
  {
    return "more energy than the surfaces return: " + std::to_string(direct / most) + ", " +
      std::to_string(sum / most);
  }
  return {};
}

std::string faultOfScan(const GeometryCase& one, const std::shared_ptr<const CollisionTree>& tree)
{
  ScanSetup setup;
  setup.tree = tree;
  std::vector<Material> materials;
  std::vector<int> numbers;
  for (std::uint32_t t = 0; t < one.mesh.size(); ++t)
  {
    materials.push_back(t % 3 == 0 ? Material{ 0.3, 0.6, 50.0 }
        : t % 3 == 1               ? Material{ 0.9, 0.0, 0.0 }
                                   : Material{ 0.0, 0.9, 1e6 });
    numbers.push_back(static_cast<int>(t % one.objects));
  }
  setup.materials = materials;
  setup.objectIds = numbers;
  setup.materialIds = std::vector<int>(numbers.size(), 0);
  double farthest = 1e-12;
  for (const Vec3& p : one.mesh.points)
  {
    farthest = std::max(farthest, safeLength(p - one.apex));
  }
  setup.sensor.halfBeamwidth = one.halfBeamwidth;
  setup.sensor.rangeGate = 4.0 * farthest;
  setup.sensor.samplingInterval = 0.01 * farthest / SpeedOfLight;
  setup.sensor.pulseWidth = setup.sensor.samplingInterval;
  setup.sensor.lowerEnergyLimit = 0.0;
  setup.sensor.beamProfile = one.profile;
  setup.settings.raysPerBeam = 24;
  setup.settings.sampling = one.sampling;
  setup.settings.beamSamples = one.cells ? BeamSampleSource::Cells : BeamSampleSource::Rays;
  setup.settings.attenuationCoefficient = 0.0;
  setup.settings.noise = false;
  finishSetup(setup);
  const ScanBeams beams = echotest::oneBeam(one.direction, one.apex);
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, 1, cache, std::size_t(1) << 24, {}, result);
  const std::string fault = faultOfEchoes(result, setup, farthest);
  if (!fault.empty())
  {
    return fault;
  }
  setup.sensor.lowerEnergyLimit = 1e-6;
  setup.settings.attenuationCoefficient = 0.1 / farthest;
  finishSetup(setup);
  simulateScan(setup, beams, 1, cache, std::size_t(1) << 24, {}, result);
  return echotest::sameEchoes(result, echotest::runScan(setup, beams))
    ? ""
    : "re-lit echoes differ from fresh ones";
}
}

std::string findFault(const GeometryCase& one)
{
  const auto mesh = std::make_shared<TriangleMesh>(one.mesh);
  const auto tree = buildVolumeTree(mesh, one.options, {}, 1);
  const auto usualTree = buildVolumeTree(mesh, TreeOptions(), {}, 1);
  const BeamFrame frame = makeBeamFrame(one.apex, one.direction, one.halfBeamwidth);
  const std::vector<Hit> hits = loopOverTriangles(one, frame, *tree);
  for (const CollisionTree* way : { tree.get(), usualTree.get() })
  {
    std::string fault = faultOfWays(one, frame, hits, *way);
    fault = fault.empty() ? faultOfBlock(one, frame, *way) : fault;
    if (!fault.empty())
    {
      return (way == tree.get() ? "tree as asked, " : "usual tree, ") + fault;
    }
  }
  const std::string fault = faultOfHits(one, frame, hits);
  return fault.empty() ? faultOfScan(one, usualTree) : fault;
}
}
