// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarAdvisor
 * @brief Which settings of vtkAvianLidarEchoFilter a scene requires, measured on it.
 *
 * Inputs and properties are those of the echo filter: beams, surfaces and, if there are any,
 * movers; air, limits and return mode as they are set. On SampleBeams beams of the scan (those with
 * echoes, those that meet movers and some of the others, the same ones each time) a ladder of
 * settings is scanned and compared with a reference of high fidelity: errors of energy, of range,
 * and echoes missed or invented, each with a bound of 95 %, and the time of a beam. The settings
 * that are advised are the fastest whose bounds are below EnergyError, RangeError and MissedShare;
 * there are none if no setting of the ladder surely meets them. BeamSamples, RaysPerBeam, Sampling,
 * NumberOfReflections, NumberOfConnections and Preset are the first of the ladder, to compare with.
 * Noise is off in all scans, as it is no error. How it is measured: Documentation/advise.md.
 *
 * Output port 0: vtkTable, one row for each setting. Columns (int): `beam_samples`,
 * `rays_per_beam`, `sampling`, `number_of_reflections`, `number_of_connections`, `turns`, `verdict`
 * (0 an error is above what is asked, 1 the beams cannot tell, 2 all are met); (double):
 * `seconds_per_beam` s of one core, `energy_error`, `range_error` m, `missed_share`, and with
 * `_most` their upper bounds. Field data: `advised` (row; -1: none), `advice` (lines of text: what
 * is advised and why, the settings as command, in Python and for ParaView).
 *
 * The choice of beams and all errors have the same bits for any number of threads and each time;
 * times differ, and with them which of two settings that take nearly the same time is advised.
 *
 * **Bad input**: what is an error of the echo filter is one here, as are errors asked for that are
 * not above 0, and fewer than 50 beams. Without an echo nothing is advised. After an abort the
 * table is empty.
 *
 * MPI ranks work together as those of the echo filter do.
 *
 * @sa vtkAvianLidarEchoFilter
 */
#ifndef vtkAvianLidarAdvisor_h
#define vtkAvianLidarAdvisor_h

#include "vtkAvianLidarEchoFilter.h"
#include "vtkAvianLidarModule.h" // For export macro

#include <string> // For the advice

namespace avianlidar
{
struct AdviceAnswer;
}
class vtkTable;

class VTKAVIANLIDAR_EXPORT vtkAvianLidarAdvisor : public vtkAvianLidarEchoFilter
{
public:
  static vtkAvianLidarAdvisor* New();
  vtkTypeMacro(vtkAvianLidarAdvisor, vtkAvianLidarEchoFilter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Error of the energy received that is allowed, rms, relative to it, above 0. Default: 0.02.
   */
  vtkSetMacro(EnergyError, double);
  vtkGetMacro(EnergyError, double);
  ///@}

  ///@{
  /**
   * Error of ranges that is allowed, rms, m, above 0. Default: 0.05.
   */
  vtkSetMacro(RangeError, double);
  vtkGetMacro(RangeError, double);
  ///@}

  ///@{
  /**
   * Echoes that may be missed or invented, as a share of the true ones, above 0. Default: 0.01.
   */
  vtkSetMacro(MissedShare, double);
  vtkGetMacro(MissedShare, double);
  ///@}

  ///@{
  /**
   * Beams that errors are measured on, a count, 50 to 1000000. A share of echoes below 3 over the
   * number of echoes among them cannot be told from 0. Default: 1000.
   */
  vtkSetMacro(SampleBeams, int);
  vtkGetMacro(SampleBeams, int);
  ///@}

  ///@{
  /**
   * Result of the last execution, properties of the echo filter by their numbers: -1 if nothing is
   * advised.
   */
  vtkGetMacro(AdvisedBeamSamples, int);
  vtkGetMacro(AdvisedRaysPerBeam, int);
  vtkGetMacro(AdvisedSampling, int);
  vtkGetMacro(AdvisedNumberOfReflections, int);
  vtkGetMacro(AdvisedNumberOfConnections, int);
  ///@}

  /**
   * Result of the last execution, a text of several lines: what is advised and why; empty before
   * the first.
   */
  const char* GetAdvice() const { return this->Advice.c_str(); }

  /**
   * The table.
   */
  vtkTable* GetTable();

protected:
  vtkAvianLidarAdvisor();
  ~vtkAvianLidarAdvisor() override = default;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  double EnergyError = 0.02;
  double RangeError = 0.05;
  double MissedShare = 0.01;
  int SampleBeams = 1000;
  int AdvisedBeamSamples = -1;
  int AdvisedRaysPerBeam = -1;
  int AdvisedSampling = -1;
  int AdvisedNumberOfReflections = -1;
  int AdvisedNumberOfConnections = -1;
  std::string Advice;

private:
  vtkAvianLidarAdvisor(const vtkAvianLidarAdvisor&) = delete;
  void operator=(const vtkAvianLidarAdvisor&) = delete;

  std::string CheckQuestion() const;
  bool Advise(const vtkAvianLidarRanks& ranks, vtkTable* table);
  void Take(const avianlidar::AdviceAnswer& answer);
};

#endif
