# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: the waveform of a beam against range, in a line chart.

Select an echo, a sample of a waveform or a point of a beam report first (Select Points On, or a row of a spreadsheet).
Without a selection the macro takes the beam with the strongest echo. The macro switches Record Waveforms of the scan on.
The chart shows the mean signal, the drawn samples, the energy of the range units and the threshold of the receiver. It
follows the scan: change the pulse of the beam source, press Apply, and the chart changes. After an error there are no
new objects, and Output Messages gives the reason.

In ParaView: choose the macro in the menu Macros, or its button. In a script: plot_waveform(echoes, beam_id).
"""

from paraview import servermanager, simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import ECHO_FILTER, WAVEFORM, of_kind, plugin_folder, run, scan_of, selected_beams

TITLE = "plot waveform"
PORT, ARRAY = 3, "beam_id"
# Words and colour of each array.
SERIES = {"signal": ("mean signal", "0.9", "0.5", "0.1"), "sample": ("drawn sample", "0.1", "0.4", "0.8"),
          "energy_received": ("range unit", "0.6", "0.6", "0.6"), "threshold": ("threshold", "0.8", "0.1", "0.1")}


def strongest(scan):
    """The beam of the strongest echo."""
    echoes = servermanager.Fetch(scan, idx=0).GetPointData()
    ids, energies = echoes.GetArray(ARRAY), echoes.GetArray("energy_received")
    if not ids or not ids.GetNumberOfTuples():
        raise ValueError("the scan has no echoes")
    return int(ids.GetTuple1(max(range(ids.GetNumberOfTuples()), key=energies.GetTuple1)))


def plot_waveform(source=None, beam_id=None):
    """Shows the waveform of the selected beam, or of the beam `beam_id` of a scan. @return the chart's view"""
    plugin_folder(on_server=True)
    if source is None:
        source, ids = next(selected_beams(), (simple.GetActiveSource(), []))
        beam_id = ids[0] if ids and beam_id is None else beam_id
    scan = scan_of(source) or next(iter(of_kind(ECHO_FILTER)), None)
    if scan is None:
        raise ValueError("make a scan first: there is no Avian Lidar Echo Filter")
    scan.RecordWaveforms = 1
    scan.UpdatePipeline(simple.GetAnimationScene().TimeKeeper.Time)
    beam = strongest(scan) if beam_id is None else beam_id
    ids = servermanager.Fetch(scan, idx=PORT).GetCellData().GetArray(ARRAY)
    if not ids or not any(ids.GetTuple1(i) == beam for i in range(ids.GetNumberOfTuples())):
        raise ValueError(f"beam {beam} has no waveform: no signal above Waveform Floor ({scan.WaveformFloor:g})")
    chart = simple.FindView(WAVEFORM)
    lines = simple.FindSource(WAVEFORM) or simple.Threshold(registrationName=WAVEFORM, Input=simple.OutputPort(scan, PORT))
    lines.Input = simple.OutputPort(scan, PORT)
    lines.Scalars = ["CELLS", ARRAY]
    lines.LowerThreshold = lines.UpperThreshold = beam
    if chart is None:
        view = simple.GetActiveView()
        layout = simple.GetLayout(view) if view else None
        chart = simple.CreateView("XYChartView")
        simple.RenameView(WAVEFORM, chart)
        if layout is not None:
            simple.AssignViewToLayout(chart, layout, layout.SplitViewVertical(view, 0.55))
    display = simple.Show(lines, chart, "XYChartRepresentation")
    display.AttributeType = "Point Data"
    display.UseIndexForXAxis = 0
    display.XArrayName = "distance_m"
    display.SeriesVisibility = list(SERIES)
    display.SeriesColor = [part for series, (_, *colour) in SERIES.items() for part in (series, *colour)]
    display.SeriesLabel = [part for series, (words, *_) in SERIES.items() for part in (series, words)]
    chart.ChartTitle, chart.LegendLocation = f"Beam {beam}", "TopLeft"
    chart.BottomAxisTitle, chart.LeftAxisTitle = "range (m)", "energy (J)"
    # Noise may be negative, which a logarithmic axis of its own choice would not show.
    found = servermanager.Fetch(lines).GetPointData()
    least, most = found.GetArray("threshold").GetRange()[0], found.GetArray("energy_received").GetRange()[1]
    chart.LeftAxisUseCustomRange, chart.LeftAxisLogScale = 1, 1
    chart.LeftAxisRangeMinimum, chart.LeftAxisRangeMaximum = 0.05 * least, 3 * max(least, most)
    return chart


if __name__ in ("__main__", "__vtkconsole__"):
    run(TITLE, plot_waveform, render=simple.RenderAllViews)
