# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: the beam of the selected echo, the surfaces in the beam, and the share of each surface.

Select an echo first, by Select Points On in a render view or as a row of a spreadsheet. The echo may be of the echo
filter, or of a filter downstream that keeps beam_id. The macro makes an Avian Lidar Beam View with the inputs and the
air of the scan. If the scan already has a beam view, the macro sets its Beam Id. The cone is translucent, and the parts
of the surfaces in the beam are coloured by their share of the energy. A table lists the shares. After an error there
are no new objects, and Output Messages gives the reason.

In ParaView: choose the macro in the menu Macros. In a script: show_beam(echoes, beam_id, view).
"""

from paraview import servermanager, simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import (
    SHARES, colour_by, free_name, legend, plugin_folder, run, say, scan_of, selected_beams, show, start)

TITLE = "show beam"
SHARE, VIEW = "energy_share", "AvianLidarBeamView"
INPUTS = ("Beams", "Surfaces", "Movers")
WHAT_TO_SELECT = "select an echo first (Select Points On in the view, or a row of a spreadsheet)"
AIR = ("AttenuationCoefficient", "MeteorologicalVisibility", "AirBackscatter", "RainRate", "ReflectanceModel")
CONE_COLOUR, CONE_OPACITY = (1.0, 0.7, 0.2), 0.25
# Shift of the drawn parts towards the lidar, off the surfaces of the scene: metres, and share of the range.
NEARER, NEARER_SHARE = 0.01, 0.002
HEIGHT = 0.75  # share of the height of the view above the table


def selected_beam():
    """(source, beam_id) of the first selected echo."""
    source, ids = next(selected_beams(), (None, []))
    if source is None:
        raise ValueError(WHAT_TO_SELECT)
    if len(set(ids)) > 1:
        several = f"echoes of {len(set(ids))} beams are selected"
        say(TITLE, f"{several}: the view shows the beam {ids[0]}", failed=False)
    return source, ids[0]


def same(one, other):
    """Whether two inputs are connected to the same output."""
    pairs = [(getattr(port, "Proxy", port), getattr(port, "Port", 0)) for port in (one, other)]
    return pairs[0] == pairs[1]


def view_of(scan):
    """The beam view with the inputs of a scan, if there is one."""
    for source in simple.GetSources().values():
        if source.SMProxy.GetXMLName() == VIEW and all(
                same(getattr(source, name), getattr(scan, name)) for name in INPUTS):
            return source
    return None


def show_parts(beam, view):
    """Shows the surfaces by their share of the energy, shifted towards the lidar, and the cone."""
    cone = simple.OutputPort(beam, 1)
    data = servermanager.Fetch(beam, idx=1)
    show(cone, view, CONE_COLOUR, Opacity=CONE_OPACITY)
    display = show(beam, view, Representation="Surface With Edges", Ambient=1.0, Diffuse=0.0)
    apex, count = data.GetPoint(0), data.GetNumberOfPoints()
    middle = [sum(data.GetPoint(i)[axis] for i in range(1, count)) / (count - 1) for axis in range(3)]
    length = sum((a - b) ** 2 for a, b in zip(middle, apex)) ** 0.5
    # The property is Translation from ParaView 5.12 on.
    place = "Translation" if "Translation" in display.ListProperties() else "Position"
    display.SetPropertyWithName(place, [-(NEARER / length + NEARER_SHARE) * (a - b) for a, b in zip(middle, apex)])
    table = colour_by(display, "CELLS", SHARE, "Viridis (matplotlib)", (0.0, 1.0))
    legend(table, view, "share of the energy").WindowLocation = "Upper Right Corner"
    display.SetScalarBarVisibility(view, True)


def show_table(beam, view):
    """Shows the shares in a spreadsheet below the view."""
    sheet = simple.FindView(SHARES)
    if sheet is None:
        sheet = simple.CreateView("SpreadSheetView")
        simple.RenameView(SHARES, sheet)
        layout = simple.GetLayout(view)
        if layout is not None:
            cell = layout.SplitViewVertical(view, HEIGHT)
            simple.AssignViewToLayout(sheet, layout, cell)
    shares = simple.OutputPort(beam, 2)
    simple.Show(shares, sheet, "SpreadSheetRepresentation")
    sheet.FieldAssociation = "Row Data"


def show_beam(source=None, beam_id=None, view=None):
    """Shows the beam of the selected echo, or the beam `beam_id` of a scan. @return the beam view"""
    plugin_folder(on_server=True)
    if beam_id is None:
        source, beam_id = selected_beam()
    scan = scan_of(source)
    if scan is None:
        raise ValueError(WHAT_TO_SELECT)
    view = start(view)
    if view.SMProxy.GetXMLName() != "RenderView":  # the echo was selected in a spreadsheet
        view = next((one for one in simple.GetRenderViews()), None) or simple.CreateView("RenderView")
    beam = view_of(scan)
    is_new = beam is None
    if is_new:
        inputs = {name: getattr(scan, name) for name in INPUTS}
        beam = simple.AvianLidarBeamView(registrationName=free_name("Beam"),
                                         **{name: value for name, value in inputs.items() if value is not None})
    beam.BeamId = beam_id
    for name in AIR:
        setattr(beam, name, getattr(scan, name))
    beam.UpdatePipeline(simple.GetAnimationScene().TimeKeeper.Time)
    if not beam.GetDataInformation(1).GetNumberOfPoints():  # Output Messages have the reason
        if is_new:
            simple.Delete(beam)
        raise ValueError(f"there is no beam {beam_id} to show")
    show_parts(beam, view)
    show_table(beam, view)
    simple.SetActiveView(view)
    simple.SetActiveSource(beam)
    return beam


if __name__ in ("__main__", "__vtkconsole__"):
    run(TITLE, show_beam, render=simple.RenderAllViews)
