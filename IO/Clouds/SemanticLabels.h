// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SemanticLabels.h
 * @brief Gives the LAS point class and the SemanticKITTI label of each class of objects.
 * Documentation/reference/formats.md has the same table.
 */
#ifndef AvianLidarSemanticLabels_h
#define AvianLidarSemanticLabels_h

#include <string>

namespace avianlidar::formats
{
struct SemanticLabel
{
  int las;   ///< ASPRS standard point class of LAS 1.4, 0 to 255
  int kitti; ///< class of SemanticKITTI, the lower 16 bits of a label
};

/// Returns the labels of an object class, in upper or lower case. The labels are 1 (unclassified)
/// and 0 (unlabeled) for a class that is not in the table.
SemanticLabel labelOfClass(const std::string& objectClass);

/// Returns the labels of echoes without an object: the labels of the class "air" for light from the
/// air (object_id -2), else 1 and 0.
SemanticLabel labelWithoutObject(int objectId);

/// Returns the label of a material in the free range of SemanticKITTI: 300 + id, or 0 without a
/// material.
int labelOfMaterial(int materialId);
}

#endif
