// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file OurTracer.h
 * @brief The traversal of this project, and brute force, as contenders.
 */
#ifndef avianlidar_OurTracer_h
#define avianlidar_OurTracer_h

#include "BeamTracer.h"
#include "CollisionTree.h"
#include "Workload.h"

namespace benchmarks
{
/// BeamTracer on a tree that outlives it. What is timed ends with the nearest triangle of each ray,
/// found by ranges in single precision with bounds, as those of the peers are; the exact ranges are
/// another step of a scan (RaySamples), and computed here only for a consumer.
Tracer ourTracer(const avianlidar::CollisionTree& tree, avianlidar::TraceMode mode);

/// Every triangle against every ray: Moeller and Trumbore's test ("Fast, Minimum Storage
/// Ray-Triangle Intersection", 1997), double precision, no tree. Shares no code with the others.
Tracer bruteForce(const Scene& scene);
}

#endif
