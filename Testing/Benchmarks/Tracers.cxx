// SPDX-License-Identifier: BSD-3-Clause
#include "Tracers.h"

#include "GeometryTestScene.h"
#include "ParallelLoop.h"
#include "Suites.h"

#include "vtkAbstractCellLocator.h"
#include "vtkCellArray.h"
#include "vtkGenericCell.h"
#include "vtkModifiedBSPTree.h"
#include "vtkNew.h"
#include "vtkOBBTree.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStaticCellLocator.h"

#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace benchmarks
{
using namespace avianlidar;

std::vector<Hit> allHits(const Tracer& tracer, const Workload& workload, int threads)
{
  std::vector<Hit> all(workload.size());
  tracer(workload, threads,
    [&](std::size_t first, const Hit* hits, std::size_t count)
    { std::copy(hits, hits + count, all.begin() + static_cast<std::ptrdiff_t>(first)); });
  return all;
}

Tracer ourTracer(const CollisionTree& tree, TraceMode mode)
{
  return [&tree, mode](const Workload& work, int threads, const Consumer& consumer)
  {
    const SceneTriangles scene(tree);
    std::vector<std::unique_ptr<BeamTracer>> tracers(threads);
    const auto rays = static_cast<std::uint32_t>(work.raysPerBeam);
    const auto body = [&](std::size_t begin, std::size_t end, int thread)
    {
      if (!tracers[thread])
      {
        tracers[thread] = std::make_unique<BeamTracer>(scene);
      }
      DrawnRays given(&work.rays[begin]);
      const TracedBeams block{ &work.frames[begin], end - begin, rays, &given };
      const TracedHits& found = tracers[thread]->traceBeams(block, mode);
      for (std::size_t b = begin; consumer && b < end; ++b)
      {
        const std::vector<Hit> hits =
          hitsOf(tree, work.frames[b], work.rays[b], found.triangles[b - begin]);
        consumer(b * work.raysPerBeam, hits.data(), work.raysPerBeam);
      }
    };
    parallelFor(work.beams(), avianlidar::beamsPerBlock(static_cast<int>(rays)), threads, body);
  };
}

namespace
{
struct Wedge
{
  Vec3 a, ab, ac;
};

Hit nearest(const std::vector<Wedge>& wedges, const Vec3& d)
{
  Hit hit;
  for (std::size_t t = 0; t < wedges.size(); ++t)
  {
    const Wedge& w = wedges[t];
    const Vec3 p = glm::cross(d, w.ac);
    const double determinant = glm::dot(w.ab, p);
    const Vec3 q = glm::cross(-w.a, w.ab);
    const double u = glm::dot(-w.a, p) / determinant;
    const double v = glm::dot(d, q) / determinant;
    const double range = glm::dot(w.ac, q) / determinant;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && range > 0.0 && range < hit.range)
    {
      hit.triangle = static_cast<std::uint32_t>(t);
      hit.range = range;
    }
  }
  return hit;
}
}

Tracer bruteForce(const Scene& scene)
{
  std::vector<Wedge> wedges;
  for (std::uint32_t t = 0; t < scene.mesh->size(); ++t)
  {
    const Vec3 a = scene.mesh->corner(t, 0) - scene.apex;
    wedges.push_back(
      { a, scene.mesh->corner(t, 1) - scene.apex - a, scene.mesh->corner(t, 2) - scene.apex - a });
  }
  return [wedges](const Workload& work, int, const Consumer& consumer)
  {
    std::vector<Hit> hits(work.size());
    for (std::size_t i = 0; i < work.size(); ++i)
    {
      hits[i] = nearest(wedges, work.direction(i));
    }
    if (consumer)
    {
      consumer(0, hits.data(), hits.size());
    }
  };
}

