// SPDX-License-Identifier: BSD-3-Clause
#include "BeamTrace.h"

#include <algorithm>
#include <utility>

namespace avianlidar
{
namespace
{
void fetch(const void* data, std::size_t bytes)
{
#if defined(__GNUC__)
  constexpr std::size_t line = 64;
  const char* const begin = static_cast<const char*>(data);
  for (std::size_t i = 0; i < bytes; i += line)
  {
    __builtin_prefetch(begin + i);
  }
#endif
}

/// No more than the nearest caches hold.
template <class T>
void fetch(const std::vector<T>& values)
{
  constexpr std::size_t most = 4096;
  fetch(values.data(), std::min(most, values.size() * sizeof(T)));
}
}

void fetchBeam(const BeamTrace& trace)
{
  fetch(&trace, sizeof(BeamTrace));
}

void fetchParts(const BeamTrace& trace)
{
  fetch(trace.hits.get(), sizeof(PrimaryHits));
  fetch(trace.patch.get(), sizeof(VisiblePatch));
  fetch(trace.strengths.get(), sizeof(PathStrengths));
}

void fetchArrays(const BeamTrace& trace)
{
  if (trace.hits && trace.strengths)
  {
    fetch(trace.hits->range);
    fetch(trace.strengths->direct);
    fetch(trace.hits->ray);
    fetch(trace.strengths->paths.length);
    fetch(trace.strengths->paths.strength);
    fetch(trace.strengths->paths.ends);
    fetch(trace.hits->cosine);
    fetch(trace.hits->triangle);
  }
}

void ShadingChange::follow(const ScanSetup& setup)
{
  this->isNew = this->number == 0 || !this->shading.isOf(setup);
  if (!this->isNew)
  {
    return;
  }
  Shading next(setup);
  const SharedBlocks<Material>& before = this->shading.materials;
  const SharedBlocks<Material>& after = next.materials;
  this->repainted.clear();
  if (this->number > 0 && before.size() == after.size() &&
    this->shading.largestReflectance == next.largestReflectance &&
    this->shading.model == next.model && this->shading.aperture == next.aperture)
  {
    this->repainted.resize(before.size());
    for (std::size_t k = 0; k < after.blocks(); ++k)
    {
      const std::size_t count = after.sharesBlock(k, before) ? 0 : after.block(k).size();
      for (std::size_t i = 0; i < count; ++i)
      {
        const Material& old = before.block(k)[i];
        const Material& now = after.block(k)[i];
        this->repainted[k * after.BlockSize + i] =
          old.kd != now.kd || old.ks != now.ks || old.kp != now.kp;
      }
    }
  }
  this->shading = std::move(next);
  ++this->number;
}

bool ShadingChange::touch(const BeamTrace& trace) const
{
  if (this->repainted.empty())
  {
    return true;
  }
  const auto isRepainted = [this](std::uint32_t triangle) { return this->isRepainted(triangle); };
  if (std::any_of(trace.hits->triangle.begin(), trace.hits->triangle.end(), isRepainted))
  {
    return true;
  }
  // Connections are of two hits; mirror paths end anywhere.
  return trace.secondary &&
    std::any_of(trace.secondary->mirrorPaths.begin(), trace.secondary->mirrorPaths.end(),
      [this](const MirrorPath& path) { return this->isRepainted(path.triangle); });
}

bool ShadingChange::touch(const VisiblePatch& patch) const
{
  return this->repainted.empty() ||
    std::any_of(patch.triangles.begin(), patch.triangles.end(),
      [this](std::uint32_t triangle) { return this->isRepainted(triangle); });
}
}
