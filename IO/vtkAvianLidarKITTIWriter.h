// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarKITTIWriter
 * @brief Writes echoes as a KITTI scan (.bin) and, beside it, SemanticKITTI's labels (.label).
 *
 * FileName gets four float32 for each point: x forward, y left, z up in metres in the sensor's
 * frame (the field data `position` and `orientation` say where that is; without them a warning is
 * given and the frame is that of the points, x right and y forward), and `intensity` / 255 (0
 * without it; intensities beyond 0 and 255 become these, with a warning). float32 rounds a
 * coordinate by at most 2^-25 of the next power of two above it: 4 micrometres at 100 m, 0.12 mm at
 * 4 km from the sensor.
 *
 * With WriteLabels the same name with the ending .label gets a uint32 for each point: class in the
 * lower 16 bits, instance in the upper ones. Classes are SemanticKITTI's by the class of the object
 * (`object_id` through the field data `object_classes`; the table of words is in
 * Documentation/formats.md, 0 is unlabeled) or, with LabelSource Material, 300 + `material_id`,
 * from a range that SemanticKITTI leaves free. The instance is (`object_id` + 1) modulo 65536, 0
 * without an object. `object_id` (and `material_id` for LabelSource Material) are needed then.
 *
 * Both files are written as a whole, or neither is, see vtkAvianLidarCloudWriter; the points take
 * their name last. A FileName that ends with .label is an error: its labels would have it, too.
 *
 * Sources: Geiger et al., "Vision meets Robotics: The KITTI Dataset", IJRR 2013; Behley et al.,
 * "SemanticKITTI", ICCV 2019.
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

  /// Values of LabelSource.
  enum LabelSources
  {
    LABEL_SOURCE_OBJECT_CLASS = 0,
    LABEL_SOURCE_MATERIAL = 1
  };

  ///@{
  /**
   * Write the labels, too. Default on.
   */
  vtkSetMacro(WriteLabels, bool);
  vtkGetMacro(WriteLabels, bool);
  vtkBooleanMacro(WriteLabels, bool);
  ///@}

  ///@{
  /**
   * What the class of a label is made of. Default LABEL_SOURCE_OBJECT_CLASS.
   */
  vtkSetClampMacro(LabelSource, int, LABEL_SOURCE_OBJECT_CLASS, LABEL_SOURCE_MATERIAL);
  vtkGetMacro(LabelSource, int);
  void SetLabelSourceToObjectClass() { this->SetLabelSource(LABEL_SOURCE_OBJECT_CLASS); }
  void SetLabelSourceToMaterial() { this->SetLabelSource(LABEL_SOURCE_MATERIAL); }
  ///@}

protected:
  vtkAvianLidarKITTIWriter();
  ~vtkAvianLidarKITTIWriter() override;

  void WriteCloud(vtkPointSet* input) override;

  bool WriteLabels;
  int LabelSource;

private:
  vtkAvianLidarKITTIWriter(const vtkAvianLidarKITTIWriter&) = delete;
  void operator=(const vtkAvianLidarKITTIWriter&) = delete;
};

#endif