namespace
{
constexpr float Far = std::numeric_limits<float>::infinity();

void traceSingle(
  RTCScene scene, const Workload& work, std::size_t ray, Hit* hits, std::size_t count)
{
  EmbreeQuery query;
  RTCRayHit r{};
  r.ray.mask = 0xffffffffu;
  for (std::size_t i = 0; i < count; ++i)
  {
    r.ray.dir_x = work.x[ray + i];
    r.ray.dir_y = work.y[ray + i];
    r.ray.dir_z = work.z[ray + i];
    r.ray.tfar = Far;
    r.hit.geomID = r.hit.primID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    query.trace(scene, r);
    hits[i].triangle = r.hit.primID;
    hits[i].range = r.ray.tfar;
  }
}

void tracePackets(
  RTCScene scene, const Workload& work, std::size_t ray, Hit* hits, std::size_t count)
{
  EmbreeQuery query(true);
  alignas(64) int valid[16];
  alignas(64) RTCRayHit16 r{};
  std::fill_n(r.ray.mask, 16, 0xffffffffu);
  for (std::size_t i = 0; i < count; i += 16)
  {
    const std::size_t lanes = std::min<std::size_t>(16, count - i);
    std::memcpy(r.ray.dir_x, &work.x[ray + i], sizeof r.ray.dir_x);
    std::memcpy(r.ray.dir_y, &work.y[ray + i], sizeof r.ray.dir_y);
    std::memcpy(r.ray.dir_z, &work.z[ray + i], sizeof r.ray.dir_z);
    for (std::size_t k = 0; k < 16; ++k)
    {
      valid[k] = k < lanes ? -1 : 0;
      r.ray.tfar[k] = Far;
      r.hit.geomID[k] = r.hit.primID[k] = r.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    query.trace(scene, valid, r);
    for (std::size_t k = 0; k < lanes; ++k)
    {
      hits[i + k].triangle = r.hit.primID[k];
      hits[i + k].range = r.ray.tfar[k];
    }
  }
}

template <class Trace>
Tracer blockwise(RTCScene scene, Trace trace)
{
  return [=](const Workload& work, int threads, const Consumer& consumer)
  {
    std::vector<std::vector<Hit>> buffers(threads);
    const auto body = [&](std::size_t begin, std::size_t end, int thread)
    {
      // Denormal numbers off, as Embree's manual advises, and on again when it is done.
      const unsigned mode = _mm_getcsr();
      _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
      _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
      const std::size_t first = begin * work.raysPerBeam;
      const std::size_t count = (end - begin) * work.raysPerBeam;
      buffers[thread].resize(count);
      trace(scene, work, first, buffers[thread].data(), count);
      _mm_setcsr(mode);
      if (consumer)
      {
        consumer(first, buffers[thread].data(), count);
      }
    };
    parallelFor(work.beams(), work.beamsPerBlock(), threads, body);
  };
}
}

EmbreeScene::EmbreeScene(const Scene& scene, int buildThreads)
{
  this->Device = rtcNewDevice(("threads=" + std::to_string(buildThreads)).c_str());
  if (!this->Device)
  {
    throw std::runtime_error("Embree gave no device");
  }
  rtcSetDeviceMemoryMonitorFunction(this->Device, &EmbreeScene::countMemory, this);
  this->Scene_ = rtcNewScene(this->Device);
  rtcSetSceneBuildQuality(this->Scene_, RTC_BUILD_QUALITY_MEDIUM);
  const TriangleMesh& mesh = *scene.mesh;
  RTCGeometry geometry = rtcNewGeometry(this->Device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
    geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.points.size()));
  for (const Vec3& p : mesh.points)
  {
    for (int k = 0; k < 3; ++k)
    {
      *points++ = static_cast<float>(p[k] - scene.apex[k]);
    }
  }
  void* triangles = rtcSetNewGeometryBuffer(
    geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.size());
  std::memcpy(triangles, mesh.triangles.data(), mesh.size() * sizeof(mesh.triangles[0]));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(this->Scene_, geometry);
  rtcReleaseGeometry(geometry);
}

EmbreeScene::~EmbreeScene()
{
  rtcReleaseScene(this->Scene_);
  rtcReleaseDevice(this->Device);
}

void EmbreeScene::build()
{
  rtcCommitScene(this->Scene_);
  if (rtcGetDeviceError(this->Device) != RTC_ERROR_NONE)
  {
    throw std::runtime_error("Embree could not build its tree");
  }
}

bool EmbreeScene::countMemory(void* self, ssize_t bytes, bool)
{
  __atomic_add_fetch(&static_cast<EmbreeScene*>(self)->Bytes, bytes, __ATOMIC_RELAXED);
  return true;
}

Tracer EmbreeScene::single() const
{
  return blockwise(this->Scene_, traceSingle);
}

Tracer EmbreeScene::packets() const
{
  return blockwise(this->Scene_, tracePackets);
}

