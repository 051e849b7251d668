// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SemanticLabels.h
 * @brief Gives the LAS point class and the SemanticKITTI label of each class of objects. The table
 * is in Documentation/reference/formats.md, too.
 */
#ifndef AvianLidarSemanticLabels_h
#define AvianLidarSemanticLabels_h

#include <string>

namespace avianlidar::formats
{
struct SemanticLabel
{
  int las;   ///< ASPRS standard point class of LAS 1.4
  int kitti; ///< SemanticKITTI
};

/// The labels of an object class, whatever its case; 1 (unclassified) and 0 (unlabeled) for a word
/// that is not in the table.
SemanticLabel labelOfClass(const std::string& objectClass);

/// The label of echoes without an object: of air that sends light back (object_id -2) those of the
/// class "air", else 1 and 0.
SemanticLabel labelWithoutObject(int objectId);

/// Label of SemanticKITTI's free range for a material: 300 + its id, 0 for none.
int labelOfMaterial(int materialId);
}

#endif
