// SPDX-License-Identifier: BSD-3-Clause
#include "GeometryCase.h"

#include "EchoTestScene.h"
#include "GeometryTestScene.h"
#include "TraceVisitors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <sstream>

namespace geometrycase
{
using namespace avianlidar;
using geometrytest::sameBits;

namespace
{
/// Numbers from bytes; zeros when they are used up.
class Bytes
{
public:
  Bytes(const std::uint8_t* data, std::size_t size)
    : Data(data)
    , Left(size)
  {
  }

  unsigned next()
  {
    if (this->Left == 0)
    {
      return 0;
    }
    --this->Left;
    return *this->Data++;
  }
  unsigned below(unsigned count) { return this->next() % count; }
  double word() { return static_cast<std::int16_t>(this->next() | this->next() << 8); }
  float single()
  {
    std::uint32_t bits = 0;
    for (int i = 0; i < 4; ++i)
    {
      bits = bits << 8 | this->next();
    }
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

private:
  const std::uint8_t* Data;
  std::size_t Left;
};

double within(double value)
{
  const double size = std::fabs(value);
  return size >= 1e-20 && size <= 1e20 ? value : 0.0;
}

class Maker
{
public:
  Maker(const std::uint8_t* data, std::size_t size)
    : In(data, size)
  {
  }

  GeometryCase make()
  {
    GeometryCase& one = this->Case;
    const unsigned kind = this->In.next();
    one.precision = kind & 1 ? Precision::Double : Precision::Single;
    one.options.splitRule = static_cast<SplitRule>(kind >> 1 & 3);
    one.options.boundingVolume = static_cast<BoundingVolumeType>((kind >> 3) % 3);
    one.options.maximumLeafSize = 1 + static_cast<int>(this->In.below(8));
    one.halfBeamwidth = this->width();
    if (this->In.below(3) == 0)
    {
      one.apex = this->point();
    }
    const unsigned points = 3 + this->In.below(40);
    for (unsigned i = 0; i < points; ++i)
    {
      one.mesh.points.push_back(this->placed());
    }
    const unsigned triangles = this->In.below(48);
    for (unsigned i = 0; i < triangles; ++i)
    {
      const unsigned a = this->In.below(points);
      const unsigned b = this->In.below(points);
      one.mesh.triangles.push_back({ a, b, this->In.below(points) });
    }
    const Vec3 aim = this->In.below(4) ? this->some() - one.apex : this->point();
    one.direction = glm::dot(aim, aim) > 0.0 ? aim : Vec3(1.0, 0.0, 0.0);
    this->aimRays();
    return one;
  }

private:
  double width()
  {
    static const double widths[] = { 1e-9, 1e-6, 1e-4, 5.6e-3, 0.1, 0.5, 1.0,
      MaximumHalfBeamwidth };
    return widths[this->In.below(8)];
  }

  double coordinate()
  {
    const unsigned kind = this->In.next();
    double value = 0.0;
    switch (kind >> 5)
    {
      case 0:
        value = static_cast<int>(kind) - 16;
        break;
      case 1:
        value = std::ldexp(kind & 1 ? 1.0 : -1.0, static_cast<int>(this->In.next() % 81) - 40);
        break;
      case 2:
        value = this->known();
        break;
      case 3:
        value = this->known();
        for (unsigned i = 0; i < (kind & 7); ++i)
        {
          value = std::nextafter(value, kind & 16 ? 1e30 : -1e30);
        }
        break;
      case 4:
        value = this->In.word() / 32768.0;
        break;
      case 5:
        value = static_cast<double>(this->In.single());
        break;
      default:
        value = this->In.word() / (1 + (kind & 63));
    }
    value = within(value);
    this->Known.push_back(value);
    return value;
  }

  double known()
  {
    const unsigned which = this->In.next();
    return this->Known.empty() ? 0.0 : this->Known[which % this->Known.size()];
  }

  Vec3 point()
  {
    const double x = this->coordinate();
    const double y = this->coordinate();
    return { x, y, this->coordinate() };
  }

  Vec3 some()
  {
    const auto& points = this->Case.mesh.points;
    return points.empty() ? this->Case.apex : points[this->In.next() % points.size()];
  }

  /// A point that has to do with others.
  Vec3 placed()
  {
    const Vec3& apex = this->Case.apex;
    Vec3 p(0.0);
    switch (this->In.below(8))
    {
      case 0:
        p = this->some();
        break;
      case 1:
        p = 0.5 * (this->some() + this->some());
        break;
      case 2:
        p = apex + this->coordinate() * (this->some() - apex);
        break;
      case 3:
        p = this->some() + this->coordinate() * (this->some() - this->some());
        break;
      case 4:
        p = apex + this->point();
        break;
      default:
        p = this->point();
    }
    return { within(p.x), within(p.y), within(p.z) };
  }

