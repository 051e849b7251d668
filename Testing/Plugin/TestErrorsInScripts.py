# SPDX-License-Identifier: BSD-3-Clause
"""An error in a script, of pvpython or of pvbatch on ranks: while it lasts nothing is shown, not what was shown before; its words
are in the field data and were printed once; what comes after it is seen.

Run by pvpython, or by pvbatch with the number of ranks."""

import os
import sys
import tempfile

from paraview import simple
from plugin_testing import airport, assert_same, fetch, load_plugin
from vtkmodules.vtkCommonDataModel import vtkDataObject


def printed(run):
    """What this process prints as errors during a call."""
    with tempfile.TemporaryFile("w+") as file:
        sys.stderr.flush()
        before = os.dup(2)
        os.dup2(file.fileno(), 2)
        try:
            run()
        finally:
            os.dup2(before, 2)
            os.close(before)
        file.seek(0)
        return file.read()


def error_of(proxy):
    array = proxy.GetDataInformation().GetArrayInformation("error", vtkDataObject.FIELD)
    return array.GetStringValue(0) if array else ""


def shown(proxy, view):
    return simple.GetRepresentation(proxy, view).SMProxy.GetRepresentedDataInformation().GetNumberOfPoints()


def main(ranks="1"):
    load_plugin()
    assert simple.servermanager.ActiveConnection.GetNumberOfDataPartitions() == int(ranks)
    _, tree, beams, echoes = airport(columns=240)
    colours = simple.AvianLidarHSBColorMap(Input=echoes)
    view = simple.CreateView("RenderView")
    for proxy in (echoes, colours):
        simple.Show(proxy, view)
    simple.Render(view)
    first = "AttenuationCoefficient is -1"
    words = {echoes: first, colours: "Input port 0: its producer failed: " + first}
    counts = [shown(echoes, view)]
    for good in (1e-3, 1e-4):
        echoes.AttenuationCoefficient = -1
        said = printed(lambda: simple.Render(view))
        assert said.count(first) == len(words), said
        for proxy, error in words.items():
            assert said.count("): " + error) == 1, said
            assert error_of(proxy).startswith(error), (error, error_of(proxy))
            assert shown(proxy, view) == 0, shown(proxy, view)
        echoes.AttenuationCoefficient = good
        assert printed(lambda: simple.Render(view)) == ""
        expected = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=tree, AttenuationCoefficient=good)
        assert_same(fetch(echoes), fetch(expected))
        for proxy in words:
            assert error_of(proxy) == ""
            assert shown(proxy, view) == expected.GetDataInformation().GetNumberOfPoints() > 0
        counts.append(shown(echoes, view))
    assert len(set(counts)) == 3, counts


if __name__ == "__main__":
    main(*sys.argv[1:])
