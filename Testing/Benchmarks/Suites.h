// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Suites.h
 * @brief The measurements, each a process of its own. Every one returns false if hits disagree.
 */
#ifndef avianlidar_Suites_h
#define avianlidar_Suites_h

#include "BenchmarkScene.h"
#include "Results.h"

#include <functional>

namespace benchmarks
{
/// What is measured with: libraries and compiler.
bool suiteMachine(const Options& options);

/// Ours against Embree: every scene, N, half-beamwidth and number of threads.
bool suiteMatrix(const Options& options);

/// VTK's locators and brute force, per ray, on 500 beams.
bool suiteLocators(const Options& options);

/// Building the tree against Embree's builder of medium quality; memory.
bool suiteBuild(const Options& options);

/// Fig. 9: split rules and volumes, tree and detection, every beam by itself.
bool suiteFigure9(const Options& options);

/// Fig. 10: the proposed method against a loop over all facets, and against a descent per ray.
bool suiteFigure10(const Options& options);

/// Fig. 11: the eight combinations of beam constraint, light-energy constraint and batch.
bool suiteFigure11(const Options& options);

/// epsilon of the light-energy constraint: time, and what is lost.
bool suiteEpsilon(const Options& options);

/// Sec. 5.2 and 5.3: the original method, the proposed one, and the defaults of this project, on
/// whole scans.
bool suiteSection5(const Options& options);

/// Cost against the number of triangles at fixed visible geometry.
bool suiteGrowth(const Options& options);

/// The stages of the filter, whole updates, lighting known hits again; airports.
bool suiteFilter(const Options& options);

/// Whole scans without refinement beside Embree tracing the same rays and nothing else, one thread;
/// airports.
bool suiteScan(const Options& options);

/// Peak memory of tree and scan; airports.
/// Time and error of scans beside those of rays that Embree traces.
bool suiteFront(const Options& options);

bool suiteMemory(const Options& options);

/// Birds that move: a scan whose static hits are known, against a tree of its own for every beam;
/// one thread, time of the processor. Outdoor scenes.
bool suiteMovers(const Options& options);

/// All scenes of the matrix that are wanted and here, one after the other; says what is left out.
void forEachScene(const Options& options, const std::function<void(const Scene&)>& measure);
}

#endif