  void aimRays()
  {
    GeometryCase& one = this->Case;
    const BeamFrame frame = makeBeamFrame(one.apex, one.direction, one.halfBeamwidth);
    one.rays.resize(1 + this->In.below(24));
    for (std::size_t i = 0; i < one.rays.size(); ++i)
    {
      double x = this->In.word() / 32768.0;
      double y = this->In.word() / 32768.0;
      const unsigned kind = this->In.below(4);
      if (kind > 0)
      {
        const Vec3 a = this->some() - one.apex;
        const Vec3 b = this->some() - one.apex;
        const Vec3 p = frame.toPlane(kind == 1 ? a : a + this->In.below(5) / 4.0 * (b - a));
        const double off = kind == 3 ? std::ldexp(this->In.word(), -40) : 0.0;
        x = p.x / p.z + off;
        y = p.y / p.z;
      }
      const bool inside = x * x + y * y <= 1.0; // not for NaN
      one.rays.x[i] = inside ? x : 0.0;
      one.rays.y[i] = inside ? y : 0.0;
    }
  }

  Bytes In;
  GeometryCase Case;
  std::vector<double> Known;
};

/// Hits by a loop over all triangles with the kernel's own test of a pair.
template <typename Real>
std::vector<Hit> loopOverTriangles(
  const TriangleMesh& mesh, const BeamFrame& frame, const BeamRays& rays)
{
  std::vector<std::uint32_t> all(mesh.size());
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    all[t] = t;
  }
  const BeamPlaneMap map(frame);
  BeamRayVisitor<Real> visitor(mesh, frame, map);
  std::vector<Hit> hits(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    visitor.setRay(static_cast<Real>(rays.x[i]), static_cast<Real>(rays.y[i]),
      unitDirection(frame.direction(rays.x[i], rays.y[i])), hits[i]);
    visitor.leaf(all.data(), static_cast<std::uint32_t>(all.size()));
  }
  return hits;
}

std::vector<Hit> loopOverTriangles(const GeometryCase& one, const BeamFrame& frame)
{
  return one.precision == Precision::Single ? loopOverTriangles<float>(one.mesh, frame, one.rays)
                                            : loopOverTriangles<double>(one.mesh, frame, one.rays);
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
  BeamTracer tracer(tree, one.precision);
  tracer.setBeam(frame);
  std::vector<Hit> hits;
  for (const TraceMode mode :
    { TraceMode::Automatic, TraceMode::Beams, TraceMode::Packets, TraceMode::SingleRays })
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
  const std::vector<std::uint32_t> counts(Beams, static_cast<std::uint32_t>(one.rays.size()));
  const BeamBlock block{ frames.data(), Beams, counts.data(),
    [&](std::size_t) -> const BeamRays& { return one.rays; } };
  BeamTracer tracer(tree, one.precision);
  const BlockHits& found = tracer.traceBlock(block, TraceMode::Automatic);
  for (std::size_t b = 0; b < Beams; ++b)
  {
    const std::vector<Hit> right = loopOverTriangles(one, frames[b]);
    for (std::size_t i = 0; i < right.size(); ++i)
    {
      const Hit hit = found.hits[b] ? found.hits[b][i] : Hit();
      if (!sameBits(hit, right[i]))
      {
        return unlike("beam of a block", static_cast<int>(b), i, hit, right[i]);
      }
    }
  }
  return {};
}

/// Nearest hit in long double, and whether rounding may decide otherwise.
struct SureHit
{
  Hit hit;
  long double bound = 0.0L; ///< of the error of its range, m
  bool sure = true;
};

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
    // So large beside its range that long double says little of it.
    const bool huge =
      0x1p-25L * pair.size > std::fabs(pair.range) || (pair.hit && !(pair.range > 0.0L));
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

std::string faultOfEchoes(const ScanResult& result, const Sensor& sensor, double farthest)
{
  double sum = 0.0;
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
    // A path over two reflections is three legs at most of the farthest, and the first and last.
    if (echo.range < before || echo.range > 2.0 * farthest * (1.0 + 1e-9))
    {
      std::ostringstream text;
      text << "echoes out of order or out of the scene: " << echo.range << " after " << before
           << ", secondary share " << echo.secondaryShare << ", farthest corner " << farthest;
      return text.str();
    }
    before = echo.range;
    sum += echo.returnEnergy;
  }
  if (sum > 0.9 * sensor.pulseEnergy * (1.0 + 1e-9))
  {
    return "more energy than the surfaces return: " + std::to_string(sum / sensor.pulseEnergy);
  }
  return {};
}

bool sameEchoes(const ScanResult& a, const ScanResult& b)
{
  const auto same = [](const Echo& x, const Echo& y)
  {
    return x.range == y.range && x.energyReceived == y.energyReceived && x.energy == y.energy &&
      x.returnEnergy == y.returnEnergy && x.energyStdError == y.energyStdError &&
      x.objectId == y.objectId && x.labelShare == y.labelShare &&
      x.incidenceAngle == y.incidenceAngle && x.secondaryShare == y.secondaryShare;
  };
  return a.echoes.size() == b.echoes.size() &&
    std::equal(a.echoes.begin(), a.echoes.end(), b.echoes.begin(), same);
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
    numbers.push_back(static_cast<int>(t % 4));
  }
  setup.materials = materials;
  setup.objectIds = numbers;
  setup.materialIds.assign(numbers.size(), 0);
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
  setup.settings.raysPerBeam = 24;
  setup.settings.attenuationCoefficient = 0.0;
  setup.settings.noise = false;
  setup.settings.precision = one.precision;
  finishSetup(setup);
  const ScanBeams beams = echotest::oneBeam(one.direction, one.apex);
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, 1, cache, std::size_t(1) << 24, {}, result);
  const std::string fault = faultOfEchoes(result, setup.sensor, farthest);
  if (!fault.empty())
  {
    return fault;
  }
  setup.sensor.lowerEnergyLimit = 1e-6;
  setup.settings.attenuationCoefficient = 0.1 / farthest;
  finishSetup(setup);
  simulateScan(setup, beams, 1, cache, std::size_t(1) << 24, {}, result);
  return sameEchoes(result, echotest::runScan(setup, beams))
    ? ""
    : "re-lit echoes differ from fresh ones";
}
}

