// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarKITTIWriter
 * @brief Writes echoes as a KITTI scan (.bin), and labels as a file of SemanticKITTI (.label).
 *
 * Input port 0 is a vtkPointSet. For each point the file FileName holds four float32: x forward, y
 * left and z up in the sensor's frame, m, and `intensity` / 255. The field data `position` and
 * `orientation` give the sensor's frame. Without `position` the writer gives a warning and takes
 * the points as coordinates in the sensor's frame, with x right and y forward.
 *
 * With WriteLabels a file of the same name with the extension .label holds a uint32 for each point.
 * The lower 16 bits are the class of the object, or 300 + `material_id`. The upper 16 bits are
 * `object_id` + 1, or 0 without an object. Without `object_id`, the labels are `semantic_label` and
 * `instance_id`, as read from KITTI; without these arrays no labels are written, with a warning. If
 * LabelSource is the material, labels need `material_id`. With WriteLabels a FileName that ends
 * with .label gives an error.
 *
 * The writer writes both files as a whole, or no file. Sources: Geiger et al., "Vision meets
 * Robotics: The KITTI Dataset", IJRR 2013; Behley et al., "SemanticKITTI", ICCV 2019. Classes and
 * rounding: Documentation/reference/formats.md.
 *
 * Example: `writer->SetFileName("000000.bin"); writer->Write();`
 *
 * @sa vtkAvianLidarCloudWriter, vtkAvianLidarPointCloudReader
 */
#ifndef vtkAvianLidarKITTIWriter_h
#define vtkAvianLidarKITTIWriter_h

#include "vtkAvianLidarCloudWriter.h"

class VTKAVIANLIDAR_EXPORT vtkAvianLidarKITTIWriter : public vtkAvianLidarCloudWriter
{
public:
  static vtkAvianLidarKITTIWriter* New();
  vtkTypeMacro(vtkAvianLidarKITTIWriter, vtkAvianLidarCloudWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum LabelSources
  {
    LABEL_SOURCE_OBJECT_CLASS = 0,
    LABEL_SOURCE_MATERIAL = 1
  };

  /// Whether the file of labels is written too. Default: on.
  vtkAvianLidarSwitchMacro(WriteLabels, true);

  ///@{
  /** Source of the lower 16 bits of a label. Default LABEL_SOURCE_OBJECT_CLASS. */
  vtkAvianLidarLimitedMacro(
    LabelSource, LABEL_SOURCE_OBJECT_CLASS, LABEL_SOURCE_MATERIAL, LABEL_SOURCE_OBJECT_CLASS);
  void SetLabelSourceToObjectClass() { this->SetLabelSource(LABEL_SOURCE_OBJECT_CLASS); }
  void SetLabelSourceToMaterial() { this->SetLabelSource(LABEL_SOURCE_MATERIAL); }
  ///@}

protected:
  vtkAvianLidarKITTIWriter() = default;
  ~vtkAvianLidarKITTIWriter() override = default;

  void WriteCloud(vtkPointSet* input) override;

private:
  vtkAvianLidarKITTIWriter(const vtkAvianLidarKITTIWriter&) = delete;
  void operator=(const vtkAvianLidarKITTIWriter&) = delete;
};

#endif