std::string embreeDescription()
{
  RTCDevice device = rtcNewDevice("threads=1");
  const auto number = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  const auto native = [&](RTCDeviceProperty p) { return rtcGetDeviceProperty(device, p) != 0; };
  const int width = native(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) ? 16
    : native(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)                ? 8
                                                                       : 4;
  rtcReleaseDevice(device);
  return "Embree " + std::to_string(number / 10000) + "." + std::to_string(number / 100 % 100) +
    "." + std::to_string(number % 100) + ", native packets of " + std::to_string(width);
}

namespace
{
/// Where the lidar stands in the locators' data: not in the planes that they cut space by.
const Vec3 Stand(17.3127, -5.7713, 0.9131);

/// The surfaces in a frame near the lidar, in double precision.
vtkSmartPointer<vtkPolyData> toPolyData(const Scene& scene)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec3& p : scene.mesh->points)
  {
    const Vec3 q = p - scene.apex + Stand;
    points->InsertNextPoint(q.x, q.y, q.z);
  }
  vtkNew<vtkCellArray> cells;
  for (const auto& t : scene.mesh->triangles)
  {
    cells->InsertNextCell(
      { static_cast<vtkIdType>(t[0]), static_cast<vtkIdType>(t[1]), static_cast<vtkIdType>(t[2]) });
  }
  data->SetPoints(points);
  data->SetPolys(cells);
  return data;
}

VtkPeer peer(const Scene& scene, const vtkSmartPointer<vtkAbstractCellLocator>& locator)
{
  const vtkSmartPointer<vtkPolyData> data = toPolyData(scene);
  locator->SetDataSet(data);
  const double seconds = secondsOf([&]() { locator->BuildLocator(); });
  double reach = 0.0; // of the segments that are given to the locators, m
  for (const Vec3& p : scene.mesh->points)
  {
    reach = std::max(reach, 2.0 * glm::length(p - scene.apex));
  }
  const auto trace = [=](const Workload& work, int, const Consumer& consumer)
  {
    vtkNew<vtkGenericCell> cell;
    std::vector<Hit> hits(work.size());
    for (std::size_t i = 0; i < work.size(); ++i)
    {
      const Vec3 to = Stand + reach * work.direction(i);
      double t = 0.0;
      double x[3];
      double parametric[3];
      int part = 0;
      vtkIdType triangle = -1;
      if (locator->IntersectWithLine(&Stand.x, &to.x, 0.0, t, x, parametric, part, triangle, cell))
      {
        hits[i].triangle = static_cast<std::uint32_t>(triangle);
        hits[i].range = safeLength(Vec3(x[0], x[1], x[2]) - Stand);
      }
    }
    if (consumer)
    {
      consumer(0, hits.data(), hits.size());
    }
  };
  return { seconds, trace };
}

template <class Locator>
PeerMaker makerOf(const std::string& name)
{
  return { name, [](const Scene& scene) { return peer(scene, vtkSmartPointer<Locator>::New()); } };
}
}

std::vector<PeerMaker> vtkPeers()
{
  return { makerOf<vtkStaticCellLocator>("vtkStaticCellLocator"),
    makerOf<vtkModifiedBSPTree>("vtkModifiedBSPTree"), makerOf<vtkOBBTree>("vtkOBBTree") };
}

namespace
{
bool atEdge(const Scene& scene, const Hit& hit, const Vec3& d)
{
  if (!hit.valid())
  {
    return false;
  }
  const geometrytest::PairResult pair =
    geometrytest::testPair(*scene.mesh, hit.triangle, scene.apex, geometrytest::wide(d));
  return pair.edgeAngle < 1e-5 + 16.0 * 0x1p-24 * pair.size / std::max(hit.range, 1e-3);
}
}

HitAgreement compareHits(const Scene& scene, const Workload& work, const std::vector<Hit>& ours,
  const std::vector<Hit>& theirs)
{
  HitAgreement agreement;
  agreement.rays = ours.size();
  for (std::size_t i = 0; i < ours.size(); ++i)
  {
    agreement.hits += ours[i].valid();
    const bool same = ours[i].valid() == theirs[i].valid() &&
      (!ours[i].valid() || std::fabs(ours[i].range - theirs[i].range) <= 1e-3 * ours[i].range);
    if (!same)
    {
      ++agreement.differ;
      const Vec3 d = work.direction(i);
      agreement.atEdges += atEdge(scene, ours[i], d) || atEdge(scene, theirs[i], d);
    }
  }
  return agreement;
}
}
