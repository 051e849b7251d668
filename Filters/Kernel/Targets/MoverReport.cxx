// SPDX-License-Identifier: BSD-3-Clause
#include "MoverReport.h"

#include "ParallelLoop.h"
#include "Silhouette.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

namespace avianlidar
{
std::vector<MoverReport> reportMovers(const ScanSetup& setup, const ScanBeams& beams,
  const std::vector<MoverLight>& sights, int threads, const std::function<bool()>& wanted)
{
  std::vector<MoverReport> reports(setup.movers ? setup.movers->size() : 0);
  std::vector<const MoverLight*> best(reports.size(), nullptr);
  constexpr double never = std::numeric_limits<double>::infinity();
  std::vector<std::array<double, 2>> met(reports.size(), { never, -never }); // first and last time
  for (const MoverLight& sight : sights)
  {
    MoverReport& report = reports[sight.mover];
    const MoverLight*& known = best[sight.mover];
    report.touched = true;
    report.beams += sight.held;
    if (sight.held || sight.energy > 0.0)
    {
      met[sight.mover][0] = std::min(met[sight.mover][0], beams.timeOf(sight.beam));
      met[sight.mover][1] = std::max(met[sight.mover][1], beams.timeOf(sight.beam));
    }
    report.probability = 1.0 - (1.0 - report.probability) * (1.0 - sight.probability);
    if (!known || sight.energy > known->energy ||
      (sight.energy == known->energy && sight.offAxis < known->offAxis))
    {
      known = &sight;
    }
  }
  if (beams.size() == 0)
  {
    return reports;
  }
  const auto times = std::minmax_element(beams.times.begin(), beams.times.end());
  const double middle = beams.times.empty() ? 0.0 : 0.5 * (*times.first + *times.second);
  const auto describe = [&](std::size_t begin, std::size_t end, int)
  {
    for (std::size_t m = begin; m < end; ++m)
    {
      const Mover& mover = (*setup.movers)[m];
      MoverReport& report = reports[m];
      const std::size_t beam = best[m] ? best[m]->beam : 0;
      const Vec3& origin = beams.origins[beam];
      report.beam = beam;
      report.energy = best[m] ? best[m]->energy : 0.0;
      report.present = poseAt(mover, best[m] ? beams.timeOf(beam) : middle, report.pose);
      report.first = report.last = report.pose;
      if (report.present && met[m][0] <= met[m][1])
      {
        poseAt(mover, met[m][0], report.first);
        poseAt(mover, met[m][1], report.last);
      }
      if (report.present)
      {
        TriangleMesh mesh;
        place(mover, report.pose, mesh);
        const MoverSphere sphere = sphereAt(mover, report.pose);
        const Vec3 to = sphere.center - origin;
        const bool isOutside = sphere.radius < safeLength(to);
        report.effectiveArea = isOutside ? effectiveArea(mesh, unitVector(to))
                                         : std::numeric_limits<double>::quiet_NaN();
        report.range = safeLength(report.pose.position - origin);
        report.origin = origin;
      }
    }
  };
  if (!parallelFor(
        reports.size(), 1, threads, describe, [&](double) { return !wanted || wanted(); }))
  {
    throw WorkStopped();
  }
  return reports;
}
}
