// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarKITTIWriter
 * @brief Writes echoes as a KITTI scan (.bin) and, beside it, SemanticKITTI's labels (.label).
 *
 * Input port 0 is a vtkPointSet. FileName gets x forward, y left, z up (m, in the sensor's frame)
 * and `intensity` / 255 as float32 for each point. The field data `position` and `orientation` give
 * the frame; without them a warning is given, and x is right, y forward.
 *
 * With WriteLabels a file of the same name with the ending .label gets a uint32 for each point. The
 * lower 16 bits are the class of the object, or 300 + `material_id`; the upper 16 bits are
 * `object_id` + 1. This needs the arrays `object_id` and, for materials, `material_id`. A FileName
 * that ends with .label gives an error.
 *
 * Either both files are written as a whole, or neither. Sources: Geiger et al., "Vision meets
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

  ///@{
  /** Whether labels are also written. Default: on. */
  vtkSetMacro(WriteLabels, bool);
  vtkGetMacro(WriteLabels, bool);
  vtkBooleanMacro(WriteLabels, bool);
  ///@}

  ///@{
  /** Source of the class of a label. Default LABEL_SOURCE_OBJECT_CLASS. */
  vtkSetClampMacro(LabelSource, int, LABEL_SOURCE_OBJECT_CLASS, LABEL_SOURCE_MATERIAL);
  vtkGetMacro(LabelSource, int);
  void SetLabelSourceToObjectClass() { this->SetLabelSource(LABEL_SOURCE_OBJECT_CLASS); }
  void SetLabelSourceToMaterial() { this->SetLabelSource(LABEL_SOURCE_MATERIAL); }
  ///@}

protected:
  vtkAvianLidarKITTIWriter();
  ~vtkAvianLidarKITTIWriter() override;

  void WriteCloud(vtkPointSet* input) override;

  bool WriteLabels = true;
  int LabelSource = LABEL_SOURCE_OBJECT_CLASS;

private:
  vtkAvianLidarKITTIWriter(const vtkAvianLidarKITTIWriter&) = delete;
  void operator=(const vtkAvianLidarKITTIWriter&) = delete;
};

#endif