GeometryCase fromBytes(const std::uint8_t* data, std::size_t size)
{
  return Maker(data, size).make();
}

std::string findFault(const GeometryCase& one)
{
  const auto mesh = std::make_shared<TriangleMesh>(one.mesh);
  const auto tree = buildCollisionTree(mesh, one.options, {}, 1);
  const auto usualTree = buildCollisionTree(mesh, TreeOptions(), {}, 1);
  const BeamFrame frame = makeBeamFrame(one.apex, one.direction, one.halfBeamwidth);
  const std::vector<Hit> hits = loopOverTriangles(one, frame);
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

GeometryCase shrunk(GeometryCase one, const std::function<bool(const GeometryCase&)>& faulty)
{
  for (std::size_t t = one.mesh.size(); t-- > 0;)
  {
    GeometryCase less = one;
    less.mesh.triangles.erase(less.mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
    one = faulty(less) ? less : one;
  }
  for (std::size_t i = one.rays.size(); i-- > 0 && one.rays.size() > 1;)
  {
    GeometryCase less = one;
    less.rays.x.erase(less.rays.x.begin() + static_cast<std::ptrdiff_t>(i));
    less.rays.y.erase(less.rays.y.begin() + static_cast<std::ptrdiff_t>(i));
    one = faulty(less) ? less : one;
  }
  return one;
}

std::string describe(const GeometryCase& one)
{
  std::ostringstream text;
  text << std::hexfloat << "precision " << static_cast<int>(one.precision) << ", split rule "
       << static_cast<int>(one.options.splitRule) << ", volume "
       << static_cast<int>(one.options.boundingVolume) << ", leaves of "
       << one.options.maximumLeafSize << ", half-beamwidth " << one.halfBeamwidth;
  const auto vector = [&text](const char* name, const Vec3& v) {
    text << '\n' << name << " { " << v.x << ", " << v.y << ", " << v.z << " }";
  };
  vector("apex", one.apex);
  vector("direction", one.direction);
  for (std::uint32_t t = 0; t < one.mesh.size(); ++t)
  {
    text << "\ntriangle";
    for (int c = 0; c < 3; ++c)
    {
      vector("  corner", one.mesh.corner(t, c));
    }
  }
  for (std::size_t i = 0; i < one.rays.size(); ++i)
  {
    text << "\nray " << one.rays.x[i] << ", " << one.rays.y[i];
  }
  return text.str();
}
}
