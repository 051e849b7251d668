// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ConvexBody.h
 * @brief Whether surfaces are one closed convex body: such a body cannot light itself.
 *
 * All corners lie on one side of each triangle, and the triangles' normals, each as long as the
 * area, sum to nothing, as those of a closed body do.
 *
 * Source: none.
 * Valid: within 1e-6 of the body's size; degenerate triangles are passed over.
 * Test: Testing/Python/TestAdvice.py (sphere, corner).
 */
#ifndef avianlidar_ConvexBody_h
#define avianlidar_ConvexBody_h

#include "TriangleMesh.h"

namespace avianlidar
{
/// Of a mesh of at least one triangle. @param from must be outside
bool isConvexBody(const TriangleMesh& mesh, const Vec3& from);
}

#endif
