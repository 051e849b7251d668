# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: colours the trails of the selected Avian Lidar Tracks by species, with the names in the legend.

A species has the same colour in all views, and the legend keeps the species of earlier tracks. The first Apply of Avian
Lidar Tracks also runs the macro.

In ParaView: select the tracks, and choose the macro in the menu Macros. In a script: colour([tracks], view).
"""

from paraview import servermanager, simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import data, legend, rgb, run, show

ARRAY, NAMES = "species_id", "species_names"

def species_of(tracks):
    """{id: name} of the species in a source of tracks."""
    trails = servermanager.Fetch(tracks, idx=1)
    ids, names = trails.GetCellData().GetArray(ARRAY), trails.GetFieldData().GetAbstractArray(NAMES)
    found = sorted({int(ids.GetValue(i)) for i in range(ids.GetNumberOfValues())}) if ids else []
    return {number: names.GetValue(number) for number in found}


def colour_of_species(number):
    """The colour of a species, in the order of the built-in species."""
    colours = data("look.json")["species"]
    return rgb(colours[number % len(colours)])


def colour_of(tracks):
    """The colour of the first species in a source of tracks."""
    return colour_of_species(min(species_of(tracks), default=0))


def colour(sources, view=None, **properties):
    """Shows the trails of sources of tracks by species, with one legend."""
    table = simple.GetColorTransferFunction(ARRAY)
    species = dict(zip(map(int, table.Annotations[::2]), table.Annotations[1::2]))
    for tracks in sources:
        if tracks is None or tracks.SMProxy.GetXMLName() != "AvianLidarTracks":
            raise ValueError("select Avian Lidar Tracks first")
        species.update(species_of(tracks))
    view = view or simple.GetActiveViewOrCreate("RenderView")
    for tracks in sources:
        display = show(simple.OutputPort(tracks, 1), view, **properties)
        simple.ColorBy(display, ("CELLS", ARRAY))
    table.InterpretValuesAsCategories = 1
    table.AnnotationsInitialized = 1
    table.Annotations = [text for number in sorted(species) for text in (str(number), species[number])]
    table.IndexedColors = [value for number in sorted(species) for value in colour_of_species(number)]
    table.IndexedOpacities = [1.0] * len(species)
    bar = legend(table, view, "species")
    bar.WindowLocation = "Lower Right Corner"
    for tracks in sources:
        simple.GetDisplayProperties(simple.OutputPort(tracks, 1), view).SetScalarBarVisibility(view, True)


if __name__ in ("__main__", "__vtkconsole__"):
    run("species colours", colour, [simple.GetActiveSource()])
