// SPDX-License-Identifier: BSD-3-Clause
#include "Tracers.h"

#include "ParallelLoop.h"

#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace benchmarks
{
using namespace avianlidar;

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
}
